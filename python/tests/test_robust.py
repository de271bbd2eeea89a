"""How scores change with every sphere, and what pieces as made are worth: the numbers of the command line, and closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import granulens as gl
from conftest import told as told_by


@pytest.fixture
def layout(small):
    return small.propose().layout


def test_sensitivities_are_those_of_the_command_line(layout):
    found = gl.sensitivity(layout, ["focal_mean", "contrast"])
    layout.write("lens.csv")
    told = told_by("sensitivity", "lens.csv", "--design", "small.toml", "--of", "focal_mean,contrast")
    for one in told["sensitivities"]:
        table = found.sites[one["measure"]]
        for column in ("d_density", "d_youngs_modulus", "d_yield_stress", "d_radius", "secant_density", "linear"):
            np.testing.assert_array_equal(table[column], one[column])
        assert found.d_force[one["measure"]] == one["d_force"]
    assert found.focal_mean_J == told["focal_mean_J"]


def test_energies_go_as_stresses_densities_and_load_together(layout):
    found = gl.sensitivity(layout, ["focal_mean"])
    of = found.sites["focal_mean"]
    total = of["d_density"].sum() + of["d_youngs_modulus"].sum() + of["d_yield_stress"].sum() + found.d_force["focal_mean"]
    assert abs(total - 1.0) < 1e-6


def test_tolerances_are_those_of_the_command_line(layout):
    found = gl.tolerance(layout, samples=40, seed=3)
    layout.write("lens.csv")
    told = told_by("tolerance", "lens.csv", "--design", "small.toml", "--samples", "40", "--seed", "3")
    assert (found["yield"], list(found["interval"])) == (told["yield"], told["interval"])
    assert found["samples"] == told["samples"] == 40
    assert len(found["pieces"]["stop"]) == 40
    assert gl.tolerance(layout, samples=40, seed=3, threads=1)["pieces"]["contrast"].tolist() == found["pieces"]["contrast"].tolist()


def test_what_cannot_be_asked_is_refused(layout):
    with pytest.raises(gl.InputError, match="there are derivatives of"):
        gl.sensitivity(layout, ["half_mass"])
    with pytest.raises(gl.InputError, match="adams and verlet"):
        gl.sensitivity(layout, integrator="rk4")


def test_tables_are_arrow_tables_too(layout):
    pyarrow = pytest.importorskip("pyarrow")
    table = gl.arrow(gl.simulate(layout).spheres)
    assert isinstance(table, pyarrow.Table)
    assert {"max_kinetic_J", "displacement_m_x", "displacement_m_z"} <= set(table.column_names)
