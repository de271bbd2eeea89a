# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     name: python3
# ---

# %% [markdown]
# # A bed with its force network
# Four hundred disks settle under gravity; what carries their weight? Lengths are in mean diameters d, times in collision times, masses in mean masses.

# %%
import matplotlib.pyplot as plt
import numpy as np

import granulens as gl

bed = gl.Bed.parse(
    """format = 1
kind = "bed"
name = "notebook-bed"
[bed]
packing = "random"
width = 20
height = 20
spread = 0.2
sides = "periodic"
seed = 1
[grains]
stiffness = 4000
restitution = 0.5
friction = 0.5
tangential_stiffness = 0.0
damping = "kondic"
[walls]
restitution = 0.1
friction = 0.9
[intruder]
shape = "disk"
diameter = 4
mass = 16
speed = 0.5
[run]
window = 100
"""
)
packing = bed.settle()
packing.measures()["volume_fraction"], packing.measures()["coordination"]

# %%
contacts = bed.contacts(packing)
network = gl.network(contacts, grains=len(packing), period=packing.width_d, title="a bed at rest")
network

# %% [markdown]
# Components and loops above a threshold, in multiples of the mean force: the network falls apart at about the mean.

# %%
topology = network.topology
figure, axis = plt.subplots()
axis.plot(topology["thresholds"], topology["components"], label="components")
axis.plot(topology["thresholds"], topology["loops"], label="loops")
axis.set(xlabel="threshold (mean force)", ylabel="number")
axis.legend()
assert topology["components"].max() > topology["components"][0] and (np.diff(topology["loops"]) <= 0).all()

# %% [markdown]
# Then a disk of four diameters falls on it, and every 5 collision times all places, velocities and contacts are kept.

# %%
course = bed.strike(packing, every=5)
moments, frames = course["moments"], course["frames"]
figure, axes = plt.subplots(2, 1, sharex=True)
axes[0].plot(moments["time_tau_c"], moments["depth_d"])
axes[0].set_ylabel("depth (d)")
axes[1].plot(moments["time_tau_c"], moments["fy"])
axes[1].set(xlabel="time (tau_c)", ylabel="force")
assert 0 < course["final_depth_d"] <= course["max_depth_d"]
frames.places.shape, frames.times[-1]

# %% [markdown]
# What carries it, when the force on it is greatest of all frames: the network of that moment.

# %%
hardest = int(np.argmax(np.abs(frames.forces[:, -1, 1])))
struck = frames.network(hardest)
assert struck.mean_force > network.mean_force
struck

# %% [markdown]
# Loops of the network as it is struck and comes to rest, by their total persistence: births less deaths, in mean forces.

# %%
persistence = []
for k in range(len(frames)):
    bars = frames.network(k).persistence1
    persistence.append(np.nansum(bars[:, 0] - bars[:, 1]))
figure, axis = plt.subplots()
axis.plot(frames.times, persistence)
axis.set(xlabel="time (tau_c)", ylabel="total persistence of loops (mean force)")

# %% [markdown]
# And how the grains moved: what no affine map of a neighbourhood explains, from rest to the end.

# %%
moved = frames.motion(0, -1)
axis = frames.plot(frame=0, values=np.log10(moved["d2min"]), label="log10 of D2_min (d^2)")
assert np.nanmax(moved["d2min"]) > 100 * np.nanmedian(moved["d2min"])
