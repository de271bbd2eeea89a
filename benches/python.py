#!/usr/bin/env python3
"""What an evaluation costs from Python, beside `granulens bench`: the same lens, in full registers of one core, by turns.

    python benches/python.py target/release/granulens [designs/quickstart.toml]
"""

import json
import subprocess
import sys
import time

import numpy as np

import granulens as gl

ROUNDS = 5


def main() -> None:
    program = sys.argv[1]
    path = sys.argv[2] if len(sys.argv) > 2 else "designs/quickstart.toml"
    design = gl.Design(path)
    layouts = np.repeat(design.propose().layout.materials[None], 16, axis=0)
    judge = gl.Evaluator(design, threads=1)
    program_ms, package_ms = [], []
    # By turns, and the best of each: what else the machine does comes and goes.
    for _ in range(ROUNDS):
        said = subprocess.check_output([program, "bench", path, "--json", "--threads", "1"], stderr=subprocess.DEVNULL)
        program_ms.append(json.loads(said)["ms_per_design"])
        for _ in range(2):
            begun = time.perf_counter()
            judge(layouts)
            package_ms.append(1e3 * (time.perf_counter() - begun) / len(layouts))
    ours, theirs = min(package_ms), min(program_ms)
    print(f"granulens bench {theirs:.2f} ms a design, granulens.Evaluator {ours:.2f} ms: {100 * (ours / theirs - 1):+.1f} %")


if __name__ == "__main__":
    main()
