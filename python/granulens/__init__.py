"""Impact lenses: packings of metal spheres that steer an impact wave to where it does no harm.

Quantities are in SI unless a name says otherwise; tables are dicts of columns, which pandas and polars take as they are. Results have the same bits
as those of the command line, for any number of threads.

- `materials`, `Material`, `contact`, `contact_path`, `collide`, `wave_speed`, `surface`: materials, contacts and waves
- `Design`, `design`, `Lens`, `Layout`: what is asked for and what is proposed; `SpaceDesign`, `SpaceLayout`: the same of crystals in space
- `evaluate`, `Evaluator`, `simulate`, `Record`: layouts under an impact
- `sensitivity`, `tolerance`: how scores change with every sphere, and what pieces as made are worth
- `Rig`, `Bed`, `Packing`: anything a lab can build, and granular beds; `Frames`, `read_frames`, `network`, `motion`: what goes on inside
- `arrow`: tables as pyarrow has them
- `Study`, `Result`: searches, here or through an executor; `granulens.engines`: Dask, HyperQueue
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ._errors import Error, GuardError, InputError, LostError
from ._granulens import (
    Bed,
    Design,
    Evaluator,
    Layout,
    Lens,
    Material,
    Packing,
    Rig,
    SpaceDesign,
    SpaceLayout,
    __commit__,
    __version__,
    collide,
    contact,
    contact_path,
    find_material,
    materials,
    motion,
    read_frames,
    wave_speed,
)

if TYPE_CHECKING:
    from ._run import (
        Frames,
        Network,
        Record,
        Sensitivity,
        Surface,
        arrow,
        design,
        evaluate,
        network,
        sensitivity,
        simulate,
        surface,
        tolerance,
    )
    from ._study import Result, Study

__all__ = [
    "Bed",
    "Design",
    "Error",
    "Evaluator",
    "Frames",
    "GuardError",
    "InputError",
    "Layout",
    "Lens",
    "LostError",
    "Material",
    "Network",
    "Packing",
    "Record",
    "Result",
    "Rig",
    "Sensitivity",
    "SpaceDesign",
    "SpaceLayout",
    "Study",
    "Surface",
    "__commit__",
    "__version__",
    "arrow",
    "collide",
    "contact",
    "contact_path",
    "design",
    "evaluate",
    "find_material",
    "materials",
    "motion",
    "network",
    "read_frames",
    "sensitivity",
    "simulate",
    "surface",
    "tolerance",
    "wave_speed",
]

# Read when they are first asked for, so that to import the package takes a few hundredths of a second.
_LATER = {
    **dict.fromkeys(
        (
            "Frames",
            "Network",
            "Record",
            "Sensitivity",
            "Surface",
            "arrow",
            "design",
            "evaluate",
            "network",
            "sensitivity",
            "simulate",
            "surface",
            "tolerance",
        ),
        "_run",
    ),
    **dict.fromkeys(("Result", "Study"), "_study"),
    "engines": "engines",
}


def __getattr__(name: str) -> object:
    if name not in _LATER:
        raise AttributeError(f"module 'granulens' has no attribute '{name}'")
    from importlib import import_module

    module = import_module(f".{_LATER[name]}", __name__)
    found = module if name == "engines" else getattr(module, name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
