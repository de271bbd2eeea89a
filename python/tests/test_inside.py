"""Rigs, beds, force networks and motion, against conservation and closed forms."""

import numpy as np
import pytest

import granulens as gl

from conftest import REPOSITORY, call, told

CHAIN = """format = 1
kind = "rig"
name = "chain"
[crystal]
packing = "chain"
diameter = "20 mm"
layers = 6
material = "440c"
[law]
kind = "hertz"
[[moving]]
layers = 1
velocity = "0.5 m/s"
[run]
window = "300 us"
"""


def test_a_chain_keeps_momentum_and_energy(desk):
    """Nothing outside acts: m v of all is that of the first at the start to rounding, and Hertz loses nothing."""
    rig = gl.Rig.parse(CHAIN)
    run = rig.histories(every="5 us")
    mass = rig.table()["mass_kg"]
    assert run["velocity_m_s"].shape == (len(run["time_s"]), 6, 1)
    momentum = (run["velocity_m_s"][:, :, 0] * mass).sum(axis=1)
    assert np.allclose(momentum, 0.5 * mass[0], rtol=1e-11)
    energies = run["energies"]
    at_hand = energies["kinetic_J"] + energies["stored_J"]
    # Within a blow Verlet holds some back; at its end all is there.
    assert at_hand[-1] == pytest.approx(at_hand[0], rel=1e-3)
    assert run["stop"] is None and run["velocity_m_s"][-1, -1, 0] > 0.4


def test_histories_do_not_depend_on_threads_and_end_as_the_program_does(desk):
    (desk / "chain.toml").write_text(CHAIN)
    rig = gl.Rig("chain.toml")
    one, two = rig.histories(threads=1), rig.histories(threads=2)
    assert (one["displacement_m"] == two["displacement_m"]).all()
    said = told("simulate", "chain.toml", "--out", "records")
    ours = rig.run("ours")
    assert ours["energies"]["kinetic"] == said["energies"]["kinetic"] == one["energies"]["kinetic_J"][-1]
    assert (desk / "ours/spheres.csv").read_text() == (desk / "records/spheres.csv").read_text()


def test_a_layout_has_histories(small):
    run = gl.simulate(small.propose().layout).histories(every="2 us")
    assert run["displacement_m"].shape[1:] == (small.sites, 2)
    # Struck spheres move down, and nothing moves before the wave comes.
    assert (run["displacement_m"][0] == 0).all() and run["displacement_m"][-1][:, 1].mean() > 0


@pytest.fixture(scope="module")
def bed_text():
    text = (REPOSITORY / "designs/bed.toml").read_text()
    return text.replace("width = 100", "width = 14").replace("height = 60", "height = 10").replace(
        "diameter = 10", "diameter = 3").replace("mass = 100", "mass = 40").replace("window = 400", "window = 60")


@pytest.fixture(scope="module")
def bed(bed_text):
    return gl.Bed.parse(bed_text)


@pytest.fixture(scope="module")
def packing(bed):
    return bed.settle()


def test_a_bed_settles_is_struck_and_carries_its_weight(bed, packing, tmp_path):
    assert len(packing) == len(packing.diameters_d) == packing.measures()["grains"]
    packing.write(tmp_path / "bed.csv")
    assert (gl.Packing(tmp_path / "bed.csv").centres_d == packing.centres_d).all()
    course = bed.strike(packing)
    moments = course["moments"]
    assert course["max_depth_d"] >= course["final_depth_d"] > 0 and course["stop"] is None
    assert moments["depth_d"].max() == pytest.approx(course["max_depth_d"])
    assert len(course["grains"]["x_d"]) == len(packing)


def test_the_network_of_a_bed_obeys_euler(bed, packing):
    """Of a graph without places: loops = contacts - grains + components, at every threshold; at zero each contact counts."""
    contacts = bed.contacts(packing)
    net = gl.network(contacts, grains=len(packing), period=packing.width_d if packing.periodic else None)
    topology = net.topology
    at_zero = topology["thresholds"].tolist().index(0.0)
    involved = len(np.union1d(contacts["i"], contacts["j"]))
    components = topology["components"][at_zero]
    assert topology["loops"][at_zero] == len(contacts["i"]) - involved + components or topology["loops"][at_zero] == len(
        contacts["i"]
    ) - len(packing) + components
    assert net.coordination == pytest.approx(2 * len(contacts["i"]) / len(packing))
    assert net.fabric.shape == (2, 2) and net.chains and net._repr_svg_().startswith("<svg")
    with pytest.raises(gl.InputError, match="columns i, j and normal"):
        gl.network({"i": [0]})


def same(ours, theirs):
    """Two sets of frames, to the last bit."""
    assert (ours.units, ours.period, ours.grains, ours.kinds) == (theirs.units, theirs.period, theirs.grains, theirs.kinds)
    for name in ("times", "diameters", "places", "velocities", "spins", "forces"):
        assert (getattr(ours, name) == getattr(theirs, name)).all(), name
    assert len(ours.contacts) == len(theirs.contacts) == len(ours)
    for one, other in zip(ours.contacts, theirs.contacts):
        assert list(one) == list(other) and all((one[name] == other[name]).all() for name in one)


def test_frames_of_a_bed_are_those_of_the_command_line(bed, bed_text, packing, desk):
    """Places, velocities and forces at contacts to the last bit; a frame less or more changes nothing of the impact."""
    course = bed.strike(packing, every=5)
    plain = bed.strike(packing)
    assert plain["frames"] is None and all((plain["moments"][name] == course["moments"][name]).all() for name in plain["moments"])
    frames = course["frames"]
    bodies = len(frames.kinds)
    assert frames.times.tolist() == [5.0 * k for k in range(13)] and frames.grains == len(packing) == frames.kinds.count("grain")
    assert frames.places.shape == frames.velocities.shape == frames.forces.shape == (13, bodies, 2) and frames.spins.shape == (13, bodies)
    packing.write("bed.csv")
    head, rest = bed_text.split("[bed]", 1)
    others = rest[rest.index("\n[") :]
    (desk / "bed.toml").write_text(f'{head}[bed]\nfile = "bed.csv"\n{others}\n[record]\nevery = 5\n')
    call("impact", "bed.toml", "--out", "struck", "--quiet")
    same(frames, gl.read_frames("struck/frames"))
    # A file that asks for frames is heard.
    same(frames, gl.Bed("bed.toml").strike(packing)["frames"])
    with pytest.raises(gl.InputError, match="multiple of run.sample, 0.5"):
        bed.strike(packing, every=0.7)
    with pytest.raises(gl.InputError, match="no-such-folder"):
        gl.read_frames("no-such-folder")


def test_frames_go_into_network_and_motion(bed, packing, desk):
    """As the command line finds them of the same frames; and the forces at the contacts of a grain are the force on it."""
    frames = bed.strike(packing, every=5)["frames"]
    net = frames.network(4, thresholds=[0, 1, 2])
    contacts = frames.contacts[4]
    sums = np.zeros((len(frames.kinds), 2))
    across = contacts["x_j"] - contacts["x_i"]
    branch = np.stack([across - frames.period * np.round(across / frames.period), contacts["z_j"] - contacts["z_i"]], axis=1)
    along = branch / np.linalg.norm(branch, axis=1)[:, None]
    force = contacts["normal"][:, None] * along + contacts["tangential"][:, None] * np.stack([-along[:, 1], along[:, 0]], axis=1)
    np.add.at(sums, contacts["j"], force)
    np.add.at(sums, contacts["i"], -force)
    # Friction is of the velocities at the end of a step, forces of those predicted for it.
    assert np.abs(sums - frames.forces[4])[: frames.grains].max() < 0.02 * contacts["normal"].max()
    among = (contacts["i"] < frames.grains) & (contacts["j"] < frames.grains)
    assert net.coordination == pytest.approx(2 * among.sum() / frames.grains)
    moved = frames.motion(0, 12)
    header = "id,x,z,diameter"
    for name, k in (("before", 0), ("after", 12)):
        rows = np.column_stack([np.arange(1, frames.grains + 1), frames.places[k, : frames.grains], frames.diameters[: frames.grains]])
        np.savetxt(f"{name}.csv", rows, delimiter=",", header=header, comments="", fmt=["%d", "%.17g", "%.17g", "%.17g"])
    said = told("motion", "before.csv", "after.csv", "--period-x", str(frames.period))
    theirs = np.array([grain["d2min"] if grain["d2min"] is not None else np.nan for grain in said["grains"]])
    assert np.array_equal(moved["d2min"], theirs, equal_nan=True) or np.allclose(moved["d2min"], theirs, rtol=1e-12, equal_nan=True)
    assert np.nanmax(moved["d2min"]) > 1e-3


def test_frames_of_a_rig_are_those_of_simulate(desk):
    sheet = CHAIN.replace('"chain"', '"hexagonal"').replace("layers = 6", "layers = 4\ncells = [3]", 1).replace('name = "hexagonal"', 'name = "sheet"')
    (desk / "sheet.toml").write_text(sheet + '[record]\nevery = "20 us"\nframes = true\n')
    told("simulate", "sheet.toml", "--out", "records")
    frames = gl.Rig("sheet.toml").frames(every="20 us")
    same(frames, gl.read_frames("records/frames"))
    assert frames.units.startswith("s;") and len(frames) == 16 and len(frames.contacts[-1]["i"]) >= 0
    histories = gl.Rig("sheet.toml").histories(every="20 us")
    assert (histories["velocity_m_s"] == frames.velocities).all() and (histories["time_s"] == frames.times).all()


def test_affine_motion_leaves_nothing():
    """A pure shear of a lattice: D2_min is zero to rounding, and the map is the shear."""
    places = np.array([[i + 0.5 * (j % 2), 0.866 * j] for i in range(8) for j in range(8)])
    shear = np.array([[1.0, 0.1], [0.0, 1.0]])
    found = gl.motion(places, places @ shear.T, radius=1.5)
    known = found["neighbours"] >= 3
    assert known.sum() > 50 and np.isnan(found["d2min"][~known]).all()
    assert found["d2min"][known].max() < 1e-20 and np.allclose(found["map"][known], shear.ravel(), atol=1e-12)
    with pytest.raises(gl.InputError, match="shape"):
        gl.motion(np.zeros((3, 3)), np.zeros((3, 3)))
