"""Crystals in space: designs, layouts and studies."""

import pickle
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest

import granulens as gl

from conftest import SPACE, SPACE_STUDY, call, told

FILES = ("study.json", "best.csv", "journal.jsonl")


def files(folder):
    return [open(f"{folder}/{name}").read() for name in FILES]


@pytest.fixture
def space(desk):
    (desk / "space.toml").write_text(SPACE)
    (desk / "study.toml").write_text(SPACE_STUDY)
    return gl.SpaceDesign("space.toml")


def test_designs_and_layouts_are_those_of_the_program(space):
    call("design", "space.toml", "--out", "lens.csv")
    lens = space.propose()
    assert lens.csv() == open("lens.csv").read()
    assert space.layout("lens.csv").csv() == lens.csv()
    names = [material.name for material in lens.palette]
    assert space.layout(lens.materials, names).csv() == lens.csv()
    table = space.table()
    # One sphere on the plane x = 0, two beside it: of the fourteen rows of a layer half have eleven, on both planes at the sides, half ten between them.
    assert table["copies"].sum() == 9 * (7 * 11 + 7 * 10) and len(table["x_m"]) == space.sites
    assert ((table["copies"] == 1) == (table["x_m"] == 0)).all()
    brass = table["copies"][lens.materials == names.index("brass-260")].sum()
    assert lens.bill["piece"]["spheres"] == brass
    lens.write("ours.csv", full=True)
    call("design", "space.toml", "--full", "--out", "full.csv")
    assert open("ours.csv").read() == open("full.csv").read()
    assert pickle.loads(pickle.dumps(space)).name == "small-space"
    with pytest.raises(gl.InputError, match="a number for each site"):
        space.layout(np.zeros(3, np.uint8))
    with pytest.raises(gl.InputError, match="in space") as raised:
        gl.Design("space.toml")
    assert "SpaceDesign" in raised.value.help


def test_a_study_in_space_is_that_of_the_program(space):
    call("study", "run", "study.toml", "--out", "program")
    whole = files("program")
    study = gl.Study("study.toml")
    for threads in (1, 2):
        result = study.run(f"ours{threads}", threads=threads)
        assert files(f"ours{threads}") == whole
    assert isinstance(result.best, gl.SpaceLayout) and result.best.csv() == whole[1]
    # Scores are those that check gives the layout.
    checked = told("check", "ours1/best.csv", "--design", "space.toml")
    assert checked["contrast"] == result.scores["contrast"]
    # The front is in the order of the first measure, and no layout of it dominates another.
    front = result.front
    assert len(result.front_layouts) == len(front["contrast"]) > 1
    assert (np.diff(front["contrast"]) < 0).all() and (np.diff(front["piece_mass_kg"]) < 0).all()
    # Letters stand for rings.
    assert isinstance(study.design, gl.SpaceDesign) and len(study.groups) == len(study.start) < len(study.free)
    table = study.journal("ours1")
    assert table["letters"].shape == (32, len(study.groups))
    assert study.layout(table["letters"][table["loss"].argmin()]).csv() == whole[1]
    assert study.random(3).shape == (3, len(study.groups))
    for group in study.groups:
        assert len(set(result.best.materials[group])) == 1


def test_a_study_in_space_is_stopped_and_gone_on_with(space):
    study = gl.Study("study.toml")
    study.run("whole")

    class Enough(Exception):
        pass

    def stop(heard):
        if heard["evaluations"] >= 8:
            raise Enough

    with pytest.raises(Enough):
        study.run("stopped", callback=stop)
    with ProcessPoolExecutor(1) as executor:
        study.run("stopped", executor=executor)
    assert files("stopped") == files("whole")
