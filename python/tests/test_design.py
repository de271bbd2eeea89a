"""Designs from files, texts and arguments; what they propose; what wrong ones hear."""

import json
import pickle

import numpy as np
import pytest

import granulens as gl

from conftest import SMALL, call, told


def test_a_design_from_a_file_a_text_and_arguments(small):
    same = gl.Design.parse(SMALL)
    made = gl.design(
        name="small",
        crystal={"packing": "hexagonal-2d", "diameter": "6.35 mm", "rows": 12, "half_width": 4.5, "sides": "mirror",
                 "host": "stainless-440c", "law": "thesis"},
        impact={"kind": "force-pulse", "force": "16 kN", "duration": "20 us"},
        target={"focus": {"rows": [8, 10], "x": ["0 D", "1 D"]}, "protect": {"rows": [8, 10], "x": ["3 D", "4.5 D"]}},
        lens={"family": "plano-convex", "material": "brass-260", "apex_row": 2, "back_row": 5, "radius": "6 D"},
        run={"window": "100 us"},
    )  # fmt: skip
    for design in (same, made, pickle.loads(pickle.dumps(small))):
        assert (design.propose().layout.materials == small.propose().layout.materials).all()
    stronger = gl.design(small, impact={"force": "30 kN"})
    assert (stronger.force_N, small.force_N, stronger.rows) == (30e3, 16e3, 12)
    with pytest.raises(gl.InputError, match="lens"):
        gl.design(small, lens=None).propose()


def test_sites_are_a_table(small):
    table = small.table()
    assert all(len(column) == small.sites for column in table.values())
    assert table["row"].min() == 1 and table["row"].max() == 12
    assert table["focus"].any() and table["protect"].any() and not (table["focus"] & table["protect"]).any()
    assert table["x_m"].max() <= small.half_width_m


def plain(value):
    """Arrays as the lists of JSON, in which what is no number is null."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [plain(one) for one in value]
    if isinstance(value, dict):
        return {name: plain(one) for name, one in value.items()}
    return None if value != value else value


def test_proposals_are_those_of_the_program(small):
    lens = small.propose()
    call("design", "small.toml", "--out", "lens.csv")
    assert lens.layout.csv() == (small.layout("lens.csv")).csv() == open("lens.csv").read()
    said = told("design", "small.toml")["proposal"]
    ours = plain(lens.proposal)
    assert set(ours) == set(said) and {"piece", "half"} <= set(said)
    for name in said:
        assert ours[name] == said[name], name


def test_rays_are_those_of_the_program(small):
    said, ours = told("trace", "small.toml", "--rays", "9"), small.propose().rays(9)
    assert len(ours["rays"]) == 9
    for ray, expected in zip(ours["rays"], said["rays"]):
        assert (ray["points_m"] == np.array(expected["points_m"])).all() and ray["points_m"].shape[1] == 2
    assert (ours["first_arrival_s"] == said["first_arrival_s"]).all()


def test_layouts_are_written_and_what_is_the_users_is_kept(small, desk):
    layout = small.propose().layout
    layout.write("mine.csv")
    layout.write("mine.csv")
    assert (small.layout("mine.csv").materials == layout.materials).all()
    text = (desk / "mine.csv").read_text().replace("brass-260", "stainless-440c")
    (desk / "mine.csv").write_text(text)
    with pytest.raises(gl.InputError, match="mine.csv"):
        layout.write("mine.csv")
    layout.write("mine.csv", force=True)
    bill = layout.bill
    assert sum(bill["piece"]["counts"]) == len(layout.piece()["row"])


def test_errors_are_those_of_the_program(desk):
    (desk / "wrong.toml").write_text(SMALL.replace("16 kN", "16 kg"))
    with pytest.raises(gl.InputError) as raised:
        gl.Design("wrong.toml")
    said = json.loads(call("design", "wrong.toml", "--json", code=2).stderr)["error"]
    error = raised.value
    assert (error.message, error.help, error.file, error.line, error.key) == tuple(
        said[name] for name in ("message", "help", "file", "line", "key")
    )
    assert error.help in str(error) and isinstance(error, ValueError) and isinstance(error, gl.Error)
    again = pickle.loads(pickle.dumps(error))
    assert str(again) == str(error) and again.line == error.line


def test_wrong_layouts_are_refused(small):
    with pytest.raises(gl.InputError, match="stands for no material"):
        small.layout(np.full(small.sites, 9, np.uint8))
    with pytest.raises(gl.InputError, match=f"shape .n, {small.sites}."):
        small.layout(np.zeros(3, np.uint8))
    with pytest.raises(gl.InputError, match="must begin with the host"):
        small.layout(np.zeros(small.sites, np.uint8), ["brass-260", "stainless-440c"])
