"""What a state of a cable means outside: tension, positions and directions of the nodes, in the public frame."""

from __future__ import annotations

from typing import Any

import numpy as np


class CableOutputs:
    """Outputs of a state y (n_f, N, *S) of ``CableEquations``: a mixin of it."""

    EA: float
    beta: float
    ds: np.ndarray
    axes: np.ndarray
    anchor: np.ndarray
    equations: Any  # the module of the fields
    stencils: Any

    def stretched_tangent(self, y):
        """Return (1 + eps) t of the nodes in (up, along[, out]) and d/dy: (n_d, N, *S), (n_d, n_f, N, *S)."""
        return self.equations.stretched_tangent(y)

    def tension(self, y, ydot=None) -> np.ndarray:
        """Return EA (eps + beta eps_t), (N, *S), N; without ydot the elastic part."""
        return self.EA * (y[0] if ydot is None else y[0] + self.beta * ydot[0])

    def positions(self, y) -> np.ndarray:
        """Return the positions of the nodes, (3, N, *S), m: anchor plus the integral of (1 + eps) t ds."""
        tangent, stencils = self.equations.stretched_tangent(y, False)[0], self.stencils
        if stencils is None:
            steps = (tangent[:, 1:] + tangent[:, :-1]) * append_sample_axes(self.ds / 2, y)
        else:
            steps = stencils(tangent, stencils.integral)[0]
        local = np.concatenate([np.zeros_like(steps[:, :1]), np.cumsum(steps, axis=1)], axis=1)
        return np.einsum("dc,dn...->cn...", self.axes, local) + append_sample_axes(self.anchor[:, None], y)

    def direction(self, y) -> np.ndarray:
        """Return the unit tangent of the nodes, (3, N, *S)."""
        return np.einsum("dc,dn...->cn...", self.axes, self.equations.stretched_tangent(y, False)[0] / (1 + y[0]))


def append_sample_axes(array, y):
    """Return the array with the axes of the samples of y (n_f, N, *S) appended, each of length one."""
    return array.reshape(*array.shape, *(1,) * (y.ndim - 2))
