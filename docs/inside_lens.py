#!/usr/bin/env python3
"""From `granulens export DESIGN --vtp FOLDER` the files that `granulens network` and `motion` read, in millimetres and newtons.

    granulens export designs/thesis-lens.toml --vtp lens --every "2 us"
    python3 docs/inside_lens.py lens lens-csv            # needs VTK: pip install vtk

Writes grains-NNNN.csv of every frame, and of the frame at which the focal region of the published lens (rows 30 to 34, 2.5 D about the
axis) has most kinetic energy contacts.csv and its parts before the lens (rows 1 to 4), in it (5 to 16) and behind it (17 to 34). The
sheet repeats itself over 33 D.
"""
import math
import pathlib
import sys

import vtk
from vtk.util.numpy_support import vtk_to_numpy

DIAMETER, WIDTH = 6.35, 33 * 6.35
ROW = DIAMETER * math.sqrt(3) / 2
PARTS = {"contacts": (1, 99), "before": (1, 4), "lens": (5, 16), "behind": (17, 34)}


def read(path):
    """Points (mm) and arrays of a VTP file."""
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    data = reader.GetOutput()
    arrays = {}
    for part in (data.GetPointData(), data.GetCellData()):
        arrays |= {part.GetArrayName(k): vtk_to_numpy(part.GetArray(k)) for k in range(part.GetNumberOfArrays())}
    points = vtk_to_numpy(data.GetPoints().GetData())[:, :2] if data.GetNumberOfPoints() else []
    # Heights for depths: the blow comes from above.
    return [(float(1e3 * x), float(-1e3 * z)) for x, z in points], arrays


def key(place):
    """A centre, whichever image of it."""
    return round(place[0] % WIDTH, 5) % WIDTH, round(place[1], 5)


source, target = map(pathlib.Path, sys.argv[1:])
target.mkdir()
first, _ = read(source / "spheres-0000.vtp")
rows = [round(-z / ROW) + 1 for _, z in first]
focus = [k for k, (x, _) in enumerate(first) if 30 <= rows[k] <= 34 and abs(x) <= 2.5 * DIAMETER + 1e-6]
most, moment = -1.0, 0
count = len(list(source.glob("spheres-*.vtp")))
for number in range(count):
    places, arrays = read(source / f"spheres-{number:04}.vtp")
    lines = [f"{k + 1},{x!r},{z!r},{DIAMETER}" for k, (x, z) in enumerate(places)]
    (target / f"grains-{number:04}.csv").write_text(f"# period_x = {WIDTH}\nid,x,z,diameter\n" + "\n".join(lines) + "\n")
    energy = arrays["kinetic_energy"][focus].mean()
    if energy > most:
        most, moment = energy, number
places, _ = read(source / f"spheres-{moment:04}.vtp")
known = {key(place): k for k, place in enumerate(places)}
ends, arrays = read(source / f"contacts-{moment:04}.vtp")
for name, (low, high) in PARTS.items():
    lines = [f"# period_x = {WIDTH}", "i,j,x_i,z_i,x_j,z_j,normal_N"]
    for k, force in enumerate(arrays["force"]):
        i = known[key(ends[2 * k])]
        # What touches its image over the seam ends a diameter less the overlap away: the nearest centre is meant.
        x, z = ends[2 * k + 1]
        j = known.get(key((x, z)))
        if j is None:
            near = lambda m: abs((places[m][0] - x + WIDTH / 2) % WIDTH - WIDTH / 2) + abs(places[m][1] - z)
            j = min(range(len(places)), key=near)
        if low <= rows[i] <= high and low <= rows[j] <= high:
            (xi, zi), (xj, zj) = places[i], places[j]
            lines.append(f"{i + 1},{j + 1},{xi!r},{zi!r},{xj!r},{zj!r},{float(force)!r}")
    (target / f"{name}.csv").write_text("\n".join(lines) + "\n")
print(f"frame {moment} of {count}: {most:.4g} J in the focal region")
