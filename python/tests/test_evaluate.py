"""Layouts to scores: the bits of the program, on any number of threads."""

import numpy as np
import pytest

import granulens as gl

from conftest import call, told


def layouts(design: gl.Design, count: int) -> np.ndarray:
    random = np.random.default_rng(1)
    found = np.zeros((count, design.sites), np.uint8)
    inside = (design.table()["row"] > 1) & (design.table()["row"] < 7)
    found[:, inside] = random.integers(0, 2, (count, inside.sum()))
    return found


def test_scores_are_those_of_check(small):
    some = layouts(small, 5)
    table = gl.evaluate(small, some)
    for k, row in enumerate(some):
        small.layout(row).write(f"{k}.csv")
        said = told("check", f"{k}.csv", "--design", "small.toml")
        for name in ("focal_mean_J", "protected_mean_J", "contrast", "focal_gain", "protection"):
            assert table[name][k] == said[name], name
    assert table["stop"] == [None] * 5


def test_bits_do_not_depend_on_threads_nor_on_neighbours(small):
    some = layouts(small, 21)
    one, two, four = (gl.evaluate(small, some, threads=threads) for threads in (1, 2, 4))
    alone = gl.evaluate(small, some[7])
    for name, column in one.items():
        if name != "stop":
            assert (column == two[name]).all() and (column == four[name]).all() and column[7] == alone[name][0]


def test_an_evaluator_is_made_once(small):
    judge = gl.Evaluator(small, forces=3, band=0.01)
    table = judge(layouts(small, 4))
    assert table["contrast"].shape == (4,) and (table["contrast_sd"] > 0).all()
    small.layout(layouts(small, 4)[2]).write("2.csv")
    said = told("check", "2.csv", "--design", "small.toml", "--forces", "3", "--band", "1 %")
    assert table["contrast"][2] == said["contrast_mean"] and table["contrast_sd"][2] == said["contrast_sd"]
    assert judge.method["step_s"] == said["step_s"]


def test_records_are_there_where_they_are_asked_for(small):
    table = gl.evaluate(small, layouts(small, 2), records=True)
    plain = gl.evaluate(small, layouts(small, 2))
    assert (table["contrast"] == plain["contrast"]).all()
    assert {"focal_momentum_kg_m_s", "far_force_N"} <= set(table) and "far_force_N" not in plain


def test_layouts_that_are_none_are_refused(small):
    good = layouts(small, 3)
    for wrong in (good.astype(float), good[:, :-1], good[None], good + 7, good.astype(int) - 1):
        with pytest.raises(gl.InputError, match="layout"):
            gl.evaluate(small, wrong)
    whole = gl.evaluate(small, good.astype(np.int64))
    assert (whole["contrast"] == gl.evaluate(small, good)["contrast"]).all()
    with pytest.raises(gl.InputError, match="step"):
        gl.evaluate(small, good, step="1 ms")
    with pytest.raises(gl.InputError, match="threads"):
        gl.evaluate(small, good, threads=0)


def test_tables_become_data_frames(small):
    pandas, polars = pytest.importorskip("pandas"), pytest.importorskip("polars")
    table = gl.evaluate(small, layouts(small, 6))
    for frame in (pandas.DataFrame(table), polars.DataFrame(table)):
        assert len(frame) == 6 and frame["contrast"].max() == table["contrast"].max()


def test_simulate_is_check_with_records(small):
    call("design", "small.toml", "--out", "lens.csv")
    said = told("check", "lens.csv", "--design", "small.toml", "--spheres", "spheres.csv")
    record = gl.simulate(small.layout("lens.csv"))
    for name in ("focal_mean_J", "contrast", "focal_gain", "protection", "residual", "dissipated_J"):
        assert record.scores[name] == said[name], name
    assert (record.method["step_s"], record.steps, record.stop) == (said["step_s"], said["steps"], None)
    lines = open("spheres.csv").read().splitlines()
    column = lines[0].split(",").index("max_kinetic_J")
    assert [float(line.split(",")[column]) for line in lines[1:]] == record.spheres["max_kinetic_J"].tolist()
    # What was put in is somewhere, to what the scheme leaves over at this step.
    energies = record.energies
    left = energies["work_in_J"] - energies["kinetic_J"] - energies["stored_J"] - energies["dissipated_J"]
    assert abs(left) < 5e-3 * energies["work_in_J"]
    assert record.spheres["displacement_m"].shape == (small.sites, 2)
    assert "contrast" in record._repr_html_()


def test_pictures_are_drawn_on_a_given_axis(small):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    _, axes = plt.subplots(1, 4)
    lens = small.propose()
    assert lens.plot(axes[0]) is axes[0] and len(axes[0].lines) == 24
    layout = lens.layout
    assert layout.plot(axes[1]) is axes[1] and len(axes[1].collections[0].get_offsets()) == small.sites
    gl.simulate(layout).plot(axes[2])
    gl.surface(shape=(20, 20)).plot(axes[3])
    plt.gcf().canvas.draw()
    for thing in (lens, layout):
        assert thing._repr_svg_().startswith("<svg")
