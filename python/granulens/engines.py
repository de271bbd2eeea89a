"""Studies on existing engines that run programs. Executors, such as a Dask client, are handed to `Study.run`.

- `dask`: a study through a Dask scheduler
- `hyperqueue`: a study through HyperQueue, a job of shards for each generation
"""

from __future__ import annotations

import sys
from os import PathLike
from pathlib import Path
from typing import Any
from collections.abc import Sequence

from ._errors import LostError
from ._study import Result, Study


def dask(study: Study, folder: str | PathLike[str], address: str, **options: Any) -> Result:
    """Runs a study through the Dask scheduler at an address, such as tcp://10.0.0.1:8786; options are those of `Study.run`.

    SLURM, PBS and clouds come with dask-jobqueue and its like: hand their client to `Study.run` as executor.
    """
    from distributed import Client

    with Client(address) as client:
        return study.run(folder, executor=client, **options)


def task(study: Study, folder: str | PathLike[str], shard: str, threads: int) -> Sequence[str]:
    """The command of one shard."""
    seed = ["--seed", str(study.seed)]
    command = [sys.executable, "-m", "granulens", "evaluate", str(Path(study.path).resolve())]
    return [*command, "--shard", shard, "--out", str(Path(folder).resolve()), "--threads", str(threads), *seed]


def hyperqueue(
    study: Study,
    folder: str | PathLike[str],
    client: Any,
    *,
    shards: int,
    threads: int = 1,
    rounds_without_answer: int = 3,
    force: bool = False,
) -> dict[str, Any]:
    """Runs a study through HyperQueue: for each generation a job of `shards` tasks, whose journals are folded when it ends.

    The folder has to be seen by the workers. That waiting ended proves nothing: each task's state is asked, and what counts is which layouts
    are evaluated; what a lost task left out is asked for again.

    Returns
    -------
    dict
        generations, tasks, failed (of these), evaluations
    """
    from hyperqueue import Job
    from hyperqueue.ffi.protocol import ResourceRequest

    folder = Path(folder).resolve()
    told = {"generations": 0, "tasks": 0, "failed": 0, "evaluations": 0}
    idle = 0
    while True:
        asked = study.ask(folder, force=force)
        if asked["asked"] == 0 and asked["waiting"] == 0:
            told["evaluations"] = asked["evaluations"]
            return told
        job = Job(max_fails=None)
        for number in range(1, shards + 1):
            job.program(
                task(study, folder, f"{number}/{shards}", threads),
                resources=ResourceRequest(cpus=threads),
                name=f"{number}/{shards}",
                stdout=None,
                stderr=None,
            )
        submitted = client.submit(job)
        client.wait_for_jobs([submitted], raise_on_error=False)
        failed = client.get_failed_tasks(submitted)
        merged = study.merge(folder)
        told["generations"] += 1
        told["tasks"] += shards
        told["failed"] += len(failed)
        idle = idle + 1 if merged["folded"] == 0 else 0
        if idle == rounds_without_answer:
            words = "; ".join(f"task {number}: {context.error}" for number, context in list(failed.items())[:3])
            raise LostError(
                f"{merged['asked'] - merged['answered']} layouts have no answer after {idle} rounds: {words or 'no task failed'}",
                "What was evaluated is kept; run again to go on.",
            )
