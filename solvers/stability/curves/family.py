"""A family of systems over one parameter, and the harmonic balance of each of them as a function of both."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...common.motions.body_motion import BodyMotion
from ...common.motions.motion import Motion
from ...common.outcome import InputError
from ...common.types import as_system
from ...common.validation import one_of
from ...harmonic_balance.residual import harmonic_residual
from ...numerics.fourier import Basis
from .bordered import factorise_bordered

UNITS = {"frequency": "Hz", "amplitude": "(factor of the driving)"}
DIFFERENCE = np.finfo(float).eps ** (1 / 3)  # of the parameter: central differences lose as much to it as to rounding


def build_family(system, parameter) -> Callable:
    """Return a function from values of a parameter to systems.

    parameter: "frequency" of a Motion or BodyMotion in Hz, of a BodyMotion that of its period; "amplitude", a factor of
    the driving as it is; or the function itself. Raises InputError for another parameter, for the frequency of a system
    that no such motion drives, and for a motion of zero amplitude.
    """
    if callable(parameter):
        return lambda value: as_system(parameter(value))
    one_of("parameter", parameter, tuple(UNITS))
    system = as_system(system)
    _require_displacement(getattr(system, "motion", None))
    if hasattr(system, "with_motion"):
        system.rest_state()  # once: each system of the family takes it over, and a network's takes longer than its rows
    if parameter == "amplitude":
        return system.scaled
    tune = _tunable(system.motion)
    if tune is None:
        problem = "'frequency' takes a system that a Motion drives; give a function from the frequency to the system"
        raise InputError(problem, field="parameter", value=parameter)
    move = getattr(system, "with_motion", None) or (lambda motion: system.replace(motion=motion))
    return lambda value: move(tune(value))


def _require_displacement(motion) -> None:
    """Raise InputError where a motion displaces nothing: each response would be the rest."""
    parts = (motion.translation, motion.rotation) if isinstance(motion, BodyMotion) else (motion,)
    given = [part for part in parts if part is not None]
    if given and not any(len(part.directions()) for part in given):
        problem = "its amplitude is 0 m in all directions, and the lines rest at each value of the parameter: "
        problem += "give it one, such as the 1 m of Motion.harmonic(0.05, (1.0, 0.0, 0.0))"
        raise InputError(problem, field="motion", value=motion, unit="m")


def _tunable(motion) -> Callable | None:
    """Return a function from a frequency in Hz to the motion at that frequency, None where it has none."""
    if isinstance(motion, Motion):
        return lambda value: replace(motion, frequency=value)
    if not isinstance(motion, BodyMotion):
        return None
    parts = {name: getattr(motion, name) for name in ("translation", "rotation") if getattr(motion, name) is not None}
    if not all(isinstance(part, Motion) for part in parts.values()):
        return None
    times = {name: round(part.frequency * motion.period) for name, part in parts.items()}  # of the common period
    retune = lambda value: {name: replace(part, frequency=value * times[name]) for name, part in parts.items()}
    return lambda value: replace(motion, **retune(value))


class HarmonicFamily:
    """The rows of the harmonic balance of ``build(value)`` for coefficients x, as functions of x and the value.

    harmonics, samples, subharmonic: as of ``solve_periodic``. The frequency of the Fourier functions is that of each
    system, so a frequency as parameter changes driving and functions together. The mean is kept and no symmetry used:
    a symmetry would hide the responses that break it.
    """

    def __init__(self, build, harmonics, samples, subharmonic):
        self.build, self.settings, self.subharmonic = build, (harmonics, samples), subharmonic
        self.density = samples, harmonics  # which stays, however many harmonics there are

    def with_harmonics(self, harmonics) -> HarmonicFamily:
        """Return the same family with other harmonics, and as many samples for each of them."""
        other, (samples, per) = copy.copy(self), self.density
        other.settings = harmonics, max(-(-samples * harmonics // per), 2 * harmonics + 1)
        return other

    def doubled(self) -> HarmonicFamily:
        """Return the family of responses of twice the period, up to the same frequency."""
        Nh, Nt = self.settings
        return HarmonicFamily(self.build, 2 * Nh, 2 * Nt, 2 * self.subharmonic)

    def basis(self, system) -> Basis:
        """Return the Fourier functions of the response of a system. Raises InputError where it has no period."""
        if system.period is None:
            problem = "the system has no periodic driving, and its periodic response takes one"
            raise InputError(problem, field="motion", value=system.motion)
        return Basis(*self.settings, 2 * math.pi / (self.subharmonic * system.period), True)

    def rows(self, value):
        """Return the HarmonicResidual of the system at a value of the parameter, or what takes its place."""
        system = self.build(value)
        return harmonic_residual(system, self.basis(system))

    def derivative(self, x, value, scale) -> np.ndarray:
        """Return d(rows)/d(parameter) by central differences; scale: the size of a change of the parameter."""
        h = DIFFERENCE * max(abs(value), scale)
        return (self.rows(value + h).residual(x) - self.rows(value - h).residual(x)) / (2 * h)

    def linearise(self, x, value, row, corner, scale):
        """Return the rows at (x, value) and a solve of the bordered Jacobian, see ``factorise_bordered``."""
        return factorise_bordered(self.rows(value), x, self.derivative(x, value, scale), row, corner)


def resize_harmonics(z, harmonics) -> np.ndarray:
    """Return coefficients z (.., C) with other harmonics: cut, or filled with zeros."""
    resized = np.zeros((*z.shape[:-1], 2 * harmonics + 1))
    count = min(z.shape[-1], resized.shape[-1])
    resized[..., :count] = z[..., :count]
    return resized


def double_period(z) -> np.ndarray:
    """Return coefficients z (.., 2 Nh + 1) as those (.., 4 Nh + 1) of a response of twice the period."""
    doubled = np.zeros((*z.shape[:-1], 2 * z.shape[-1] - 1))
    doubled[..., 0], doubled[..., 3::4], doubled[..., 4::4] = z[..., 0], z[..., 1::2], z[..., 2::2]
    return doubled
