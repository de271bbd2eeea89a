#!/usr/bin/env python3
"""What a campaign costs besides its simulations: many tiny evaluations, asked for at once, evaluated in shards and folded.

    python3 benches/campaign.py target/release/granulens [--evaluations 100000] [--shards 4]

Each layout has 28 free sites and takes some hundredths of a millisecond, so that what is measured is the rest: to ask, to begin a process, to read and
write journals, to fold. Prints a table, and fails where the rest takes 1 ms or more for an evaluation.
"""

import argparse
import json
import resource
import subprocess
import tempfile
import time
from pathlib import Path

# The small crystal of the tests, under the law that lenses were published with.
DESIGN = Path(__file__).parents[1].joinpath("tests/tiny.toml").read_text()
DESIGN = DESIGN.replace("[impact]", 'law = "thesis"\n[impact]')

STUDY = """format = 1
design = "tiny.toml"
materials = ["stainless-440c", "brass-260"]
rows = [1, 7]
objective = { contrast = { maximise = 1 } }
budget = 1000
start = "random"
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("--evaluations", type=int, default=100_000)
    parser.add_argument("--shards", type=int, default=4)
    given = parser.parse_args()
    program = str(given.program.resolve())
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "tiny.toml").write_text(DESIGN)
        Path(folder, "study.toml").write_text(STUDY)

        def run(*arguments: str) -> dict:
            """One command: what it says, its seconds on the clock and on the processor."""
            before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
            done = subprocess.run([program, *arguments, "--out", "s", "--json", "--threads", "1"], cwd=folder, capture_output=True, text=True)
            wall = time.perf_counter() - begun
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            if done.returncode != 0:
                raise SystemExit(done.stderr)
            cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            return {**json.loads(done.stdout), "wall": wall, "cpu": cpu, "memory": after.ru_maxrss / 1024}

        asked = run("study", "ask", "study.toml", "--random", str(given.evaluations))
        count = asked["asked"]
        shards = [run("evaluate", "study.toml", "--shard", f"{k}/{given.shards}") for k in range(1, given.shards + 1)]
        evaluated = sum(shard["evaluated"] for shard in shards)
        merged = run("study", "merge", "study.toml")
        shown = run("study", "show", "study.toml")
        again = run("evaluate", "study.toml", "--shard", f"1/{given.shards}")
        assert evaluated == count == merged["folded"] == shown["evaluations"] and again["evaluated"] == 0
        # What the simulations themselves take: the same layouts again, in a shard that shares its process with nothing else.
        bench = run_bench(program, folder)
        work = count * bench
        size = Path(folder, "s/journal.jsonl").stat().st_size
        total = asked["cpu"] + sum(shard["cpu"] for shard in shards) + merged["cpu"]
        print(f"{count} evaluations in {given.shards} shards; {size / count:.0f} bytes of journal each\n")
        print("| part | clock (s) | processor (s) | processor per evaluation (us) |\n|---|---|---|---|")
        rows = [("ask", [asked]), ("evaluate, all shards", shards), ("merge", [merged]), ("show", [shown]), ("a shard that finds all known", [again])]
        for name, parts in rows:
            wall, cpu = (sum(part[key] for part in parts) for key in ("wall", "cpu"))
            print(f"| {name} | {wall:.2f} | {cpu:.2f} | {1e6 * cpu / count:.1f} |")
        print(f"| of which simulations | | {work:.2f} | {1e6 * bench:.1f} |")
        rest = (total - work) / count
        print(f"\nbesides simulations {1e6 * rest:.1f} us per evaluation; most memory {max(p['memory'] for p in (asked, *shards, merged)):.0f} MB")
        if rest >= 1e-3:
            raise SystemExit("more than 1 ms per evaluation besides its simulation")


def run_bench(program: str, folder: str) -> float:
    """Seconds of one core for one simulation in a full register."""
    design = DESIGN + '[lens]\nfamily = "plano-convex"\nmaterial = "brass-260"\napex_row = 2\nback_row = 4\nradius = "6 D"\n'
    Path(folder, "lens.toml").write_text(design)
    done = subprocess.run([program, "bench", "lens.toml", "--json", "--threads", "1"], cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(done.stderr)
    return 1e-3 * json.loads(done.stdout)["ms_per_design"]


if __name__ == "__main__":
    main()
