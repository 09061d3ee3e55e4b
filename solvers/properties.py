"""What a cable is and what surrounds it: validated when built, SI units."""

from __future__ import annotations

import math
from dataclasses import dataclass
from numbers import Real

import numpy as np

from .outcome import InputError


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


@dataclass(frozen=True)
class Environment:
    """Water and gravity: rho in kg/m^3, g in m/s^2; depth of the flat seabed below z = 0 in m, None: no seabed."""

    rho: float = 1025.0
    g: float = 9.80665
    depth: float | None = None

    def __post_init__(self):
        object.__setattr__(self, "rho", real_number("rho", self.rho, "kg/m^3"))
        if self.rho < 0:
            raise InputError(f"rho: {self.rho:g} kg/m^3 must be >= 0")
        object.__setattr__(self, "g", positive_number("g", self.g, "m/s^2"))
        if self.depth is not None:
            object.__setattr__(self, "depth", positive_number("depth", self.depth, "m"))


@dataclass(frozen=True)
class CableProperties:
    """Section of a cable: diameter in m, mass_per_length (in air) in kg/m, EA in N.

    submerged_weight in N/m per unstretched length; if None it follows from mass, diameter and environment, (2.2).
    """

    EA: float
    diameter: float | None = None
    mass_per_length: float | None = None
    submerged_weight: float | None = None

    def __post_init__(self):
        object.__setattr__(self, "EA", positive_number("EA", self.EA, "N"))
        for name, unit in (("diameter", "m"), ("mass_per_length", "kg/m")):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, positive_number(name, getattr(self, name), unit))
        if self.submerged_weight is not None:
            weight = real_number("submerged_weight", self.submerged_weight, "N/m")
            object.__setattr__(self, "submerged_weight", weight)
        elif self.diameter is None or self.mass_per_length is None:
            raise InputError(
                "submerged_weight: not given (N/m), and it takes both diameter (m) and mass_per_length (kg/m)"
            )

    def weight_in(self, environment: Environment) -> float:
        """Submerged weight per unstretched length, N/m: as given, else g (m - rho pi d^2/4), MSQS (2.2)."""
        if self.submerged_weight is not None:
            return self.submerged_weight
        displaced = environment.rho * math.pi * self.diameter**2 / 4
        return environment.g * (self.mass_per_length - displaced)
