"""A small crystal that takes milliseconds, a study of it, and the program beside which numbers are held."""

from __future__ import annotations

import json
import os
import subprocess
import time
from pathlib import Path

import pytest

import granulens as gl

REPOSITORY = Path(__file__).resolve().parents[2]

SMALL = """format = 1
name = "small"
[crystal]
packing = "hexagonal-2d"
diameter = "6.35 mm"
rows = 12
half_width = 4.5
sides = "mirror"
host = "stainless-440c"
law = "thesis"
[impact]
kind = "force-pulse"
force = "16 kN"
duration = "20 us"
[target]
focus = { rows = [8, 10], x = ["0 D", "1 D"] }
protect = { rows = [8, 10], x = ["3 D", "4.5 D"] }
[lens]
family = "plano-convex"
material = "brass-260"
apex_row = 2
back_row = 5
radius = "6 D"
[run]
window = "100 us"
"""

STUDY = """format = 1
design = "small.toml"
materials = ["stainless-440c", "brass-260"]
rows = [2, 6]
objective = { contrast = { maximise = 1 }, mass = { minimise = 0.5 } }
budget = 400
seed = 1
method = "nsga2"
start = ["lens", "random"]
"""


# A crystal in space of 1260 spheres: a twentieth of a second a layout.
SPACE = """format = 1
name = "small-space"
[crystal]
packing = "hcp"
diameter = "6.35 mm"
layers = 9
cells = [10, 7]
axis_layer = 2
sides = ["mirror", "period"]
host = "stainless-440c"
law = "thesis"
[impact]
kind = "force-pulse"
force = "20 kN"
duration = "20 us"
[target]
focus = { layers = [7, 8], r = ["0 D", "1.1 D"] }
protect = { layers = [7, 8], r = ["4 D", "5 D"] }
[lens]
family = "plano-convex"
material = "brass-260"
apex_layer = 2
back_layer = 5
radius = "5.5 D"
max_interface_angle = "75 deg"
[run]
window = "70 us"
step = "500 ns"
"""

# Bodies of revolution: spheres of a layer at one distance from the axis change together.
SPACE_STUDY = """format = 1
design = "space.toml"
materials = ["stainless-440c", "brass-260"]
layers = [2, 5]
r = ["0 D", "3 D"]
symmetry = "axis"
objective = { contrast = { maximise = 1 }, piece_mass = { minimise = 0.5 } }
budget = 32
seed = 1
method = "nsga2"
start = ["lens", "random"]
"""


def program() -> str:
    """The command-line program, beside which numbers are held."""
    for path in (os.environ.get("GRANULENS"), REPOSITORY / "target/debug/granulens", REPOSITORY / "target/release/granulens"):
        if path and Path(path).exists():
            return str(path)
    raise AssertionError("no granulens to compare with; build it, or name it in GRANULENS")


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of one test's own with small.toml and study.toml, in which it runs."""
    (tmp_path / "small.toml").write_text(SMALL)
    (tmp_path / "study.toml").write_text(STUDY)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def call(*arguments: str, code: int | None = 0) -> subprocess.CompletedProcess[str]:
    """The program, in the present folder."""
    done = subprocess.run([program(), *arguments], capture_output=True, text=True)
    assert code is None or done.returncode == code, done.stderr
    return done


def told(*arguments: str, code: int | None = 0) -> dict:
    """What the program says with --json."""
    return json.loads(call(*arguments, "--json", code=code).stdout)


@pytest.fixture
def small(desk: Path) -> gl.Design:
    return gl.Design("small.toml")


def wait_for(what: str, done, seconds: float = 60.0) -> None:
    """Until something is so; with words where it does not come."""
    until = time.monotonic() + seconds
    while not done():
        assert time.monotonic() < until, f"{what} did not come in {seconds} s"
        time.sleep(0.005)
