#!/usr/bin/env python3
"""Follows a close-packed crystal of spheres in space as a rig, contact by contact, with granulens and with LAMMPS, in turn, and prints million
sphere-steps per second of processor time of each, their ratio and the bytes a sphere.

    cargo build --release
    benches/lammps_rig.py --lmp lmp [--granulens target/release/granulens] [--cells 40 23] [--layers 30] [--rounds 3]

Hertz contacts, without friction and with (Mindlin's spring, mu 0.3), every contact squeezed by 0.1 % ("closed"), or spheres of two sizes by chance, so that
a quarter of all neighbours gape ("gaps"). Everything is periodic; a layer is pushed. LAMMPS runs `pair_style granular`, and where spheres are
of one size `gran/hertz/history` beside it. Kinetic energies at the end are printed: equal to some digits, or something is wrong.
"""
import argparse
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent

# In the words of 0.1, which every release reads.
RIG = """format = 1
kind = "rig"
name = "rig"
[crystal]
packing = "hcp"
diameter = "6 mm"
layers = {layers}
cells = [{x}, {y}]
material = "440c"
[[pattern]]
{pattern}
[sides]
x = "periodic"
y = "periodic"
z = "periodic"
[[load]]
kind = "force"
pulse = "square"
peak = "500 N"
duration = "1 us"
layers = 1
direction = [1, 0, 1]
[law]
kind = "hertz"
{friction}
[run]
window = "{window} us"
step = "1e-7 s"
squeezed = true
[record]
every = "{window} us"
pictures = []
"""
PATTERNS = {
    "closed": 'kind = "uniform"\nmaterials = ["440c"]\ndiameters = ["6.006 mm"]',
    "gaps": 'kind = "mix"\nmaterials = ["440c", "440c"]\ndiameters = ["6.006 mm", "5.99 mm"]\nfractions = [0.5, 0.5]\nseed = 1',
}
FRICTION = '[friction]\ncoefficient = 0.3\nspring = "mindlin"'


def run(command, folder):
    """Processor seconds of a command, its greatest memory (bytes), and what it printed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(["/usr/bin/time", "-f", "%M", *command], cwd=folder, capture_output=True, text=True,
                          env=os.environ | {"OMP_NUM_THREADS": "1"})
    if done.returncode != 0:
        raise SystemExit(f"{command[0]} failed:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before.ru_utime
    return seconds, 1024 * int(done.stderr.split()[-1]), done.stdout


def rig_file(options, case, friction, steps):
    return RIG.format(layers=options.layers, x=options.cells[0], y=options.cells[1], pattern=PATTERNS[case],
                      friction=FRICTION if friction else "", window=0.1 * steps)


def ours(options, folder, case, friction, steps):
    (folder / "rig.toml").write_text(rig_file(options, case, friction, steps))
    shutil.rmtree(folder / f"out-{steps}", ignore_errors=True)
    command = [options.granulens, "simulate", "rig.toml", "--out", f"out-{steps}", "--threads", "1", "--json"]
    seconds, memory, text = run(command, folder)
    return seconds, memory, json.loads(text)


def theirs(options, folder, deck, steps):
    deck = re.sub(r"^(dump|dump_modify).*\n", "", deck, flags=re.M)
    deck = re.sub(r"^thermo .*\n", f"compute turns all erotate/sphere\nthermo_style custom step ke c_turns\nthermo_modify format float %.12g\nthermo {steps}\n", deck, flags=re.M)
    head, tail = deck.split("\nrun ", 1)
    unfix = re.findall(r"^unfix.*$", tail, flags=re.M)
    (folder / "in.timed").write_text("\n".join([head, "run 10", *unfix, f"run {steps - 10}", ""]))
    seconds, _, text = run([options.lmp, "-in", "in.timed", "-log", "none"], folder)
    rows = [line.split() for line in text.splitlines() if re.match(rf"\s+{steps}\s+\S+\s+\S+\s*$", line)]
    return seconds, float(rows[-1][1]) + float(rows[-1][2])


def decks(deck, friction, case):
    """The deck under LAMMPS's styles, with friction where it is asked for."""
    poisson = 0.3
    stiffness = float(re.search(r"^pair_coeff 1 1 hertz (\S+)", deck, re.M)[1])
    tangential = 3 * (1 - poisson) / (2 - poisson) * stiffness
    new = f"tangential mindlin_rescale/force {tangential!r} 0.0 0.3" if friction else "tangential linear_nohistory 0.0 0.0"
    yield "granular", re.sub(r"tangential linear_nohistory 0.0 0.0", new, deck)
    if case == "closed":
        lines = re.sub(r"^pair_coeff.*\n", "", deck, flags=re.M)
        friction_words = f"{tangential!r} 0.0 0.0 0.3" if friction else "0.0 0.0 0.0 0.0"
        style = f"pair_style gran/hertz/history {stiffness!r} {friction_words} 0\npair_coeff * *\n"
        yield "gran/hertz/history", re.sub(r"^pair_style granular\n", style, lines, flags=re.M)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lmp", default="lmp")
    parser.add_argument("--granulens", default=str(ROOT / "target/release/granulens"))
    parser.add_argument("--cells", nargs=2, type=int, default=[40, 23])
    parser.add_argument("--layers", type=int, default=30)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--steps", type=int, default=220)
    parser.add_argument("--cases", nargs="*", default=["closed", "gaps"])
    options = parser.parse_args()
    options.granulens = str(pathlib.Path(options.granulens).resolve())
    spheres = 2 * options.cells[0] * options.cells[1] * options.layers
    few, many = 20, options.steps
    print(f"{spheres} spheres; million sphere-steps/s of {many - few} steps")
    for case in options.cases:
        for friction in (False, True):
            with tempfile.TemporaryDirectory() as folder:
                folder = pathlib.Path(folder)
                (folder / "rig.toml").write_text(rig_file(options, case, False, many))
                run([options.granulens, "export", "--lammps", "deck", "rig.toml"], folder)
                (folder / "crystal.data").write_bytes((folder / "deck" / "crystal.data").read_bytes())
                deck = (folder / "deck" / "in.crystal").read_text()
                rate = lambda times: 1e-6 * spheres * (many - few) / (times[1] - times[0])
                for _ in range(options.rounds):
                    both = [ours(options, folder, case, friction, steps) for steps in (few, many)]
                    own = rate([seconds for seconds, *_ in both])
                    print(f"{case}, {'mu 0.3' if friction else 'no friction'}: granulens {own:.2f} ({both[1][1] / spheres:.0f} B a sphere)", end="")
                    for style, text in decks(deck, friction, case):
                        pair = [theirs(options, folder, text, steps) for steps in (few, many)]
                        other = rate([seconds for seconds, _ in pair])
                        print(f"; {style} {other:.2f}, {own / other:.2f} times, kinetic energy {pair[1][1]:.9g}", end="")
                    print(f"; ours {kinetic(both[1][2]):.9g} J", flush=True)


def kinetic(result):
    """The kinetic energy at the end (J)."""
    return result["energies"]["kinetic"]


if __name__ == "__main__":
    main()
