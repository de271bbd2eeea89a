"""CPU time of `granulens trace` for every design of the gallery and the published lens: median and least of some runs, user and
system time together, in milliseconds.

    cargo build --release && python3 benches/trace.py [BINARY] [RUNS]
"""

import glob
import resource
import statistics
import subprocess
import sys

binary = sys.argv[1] if len(sys.argv) > 1 else "target/release/granulens"
runs = int(sys.argv[2]) if len(sys.argv) > 2 else 20


def spent():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return 1e3 * (used.ru_utime + used.ru_stime)


for design in [*sorted(glob.glob("designs/gallery/*.toml")), "designs/thesis-lens.toml", "designs/quickstart.toml"]:
    times = []
    for _ in range(runs):
        before = spent()
        subprocess.run([binary, "trace", design, "--quiet"], stdout=subprocess.DEVNULL, check=True)
        times.append(spent() - before)
    print(f"{design:40} {statistics.median(times):7.1f} {min(times):7.1f}")
