#!/usr/bin/env python3
"""Strikes the reference bed (tests/data/beds/bed1.csv: 5971 grains, 200 wall disks, an intruder of D 10 and mass 100 at 0.7)
with granulens and with LAMMPS, in turn, and prints the processor seconds of each and their ratio.

    cargo build --release
    benches/lammps_bed.py --lmp lmp [--granulens target/release/granulens] [--rounds 3] [--steps 15000]

Both follow the same linear spring and dashpot, F = k x - gamma m_eff v, with friction by damping and a cap alone (kinetic) or
with a tangential spring too (static), one thread, a step of 0.02. LAMMPS takes its own special pair styles for it (gran/hooke,
gran/hooke/history: faster than pair granular). They give walls the grains' law, which changes nothing (walls lie still). The
depths at the end are printed too: equal within the spread of one trajectory, or something is wrong.
"""
import argparse
import math
import os
import pathlib
import resource
import subprocess
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
SPRING = math.pi**2 / 2
GAMMA = -2 * math.log(0.5)
GRAVITY = SPRING / 4000
SURFACE = 55.45720033175587
STEP = 0.02


def disks():
    """(type, x, y, diameter) of the reference bed."""
    for line in (ROOT / "tests/data/beds/bed1.csv").read_text().splitlines():
        if line[:1].isdigit():
            _, kind, x, y, diameter = line.split(",")
            yield int(kind), float(x), float(y), float(diameter)


def lammps_deck(folder, static, steps, skin):
    """Writes the input of LAMMPS; in its data file a sphere's mass is density times volume, ours is D^2."""
    rows = [*disks(), (3, 50.0, SURFACE + 10.0, 10.0)]
    data = ["bed", "", f"{len(rows)} atoms", "3 atom types", "", "0 100 xlo xhi", "-1 90 ylo yhi", "-0.5 0.5 zlo zhi", "", "Atoms", ""]
    for n, (kind, x, y, diameter) in enumerate(rows, 1):
        density = diameter**2 / (math.pi / 6 * diameter**3)
        data.append(f"{n} {kind} {diameter!r} {density!r} {x % 100.0!r} {y!r} 0")
    (folder / "bed.data").write_text("\n".join(data) + "\n")
    style = "gran/hooke/history" if static else "gran/hooke"
    kt = 0.8 * SPRING if static else 0.0
    (folder / "bed.in").write_text(f"""units lj
dimension 2
boundary p f p
atom_style sphere
newton off
read_data bed.data
neighbor {skin} multi
comm_modify mode multi vel yes
neigh_modify every 1 delay 0 check yes
group wall type 2
group free type 1 3
group intruder type 3
velocity intruder set 0 -0.7 0
pair_style {style} {SPRING!r} {kt!r} {GAMMA!r} {GAMMA / 2!r} 0.5 1
pair_coeff * *
neigh_modify exclude group wall wall
timestep {STEP}
fix gravity free gravity {GRAVITY!r} vector 0 -1 0
fix move free nve/sphere disc
fix freeze wall freeze
fix plane all enforce2d
compute height intruder reduce max y
variable depth equal {SURFACE!r}-(c_height-5)
thermo_style custom step ke v_depth
thermo {max(steps // 15, 1)}
run {steps}
""")


def granulens_deck(folder, static, steps):
    """The same for granulens: a bed in its own form, and a bed file."""
    lines = ["# width 100.0 d, sides periodic", "kind,x_d,y_d,diameter_d"]
    for kind, x, y, diameter in disks():
        lines.append(f"{'grain' if kind == 1 else 'wall'},{x!r},{y!r},{diameter!r}")
    (folder / "bed.csv").write_text("\n".join(lines) + "\n")
    kt = 0.8 if static else 0.0
    (folder / "bed.toml").write_text(f"""format = 1
kind = "bed"
name = "bed"
[bed]
file = "bed.csv"
[grains]
tangential_stiffness = {kt}
[intruder]
shape = "disk"
diameter = 10
mass = 100
speed = 0.7
[run]
window = {steps * STEP}
step = {STEP}
""")


def run(command, folder):
    """Processor and wall seconds of a command, and what it printed."""
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime, time.monotonic()
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=os.environ | {"OMP_NUM_THREADS": "1"})
    if done.returncode != 0:
        raise SystemExit(f"{command[0]} failed:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before, time.monotonic() - begun, done.stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lmp", default="lmp")
    parser.add_argument("--granulens", default=str(ROOT / "target/release/granulens"))
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--steps", type=int, default=15000)
    parser.add_argument("--skin", type=float, default=0.3, help="of LAMMPS' neighbour lists")
    options = parser.parse_args()
    print("friction   round  granulens (s)  LAMMPS (s)  ratio   depth at the end (d)")
    for static in (False, True):
        name = "static" if static else "kinetic"
        best = [math.inf, math.inf]
        with tempfile.TemporaryDirectory() as place:
            folder = pathlib.Path(place)
            lammps_deck(folder, static, options.steps, options.skin)
            granulens_deck(folder, static, options.steps)
            for number in range(1, options.rounds + 1):
                ours, _, _ = run([options.granulens, "impact", "bed.toml", "--threads", "1", "--quiet", "--out", "out"], folder)
                depth = float((folder / "out/impact.csv").read_text().splitlines()[-1].split(",")[1])
                theirs, _, text = run([options.lmp, "-in", "bed.in", "-log", "none"], folder)
                last = [line.split() for line in text.splitlines() if line.split()[:1] == [str(options.steps)]][-1]
                best = [min(best[0], ours), min(best[1], theirs)]
                print(f"{name:9} {number:6} {ours:14.2f} {theirs:11.2f} {theirs / ours:6.2f}   {depth:.2f} and {float(last[2]):.2f}", flush=True)
        print(f"{name:9}   best {best[0]:14.2f} {best[1]:11.2f} {best[1] / best[0]:6.2f}", flush=True)


if __name__ == "__main__":
    main()
