"""A scene: one TOML file with a cable, its surroundings, its ends and the tolerance its owner wants.

name = "OC3 Hywind"                  optional: description
tolerance = 1e-6                     relative error wanted of the fairlead tension
[environment]                        rho = 1025 kg/m^3, g = 9.80665 m/s^2; depth (m): a flat seabed at z = -depth
[line]                               length (m), EA (N), then submerged_weight (N/m) or diameter (m) + mass_per_length
friction = 0.001                     (kg/m); friction of the seabed: one value, or a list to compare
[ends]
anchor = [-853.87, 0.0, -320.0]      m, z up from still water
fairlead = [-5.2, 0.0, -70.0]
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

from .catenary import Span
from .outcome import InputError
from .properties import CableProperties, Environment, positive_number, real_number

_KEYS = {
    "": {"name", "description", "tolerance", "environment", "line", "ends"},
    "environment": {"rho", "g", "depth"},
    "line": {"length", "EA", "submerged_weight", "diameter", "mass_per_length", "friction"},
    "ends": {"anchor", "fairlead"},
}
_REQUIRED = {"": ("line", "ends"), "environment": (), "line": ("length", "EA"), "ends": ("anchor", "fairlead")}


@dataclass(frozen=True)
class Scene:
    """One line with its surroundings: length in m, friction a tuple of coefficients, anchor and fairlead (3,) in m.

    Raises InputError naming the key, its value and its unit.
    """

    name: str
    cable: CableProperties
    length: float
    anchor: tuple[float, float, float]
    fairlead: tuple[float, float, float]
    environment: Environment = Environment()  # noqa: RUF009 (frozen)
    friction: tuple[float, ...] = (0.0,)
    tolerance: float = 1e-6
    description: str = ""

    @classmethod
    def load(cls, path) -> Scene:
        """Read a scene file. Raises InputError naming file and key for anything missing, unknown or out of range."""
        return read_tables(path, cls._from_tables)

    @classmethod
    def _from_tables(cls, data: dict, stem: str) -> Scene:
        tables = {name: data.get(name, {}) for name in ("environment", "line", "ends")}
        for name, table in {"": data, **tables}.items():
            _check_keys(name, table)
        for key in ("name", "description"):
            if not isinstance(data.get(key, ""), str):
                raise InputError(f"{key}: {data[key]!r} must be a text")
        line, ends = tables["line"], tables["ends"]
        friction = line.get("friction", 0.0)
        section = {key: line[key] for key in ("diameter", "mass_per_length", "submerged_weight") if key in line}
        scene = cls(
            name=data.get("name", stem),
            description=data.get("description", ""),
            tolerance=_tolerance(data.get("tolerance", 1e-6)),
            environment=Environment(**tables["environment"]),
            cable=CableProperties(line["EA"], **section),
            length=positive_number("line.length", line["length"], "m"),
            friction=tuple(friction) if isinstance(friction, list) else (friction,),
            anchor=_point("ends.anchor", ends["anchor"]),
            fairlead=_point("ends.fairlead", ends["fairlead"]),
        )
        if not scene.friction:
            raise InputError("line.friction: the list is empty; give one coefficient or several")
        scene.spans()
        return scene

    def spans(self) -> tuple[Span, ...]:
        """The line as solvers.Span in its vertical plane, one for each friction coefficient."""
        (x0, y0, z0), (x1, y1, z1) = self.anchor, self.fairlead
        depth = self.environment.depth
        shape = {
            "w": self.cable.weight_in(self.environment),
            "EA": self.cable.EA,
            "L": self.length,
            "x": math.hypot(x1 - x0, y1 - y0),
            "z": z1 - z0,
            "seabed": depth is not None,
            "clearance": 0.0 if depth is None else z0 + depth,
        }
        return tuple(Span(**shape, friction=friction) for friction in self.friction)


def read_tables(path, build):
    """build(tables, stem) of a TOML file. Raises InputError naming the file, for what it is and for what is in it."""
    try:
        path = Path(path)
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except TypeError:
        raise InputError(f"path: {path!r} is not the path of a scene file") from None
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such scene file") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read as a text file: {error}") from None
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: is not a TOML file: {error}") from None
    try:
        return build(data, path.stem)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def _check_keys(name: str, table):
    where = f"[{name}]" if name else "the top level"
    if not isinstance(table, dict):
        raise InputError(f"{name}: {table!r} must be a table, [{name}]")
    for key in table:
        if key not in _KEYS[name]:
            near = [k for k in _KEYS[name] if k.lower() == key.lower()] or get_close_matches(key, _KEYS[name], n=1)
            hint = f"did you mean {near[0]!r}?" if near else f"known keys are {', '.join(sorted(_KEYS[name]))}"
            raise InputError(f"unknown key {key!r} in {where}; {hint}")
    for key in _REQUIRED[name]:
        if key not in table:
            raise InputError(f"missing key {key!r} in {where}")


def _tolerance(value) -> float:
    tolerance = positive_number("tolerance", value, "(dimensionless)")
    if tolerance >= 1:
        raise InputError(f"tolerance: {tolerance:g} (dimensionless) must be < 1, a relative error")
    return tolerance


def _point(name: str, value) -> tuple[float, float, float]:
    if not isinstance(value, list) or len(value) != 3:
        raise InputError(f"{name}: {value!r} must be three coordinates [x, y, z] (m)")
    return tuple(real_number(f"{name}[{i}]", v, "m") for i, v in enumerate(value))
