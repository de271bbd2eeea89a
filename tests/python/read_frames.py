"""Runs a small impact and a small crystal, and reads their frames back with libraries that are not ours: pandas, pyarrow, VTK, ASE and OVITO,
whose atomic strain is also held against ours.

    python3 tests/python/read_frames.py PROGRAM

PROGRAM is granulens; Parquet files are read back where it is built with the feature parquet. Exit 0: what was read is what was written; 1: it is not;
77: the libraries are not to be had (pip install pandas pyarrow vtk ase ovito).
"""

import io
import json
import pathlib
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

try:
    import ase.io
    import numpy as np
    import pandas
    import pyarrow.parquet
    import vtk
    from ovito.data import DataCollection, SimulationCell
    from ovito.io import import_file
    from ovito.modifiers import AtomicStrainModifier
    from ovito.pipeline import Pipeline, StaticSource
    from vtk.util.numpy_support import vtk_to_numpy
except ImportError as error:
    print(f"not to be had: {error}; pip install pandas pyarrow vtk ase ovito", file=sys.stderr)
    sys.exit(77)

PROGRAM = str(pathlib.Path(sys.argv[1]).resolve())
BED = """format = 1
kind = "bed"
name = "small"
[bed]
width = 24
height = 10
[intruder]
shape = "disk"
diameter = 3
mass = 9
speed = 0.7
height = 1
[run]
window = 20
[record]
every = 5
"""
RIG = """format = 1
kind = "rig"
name = "sheet"
[crystal]
packing = "hexagonal"
diameter = "6 mm"
layers = 6
cells = [5]
material = "brass-260"
[sides]
x = "periodic"
z = ["free", "wall"]
[[load]]
kind = "force"
layers = 1
pulse = "square"
peak = "5 kN"
duration = "20 us"
[law]
kind = "thesis"
[run]
window = "40 us"
[record]
every = "10 us"
frames = true
"""


def expect(what, found, wanted, within=0.0):
    """Ends the program where numbers or words are not as they should be."""
    close = np.all(np.abs(np.asarray(found) - np.asarray(wanted)) <= within) if within else np.all(found == wanted)
    if not close:
        sys.exit(f"{what}: {found}, expected {wanted}")


def granulens(*arguments):
    """Runs the program; what it prints."""
    ran = subprocess.run([PROGRAM, *map(str, arguments)], cwd=folder, capture_output=True, text=True)
    if ran.returncode:
        sys.exit(f"granulens {' '.join(map(str, arguments))}: {ran.returncode}\n{ran.stderr}")
    return ran.stdout


def frames(place):
    """(grains, contacts) of each frame, with pandas."""
    names = sorted(place.glob("*-grains.csv"))
    return [
        [pandas.read_csv(str(name).replace("grains", what), comment="#") for what in ("grains", "contacts")]
        for name in names
    ]


def balanced(grains, contacts, period, within):
    """The forces at the contacts of each grain add up to the force on it; `within` of the greatest normal force."""
    at = {str(name): place for place, name in enumerate(grains.id)}
    sums = np.zeros((len(grains), 2))
    for row in contacts.itertuples():
        x = row.x_j - row.x_i
        branch = np.array([x - period * round(x / period) if period else x, row.z_j - row.z_i])
        normal = branch / np.hypot(*branch)
        force = row.normal_N * normal + row.tangential_N * np.array([-normal[1], normal[0]])
        for name, sign in ((row.i, -1), (row.j, 1)):
            if str(name) in at:
                sums[at[str(name)]] += sign * force
    free = (grains.kind == "grain").to_numpy()
    most = contacts.normal_N.abs().max()
    expect("sums of forces", sums[free], grains[["fx", "fz"]].to_numpy()[free], within * most)


def vtk_of(path):
    """Points and arrays of a VTP file."""
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    data = reader.GetOutput()
    arrays = {}
    for attributes in (data.GetPointData(), data.GetCellData()):
        for k in range(attributes.GetNumberOfArrays()):
            arrays[attributes.GetArrayName(k)] = vtk_to_numpy(attributes.GetArray(k))
    return data, arrays


def flat(places, width, periodic):
    """Places in the plane as OVITO has them: in a cell of two dimensions, in which the map along the third is one."""
    data = DataCollection()
    cell = SimulationCell(pbc=(periodic, False, False), is2D=True)
    low, height = places[:, 1].min() - 1.0, np.ptp(places[:, 1]) + 2.0
    cell[:] = [[width, 0, 0, 0], [0, height, 0, low], [0, 0, 1, -0.5]]
    data.objects.append(cell)
    data.create_particles(count=len(places)).create_property("Position", data=np.column_stack([places, np.zeros(len(places))]))
    return data


def strained(before, after, width, periodic, radius):
    """D2_min and the deformation gradient by OVITO's atomic strain; it lays its gradient down column by column."""
    pipeline = Pipeline(source=StaticSource(data=flat(after, width, periodic)))
    modifier = AtomicStrainModifier(
        cutoff=radius,
        output_nonaffine_squared_displacements=True,
        output_deformation_gradients=True,
        minimum_image_convention=periodic,
    )
    modifier.reference = StaticSource(data=flat(before, width, periodic))
    pipeline.modifiers.append(modifier)
    done = pipeline.compute().particles
    gradient = np.asarray(done["Deformation Gradient"]).reshape(-1, 3, 3).transpose(0, 2, 1)[:, :2, :2]
    return np.asarray(done["Nonaffine Squared Displacement"]), gradient.reshape(-1, 4)


def same_motion(what, first, last, period, most):
    """D2_min of a run's grains, from its first frame to its last, is OVITO's to 1e-10, of what is `most` at the least somewhere."""
    grains = [pandas.read_csv(folder / name, comment="#").query("kind == 'grain'") for name in (first, last)]
    before, after = (table[["x", "z"]].to_numpy() for table in grains)
    radius = 2.2 * grains[0].diameter.mean()
    ours = pandas.read_csv(io.StringIO(granulens("motion", first, last, "--radius", repr(float(radius)), "--quiet")))
    d2min, gradient = strained(before, after, period or np.ptp(before[:, 0]) + 2.0 * radius, period is not None, radius)
    expect(f"{what}: some grains move", ours.d2min.max() > most, True)
    # Places of a sheet are in metres: what is small is told by the greatest.
    scale = max(ours.d2min.max(), 1e-300)
    expect(f"{what}: D2_min by OVITO", ours.d2min.to_numpy() / scale, d2min / scale, 1e-10)
    expect(f"{what}: the map by OVITO", ours[["a11", "a12", "a21", "a22"]].to_numpy(), gradient, 1e-10)


def same_tables(place, kept, period):
    """Parquet files hold what the frames hold, and say their period."""
    tables = [pandas.read_parquet(folder / place / f"{name}.parquet") for name in ("grains", "contacts")]
    for name, table in zip(("grains", "contacts"), tables):
        notes = pyarrow.parquet.read_schema(folder / place / f"{name}.parquet").metadata
        expect("period in Parquet", float(notes[b"period_x"]), period)
    for number, (grains, contacts) in enumerate(kept):
        bodies, touching = (table[table.frame == number].reset_index(drop=True) for table in tables)
        expect("bodies in Parquet", len(bodies), len(grains))
        for column in grains:
            expect(f"{column} in Parquet", bodies[column].to_numpy(), grains[column].to_numpy())
        expect("contacts in Parquet", len(touching), len(contacts))
        for column in contacts.columns.drop(["i", "j"]):
            expect(f"{column} in Parquet", touching[column].to_numpy(), contacts[column].to_numpy())
        for end in ("i", "j"):
            named = touching[end].astype(str).where(touching[end] > 0, touching["flat"].fillna(""))
            expect(f"{end} in Parquet", list(named), list(contacts[end].astype(str)))


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    (folder / "bed.toml").write_text(BED)
    (folder / "rig.toml").write_text(RIG)
    told = json.loads(granulens("impact", "bed.toml", "--out", "bed", "--json", "--quiet"))
    granulens("export", "bed/frames", "--vtp", "vtk", "--xyz", "bed.xyz", "--quiet")
    granulens("simulate", "rig.toml", "--out", "rig", "--quiet")

    # pandas.
    bed = frames(folder / "bed/frames")
    expect("frames of the bed", len(bed), 5)
    expect("grains", (bed[0][0].kind == "grain").sum(), told["grains"])
    for grains, contacts in bed[1:]:
        # Friction is of the velocities at the end of a step, forces of those predicted for it.
        balanced(grains, contacts, 24.0, 0.02)
    rig = frames(folder / "rig/frames")
    expect("frames of the rig", len(rig), 5)
    for grains, contacts in rig:
        if len(contacts):
            balanced(grains, contacts, 0.03, 1e-9)

    # OVITO's atomic strain.
    same_motion("bed", "bed/frames/000000-grains.csv", "bed/frames/000004-grains.csv", 24.0, 1e-2)
    same_motion("rig", "rig/frames/000000-grains.csv", "rig/frames/000004-grains.csv", 0.03, 1e-12)

    # Parquet.
    made = subprocess.run(
        [PROGRAM, "export", "bed/frames", "--parquet", "bed-tables", "--quiet"], cwd=folder, capture_output=True, text=True
    )
    if "built without the feature parquet" in made.stderr:
        print("Parquet files are left out: this granulens has not the feature parquet")
    else:
        expect("export --parquet", made.returncode, 0)
        granulens("export", "rig/frames", "--parquet", "rig-tables", "--quiet")
        same_tables("bed-tables", bed, 24.0)
        same_tables("rig-tables", rig, 0.03)

    # VTK.
    times = [float(file.get("timestep")) for file in xml.etree.ElementTree.parse(folder / "vtk/bodies.pvd").iter("DataSet")]
    expect("times in the collection", times, [0.0, 5.0, 10.0, 15.0, 20.0])
    for number, (grains, contacts) in enumerate(bed):
        data, arrays = vtk_of(folder / f"vtk/bodies-{number:06}.vtp")
        expect("bodies in VTK", data.GetNumberOfPoints(), len(grains))
        places = vtk_to_numpy(data.GetPoints().GetData())
        expect("x in VTK", places[:, 0], grains.x.to_numpy(), 1e-6 * 24)
        expect("velocities in VTK", arrays["velocity"][:, [0, 1]], grains[["vx", "vz"]].to_numpy())
        expect("spins in VTK", arrays["spin"], grains.spin.to_numpy())
        data, arrays = vtk_of(folder / f"vtk/contacts-{number:06}.vtp")
        expect("contacts in VTK", data.GetNumberOfLines(), len(contacts))
        expect("normal forces in VTK", arrays["normal_force"], contacts.normal_N.to_numpy())
        expect("tangential forces in VTK", arrays["tangential_force"], contacts.tangential_N.to_numpy())

    # ASE.
    images = ase.io.read(folder / "bed.xyz", index=":")
    expect("frames in ASE", len(images), 5)
    for atoms, (grains, _) in zip(images, bed):
        expect("bodies in ASE", len(atoms), len(grains))
        expect("period in ASE", (atoms.cell[0, 0], list(atoms.pbc)), (24.0, [True, False, False]))
        expect("x in ASE", atoms.positions[:, 0], grains.x.to_numpy())
        expect("radii in ASE", atoms.arrays["radius"], 0.5 * grains.diameter.to_numpy())
        expect("kinds in ASE", list(atoms.arrays["kind"]), list(grains.kind))

    # OVITO.
    pipeline = import_file(str(folder / "bed.xyz"))
    expect("frames in OVITO", pipeline.source.num_frames, 5)
    for number, (grains, _) in enumerate(bed):
        data = pipeline.compute(number)
        expect("bodies in OVITO", data.particles.count, len(grains))
        order = np.argsort(data.particles["Particle Identifier"][...])
        expect("radii in OVITO", data.particles["Radius"][...][order], 0.5 * grains.diameter.to_numpy(), 1e-6)
print("read back: pandas, Parquet, VTK, ASE, OVITO")
