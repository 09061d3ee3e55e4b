"""A family of systems over one parameter, and the harmonic balance of each of them as a function of both."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..common.motion import Motion
from ..common.outcome import InputError
from ..common.types import as_system
from ..common.validation import one_of
from ..harmonic_balance.residual import harmonic_residual
from ..numerics.fourier import Basis
from .bordered import factorise_bordered

UNITS = {"frequency": "Hz", "amplitude": "(factor of the driving)"}
DIFFERENCE = np.finfo(float).eps ** (1 / 3)  # of the parameter: central differences lose as much to it as to rounding


def build_family(system, parameter) -> Callable:
    """Return a function from values of a parameter to systems.

    parameter: "frequency" of a Motion in Hz, "amplitude", a factor of the driving as it is, or the function itself.
    Raises InputError for another parameter, or for the frequency of a system that no Motion drives.
    """
    if callable(parameter):
        return lambda value: as_system(parameter(value))
    one_of("parameter", parameter, tuple(UNITS))
    system = as_system(system)
    if parameter == "amplitude":
        return system.scaled
    motion = system.motion
    if not isinstance(motion, Motion):
        problem = "'frequency' takes a system that a Motion drives; give a function from the frequency to the system"
        raise InputError(problem, field="parameter", value=parameter)
    move = getattr(system, "with_motion", None) or (lambda motion: system.replace(motion=motion))
    return lambda value: move(replace(motion, frequency=value))


class HarmonicFamily:
    """The rows of the harmonic balance of ``build(value)`` for coefficients x, as functions of x and the value.

    harmonics, samples, subharmonic: as of ``solve_periodic``. The frequency of the Fourier functions is that of each
    system, so a frequency as parameter changes driving and functions together. The mean is kept and no symmetry used:
    a symmetry would hide the responses that break it.
    """

    def __init__(self, build, harmonics, samples, subharmonic):
        self.build, self.settings, self.subharmonic = build, (harmonics, samples), subharmonic

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
