"""Response curves in files: all their numbers as they are, so that a curve goes on from its file as from memory."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ..common.outcome import InputError, Status
from ..stability.curves.curve import ResponseCurve, assemble_curve
from ..stability.curves.family import HarmonicFamily, build_family
from ..stability.curves.special_points import SpecialPoint
from ..stability.curves.tracing import CurvePoint, TraceState

FORMAT = 2  # of the file; another number is refused
_ARRAYS = "z", "greatest", "least"
_MULTIPLIERS = "multipliers", "sideways"
_NUMBERS = "value", "omega", "tangent", "error", "iterations", "residual_norm"


def save_curve(curve, path) -> None:
    """Write a ResponseCurve to a file .npz, without its system.

    Raises InputError for anything else.
    """
    if not isinstance(curve, ResponseCurve):
        raise InputError("must be a ResponseCurve", field="curve", value=curve)
    family = curve.family
    content: dict[str, Any] = {
        "format": FORMAT, "parameter": curve.parameter, "status": curve.status.name, "end": curve.end,
        "settings": [*family.settings, family.subharmonic],
    }  # fmt: skip
    for i, point in enumerate(curve.points):
        content |= {f"{i}.{name}": getattr(point, name) for name in (*_ARRAYS, *_NUMBERS)}
        content |= _with_multipliers(f"{i}", point)
        for j, special in enumerate(point.special):
            prefix = f"{i}.special{j}"
            content |= {f"{prefix}.kind": special.kind, f"{prefix}.value": special.value, f"{prefix}.z": special.z}
            content |= {f"{prefix}.after": special.after, f"{prefix}.doubt": special.doubt}
            content |= _with_multipliers(prefix, special)
    if curve.state is not None:
        content |= {f"state.{name}": value for name, value in curve.state._asdict().items()}
    np.savez(Path(path), **content)


def _with_multipliers(prefix, point):
    """Return the multipliers of a point or special point under the names that they have in the file."""
    named = {name: getattr(point, name, None) for name in _MULTIPLIERS}
    return {f"{prefix}.{name}": values for name, values in named.items() if values is not None}


def load_curve(path, system=None, parameter="frequency") -> ResponseCurve:
    """Return the ResponseCurve of a file that ``save_curve`` wrote.

    system, parameter: those that it was made with, as of ``response_curve``. Raises InputError where the file holds no
    curve, or one over another parameter.
    """
    try:
        with np.load(Path(path), allow_pickle=False) as file:
            content = dict(file)
        if content["format"] != FORMAT:
            raise InputError(f"format {content['format']} must be {FORMAT}", field="path", value=path)
    except (OSError, ValueError, KeyError, TypeError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path} is no file of a response curve: {error}", field="path", value=path) from error
    name = parameter if isinstance(parameter, str) else "value"
    if content["parameter"] != name:
        raise InputError(f"the file is over {str(content['parameter'])!r}", field="parameter", value=parameter)
    family = HarmonicFamily(build_family(system, parameter), *(int(number) for number in content["settings"]))
    points: list[CurvePoint] = []
    while f"{len(points)}.z" in content:
        points.append(_point(content, len(points)))
    state = None
    if "state.x" in content:
        numbers = {name: content[f"state.{name}"] for name in TraceState._fields}
        for key in ("u", "value", "step"):
            numbers[key] = float(numbers[key])
        state = TraceState(**numbers | {"harmonics": int(numbers["harmonics"])})
    status = Status[str(content["status"])]
    return assemble_curve(family, name, points, state, status, str(content["end"]))


def _point(content, i):
    """Return the CurvePoint of a number."""
    special: list[SpecialPoint] = []
    while (prefix := f"{i}.special{len(special)}") + ".z" in content:
        kind, value, z, after, doubt = (
            content[f"{prefix}.{name}"] for name in ("kind", "value", "z", "after", "doubt")
        )
        multipliers = content.get(f"{prefix}.multipliers")
        special.append(SpecialPoint(str(kind), float(value), z, multipliers, int(after), str(doubt)))
    values: dict[str, Any] = {name: content[f"{i}.{name}"] for name in _ARRAYS}
    values |= {name: float(content[f"{i}.{name}"]) for name in _NUMBERS}
    values |= {"iterations": int(values["iterations"])}
    values |= {name: content.get(f"{i}.{name}") for name in _MULTIPLIERS}
    return CurvePoint(**values, special=tuple(special))
