"""Natural modes of a ChainSystem about rest: frequencies, damping and shapes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs

from ..common.outcome import ConvergenceError, InputError, Status
from ..common.types import as_system
from ..common.validation import non_negative_number, whole_number
from .chain import BandedJacobian, ChainSystem, product

_RIGID = 1e-5  # share of the shift below which an eigenvalue is zero: the end rows see velocities, not positions
_FAR = 10.0  # ratio of the shift to the lowest frequency at which another shift saves time
_MAX_SHIFT = 1e8  # of the lowest frequency: beyond, a frequency loses more than eight of its digits
_ACCURACY = 1e-13  # of the eigenvalues of the operator, relative


@dataclass(frozen=True)
class Modes:
    """frequencies (k,) in Hz, rising; damping (k,): share of the critical; shapes (n_f, N, k), complex, of norm 1.

    A mode is shape exp(lambda t), lambda = 2 pi f (i sqrt(1 - damping^2) - damping).
    """

    frequencies: np.ndarray
    damping: np.ndarray
    shapes: np.ndarray


def natural_modes(system: ChainSystem, count: int = 6, near: float = 0.0) -> Modes:
    """Return the ``count`` oscillations about rest of the lowest frequencies, or of those nearest to ``near`` in Hz.

    Eigenvalues of (A + lambda B) x = 0 with A = dF/dy and B = dF/d(ydot) at rest: Arnoldi's method on
    (A + sigma B)^-1 B. A real sigma orders undamped modes by their frequency, whatever its size.
    Raises InputError for a count that the chain does not have, or a ``near`` so far above its lowest frequency that
    rounding hides the modes, ConvergenceError when Arnoldi's method fails.
    Of a line of nodes and elements, or a Scene taken as one, the shapes are displacements, (n, N, k).

    >>> from solvers.numerics.modes import natural_modes
    >>> chain = CableProperties(EA=384.243e6, diameter=0.09, mass_per_length=77.7066, Cdn=1.6)
    >>> scene = Scene("my line", chain, 902.2, (0.0, 0.0, -320.0), (848.67, 0.0, -70.0))
    >>> natural_modes(cable_system(scene, nodes=20), count=2).frequencies.round(3).tolist()  # Hz
    [0.112, 0.163]
    """
    system = as_system(system)
    pencil = system.pencil() if hasattr(system, "pencil") else _ChainPencil(system)
    size, nodes = pencil.size, system.nodes
    count = whole_number("count", count, 1, unit="modes")
    if 2 * count > size:  # eigenvalues come in pairs
        problem = f"{count} modes asked, a chain of {nodes} nodes has at most {size // 2}"
        raise InputError(problem, field="count", value=count, unit="modes")
    near = non_negative_number("near", near, "Hz")
    if near:
        lowest = float(natural_modes(system, 1).frequencies[0])
        if near > _MAX_SHIFT * lowest:
            problem = f"{near:g} Hz must not exceed {_MAX_SHIFT:g} of the lowest frequency, {lowest:.3g} Hz"
            raise InputError(problem, field="near", value=near, unit="Hz")
        near *= near > lowest / _FAR  # the modes nearest to a number far below all are the lowest

    k, sigma = 2 * count + 2 * len(system.fields), 2j * math.pi * near if near else 1.0
    while True:
        eigenvalues, vectors = _oscillations_near(pencil, sigma, min(k, size))
        if not near and eigenvalues.size and not 1 / _FAR < abs(eigenvalues[0]) / sigma < _FAR:
            sigma = float(abs(eigenvalues[0]))
            continue
        if eigenvalues.size >= count:
            break
        if k >= size:
            where = f" at near = {near:g} Hz" if near else ""
            problem = f"{count} modes asked, {eigenvalues.size} found on {nodes} nodes{where}"
            raise InputError(problem, field="count", value=count, unit="modes")
        k *= 2
    chosen = np.argsort(abs(eigenvalues[:count]))
    eigenvalues, shapes = eigenvalues[chosen], pencil.shapes(vectors[:, chosen])
    omega = abs(eigenvalues)
    return Modes(omega / (2 * math.pi), -eigenvalues.real / omega, shapes)


def _oscillations_near(pencil, sigma, k):
    """Return the oscillations among the k or more eigenvalues nearest to sigma in rad/s, and their vectors."""
    size = pencil.size
    step = pencil.inverse(sigma)
    if step is None:
        raise ConvergenceError(f"the shift {sigma:g} rad/s meets an eigenvalue: give another ``near``")
    if k >= size - 1:
        mu, vectors = np.linalg.eig(np.column_stack([step(column) for column in np.eye(size)]))
    else:
        operator = LinearOperator((size, size), matvec=step, dtype=type(sigma))
        start = step(np.random.default_rng(0).normal(size=size).astype(type(sigma)))
        try:
            mu, vectors = eigs(operator, k=k, v0=start, tol=_ACCURACY, ncv=min(size, 3 * k + 20))
        except ArpackNoConvergence as error:
            reached = f"{len(error.eigenvalues)} of {k} eigenvalues near {sigma.imag / (2 * math.pi):g} Hz"
            raise ConvergenceError(f"{Status.NOT_CONVERGED.value} (given {reached})") from None
    with np.errstate(divide="ignore", invalid="ignore"):
        eigenvalues = sigma - 1 / mu
    good = np.isfinite(eigenvalues) & (eigenvalues.imag > _RIGID * abs(sigma))
    order = np.argsort(abs(eigenvalues[good] - 1j * sigma.imag))
    return eigenvalues[good][order], vectors[:, good][:, order]


class _ChainPencil:
    """A + lambda B of a ChainSystem about rest: ``size``, (A + sigma B)^-1 B, and vectors as shapes."""

    def __init__(self, system):
        rest = system.rest_state()
        self.system, self.size = system, rest.size
        self.rows = [f(rest, np.zeros_like(rest), 0.0) for f in (system.start, system.cells_or_empty, system.end)]

    def inverse(self, sigma):
        """Return the function x -> (A + sigma B)^-1 B x, None where that is singular."""
        n_f, nodes = len(self.system.fields), self.system.nodes
        jacobian = BandedJacobian(n_f, nodes, self.system.start_rows, type(sigma))
        if not jacobian.factorise(*(part.dy + sigma * part.dydot for part in self.rows)):
            return None
        rates = [part.dydot for part in self.rows]
        return lambda x: jacobian.solve(product(rates, x.reshape(nodes, n_f).T))

    def shapes(self, vectors) -> np.ndarray:
        """Return vectors (size, k) as shapes (n_f, N, k)."""
        return vectors.reshape(self.system.nodes, len(self.system.fields), -1).swapaxes(0, 1)
