"""Studies: here, or through any executor."""

from __future__ import annotations

import json
import zlib
from dataclasses import dataclass, field
from functools import lru_cache
from os import PathLike
from pathlib import Path
from tempfile import mkdtemp
from time import monotonic, sleep
from typing import Any, Callable

from . import _granulens
from ._errors import Error, LostError
from ._granulens import Layout, SpaceLayout
from ._run import table_html

# Layouts that fill the registers of a core: a shard of fewer takes as long.
BLOCK = 8


class Study(_granulens.Study):
    """A study: what is wanted of a design's layouts, and what is done to find one.

    Parameters
    ----------
    path : path
        Study file.
    seed : int, optional
        In place of the file's.
    """

    def run(
        self,
        folder: str | PathLike[str],
        *,
        executor: Any = None,
        shard: int = BLOCK,
        retries: int = 3,
        callback: Callable[[dict[str, Any]], Any] | None = None,
        force: bool = False,
        threads: int | None = None,
    ) -> Result:
        """Runs the study in a folder, or goes on where it was; it comes to the same bits wherever and however often it was ended.

        Parameters
        ----------
        folder : path
            As the command line's --out: journal.jsonl, study.json, best.csv.
        executor : optional
            Anything with ``submit(function, *arguments)`` that gives futures with ``done()`` and ``result()``, such as a Dask client or a
            ``concurrent.futures`` executor: evaluates shards of every generation elsewhere. Here where left out.
        shard : int
            Layouts of a task; multiples of 8 fill the registers.
        retries : int
            How often a task that was lost, with its process or its machine, is given away again.
        callback : callable, optional
            Hears after every batch a dict: evaluations, simulated, stopped, stage, best, loss, within_limits. What it raises ends the run.
        force : bool
            Whether results of another study in the folder may be replaced; its journal stays.
        threads : int, optional
            Threads here, or of each task elsewhere (1 where left out).
        """
        engine = None if executor is None else _Shards(self, executor, shard, retries, threads or 1)
        found = self.run_in(folder, engine=engine, callback=callback, force=force, threads=None if engine else threads)
        return Result.of(found)

    def __reduce__(self) -> Any:
        return _unpacked, (self.packed(),)

    def packed(self) -> bytes:
        """The study with all its files, to be read elsewhere."""
        return zlib.compress(json.dumps(self.files()).encode())


@lru_cache(maxsize=8)
def _unpacked(packed: bytes) -> Study:
    """The study of some files. One process reads it once, so that what it simulates for it is simulated once."""
    files = json.loads(zlib.decompress(packed))
    folder = Path(mkdtemp(prefix="granulens-"))
    try:
        for name, text in files:
            (folder / name).write_text(text)
        return Study(folder / files[0][0])
    finally:
        for name, _ in files:
            (folder / name).unlink(missing_ok=True)
        folder.rmdir()


def work(packed: bytes, rung: int, layouts: list[str], threads: int) -> list[str]:
    """A task: evaluates some layouts of a study; a line of a journal for each."""
    return _granulens.evaluate_lines(_unpacked(packed), rung, layouts, threads=threads)


@dataclass
class _Task:
    layouts: list[str]
    future: Any
    lost: int = 0
    lines: list[str] | None = None


class _Shards:
    """Gives parts of a generation to an executor, and those that are lost again."""

    def __init__(self, study: Study, executor: Any, shard: int, retries: int, threads: int) -> None:
        self.packed = study.packed()
        self.executor = executor
        self.shard = max(1, shard)
        self.retries = retries
        self.threads = threads
        self.tasks: list[_Task] = []

    def _give(self, rung: int, layouts: list[str]) -> Any:
        try:
            return self.executor.submit(work, self.packed, rung, layouts, self.threads)
        except Error:
            raise
        except Exception as error:  # An executor that is broken takes nothing more.
            raise LostError(
                f"the executor takes no more work: {type(error).__name__}: {error}",
                "What was evaluated is kept; run again with another one to go on.",
            ) from error

    def submit(self, rung: int, layouts: list[str]) -> int:
        self.tasks = [
            _Task(layouts[k : k + self.shard], self._give(rung, layouts[k : k + self.shard]))
            for k in range(0, len(layouts), self.shard)
        ]
        return rung

    def poll(self, rung: int) -> list[str] | None:
        """The lines of all tasks, in order; None while some are not done, after a moment."""
        until, pause = monotonic() + 0.05, 0.0002
        while True:
            waiting = [task for task in self.tasks if task.lines is None]
            for task in waiting:
                if task.future.done():
                    self._take(rung, task)
            if all(task.lines is not None for task in self.tasks):
                return [line for task in self.tasks for line in task.lines or ()]
            if monotonic() > until:
                return None
            sleep(pause)
            pause = min(2 * pause, 0.01)

    def _take(self, rung: int, task: _Task) -> None:
        try:
            task.lines = task.future.result()
        except Error:
            # What granulens itself says is wrong is wrong everywhere.
            raise
        except Exception as error:
            task.lost += 1
            if task.lost > self.retries:
                raise LostError(
                    f"a task of {len(task.layouts)} layouts was lost {task.lost} times, the last time by {type(error).__name__}: {error}",
                    "Killed, out of time or memory, or its machine gone: no layout's fault. What was evaluated is kept; run again to go on.",
                ) from error
            task.future = self._give(rung, task.layouts)

    def stop(self) -> None:
        for task in self.tasks:
            if task.lines is None:
                task.future.cancel()


@dataclass(frozen=True)
class Result:
    """What a study came to.

    Attributes
    ----------
    best : Layout, SpaceLayout or None
        The best layout, or the nearest to the limits.
    within_limits : bool
    scores : dict of float
        Every measure of it over all impacts.
    history : dict of columns
        Every evaluation that was the best so far: evaluations, step_s, loss, within_limits.
    front : dict of columns or None
        Where several measures are traded: each of them, evaluation, loss, in the order of the first, best first.
    front_layouts : list of Layout or SpaceLayout
    stages, baselines : list of dict
    evaluations : int
    ended : str
        budget, nothing-new, time or interrupted.
    warnings : list of str
    report : dict
        All of study.json.
    """

    best: Layout | SpaceLayout | None
    within_limits: bool
    scores: dict[str, float]
    history: dict[str, Any]
    front: dict[str, Any] | None
    front_layouts: list[Layout] | list[SpaceLayout]
    stages: list[dict[str, Any]]
    baselines: list[dict[str, Any]]
    evaluations: int
    ended: str
    warnings: list[str]
    report: dict[str, Any] = field(repr=False)

    @classmethod
    def of(cls, report: dict[str, Any]) -> Result:
        """From what a run gives."""
        found = report.get("best") or report.get("nearest") or {}
        front, layouts = None, []
        if report.get("front"):
            layouts = report["front"].pop("found", [])
            front = columns(
                [
                    {"evaluation": one["evaluation"], "loss": one["loss"], **numbers(one)}
                    for one in report["front"]["layouts"]
                ]
            )
        return cls(
            best=report.pop("layout", None),
            within_limits=bool(report.get("best")),
            scores=numbers(found),
            history=columns(report.get("history", [])),
            front=front,
            front_layouts=layouts,
            stages=report.get("stages", []),
            baselines=report.get("baselines", []),
            evaluations=report["evaluations"],
            ended=report["ended"],
            warnings=report.pop("warnings", []),
            report=report,
        )

    def _repr_html_(self) -> str:
        limits = "within the limits" if self.within_limits else "misses a limit"
        return table_html(self.scores, f"{self.evaluations} evaluations, {self.ended}; the best {limits}")


# What a found layout has besides its measures.
OTHERS = {"loss", "evaluation", "within_limits", "one_opt", "two_opt"}


def numbers(found: dict[str, Any]) -> dict[str, float]:
    """The measures among what is stored of a layout."""
    return {
        name: value
        for name, value in found.items()
        if isinstance(value, (int, float)) and not isinstance(value, bool) and name not in OTHERS
    }


def columns(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Rows as a dict of arrays."""
    import numpy as np

    names = list(dict.fromkeys(name for row in rows for name in row))
    return {name: np.array([row.get(name, np.nan) for row in rows]) for name in names}
