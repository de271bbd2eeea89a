#!/usr/bin/env python3
"""Persistence of random force networks by GUDHI: makes bars.json, with which the tests of `network` are held.

    pip install "gudhi==3.13.0" "numpy==2.4.6"
    python with_gudhi.py > bars.json

Each network is a list of contacts [i, j, normal, tangential]. GUDHI gets its clique complex up to triangles with the filtration
value minus the force, so that its sublevel filtration is the superlevel filtration of the force:

  contacts:  a contact at its force, a grain at that of its strongest contact, a triangle at that of its weakest
  particles: a grain at the sum of the forces at its contacts, contacts and triangles at that of their weakest grain

Bars are in force, not in multiples of the mean; null never dies. Bars of length zero are left out, as GUDHI does.
"""
import json
import gudhi
import numpy as np

rng = np.random.default_rng(20120118)


def bars(contacts, carrier, column):
    grain = {}
    for c in contacts:
        for g in c[:2]:
            known = grain.get(g, 0.0)
            grain[g] = max(known, abs(c[column])) if carrier == "contacts" else known + abs(c[column])
    tree = gudhi.SimplexTree()
    for g, value in grain.items():
        tree.insert([g], -value)
    for c in contacts:
        value = abs(c[column]) if carrier == "contacts" else min(grain[c[0]], grain[c[1]])
        tree.insert(list(c[:2]), -value)
    tree.expansion(2)
    tree.persistence(homology_coeff_field=2, persistence_dim_max=True)
    out = []
    for dim in (0, 1):
        rows = [[-float(b), None if np.isinf(d) else -float(d)] for b, d in tree.persistence_intervals_in_dimension(dim)]
        out.append(sorted(rows, key=lambda r: (-r[0], r[1] if r[1] is not None else -1e300)))
    return out


def disks(count, width, period, levels):
    """Disks at random, in touch where nearer than 1; forces at random, of `levels` values or all different."""
    place = rng.uniform(0, width, (count, 2))
    pairs = []
    for i in range(count):
        for j in range(i + 1, count):
            d = place[i] - place[j]
            if period:
                d[0] -= width * round(d[0] / width)
            if np.hypot(*d) < 1:
                pairs.append((i, j))
    return weigh(pairs, levels)


def weigh(pairs, levels):
    def force():
        return float(rng.integers(1, levels + 1)) if levels else float(round(rng.exponential(), 6)) + 1e-6

    return [[i, j, force(), round(float(rng.normal()), 6)] for i, j in pairs]


def graph(count, part, levels):
    """Any two grains in touch with the same chance: far from planar."""
    return weigh([(i, j) for i in range(count) for j in range(i + 1, count) if rng.uniform() < part], levels)


def hexagonal(columns, rows, levels):
    """A hexagonal sheet that repeats itself sideways."""
    at = lambda c, r: r * columns + c % columns
    pairs = []
    for r in range(rows):
        for c in range(columns):
            pairs.append((at(c, r), at(c + 1, r)))
            if r + 1 < rows:
                pairs += [(at(c, r), at(c + s + r % 2, r + 1)) for s in (-1, 0)]
    return weigh([tuple(sorted(p)) for p in pairs], levels)


networks = {
    "disks": disks(80, 7.0, False, 0),
    "disks, few forces": disks(80, 7.0, False, 4),
    "disks round a cylinder": disks(120, 9.0, True, 0),
    "crowded disks": disks(60, 3.5, False, 0),
    "crowded disks round a cylinder, few forces": disks(70, 5.0, True, 3),
    "hexagonal": hexagonal(9, 7, 0),
    "hexagonal, few forces": hexagonal(8, 8, 3),
    "hexagonal, one force": hexagonal(7, 5, 1),
    "sparse graph": graph(60, 0.06, 0),
    "graph": graph(40, 0.3, 0),
    "dense graph, few forces": graph(25, 0.6, 5),
}
print("[")
print(",\n".join(
    json.dumps({
        "name": name,
        "contacts": contacts,
        **{f"{carrier} {part}": bars(contacts, carrier, column)
           for carrier in ("contacts", "particles") for part, column in (("normal", 2), ("tangential", 3))},
    }) for name, contacts in networks.items()))
print("]")
