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
# # A design surface for a paper
# How fast is a wave in a chain of spheres? The bound V follows from the stiffness K of the fully plastic contact and the density alone.

# %%
import matplotlib.pyplot as plt
import numpy as np

import granulens as gl

surface = gl.surface("speed", dimension=1)
surface

# %% [markdown]
# The same on an axis of one's own, as a column of a paper is wide.

# %%
figure, axis = plt.subplots(figsize=(3.4, 2.8), layout="constrained")
surface.plot(axis)

# %% [markdown]
# V goes as the root of K over that of the density: along a line of equal density the slope of ln V over ln K is 1/2.

# %%
row = len(surface.y) // 2
along = surface.values[row]
slope = np.polyfit(np.log(surface.x), np.log(along), 1)[0] if surface.axes[0] == "stiffness" else np.polyfit(
    np.log(surface.y), np.log(surface.values[:, len(surface.x) // 2]), 1
)[0]
print(f"slope {slope:.6f}")
assert abs(slope - 0.5) < 1e-6

# %% [markdown]
# Which known media are slower than steel by at least a third?

# %%
media = surface.media
steel = gl.wave_speed("440c", dimension=1)["speed_m_s"]
for label, kind, speed in zip(media["label"], media["kind"], media["value"]):
    if kind == "uniform" and speed < 2 / 3 * steel:
        print(f"{label:12} {speed:6.0f} m/s")
