"""What a cable is and what surrounds it: validated when built, SI units."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from numbers import Complex, Real

import numpy as np

from .outcome import InputError

_LARGEST = 1e100  # m; squares of a diameter and products with it stay within double precision


def real_number(name: str, value, unit: str) -> float:
    """``value`` as a finite float; raises InputError naming the field, the value and its unit."""
    if type(value) is not float:
        if isinstance(value, np.ndarray) and value.ndim == 0 and not np.ma.is_masked(value):
            value = value.item()
        if isinstance(value, bool) or not isinstance(value, Real):
            article = "one" if isinstance(value, (list, tuple, np.ndarray)) else "a"
            raise InputError(f"{name}: {value!r} must be {article} real number ({unit.strip('()')})")
        try:
            value = float(value)
        except OverflowError:
            raise InputError(f"{name}: {value!r} {unit} must be finite") from None
    if not math.isfinite(value):
        raise InputError(f"{name}: {value} {unit} must be finite")
    return value


def positive_number(name: str, value, unit: str) -> float:
    """As ``real_number``, and > 0."""
    value = real_number(name, value, unit)
    if value <= 0:
        raise InputError(f"{name}: {value:g} {unit} must be > 0")
    return value


def non_negative_number(name: str, value, unit: str) -> float:
    """As ``real_number``, and >= 0."""
    value = real_number(name, value, unit)
    if value < 0:
        raise InputError(f"{name}: {value:g} {unit} must be >= 0")
    return value


def as_array(value) -> np.ndarray:
    """np.asarray; raises ValueError for rows of different lengths, and for masked elements, which numpy makes NaN."""
    if _masked(value):
        raise ValueError("masked elements")
    return np.asarray(value)


def _masked(value) -> bool:
    return value is np.ma.masked or (isinstance(value, (list, tuple)) and any(map(_masked, value)))


def real_array(value) -> np.ndarray:
    """A copy as floats; raises TypeError or ValueError where it is none, also for complex numbers, which numpy cuts."""
    array = as_array(value)
    among = array.ravel().tolist() if array.dtype == object else ()
    if np.iscomplexobj(array) or any(isinstance(number, Complex) and not isinstance(number, Real) for number in among):
        raise TypeError("complex numbers")
    try:
        return np.array(value, dtype=float)
    except OverflowError as error:  # a whole number beyond 1e308
        raise ValueError(str(error)) from None


def one_of(name: str, value, choices):
    """Raises InputError naming the choices where ``value`` is none of them."""
    if not isinstance(value, (str, type(None))) or value not in choices:
        *most, last = map(repr, choices)
        raise InputError(f"{name}: {value!r} must be {', '.join(most)} or {last}")


def flags(**given):
    """Raises InputError naming the one of the keywords that is neither True nor False."""
    for name, value in given.items():
        if type(value) is not bool and not isinstance(value, np.bool_):
            raise InputError(f"{name}: {value!r} must be True or False")


def vector(name: str, value, unit: str, what: str = "components") -> tuple[float, float, float]:
    """Three real numbers in x, y, z as a tuple of finite floats; raises InputError naming the one that is not."""
    listed = isinstance(value, (list, tuple)) or (isinstance(value, np.ndarray) and value.ndim == 1)
    if not listed or len(value) != 3 or any(isinstance(part, (list, tuple, np.ndarray)) for part in value):
        raise InputError(f"{name}: {value!r} must be three {what} [x, y, z] ({unit})")
    return tuple(real_number(f"{name}[{i}]", v, unit) for i, v in enumerate(value))


@dataclass(frozen=True)
class Environment:
    """Water, gravity and seabed, flat at z = -depth.

    rho in kg/m^3, g in m/s^2, depth in m (None: no seabed); current: steady velocity of the water, (3,) in m/s;
    seabed_stiffness in N/m^2, per unit length of line and metre of penetration (None: rigid, for statics only).
    Raises InputError naming the field, its value and its unit.
    """

    rho: float = 1025.0
    g: float = 9.80665
    depth: float | None = None
    current: tuple[float, float, float] = field(default=(0.0, 0.0, 0.0), kw_only=True)
    seabed_stiffness: float | None = field(default=None, kw_only=True)

    def __post_init__(self):
        object.__setattr__(self, "rho", non_negative_number("rho", self.rho, "kg/m^3"))
        object.__setattr__(self, "g", positive_number("g", self.g, "m/s^2"))
        if self.depth is not None:
            object.__setattr__(self, "depth", positive_number("depth", self.depth, "m"))
        object.__setattr__(self, "current", vector("current", self.current, "m/s"))
        if self.seabed_stiffness is not None:
            stiffness = non_negative_number("seabed_stiffness", self.seabed_stiffness, "N/m^2")
            if self.depth is None:
                raise InputError(f"seabed_stiffness: {stiffness:g} N/m^2 takes a seabed, and depth (m) is not given")
            object.__setattr__(self, "seabed_stiffness", stiffness)


_COEFFICIENTS = {  # field -> unit
    "Cdn": "(dimensionless)",
    "Cdb": "(dimensionless)",
    "Cdt": "(dimensionless)",
    "Ca": "(dimensionless)",
    "damping": "s",
}


@dataclass(frozen=True)
class CableProperties:
    """Section of a cable: diameter in m, mass_per_length (in air) in kg/m, EA in N.

    submerged_weight in N/m per unstretched length; if None it follows from mass, diameter and environment, (2.2).
    For dynamics, HB (1)-(12): drag coefficients Cdn, Cdb (normal, binormal, on d l; Cdb is Cdn unless given) and Cdt
    (tangential, on pi d l), added mass coefficient Ca, and damping: the Kelvin-Voigt time beta in s of
    T = EA (eps + beta d(eps)/dt). They act with diameter and mass_per_length, which statics does not need.
    Raises InputError naming the field, its value and its unit.
    """

    EA: float
    diameter: float | None = None
    mass_per_length: float | None = None
    submerged_weight: float | None = None
    Cdn: float = field(default=0.0, kw_only=True)
    Cdb: float | None = field(default=None, kw_only=True)
    Cdt: float = field(default=0.0, kw_only=True)
    Ca: float = field(default=0.0, kw_only=True)
    damping: float = field(default=0.0, kw_only=True)

    def __post_init__(self):
        object.__setattr__(self, "EA", positive_number("EA", self.EA, "N"))
        for name, unit in (("diameter", "m"), ("mass_per_length", "kg/m")):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, positive_number(name, getattr(self, name), unit))
        if self.diameter is not None and self.diameter > _LARGEST:
            raise InputError(f"diameter: {self.diameter:g} m must not exceed {_LARGEST:g} m")
        if self.submerged_weight is not None:
            weight = real_number("submerged_weight", self.submerged_weight, "N/m")
            object.__setattr__(self, "submerged_weight", weight)
        elif self.diameter is None or self.mass_per_length is None:
            raise InputError(
                "submerged_weight: not given (N/m), and it takes both diameter (m) and mass_per_length (kg/m)"
            )
        if self.Cdb is None:
            object.__setattr__(self, "Cdb", self.Cdn)
        for name, unit in _COEFFICIENTS.items():
            object.__setattr__(self, name, non_negative_number(name, getattr(self, name), unit))

    @property
    def area(self) -> float:
        """Area of the section, pi d^2/4, m^2. Raises InputError without a diameter."""
        if self.diameter is None:
            raise InputError("diameter: not given (m), and the area of the section takes it")
        return math.pi * self.diameter**2 / 4

    def added_mass(self, environment: Environment) -> float:
        """Added mass per unstretched length, C_a rho pi d^2/4 in kg/m, HB 2.1. Raises InputError without a diameter."""
        return self.Ca * environment.rho * self.area

    def weight_in(self, environment: Environment) -> float:
        """Submerged weight per unstretched length, N/m: as given, else g (m - rho pi d^2/4), MSQS (2.2)."""
        if self.submerged_weight is not None:
            return self.submerged_weight
        return environment.g * (self.mass_per_length - environment.rho * self.area)
