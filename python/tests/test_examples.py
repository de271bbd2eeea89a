"""Examples and notebooks run from begin to end."""

import json
import subprocess
import sys

import pytest

from conftest import REPOSITORY

EXAMPLES = REPOSITORY / "python/examples"
NOTEBOOKS = REPOSITORY / "python/notebooks"


def run(name: str, evaluations: int) -> dict:
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / name), "--evaluations", str(evaluations)], capture_output=True, text=True, cwd=EXAMPLES
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_cma_beside_level_sets():
    pytest.importorskip("cma")
    told = run("by_cma.py", 320)
    # Both find what no strip or mixture is; which is better is a matter of the seed.
    assert told["evaluations"] == 320 and told["cma"] > 1.5 and told["level_set"] > 1.5, told


def test_optuna_beside_lens_families():
    pytest.importorskip("optuna")
    told = run("by_optuna.py", 64)
    assert told["optuna"] > 1.05 and told["lens_family"] > 1.05, told


def test_pymoo_beside_nsga():
    pytest.importorskip("pymoo")
    told = run("by_pymoo.py", 400)
    assert told["pymoo"]["hypervolume"] > 0 and told["nsga2"]["hypervolume"] > 0, told


@pytest.mark.parametrize("name", sorted(path.name for path in NOTEBOOKS.glob("*.py")))
def test_notebooks_run(name, tmp_path):
    for package in ("jupytext", "nbconvert", "ipykernel", "matplotlib"):
        pytest.importorskip(package)
    made = tmp_path / f"{name}.ipynb"
    done = subprocess.run(
        [sys.executable, "-m", "jupytext", "--to", "ipynb", "--execute", "--output", str(made), str(NOTEBOOKS / name)],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    cells = json.loads(made.read_text())["cells"]
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    assert code and all(cell["execution_count"] for cell in code)
    drawn = [output for cell in code for output in cell["outputs"] if "data" in output]
    assert any({"image/svg+xml", "image/png"} & set(output["data"]) for output in drawn)
