"""Reads back what `granulens build` wrote, with libraries that are not ours: ezdxf, trimesh and pypdf.

    python3 tests/python/read_back.py FOLDER

Exit 0: all is as the lists say; 1: it is not; 77: the libraries are not to be had (pip install ezdxf trimesh lxml networkx pypdf).
"""

import collections
import csv
import json
import pathlib
import sys

try:
    import ezdxf
    import lxml  # noqa: F401  (trimesh reads 3MF with it and networkx)
    import networkx  # noqa: F401
    import pypdf
    import trimesh
except ImportError as error:
    print(f"not to be had: {error}; pip install ezdxf trimesh lxml networkx pypdf", file=sys.stderr)
    sys.exit(77)

folder = pathlib.Path(sys.argv[1])
told = json.loads((folder / "build.json").read_text())
with open(folder / "layout-full.csv") as file:
    spheres = list(csv.DictReader(line for line in file if not line.startswith("#")))


def expect(what, found, wanted, within=0.0):
    """Ends the program where a number or list is not as it should be."""
    close = abs(found - wanted) <= within if within else found == wanted
    if not close:
        sys.exit(f"{what}: {found}, expected {wanted}")


# The drawing for CAD.
drawing = ezdxf.readfile(folder / "map.dxf")
auditor = drawing.audit()
expect("errors in the DXF", [str(error) for error in auditor.errors], [])
expect("release", drawing.dxfversion, "AC1009")
circles = drawing.modelspace().query("CIRCLE")
expect("circles", len(circles), len(spheres))
by_layer = collections.Counter(circle.dxf.layer for circle in circles)
expect("circles by layer", sorted(by_layer.values()), sorted(part["count"] for part in told["parts"]))
for circle, sphere in zip(circles, spheres):
    expect("x", circle.dxf.center.x, 1e3 * float(sphere["x"]), 1e-6)
    expect("y", circle.dxf.center.y, -1e3 * float(sphere["z"]), 1e-6)
    expect("diameter", 2 * circle.dxf.radius, 1e3 * float(sphere["diameter"]), 1e-6)

# The frame.
frame = told["frame_mm"]
solids = {name: trimesh.load(folder / name, force="mesh") for name in ("frame.stl", "frame.3mf")}
for name, solid in solids.items():
    expect(f"{name}: a closed solid", solid.is_watertight and solid.is_winding_consistent, True)
width, depth = frame["width"], frame["depth"]
outer = (width + 2 * frame["wall"]) * (depth + frame["wall"])
volume = outer * frame["floor"] + (outer - width * depth) * frame["height"]
for name, solid in solids.items():
    expect(f"{name}: volume (mm3)", solid.volume, volume, 1e-5 * volume)
expect("unit of the 3MF", solids["frame.3mf"].units, "millimeter")
sizes = (width + 2 * frame["wall"], depth + frame["wall"], frame["floor"] + frame["height"])
for name, solid in solids.items():
    for found, wanted in zip(solid.extents, sizes):
        expect(f"{name}: size of the frame", found, wanted, 1e-4)

# The pages.
for paper, size in (("a4", (210, 297)), ("a3", (297, 420)), ("letter", (215.9, 279.4))):
    reader = pypdf.PdfReader(folder / f"map-{paper}.pdf")
    for page in reader.pages:
        sides = sorted(float(side) * 25.4 / 72 for side in (page.mediabox.width, page.mediabox.height))
        for found, wanted in zip(sides, size):
            expect(f"{paper}: side (mm)", found, wanted, 1e-3)
    words = "".join(page.extract_text() for page in reader.pages)
    for part in told["parts"]:
        expect(f"{paper}: {part['material']} in the legend", part["material"] in words, True)
pypdf.PdfReader(folder / "placement.pdf")
print("read back: DXF, STL, 3MF, PDF")
