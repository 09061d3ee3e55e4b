"""The equilibrium of a cable and its quasi-static response to the fairlead, which starts a periodic solve."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np

from .statics import StaticState, rest_sensitivity, solve_static


class Equilibrium:
    """The equilibrium of a cable, solved for when first asked; cables that differ in their motion share it."""

    def __init__(self, system):
        self.system = system

    @cached_property
    def state(self) -> StaticState:
        """The discrete equilibrium."""
        return solve_static(self.system)

    @property
    def y(self) -> np.ndarray:
        """Its fields, (n_f, N)."""
        return self.state.y

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """What the mesh has lost of the exact equilibrium."""
        return self.state.warnings

    @cached_property
    def sensitivity(self) -> tuple[np.ndarray, np.ndarray] | None:
        """As ``rest_sensitivity`` returns it."""
        return rest_sensitivity(self.system)


class RestrictedEquilibrium(NamedTuple):
    """The equilibrium of a finer cable on some of its nodes."""

    y: np.ndarray
    sensitivity: tuple[np.ndarray, np.ndarray] | None
    warnings: tuple[str, ...] = ()

    @classmethod
    def to_nodes(cls, equilibrium, nodes) -> RestrictedEquilibrium:
        """Return an equilibrium at the nodes of these indices."""
        sensitivity = equilibrium.sensitivity
        return cls(equilibrium.y[:, nodes], sensitivity and tuple(part[..., nodes] for part in sensitivity))


def quasi_static_predictor(system, t) -> np.ndarray | None:
    """Return the equilibrium as it follows the fairlead, linearised, with its velocities, (n_f, N, S) at times t (S,).

    With a source, which moves the line elsewhere, the velocities alone: drag needs them. None without a motion, or
    where the stiffness is singular.
    """
    if system.motion is None or system.equilibrium.sensitivity is None:
        return None
    by_state, by_position = system.equilibrium.sensitivity
    n, rest = system.dimension, system.rest_state()
    rotation = system.equations.velocity(rest)[1][:, 1 : 1 + n]  # d(velocity in the axes)/d(u, v[, w])
    moved, rate = system.axes @ system.motion.displacement(t), system.axes @ system.motion.velocity(t)
    y = rest[..., None] + np.einsum("afn,at->fnt", by_state, moved * (system.source is None))
    y[1 : 1 + n] = np.einsum("dcn,adn,at->cnt", rotation, by_position, rate)
    return y
