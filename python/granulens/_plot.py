"""Pictures on a matplotlib axis."""

from __future__ import annotations

from typing import Any

# The colours of granulens's own pictures: host, then other materials.
COLOURS = ("#d9d9d9", "#c98a2b", "#4c78a8", "#6a9f58", "#b05a7a", "#7b6fb0")


def _axis(ax: Any) -> Any:
    if ax is None:
        import matplotlib.pyplot as plt

        _, ax = plt.subplots()
    return ax


def layout(layout: Any, ax: Any, values: Any, label: str) -> Any:
    """The spheres of the half crystal, by material or by a value."""
    from matplotlib.collections import EllipseCollection

    ax = _axis(ax)
    design = layout.design
    table = design.table()
    size = 1e3 * design.diameter_m
    places = list(zip(1e3 * table["x_m"], 1e3 * table["z_m"]))
    options: dict[str, Any] = {"units": "xy", "offsets": places, "transOffset": ax.transData, "edgecolors": "none"}
    options["offset_transform"] = options.pop("transOffset")
    count = len(places)
    spheres = EllipseCollection([size] * count, [size] * count, [0] * count, **options)
    if values is None:
        spheres.set_facecolor([COLOURS[min(number, len(COLOURS) - 1)] for number in layout.materials])
    else:
        spheres.set_array(values)
        ax.figure.colorbar(spheres, ax=ax, label=label)
    ax.add_collection(spheres)
    ax.set_xlim(-0.5 * size, 1e3 * design.half_width_m + 0.5 * size)
    ax.set_ylim(1e3 * max(table["z_m"]) + 0.5 * size, -0.5 * size)
    ax.set_aspect("equal")
    ax.set_xlabel("x (mm)")
    ax.set_ylabel("z (mm)")
    return ax


def lens(lens: Any, ax: Any, rays: int) -> Any:
    """The proposed layout with rays through it."""
    ax = lens.layout.plot(ax)
    for ray in lens.rays(rays)["rays"]:
        points = 1e3 * ray["points_m"]
        ax.plot(points[:, 0], points[:, 1], color="black", linewidth=0.6)
    return ax


def surface(surface: Any, ax: Any) -> Any:
    """A design surface with the known media on it."""
    ax = _axis(ax)
    drawn = ax.contourf(surface.x, surface.y, surface.values, levels=16)
    ax.figure.colorbar(drawn, ax=ax, label=surface.column)
    media = surface.media
    ax.plot(media["x"], media["y"], "k.", markersize=3)
    ax.set(xscale="log", yscale="log", xlabel=surface.axes[0], ylabel=surface.axes[1])
    ax.set_xlim(surface.x[0], surface.x[-1])
    ax.set_ylim(surface.y[0], surface.y[-1])
    return ax


def frames(frames: Any, frame: int, values: Any, label: str, ax: Any) -> Any:
    """The bodies of a frame: grains plain or by a value, walls and intruder dark."""
    from matplotlib.collections import EllipseCollection

    ax = _axis(ax)
    places, sizes = frames.places[frame], frames.diameters
    is_bed = "lengths in d" in frames.units
    x = places[:, 0] % frames.period if frames.period else places[:, 0]
    ends = ((0, frames.grains), (frames.grains, len(sizes)))
    for (first, last), colour in zip(ends, (COLOURS[0], "#555555")):
        size = sizes[first:last]
        offsets = list(zip(x[first:last], places[first:last, 1]))
        options: dict[str, Any] = {"units": "xy", "offsets": offsets, "offset_transform": ax.transData, "edgecolors": "none"}
        disks = EllipseCollection(size, size, [0] * len(size), **options)
        if values is not None and first == 0:
            disks.set_array(values)
            ax.figure.colorbar(disks, ax=ax, label=label)
        else:
            disks.set_facecolor(colour)
        ax.add_collection(disks)
    half = 0.5 * max(sizes)
    ax.set_xlim(min(x) - half, max(x) + half)
    low, high = min(places[:, 1]) - half, max(places[:, 1]) + half
    # Depth grows downwards in a crystal, height upwards in a bed.
    ax.set_ylim((low, high) if is_bed else (high, low))
    ax.set_aspect("equal")
    ax.set_xlabel("x (d)" if is_bed else "x (m)")
    ax.set_ylabel("z (d)" if is_bed else "z (m)")
    return ax
