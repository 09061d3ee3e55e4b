"""A scene: one TOML file with a cable, its environment, its ends and the tolerance that is asked for.

name = "OC3 Hywind"                  optional: description
tolerance = 1e-6                     relative error wanted of the fairlead tension
[environment]                        rho = 1025 kg/m^3, g = 9.80665 m/s^2; depth (m): a flat seabed at z = -depth
current = [0.5, 0.0, 0.0]            m/s, of the water; seabed_stiffness (N/m^2): for dynamics over a seabed,
                                     and seabed_damping (N s/m^2) there
[line]                               length (m), EA (N), then submerged_weight (N/m) or diameter (m) + mass_per_length
friction = 0.001                     (kg/m); friction of the seabed: one value, or a list to compare
Cdn = 1.6                            dynamics: drag Cdn, Cdb, Cdt, added mass Ca, damping (s), see CableProperties
[ends]
anchor = [-853.87, 0.0, -320.0]      m, z up from still water
fairlead = [-5.2, 0.0, -70.0]
[motion]                             of the fairlead about that position; optional, needs diameter and mass_per_length
frequency = 0.05                     Hz, or period (s)
amplitude = [5.0, 0.0, 0.0]          m in x, y, z, of sin(2 pi f t + phase); phase (rad) is 0 where it is not given;
                                     both may be lists of rows [x, y, z], one for each harmonic of the frequency
spectrum = "jonswap"                 in place of all these: a sea that moves a body with the fairlead, by response
                                     amplitude operators; its keys are those of a network file
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from ..catenary.span import Span
from ..common.diagnostics import check_drag
from ..common.motions.body_motion import BodyMotion
from ..common.motions.motion import Motion
from ..common.outcome import InputError
from ..common.properties import CableProperties, Environment, missing_seabed_stiffness
from ..common.types import Vector, as_system
from ..common.validation import positive_number, real_number, vector
from ..mooring.system import mooring_system
from .keys import SCENE, SECTION, check_keys
from .plausibility import suspect_heights, suspect_phases, suspect_rest, suspect_section
from .series.motion_file import motion_from_table


@dataclass(frozen=True)
class Scene:
    """One line with its environment: length in m, friction a tuple of coefficients, anchor and fairlead (3,) in m.

    motion: of the fairlead about that position, or None; safety_factors: on mean and dynamic tension, for the page of
    a file; notes: what its text alone makes suspect. Raises InputError naming the key, its value and its unit.

    >>> section = CableProperties(EA=384.243e6, diameter=0.09, mass_per_length=77.7066)
    >>> Scene("my line", section, 902.2, (0.0, 0.0, -320.0), (848.67, 0.0, -70.0)).spans()[0].z  # m
    250.0
    """

    name: str
    cable: CableProperties
    length: float
    anchor: Vector
    fairlead: Vector
    environment: Environment = Environment()  # noqa: RUF009 (frozen)
    friction: tuple[float, ...] = (0.0,)
    tolerance: float = 1e-6
    description: str = ""
    motion: Motion | BodyMotion | None = None
    safety_factors: tuple[float, float] | None = None
    notes: tuple[str, ...] = ()

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Scene:
        """Read a scene file. Raises InputError naming file and key for anything missing, unknown or out of range.

        What is suspected by its magnitude, a unit or a sign, stands in ``warnings``.

        >>> from importlib.resources import files
        >>> Scene.load(files("reference_data") / "scenes" / "shallow_chain.toml").environment.depth  # m
        30.0
        """
        return read_tables(path, cls._from_tables)

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """What is suspected by its magnitude, with the likely unit or sign, one sentence each."""
        water, of_section = self.environment, tuple(suspect_section(self.cable, self.environment))
        return (
            *of_section,
            *suspect_heights(
                {"anchor": self.anchor[2], "fairlead": self.fairlead[2]}, ("anchor",), water.depth is not None
            ),
            *self.notes,
            *check_drag([self.cable], self.motion is not None, water.current),
            *(() if of_section else suspect_rest(self.spans()[0], water.current)),
        )

    @classmethod
    def _from_tables(cls, data: dict, path: Path) -> Scene:
        tables = {"environment": {}, "line": {}, "ends": {}} | {k: data[k] for k in SCENE if k in data}
        in_waves = isinstance(tables.get("motion"), dict) and "spectrum" in tables["motion"]
        for name, table in {"": data, **tables}.items():
            check_table(name, table, SCENE | {"motion": SCENE["sea" if in_waves else "motion"]})
        for key in ("name", "description"):
            if not isinstance(data.get(key, ""), str):
                raise InputError(f"{data[key]!r} must be a text", field=key, value=data[key])
        line, ends = tables["line"], tables["ends"]
        friction = line.get("friction", 0.0)
        section = {key: line[key] for key in SECTION if key in line}
        scene = cls(
            name=data.get("name", path.stem),
            description=data.get("description", ""),
            tolerance=_tolerance(data.get("tolerance", 1e-6)),
            environment=Environment(**tables["environment"]),
            cable=CableProperties(line["EA"], **section),
            length=positive_number("line.length", line["length"], "m"),
            friction=tuple(friction) if isinstance(friction, list) else (friction,),
            anchor=_point("ends.anchor", ends["anchor"]),
            fairlead=_point("ends.fairlead", ends["fairlead"]),
            motion=_motion(tables["motion"], path.parent) if "motion" in tables else None,
            safety_factors=read_safety_factors(data),
            notes=tuple(suspect_phases(tables.get("motion", {}).get("phase", ()))),
        )
        if not scene.friction:
            problem = "the list is empty; give one coefficient or several"
            raise InputError(problem, field="line.friction", value=friction)
        try:
            scene.spans()
        except InputError as error:
            raise _explained(error, list(suspect_section(scene.cable, scene.environment))) from None
        if scene.motion is not None:
            scene._check_dynamics()
        return scene

    def _check_dynamics(self):
        """Raise InputError for what a motion needs and a line at rest does not."""
        for key, unit in (("diameter", "m"), ("mass_per_length", "kg/m")):
            if getattr(self.cable, key) is None:
                raise InputError(f"not given ({unit}), and [motion] takes it", field=f"line.{key}", unit=unit)
        depth = self.environment.depth
        if depth is None:
            return
        if self.environment.seabed_stiffness is None:
            raise missing_seabed_stiffness("[motion]", self.cable.diameter, "environment.seabed_stiffness")
        if not isinstance(self.motion, Motion):  # of a sea: looked at as it is integrated
            return
        period = np.linspace(0.0, self.motion.period, 64 * self.motion.harmonics + 1)
        lowest = self.fairlead[2] + self.motion.displacement(period)[2].min()
        if lowest < -depth:
            problem = f"takes the fairlead down to z = {lowest:g} m, below the seabed, {-depth:g} m"
            raise InputError(problem, field="motion.amplitude", value=self.motion.sine.tolist(), unit="m")

    def spans(self) -> tuple[Span, ...]:
        """Return the line as solvers.Span in its vertical plane, one for each friction coefficient."""
        (x0, y0, z0), (x1, y1, z1) = self.anchor, self.fairlead
        depth = self.environment.depth
        shape: dict[str, Any] = {
            "w": self.cable.weight_in(self.environment),
            "EA": self.cable.EA,
            "L": self.length,
            "x": math.hypot(x1 - x0, y1 - y0),
            "z": z1 - z0,
            "seabed": depth is not None,
            "clearance": 0.0 if depth is None else z0 + depth,
        }
        return tuple(Span(**shape, friction=friction) for friction in self.friction)


def _explained(error: InputError, suspected: list[str]) -> InputError:
    """Return the error of a line that has no span, with what is suspected of its section, or what a file can say."""
    about = {"field": error.field, "value": error.value, "unit": error.unit}
    if suspected:
        return InputError(f"{suspected[0]} As it stands, {error.field}: {error.problem}.", label="", **about)
    hint = "In a file: leave out depth." if error.field == "w" else ""
    return InputError(f"{error.problem}. {hint}", **about)


def read_safety_factors(data: dict) -> tuple[float, float] | None:
    """Return the factors on mean and dynamic tension of the tables of a file, None where there are none."""
    if "safety_factors" not in data:
        return None
    table = data["safety_factors"]
    mean, dynamic = (positive_number(f"safety_factors.{k}", table[k], "(dimensionless)") for k in ("mean", "dynamic"))
    return mean, dynamic


def read_tables(path, build):
    """Return build(tables, path) of a TOML file; raises InputError naming the file for what is wrong with or in it."""
    try:
        path = Path(path)
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except TypeError:
        raise InputError(f"{path!r} is not the path of a scene file", field="path", value=path) from None
    except FileNotFoundError:
        raise _path_error(path, "there is no such scene file") from None
    except (OSError, UnicodeDecodeError) as error:
        raise _path_error(path, f"cannot be read as a text file: {error}") from None
    except tomllib.TOMLDecodeError as error:
        raise _path_error(path, f"is not a TOML file: {error}") from None
    except ValueError:
        raise InputError(f"{str(path)!r} is not the path of a scene file", field="path", value=path) from None
    try:
        return build(data, path)
    except InputError as error:
        raise error.located(str(path)) from None


def _path_error(path, problem) -> InputError:
    return InputError(problem, field="path", value=str(path), label=str(path))


def check_table(name: str, table, tables):
    """Raise InputError for a table of a file, "" for the top level, that is none or has wrong keys."""
    if not isinstance(table, dict):
        raise InputError(f"{table!r} must be a table, [{name}]", field=name, value=table)
    check_keys(f"[{name}]" if name else "the top level", table, tables[name])


def _tolerance(value) -> float:
    tolerance = positive_number("tolerance", value, "(dimensionless)")
    if tolerance >= 1:
        problem = f"{tolerance:g} (dimensionless) must be < 1, a relative error"
        raise InputError(problem, field="tolerance", value=tolerance, unit="(dimensionless)")
    return tolerance


def _motion(table: dict, folder: Path) -> Motion | BodyMotion:
    if "spectrum" in table:
        return motion_from_table(table, folder)
    given = [key for key in ("frequency", "period") if key in table]
    if len(given) != 1:
        raise InputError(f"[motion] takes either frequency (Hz) or period (s); given: {' and '.join(given) or 'none'}")
    frequency = positive_number(f"motion.{given[0]}", table[given[0]], "Hz" if given[0] == "frequency" else "s")
    amplitude = _rows("motion.amplitude", table["amplitude"], "m")
    phase = _rows("motion.phase", table["phase"], "rad") if "phase" in table else np.zeros_like(amplitude)
    if phase.shape != amplitude.shape:
        problem = f"{len(phase)} rows [x, y, z] (rad) do not fit {len(amplitude)} of amplitude"
        raise InputError(problem, field="motion.phase", value=table["phase"], unit="rad")
    if given[0] == "period":
        frequency = 1 / frequency
    return Motion(frequency, amplitude * np.cos(phase), amplitude * np.sin(phase))


def _rows(name: str, value, unit: str) -> np.ndarray:
    """Return [x, y, z] of the first harmonic, or a list of such rows, as an array (K, 3)."""
    rows = value if isinstance(value, list) and value and isinstance(value[0], list) else [value]
    return np.array([vector(f"{name}[{k}]" if rows is value else name, row, unit) for k, row in enumerate(rows)])


def _point(name: str, value) -> tuple[float, float, float]:
    if not isinstance(value, list) or len(value) != 3:
        raise InputError(f"{value!r} must be three coordinates [x, y, z] (m)", field=name, value=value, unit="m")
    x, y, z = (real_number(f"{name}[{i}]", v, "m") for i, v in enumerate(value))
    return x, y, z


as_system.register(Scene, mooring_system)  # its moving line of nodes and elements on the default mesh
