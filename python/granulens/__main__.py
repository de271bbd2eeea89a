"""Studies from a shell, where there is the package and no program: ``python -m granulens``. Options are those of ``granulens``."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any
from collections.abc import Sequence

from . import Error, Study, __commit__, __version__


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m granulens", description=__doc__)
    parser.add_argument("--version", action="version", version=f"granulens {__version__} (commit {__commit__})")
    commands = parser.add_subparsers(dest="command", required=True)

    def command(name: str, words: str) -> argparse.ArgumentParser:
        made = commands.add_parser(name, help=words, description=words)
        made.add_argument("study", type=Path, help="study file")
        made.add_argument("--out", type=Path, help="folder of the study [default: reports/NAME]")
        made.add_argument("--seed", type=int, help="in place of the file's")
        made.add_argument("--threads", type=int, help="results do not depend on it")
        made.add_argument("--force", action="store_true", help="replace results of another study")
        return made

    run = command("run", "run a study, or go on with it")
    run.add_argument("--dask", metavar="ADDRESS", help="let the workers of a Dask scheduler evaluate")
    command("ask", "write down which layouts are to be evaluated next; exit code 4 while there are some")
    evaluate = command("evaluate", "evaluate one shard of the layouts that are asked for")
    evaluate.add_argument("--shard", required=True, metavar="K/N", help="such as 3/8")
    command("merge", "fold the journals of shards; exit code 4 while some layouts are missing")
    given = parser.parse_args(arguments)
    try:
        return perform(given)
    except Error as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted: what is evaluated is kept, and the same command goes on", file=sys.stderr)
        return 130


def perform(given: argparse.Namespace) -> int:
    study = Study(given.study, seed=given.seed)
    folder = given.out or Path("reports") / given.study.stem
    told: dict[str, Any]
    if given.command == "run":
        if given.dask:
            from .engines import dask

            result = dask(study, folder, given.dask, threads=given.threads, force=given.force)
        else:
            result = study.run(folder, threads=given.threads, force=given.force)
        told = {"evaluations": result.evaluations, "ended": result.ended, "within_limits": result.within_limits, **result.scores}
        code = 0 if result.within_limits else 3
    elif given.command == "ask":
        told = study.ask(folder, force=given.force, threads=given.threads)
        code = 4 if told["asked"] or told["waiting"] else 0
    elif given.command == "evaluate":
        told = study.evaluate(folder, given.shard, threads=given.threads)
        code = 0 if told["whole"] else 130
    else:
        told = study.merge(folder)
        code = 0 if told["asked"] == told["answered"] else 4
    print(json.dumps(told, indent=2))
    return code


if __name__ == "__main__":
    sys.exit(main())
