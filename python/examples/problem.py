"""The problem that all examples solve: as much energy in the focus, over that in the protected region, as can be; sphere by sphere in rows 2 to 9."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import granulens as gl

DESIGN = Path(__file__).resolve().parent / "lens.toml"

STUDY = """format = 1
design = "{design}"
materials = ["stainless-440c", "brass-260"]
rows = [2, 9]
budget = {budget}
method = "{method}"
seed = {seed}
start = "lens"
[objective]
contrast = {{ maximise = 1 }}
{more}
"""


class Judge:
    """Scores layouts by their letters, and counts them."""

    def __init__(self, evaluations: int) -> None:
        self.left = evaluations
        self.design = gl.Design(DESIGN)
        with study("local", 1) as made:
            self.free = made.free
            self.base = made.layout(made.start).materials
        self.evaluator = gl.Evaluator(self.design)
        self.best = -np.inf

    def sites(self) -> tuple[np.ndarray, np.ndarray]:
        """Row and distance from the axis of the sites that may change, each from 0 to 1."""
        table = self.design.table()
        return tuple((column - column.min()) / np.ptp(column) for column in (table["row"][self.free], table["x_m"][self.free]))

    def layouts(self, letters: np.ndarray) -> np.ndarray:
        """(n, free) letters as (n, sites) layouts."""
        layouts = np.repeat(self.base[None], len(letters), axis=0)
        layouts[:, self.free] = letters
        return layouts

    def score(self, layouts: np.ndarray) -> dict:
        """Scores of layouts; of those that a guard stopped the contrast is 0. No more than there are evaluations left."""
        layouts = layouts[: self.left]
        self.left -= len(layouts)
        table = self.evaluator(np.ascontiguousarray(layouts, dtype=np.uint8))
        stopped = np.array([stop is not None for stop in table["stop"]])
        table["contrast"] = np.where(stopped, 0.0, np.nan_to_num(table["contrast"]))
        self.best = max(self.best, table["contrast"].max(initial=0.0))
        return table


class study:
    """A study of the problem in a folder of its own, by one of granulens's methods."""

    def __init__(self, method: str, evaluations: int, seed: int = 1, more: str = "") -> None:
        self.folder = TemporaryDirectory()
        path = Path(self.folder.name) / "study.toml"
        path.write_text(STUDY.format(design=DESIGN.as_posix(), budget=evaluations, method=method, seed=seed, more=more))
        self.made = gl.Study(path)

    def __enter__(self) -> gl.Study:
        return self.made

    def __exit__(self, *_) -> None:
        self.folder.cleanup()

    @classmethod
    def ours(cls, method: str, evaluations: int, seed: int = 1, more: str = "") -> gl.Result:
        """What granulens's own method comes to with as many evaluations."""
        made = cls(method, evaluations, seed, more)
        with made as one:
            return one.run(Path(made.folder.name) / "run")


def arguments(words: str, evaluations: int) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=words)
    parser.add_argument("--evaluations", type=int, default=evaluations)
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args()


def tell(**rows) -> None:
    """What both came to, as JSON."""
    print(json.dumps(rows, indent=2, default=float))
