"""Data of a cable and its environment, validated when built, SI units."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from .outcome import InputError
from .types import Vector
from .validation import non_negative_number, positive_number, real_number, vector

MAX_STRAIN = 0.3  # of a moving line: chain breaks at 0.01, polyester at 0.15, nylon near 0.3
_LARGEST = 1e100  # m; squares of a diameter and products with it stay within double precision


@dataclass(frozen=True)
class Environment:
    """Water, gravity and seabed, flat at z = -depth.

    rho in kg/m^3, g in m/s^2, depth in m (None: no seabed); current: steady velocity of the water, (3,) in m/s;
    seabed_stiffness in N/m^2, per unit length of line and metre of penetration (None: rigid, for statics only);
    seabed_damping in N s/m^2, per unit length and m/s while the seabed is pressed, for moving lines of nodes.
    Raises InputError naming the field, its value and its unit.

    >>> Environment(depth=320.0, current=(0.5, 0.0, 0.0)).rho  # kg/m^3
    1025.0
    """

    rho: float = 1025.0
    g: float = 9.80665
    depth: float | None = None
    current: Vector = field(default=(0.0, 0.0, 0.0), kw_only=True)
    seabed_stiffness: float | None = field(default=None, kw_only=True)
    seabed_damping: float = field(default=0.0, kw_only=True)

    def __post_init__(self):
        object.__setattr__(self, "rho", non_negative_number("rho", self.rho, "kg/m^3"))
        object.__setattr__(self, "g", positive_number("g", self.g, "m/s^2"))
        if self.depth is not None:
            depth = real_number("depth", self.depth, "m")
            if depth < 0:
                problem = f"{depth:g} m must be > 0: the seabed is at z = -depth, so give {-depth:g} m"
                raise InputError(problem, field="depth", value=depth, unit="m")
            object.__setattr__(self, "depth", positive_number("depth", depth, "m"))
        object.__setattr__(self, "current", vector("current", self.current, "m/s"))
        for name, unit, without in (("seabed_stiffness", "N/m^2", None), ("seabed_damping", "N s/m^2", 0.0)):
            if getattr(self, name) is None and without is None:
                continue
            value = non_negative_number(name, getattr(self, name), unit)
            if value != without and self.depth is None:
                problem = f"{value:g} {unit} takes a seabed, and depth (m) is not given"
                raise InputError(problem, field=name, value=value, unit=unit)
            object.__setattr__(self, name, value)


SEABED_PRESSURE = 3e6  # Pa/m, of the seabed that MoorDyn and MoorPy take where none is given (kBot)


def missing_seabed_stiffness(who: str, diameter, field="seabed_stiffness") -> InputError:
    """Return the error of who takes a seabed's stiffness and has none, with a usual value for a diameter in m."""
    problem = (
        f"not given (N/m^2), and {who} over a seabed takes it: usual are {SEABED_PRESSURE:g} Pa/m times the diameter "
        f"(the default of MoorDyn, kBot), here {SEABED_PRESSURE * diameter:.2g} N/m^2; or leave out depth, which "
        "removes the seabed"
    )
    return InputError(problem, field=field, unit="N/m^2")


_COEFFICIENTS = {  # field -> unit
    "Cdn": "(dimensionless)",
    "Cdb": "(dimensionless)",
    "Cdt": "(dimensionless)",
    "Ca": "(dimensionless)",
    "damping": "s",
}


@dataclass(frozen=True)
class CableProperties:
    """Section of a cable: diameter in m, mass_per_length (in air) in kg/m, EA in N, breaking_load in N or None.

    submerged_weight in N/m per unstretched length; if None it follows from mass, diameter and environment, (2.2).
    For dynamics, HB (1)-(12): drag coefficients Cdn, Cdb (normal, binormal, on d l; Cdb is Cdn unless given) and Cdt
    (tangential, on pi d l), added mass coefficient Ca, and damping: the Kelvin-Voigt time beta in s of
    T = EA (eps + beta d(eps)/dt). They act with diameter and mass_per_length, which statics does not need.
    Raises InputError naming the field, its value and its unit.

    >>> chain = CableProperties(EA=384.243e6, diameter=0.09, mass_per_length=77.7066)
    >>> round(chain.weight_in(Environment()), 2)  # N/m
    698.09
    """

    EA: float
    diameter: float | None = None
    mass_per_length: float | None = None
    submerged_weight: float | None = None
    breaking_load: float | None = field(default=None, kw_only=True)
    Cdn: float = field(default=0.0, kw_only=True)
    Cdb: float | None = field(default=None, kw_only=True)
    Cdt: float = field(default=0.0, kw_only=True)
    Ca: float = field(default=0.0, kw_only=True)
    damping: float = field(default=0.0, kw_only=True)

    def __post_init__(self):
        object.__setattr__(self, "EA", positive_number("EA", self.EA, "N"))
        for name, unit in (("diameter", "m"), ("mass_per_length", "kg/m"), ("breaking_load", "N")):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, positive_number(name, getattr(self, name), unit))
        if self.diameter is not None and self.diameter > _LARGEST:
            problem = f"{self.diameter:g} m must not exceed {_LARGEST:g} m"
            raise InputError(problem, field="diameter", value=self.diameter, unit="m")
        if self.submerged_weight is not None:
            weight = real_number("submerged_weight", self.submerged_weight, "N/m")
            object.__setattr__(self, "submerged_weight", weight)
        elif self.diameter is None or self.mass_per_length is None:
            problem = "not given (N/m), and it takes both diameter (m) and mass_per_length (kg/m)"
            raise InputError(problem, field="submerged_weight", unit="N/m")
        if self.Cdb is None:
            object.__setattr__(self, "Cdb", self.Cdn)
        for name, unit in _COEFFICIENTS.items():
            object.__setattr__(self, name, non_negative_number(name, getattr(self, name), unit))

    @property
    def area(self) -> float:
        """Area of the section, pi d^2/4, m^2. Raises InputError without a diameter."""
        if self.diameter is None:
            raise InputError("not given (m), and the area of the section takes it", field="diameter", unit="m")
        return math.pi * self.diameter**2 / 4

    def added_mass(self, environment: Environment) -> float:
        """Return the added mass per unstretched length, C_a rho pi d^2/4 in kg/m, HB 2.1.

        Raises InputError without a diameter.
        """
        return self.Ca * environment.rho * self.area

    def weight_in(self, environment: Environment) -> float:
        """Return the submerged weight per unstretched length, N/m: as given, else g (m - rho pi d^2/4), MSQS (2.2)."""
        if self.submerged_weight is not None:
            return self.submerged_weight
        return environment.g * (self.mass_per_length - environment.rho * self.area)  # type: ignore[operator]
