"""Evaluations, simulations and surfaces, with a face for notebooks."""

from __future__ import annotations

import json
from dataclasses import dataclass
from html import escape
from os import PathLike
from typing import TYPE_CHECKING, Any
from collections.abc import Mapping, Sequence

from . import _granulens
from ._errors import InputError
from ._granulens import Design, Evaluator, Layout, Material, Rig

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Palette = Sequence["Material | str"]


def design(base: Design | str | PathLike[str] | None = None, /, **sections: Any) -> Design:
    """A design from arguments, alone or in place of parts of another one.

    Parameters
    ----------
    base : Design or path, optional
        What is left out below is as there.
    **sections
        The sections of a design file as dicts, and its name: ``name="mine", crystal={"rows": 12, ...}, impact={...}, target={...}``; quantities
        as text with units, as in files. None takes a value out.

    Examples
    --------
    >>> stronger = design("designs/quickstart.toml", impact={"force": "30 kN"})
    """
    if base is not None and not isinstance(base, Design):
        base = Design(base)
    text = base.text if base is not None else "format = 1\n"
    name = str(base.path) if base is not None else "design.toml"
    return Design.parse(_granulens.merge_text(text, json.dumps(sections)), name)


def as_layouts(layouts: ArrayLike | Layout | Sequence[Layout]) -> NDArray[Any]:
    """Layouts as an array of uint8 of shape (n, sites); one without a first axis is one layout."""
    import numpy as np

    if isinstance(layouts, Layout):
        layouts = [layouts]
    if isinstance(layouts, (list, tuple)) and layouts and all(isinstance(one, Layout) for one in layouts):
        if any(one.palette != layouts[0].palette for one in layouts):
            raise InputError("the layouts have different palettes", "Make them with one palette, or evaluate them one by one.")
        layouts = [one.materials for one in layouts]
    array = np.asarray(layouts)
    if array.ndim == 1:
        array = array[None, :]
    if array.ndim != 2 or (array.dtype != np.uint8 and not np.issubdtype(array.dtype, np.integer)):
        raise InputError(
            f"layouts must be an array of uint8 of shape (n, sites), not of {array.dtype} and shape {array.shape}",
            "Each number is the place of a material in the palette.",
        )
    if array.dtype != np.uint8:
        if array.size and (array.min() < 0 or array.max() > 255):
            raise InputError("layouts hold numbers that stand for no material")
        array = array.astype(np.uint8)
    return array


def evaluate(
    design: Design,
    layouts: ArrayLike | Layout | Sequence[Layout],
    palette: Palette | None = None,
    **options: Any,
) -> dict[str, Any]:
    """Scores of many layouts, side by side in the registers of every core.

    Parameters
    ----------
    design : Design
    layouts : array of uint8, shape (n, sites), or Layout, or a list of these
        For each layout the number of the material on each site.
    palette : list of Material or str, optional
        What the numbers stand for, host first; of arrays the design's own materials where left out, of a Layout its own.
    **options
        Those of `Evaluator`: forces, band, step, window, integrator, records, threads.

    Returns
    -------
    dict of columns, one entry per layout
        focal_mean_J, protected_mean_J, contrast, focal_gain, protection, ... (float64, NaN where a measure has no value); stop (str or None).
        ``pandas.DataFrame(...)`` and ``polars.DataFrame(...)`` take it as it is.

    An `Evaluator` is the same, made once for many calls.
    """
    if palette is None:
        first = layouts[0] if isinstance(layouts, (list, tuple)) and layouts else layouts
        palette = first.palette if isinstance(first, Layout) else None
    return Evaluator(design, palette, **options)(as_layouts(layouts))


@dataclass(frozen=True)
class Record:
    """One impact on one layout.

    Attributes
    ----------
    layout : Layout
    scores : dict of float
        Every measure by its name with the unit; `granulens check --json` says the same, to the last bit.
    spheres : dict of arrays, shape (sites,)
        max_kinetic_J, max_net_force_N, max_contact_force_N, arrival_s, dissipated_J; displacement_m and velocity_m_s at the end, shape (sites, 2)
    contacts : dict of arrays, shape (contacts,)
        i, j, weight, overlap_max_m, force_max_N, work_J, stored_J
    energies : dict of float
        work_in_J, kinetic_J, stored_J, dissipated_J at the end, of the half
    method : dict
        Law, constants, integrator, step and window, with reasons.
    """

    layout: Layout
    scores: dict[str, float]
    spheres: dict[str, Any]
    contacts: dict[str, Any]
    energies: dict[str, float]
    method: dict[str, Any]
    reference: str | None
    steps: int
    warnings: list[str]
    stop: str | None

    def histories(self, **options: Any) -> dict[str, Any]:
        """The motion of every sphere over time, by the same impact as a rig (velocity Verlet); see `Rig.histories`."""
        return Rig.of_layout(self.layout).histories(**options)

    def plot(self, ax: Any = None, column: str = "max_kinetic_J") -> Any:
        """Draws a column of `spheres` on a matplotlib axis; gives the axis."""
        return self.layout.plot(ax, values=self.spheres[column], label=column)

    def _repr_html_(self) -> str:
        return table_html(self.scores, "score")


def simulate(layout: Layout, **options: Any) -> Record:
    """One impact on one layout, with all records, beside the uniform crystals that G and Q refer to: what `granulens check` does.

    Parameters
    ----------
    layout : Layout
        Such as ``design.propose().layout`` or ``design.layout("mine.csv")``.
    **options
        forces, band, step, window, integrator, threads, as of `Evaluator`.
    """
    return Record(layout=layout, **_granulens.simulate(layout, **options))


@dataclass(frozen=True)
class Surface:
    """A value over two design variables.

    Attributes
    ----------
    column : str
        The value with its unit.
    axes : list of str
    x, y : arrays, shape (nx,), (ny,)
        Nodes of the axes (SI).
    values : array, shape (ny, nx)
        NaN where nothing can be said.
    media : dict of columns
        label, kind, x, y, value of the known media.
    svg : str
    """

    column: str
    axes: list[str]
    x: Any
    y: Any
    values: Any
    media: dict[str, Any]
    svg: str

    def _repr_svg_(self) -> str:
        return self.svg

    def plot(self, ax: Any = None) -> Any:
        """Draws it on a matplotlib axis, with the media; gives the axis."""
        from . import _plot

        return _plot.surface(self, ax)


def surface(
    value: str = "speed",
    *,
    x: str | None = None,
    y: str | None = None,
    x_range: Sequence[float] | None = None,
    y_range: Sequence[float] | None = None,
    shape: Sequence[int] = (97, 73),
    material: Material | str = "440c",
    against: Material | str | None = None,
    dimension: int = 1,
    diameter: float | str = 6.35e-3,
    constants: str = "code",
    amplitude: float | None = None,
) -> Surface:
    """A design surface: speed, speed-ratio, critical-angle, impedance-ratio, plastic-force or dissipation over two variables.

    Parameters
    ----------
    x, y : str, optional
        stiffness, density, yield-stress, modulus, radius, amplitude or dimension.
    x_range, y_range : pair of float, optional
        SI; those of the known media where left out.
    shape : pair of int
        Nodes along x and y.
    material, against : Material or str
        What is not an axis is this material's; ratios are against the other.
    """
    found = _granulens.surface(
        value, x, y, x_range, y_range, list(shape), material, against, dimension, diameter, constants, amplitude
    )
    return Surface(**found)


@dataclass(frozen=True)
class Network:
    """A force network.

    Attributes
    ----------
    topology : dict of arrays
        thresholds (multiples of the mean force), components, loops, holes
    persistence0, persistence1 : arrays, shape (bars, 2)
        Birth and death of components and of loops, in multiples of the mean; NaN for never.
    coordination, coordination_without_rattlers, mean_force : float
    rattlers : array of int64
    fabric, virial : arrays, shape (2, 2), or None without places
    chains : list of arrays of int64, or None without places
    svg : str or None
    """

    grains: int
    mean_force: float
    topology: dict[str, Any]
    persistence0: Any
    persistence1: Any
    coordination: float
    coordination_without_rattlers: float
    rattlers: Any
    fabric: Any
    virial: Any
    chains: list[Any] | None
    svg: str | None

    def _repr_svg_(self) -> str | None:
        return self.svg


def network(contacts: Mapping[str, Any], **options: Any) -> Network:
    """Topology and structure of a force network, as `granulens network` finds them.

    Parameters
    ----------
    contacts : dict of columns, such as `Bed.contacts` gives
        i, j : int, numbers of the grains from 0; normal and, if any, tangential : forces; x_i, y_i, x_j, y_j (or z_i, z_j) : places, if known.
    **options
        grains, period, on ("contacts" or "particles"), force ("normal" or "tangential"), thresholds, title.
    """
    import numpy as np

    def column(*names: str) -> Any:
        for name in names:
            if name in contacts:
                return np.ascontiguousarray(contacts[name], dtype=float)
        return None

    normal = column("normal", "normal_N")
    if normal is None or "i" not in contacts or "j" not in contacts:
        raise InputError("contacts must have the columns i, j and normal", f"These are there: {', '.join(map(str, contacts))}.")
    places = [column("x_i"), column("y_i", "z_i"), column("x_j"), column("y_j", "z_j")]
    i, j = (np.ascontiguousarray(contacts[name], dtype=np.int64) for name in ("i", "j"))
    found = _granulens.network(
        i,
        j,
        normal,
        column("tangential", "tangential_N"),
        None if any(place is None for place in places) else places,
        **options,
    )
    names = ("thresholds", "components", "loops", "holes")
    return Network(topology={name: found.pop(name) for name in names}, **found)


@dataclass(frozen=True)
class Frames:
    """Every body and closed contact in the plane at moments; of a bed, or of a rig.

    Attributes
    ----------
    units : str
        What the numbers are in.
    period : float or None
        Of the sides, along x; places are not taken back.
    grains : int
        Bodies are the grains, then the disks of walls, then those of an intruder; a flat has none.
    kinds : list of str
        Of each body: grain, wall or intruder.
    diameters : array, shape (bodies,)
    times : array, shape (T,)
    places, velocities, forces : arrays, shape (T, bodies, 2)
        Along x and z, which points up in a bed and down in a crystal; forces are the net forces of contacts.
    spins : array, shape (T, bodies)
        From x towards z.
    contacts : list of tables, one for each moment
        i, j : int64, numbers of bodies from 0 (files count from 1), -1 of a flat, -2 of an image in a mirror; x_i, z_i, x_j, z_j : places; normal : force,
        positive where it presses; tangential : force on j, along the normal from i to j turned from x to z.
    """

    units: str
    period: float | None
    grains: int
    kinds: list[str]
    diameters: Any
    times: Any
    places: Any
    velocities: Any
    spins: Any
    forces: Any
    contacts: list[dict[str, Any]]

    def __len__(self) -> int:
        return len(self.times)

    def network(self, frame: int = -1, **options: Any) -> Network:
        """The force network of the grains among themselves at a moment, as `granulens network` finds it; options as of `network`."""
        contacts = self.contacts[frame]
        among = (contacts["i"] >= 0) & (contacts["j"] >= 0) & (contacts["i"] < self.grains) & (contacts["j"] < self.grains)
        options = {"grains": self.grains, "period": self.period, "title": f"at {self.times[frame]:.6g}"} | options
        return network({name: column[among] for name, column in contacts.items()}, **options)

    def motion(self, before: int = 0, after: int = -1, *, radius: float | None = None) -> dict[str, Any]:
        """How the grains moved between two moments, each with its neighbours; see `motion`. Within 2.5 mean diameters where radius is left out."""
        if radius is None:
            radius = 2.5 * float(self.diameters[: self.grains].mean())
        places = self.places[:, : self.grains]
        return _granulens.motion(places[before], places[after], radius=radius, period=self.period)

    def plot(self, ax: Any = None, frame: int = -1, values: Any = None, label: str = "") -> Any:
        """Draws the bodies at a moment on a matplotlib axis, the grains coloured by an array of shape (grains,); gives the axis."""
        from . import _plot

        return _plot.frames(self, frame, values, label, ax)


def table_html(values: Mapping[str, Any], head: str) -> str:
    """Names and values as a table of HTML."""

    def shown(value: Any) -> str:
        return f"{value:.6g}" if isinstance(value, float) else escape(str(value))

    rows = "".join(f"<tr><td>{escape(name)}</td><td>{shown(value)}</td></tr>" for name, value in values.items())
    return f"<table><thead><tr><th>{escape(head)}</th><th></th></tr></thead><tbody>{rows}</tbody></table>"


@dataclass(frozen=True)
class Sensitivity:
    """How scores change with every sphere.

    Derivatives of the logarithm of a measure by the logarithms of density, Young's modulus, yield stress and radius of each sphere: −0.5 says that
    one per cent more of the quantity takes 0.5 % off the measure. `secant_density` is the same quotient over 1 % of density, by a run of its own;
    `linear` says whether both agree to a tenth. Where they do not, the derivative is right and of no use.

    Attributes
    ----------
    layout : Layout
    sites : dict of tables, by measure
        Each a dict of arrays of shape (sites,): d_density, d_youngs_modulus, d_yield_stress, d_radius, secant_density (float64), linear (bool).
    d_force : dict of float
        By measure, of its logarithm by that of the impact's force.
    focal_mean_J, protected_mean_J : float
        F and P at the same step.
    bytes : int
        Memory that the derivatives took.
    """

    layout: Layout
    sites: dict[str, dict[str, Any]]
    d_force: dict[str, float]
    focal_mean_J: float
    protected_mean_J: float
    method: dict[str, Any]
    bytes: int

    def plot(self, ax: Any = None, measure: str = "focal_mean", column: str = "secant_density") -> Any:
        """Draws a column of `sites` on a matplotlib axis; gives the axis."""
        return self.layout.plot(ax, values=self.sites[measure][column], label=f"{column} of {measure}")


def sensitivity(layout: Layout, of: Sequence[str] | None = None, **options: Any) -> Sensitivity:
    """How scores change with every sphere, by the adjoint of the run: what `granulens sensitivity` does.

    Parameters
    ----------
    layout : Layout
    of : list of str, optional
        Among focal_mean, protected_mean, contrast, focal_gain, protection; the first three where left out.
    **options
        step, window (s, or text with a unit), integrator, threads.
    """
    return Sensitivity(layout, **_granulens.sensitivity(layout, None if of is None else list(of), **options))


def tolerance(layout: Layout, tolerances: str | PathLike[str] | None = None, **options: Any) -> dict[str, Any]:
    """What a layout is worth once a workshop has made it: what `granulens tolerance` does.

    Parameters
    ----------
    layout : Layout
    tolerances : path, optional
        A file of tolerances; diameters of grade G100 and all else nominal where left out.
    **options
        samples, seed, step, window, integrator, threads.

    Returns
    -------
    dict
        yield, interval (Wilson, 95 %), yield_of, samples, passed, stopped, seed; pieces, a table with a row for each piece made; warnings; sensitivity, as_built,
        distribution, quantities, method. The numbers are those of the command line with the same seed, to the last bit.
    """
    return _granulens.tolerance(layout, tolerances, **options)


def arrow(table: Mapping[str, Any]) -> Any:
    """A table of this package, a dict of columns, as a `pyarrow.Table`; needs pyarrow. Columns of points become one column for each axis."""
    import numpy as np
    import pyarrow

    columns: dict[str, Any] = {}
    for name, column in table.items():
        array = np.asarray(column)
        if array.ndim == 2:
            for axis, part in zip("xyz" if array.shape[1] == 3 else "xz", array.T):
                columns[f"{name}_{axis}"] = np.ascontiguousarray(part)
        else:
            columns[name] = column
    return pyarrow.table(columns)
