"""Rigs, beds, force networks and motion, against conservation and closed forms."""

import numpy as np
import pytest

import granulens as gl

from conftest import REPOSITORY, told

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
def bed():
    text = (REPOSITORY / "designs/bed.toml").read_text()
    return gl.Bed.parse(text.replace("width = 100", "width = 14").replace("height = 60", "height = 10").replace(
        "diameter = 10", "diameter = 3").replace("mass = 100", "mass = 40").replace("window = 400", "window = 60"))


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
