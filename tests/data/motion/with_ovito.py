#!/usr/bin/env python3
"""D2_min of random motions by OVITO and by numpy: makes strain.json, with which the tests of `motion` are held.

    pip install "ovito==3.17.2" "numpy==2.4.6"
    python with_ovito.py > strain.json

OVITO's atomic strain modifier in a cell of two dimensions; its D2min is the sum over the neighbours within the cutoff of
|F d - D|^2, divided by nothing, F the gradient that fits best. Its deformation gradient is by rows over columns x, y.
"""
import json
import numpy as np
from ovito.data import DataCollection, SimulationCell
from ovito.modifiers import AtomicStrainModifier
from ovito.pipeline import Pipeline, StaticSource

rng = np.random.default_rng(19980801)


def collection(places, width, height, periodic):
    data = DataCollection()
    cell = SimulationCell(pbc=(periodic, False, False), is2D=True)
    cell[:] = [[width, 0, 0, 0], [0, height, 0, 0], [0, 0, 1, -0.5]]
    data.objects.append(cell)
    particles = data.create_particles(count=len(places))
    particles.create_property("Position", data=np.column_stack([places, np.zeros(len(places))]))
    return data


def by_numpy(before, after, radius, period):
    near = lambda x: x - period * np.round(x / period) if period else x
    out = []
    for i in range(len(before)):
        old = before - before[i]
        old[:, 0] = near(old[:, 0])
        on = (np.hypot(old[:, 0], old[:, 1]) <= radius) & (np.arange(len(before)) != i)
        old, new = old[on], (after - after[i])[on]
        new[:, 0] = old[:, 0] + near(new[:, 0] - old[:, 0])
        gradient = np.linalg.lstsq(old, new, rcond=None)[0].T
        out.append((float(((new - old @ gradient.T) ** 2).sum()), gradient))
    return out


cases = []
for name, periodic, strength in [("open", False, 0.3), ("periodic", True, 0.3), ("periodic, strong", True, 0.8)]:
    width, height, radius = 14.0, 11.0, 2.5
    before = rng.uniform(0, 1, (180, 2)) * [width, height]
    after = before + strength * rng.normal(size=before.shape) * 0.4
    after[:, 1] += 0.1 * before[:, 1]
    if periodic:
        after[:, 0] %= width
    pipeline = Pipeline(source=StaticSource(data=collection(after, width, height, periodic)))
    modifier = AtomicStrainModifier(cutoff=radius, output_nonaffine_squared_displacements=True,
                                    output_deformation_gradients=True, minimum_image_convention=periodic)
    modifier.reference = StaticSource(data=collection(before, width, height, periodic))
    pipeline.modifiers.append(modifier)
    done = pipeline.compute().particles
    d2min = np.asarray(done["Nonaffine Squared Displacement"])
    gradient = np.asarray(done["Deformation Gradient"]).reshape(-1, 3, 3).transpose(0, 2, 1)[:, :2, :2]
    plain = by_numpy(before, after, radius, width if periodic else None)
    assert all(abs(a - b[0]) < 1e-12 * max(1, b[0]) for a, b in zip(d2min, plain))
    assert all(np.abs(a - b[1]).max() < 1e-12 for a, b in zip(gradient, plain))
    cases.append({"name": name, "period": width if periodic else None, "radius": radius, "before": before.tolist(),
                  "after": after.tolist(), "d2min": d2min.tolist(), "map": gradient.reshape(-1, 4).tolist()})
print("[\n" + ",\n".join(json.dumps(case) for case in cases) + "\n]")
