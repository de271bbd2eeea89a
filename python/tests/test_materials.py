"""Materials, contacts and waves, against closed forms and the program."""

import numpy as np
import pytest

import granulens as gl

from conftest import call, told


def test_library_is_that_of_the_program():
    table, said = gl.materials(), told("materials")["materials"]
    assert table["name"] == [material["name"] for material in said]
    assert (table["density_kg_m3"] == [material["density_kg_m3"] for material in said]).all()


def test_hertz_is_the_closed_form():
    """F = 4/3 E* sqrt(R*) d^(3/2) (Johnson 1985, eq. 4.22), to rounding."""
    steel, diameter = gl.find_material("440c"), 6.35e-3
    modulus = 0.5 * steel.youngs_modulus / (1 - steel.poisson_ratio**2)
    overlap = np.linspace(0, 2e-5, 50)
    found = gl.contact_path("440c", overlap=overlap, law="hertz", diameter="6.35 mm")
    expected = 4 / 3 * modulus * np.sqrt(diameter / 4) * overlap**1.5
    assert np.allclose(found["force_N"], expected, rtol=1e-12)
    assert found["force_N"].shape == (50,)


def test_plastic_contacts_lose_energy_and_elastic_ones_do_not():
    path = np.concatenate([np.linspace(0, 1e-4, 4000), np.linspace(1e-4, 0, 4000)])
    work = {}
    for law in ("hertz", "thesis"):
        found = gl.contact_path("brass-260", overlap=path, law=law)
        work[law] = np.trapezoid(found["force_N"], found["overlap_m"]) / found["force_N"].max() / 1e-4
    # The path is cut into 4000 pieces, so that the trapezoids of one way and the other agree to rounding.
    assert abs(work["hertz"]) < 1e-12 and work["thesis"] > 0.1


def test_restitution_falls_with_speed_and_is_one_without_loss():
    speeds = np.array([0.1, 1.0, 10.0])
    assert np.allclose(gl.collide("440c", speeds=speeds, law="hertz")["restitution"], 1.0, atol=1e-5)
    plastic = gl.collide("brass-260", speeds=speeds)["restitution"]
    assert (np.diff(plastic) < 0).all() and plastic[-1] < 0.6


def test_wave_speeds_are_those_of_the_program():
    for dimension in (1, 2, 3):
        said = told("speed", "--material", "440c", "--material", "al", "--dimension", str(dimension), "--amplitude", "2")
        found = gl.wave_speed("440c", "al", dimension=dimension, amplitude=2)
        for name in ("speed_m_s", "stiffness_N_m", "fully_plastic_force_N", "expected_speed_m_s"):
            assert found[name] == said[name]


def test_surfaces_hold_the_bound_of_a_medium():
    """Where a medium lies its own speed is the surface's, as far as the grid is fine."""
    surface = gl.surface("speed", shape=(60, 50))
    assert surface.values.shape == (50, 60) and surface.x.shape == (60,) and surface.y.shape == (50,)
    media = surface.media
    at = media["label"].index("440C") if "440C" in media["label"] else 0
    i = np.abs(np.log(surface.x / media["x"][at])).argmin()
    j = np.abs(np.log(surface.y / media["y"][at])).argmin()
    # V goes as the root of both axes, whose nodes lie a few per cent apart.
    assert surface.values[j, i] == pytest.approx(media["value"][at], rel=0.1)
    assert surface._repr_svg_().startswith("<svg")


def test_materials_of_ones_own():
    mine = gl.Material("mine", density=2700.0, youngs_modulus=70e9, poisson_ratio=0.33, yield_stress=250e6)
    assert gl.wave_speed(mine)["speed_m_s"] > 0 and "mine" in repr(mine)
    with pytest.raises(gl.InputError, match="poisson_ratio"):
        gl.Material("mine", density=2700.0, youngs_modulus=70e9, poisson_ratio=0.7, yield_stress=250e6)
    with pytest.raises(ValueError) as raised:
        gl.wave_speed("unobtainium")
    # The words are the program's.
    assert raised.value.message in call("speed", "--material", "unobtainium", code=2).stderr
