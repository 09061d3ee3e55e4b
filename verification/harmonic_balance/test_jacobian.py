"""Are the Fourier basis and the derivatives of the harmonic balance right? Series, blocks (72)-(74), assembled matrix.

Truth is a Fourier series of complex exponentials, numpy's FFT of the sampled rows, and a complex step in every
coefficient; it takes from the solver the rows of the chain (verified in time) and nothing of the balance.
"""

from __future__ import annotations

import copy
import math
from dataclasses import dataclass, replace
from functools import lru_cache
from importlib.resources import files

import numpy as np
import pytest

from solvers import Environment, Motion, Scene
from solvers.cable.system import cable_system
from solvers.harmonic_balance import blocks as harmonic_blocks
from solvers.harmonic_balance import residual as harmonic_rows
from solvers.harmonic_balance.blocks import Blocks
from solvers.harmonic_balance.residual import HarmonicResidual, find_mirror
from solvers.numerics.fourier import Basis

from ..cases.oscillators import cubic_chain, duffing, towed_chain
from ..numerics.test_bordered import Chain, backward_error
from ..reference import EPS
from ..tools.planting import Fault, planted

NO_WORSE = 10  # times what LAPACK loses on the same matrix
DATA = files("reference_data")
COMPLEX_STEP = 1e-30  # no truncation, no cancellation
BLOCK = 1e-10  # of the largest entry of the block of one row and one field: asked; measured 3e-13
SERIES = 100 * EPS  # of sums of some twenty sines and cosines of order one
RESIDUAL = 1e-12  # of the largest coefficient of the rows of its kind: EA eps and its differences between nodes
DIFFERENCE = 1e-5  # of the largest change of its row: central differences, rounding and curvature
DIFFERENCE_STEP = 1e-6


# ---------------------------------------------------------------- the series, written another way
def series(z, omega, t, mean):
    """(y, ydot) at times t (Nt,) of coefficients z (..., C) by (49), as the real part of a sum of exponentials."""
    c0, rest = (z[..., :1], z[..., 1:]) if mean else (np.zeros_like(z[..., :1]), z)
    k = np.arange(1, rest.shape[-1] // 2 + 1)
    turning = np.exp(1j * omega * np.multiply.outer(k, t))
    sine, cosine = rest[..., 0::2], rest[..., 1::2]
    value = _real(cosine, turning) + _imaginary(sine, turning)
    rate = _real(sine * (k * omega), turning) - _imaginary(cosine * (k * omega), turning)
    return value + c0 / math.sqrt(2), rate


def _real(a, turning):
    return a @ turning.real


def _imaginary(a, turning):
    return a @ turning.imag


def coefficients(f, harmonics, mean):
    """Coefficients (..., C) of samples f (..., Nt) by numpy's FFT."""
    spectrum = np.fft.rfft(f) / f.shape[-1]
    z = np.empty((*f.shape[:-1], 2 * harmonics + 1))
    z[..., 0] = math.sqrt(2) * spectrum[..., 0].real
    z[..., 1::2], z[..., 2::2] = -2 * spectrum.imag[..., 1 : harmonics + 1], 2 * spectrum.real[..., 1 : harmonics + 1]
    return z if mean else z[..., 1:]


@dataclass(frozen=True)
class Setting:
    """Nh, Nt, nu, and whether the constant term is kept."""

    harmonics: int
    samples: int
    subharmonic: int
    mean: bool

    def basis(self, period):
        """As solve_periodic builds it."""
        return Basis(self.harmonics, self.samples, 2 * math.pi / (self.subharmonic * period), self.mean)

    def __str__(self):
        return f"Nh {self.harmonics}, Nt {self.samples}, nu {self.subharmonic}, {'mean' if self.mean else 'no mean'}"


SETTINGS = [
    Setting(*row)
    for row in (
        (1, 3, 1, True),  # Nt = 2 Nh + 1
        (2, 6, 1, False),
        (2, 8, 1, True),
        (3, 7, 1, False),
        (3, 12, 2, True),
        (4, 9, 3, True),
        (4, 16, 3, False),
    )
]
each_setting = pytest.mark.parametrize("setting", SETTINGS, ids=str)


# ---------------------------------------------------------------- Fourier basis
def basis_misses(basis, setting, period) -> list[str]:
    """Gram matrix, (57) with its erratum, the series and its rate, coefficients and back, the period."""
    omega = 2 * math.pi / (setting.subharmonic * period)
    rng = np.random.default_rng(3)
    z = rng.normal(size=(2, basis.harmonic.size))
    value, rate = series(z, omega, basis.times, setting.mean)
    theta = np.zeros((basis.harmonic.size,) * 2)
    for k in range(1, setting.harmonics + 1):
        at = 2 * k - 1 - (not setting.mean)
        theta[at : at + 2, at : at + 2] = [[0.0, -k * omega], [k * omega, 0.0]]
    size = setting.harmonics * omega
    errors = {
        "orthogonality": abs(basis.P.T @ basis.Q - np.eye(len(theta))).max(),
        "values": abs(z @ basis.Q.T - value).max(),
        "rates": abs(z @ basis.Q_t.T - rate).max() / size,
        "(57)": abs(basis.Q_t - basis.Q @ theta).max() / size,
        "coefficients": abs(value @ basis.P - z).max(),
        "FFT": abs(value @ basis.P - coefficients(value, setting.harmonics, setting.mean)).max(),
        "times": abs(basis.times - setting.subharmonic * period * np.arange(setting.samples) / setting.samples).max(),
    }
    return [f"{name}: {error:.3g}" for name, error in errors.items() if not error <= SERIES]


@each_setting
def test_fourier_basis(setting):
    """The basis is orthogonal on its samples, its rate is (57) with a zero block, samples give coefficients back."""
    assert basis_misses(setting.basis(2.5), setting, 2.5) == []


def test_aliases_at_the_limit():
    """2 Nh samples do not tell the highest sine from zero; 2 Nh + 1 do, which is why fewer are refused."""
    short = Basis(3, 6, 1.0, True)
    assert abs(short.Q[:, 5]).max() <= SERIES  # sin(3 t) at t = j pi / 3
    assert abs(short.P.T @ short.Q - np.eye(7)).max() > 0.5


def test_the_printed_gram_matrix_is_singular():
    """Erratum of (71): F- F-^T has rank Nc and not Nt; the least-squares form with F-^T F- gives the solver's P."""
    basis = Basis(3, 12, 1.0, True)
    Q = basis.Q
    assert np.linalg.matrix_rank(Q @ Q.T) == 7 < 12
    assert abs(np.linalg.solve(Q.T @ Q, Q.T) - basis.P.T).max() <= SERIES


def _scale(name, column, factor):
    def spoil(basis):
        getattr(basis, name)[:, column] *= factor

    return spoil


BASIS_FAULTS = {
    "rate of one harmonic 1 % off": _scale("Q_t", 3, 1.01),
    "sign of a rate": _scale("Q_t", 2, -1.0),
    "constant not divided by the root of 2": _scale("Q", 0, math.sqrt(2)),
    "coefficients as the mean of samples": _scale("P", slice(None), 0.5),
    "no Gram matrix at all: the transposed basis": lambda b: b.P.__imul__(b.samples / 2),
    "nu forgotten": lambda b: b.__init__(b.harmonics, b.samples, 2 * b.omega, b.mean),
}


@pytest.mark.parametrize("spoil", BASIS_FAULTS.values(), ids=BASIS_FAULTS)
def test_a_wrong_basis_is_found(spoil):
    """Each slip of (49)-(58), (61), (71) turns the check of the basis red."""
    setting = SETTINGS[4]
    basis = setting.basis(2.5)
    spoil(basis)
    assert basis_misses(basis, setting, 2.5)


# ---------------------------------------------------------------- chains
OC3 = Scene.load(DATA / "scenes" / "dynamics" / "hb_case_1.toml")
SWAY = Motion.harmonic(0.05, (0.0, 3.0, 0.0))
IN_PLANE = Motion(0.05, [[2.0, 0.0, 1.0], [0.5, 0.0, 0.0]], [[0.3, 0.0, -0.4], [0.0, 0.0, 0.2]])
IN_SPACE = Motion(0.05, [[2.0, 1.0, 1.0], [0.5, 0.3, 0.0]], [[0.3, 0.0, -0.4], [0.0, 0.6, 0.2]])
SEABED = {"depth": 320.0, "seabed_stiffness": 3000.0}
ALL_LOADS = {"Cdb": 1.2, "Cdt": 0.05, "damping": 0.02}


def cable(motion, nodes=4, *, current=(0.0, 0.0, 0.0), seabed=False, **section):
    """The OC3 line on a few nodes."""
    environment = Environment(current=current, **(SEABED if seabed else {}))
    scene = replace(OC3, motion=motion, environment=environment, cable=replace(OC3.cable, **section))
    return cable_system(scene, nodes)


CHAINS = {
    "cable in its plane": lambda: cable(IN_PLANE),
    "in its plane, all loads": lambda: cable(IN_PLANE, current=(0.5, 0.0, 0.2), seabed=True, **ALL_LOADS),
    "cable in space": lambda: cable(IN_SPACE),
    "in space, all loads": lambda: cable(IN_SPACE, 3, current=(0.5, 0.3, 0.2), seabed=True, **ALL_LOADS),
    "sway, symmetric": lambda: cable(SWAY),
    "sway over a seabed and a current, symmetric": lambda: cable(SWAY, 3, current=(0.5, 0.0, 0.0), seabed=True),
    "one mass": lambda: duffing(0.8, 0.3, k2=0.2, d=0.4),
    "one mass, symmetric": lambda: duffing(0.8, 0.3, d=0.4),
    "masses, symmetric": lambda: cubic_chain(4, d=0.3),
    "masses, towed": lambda: towed_chain(4),
}
chain_of = lru_cache(lambda name: CHAINS[name]())
each_chain = pytest.mark.parametrize("name", CHAINS)
SPREAD = {"eps": 2e-3, "u": 0.5, "v": 0.5, "w": 0.5, "phi": 0.1, "theta": 0.1, "z": 0.2}  # about rest; SI


def random_balance(name, setting, seed=0):
    """(HarmonicResidual, x): random coefficients of a size at which every term counts."""
    system = chain_of(name)
    basis = setting.basis(system.period)
    balance = HarmonicResidual(system, basis, find_mirror(system, basis) if "symmetric" in name else None)
    rng = np.random.default_rng(seed)
    spread = np.array([SPREAD.get(field, 1.0) for field in system.fields]) / setting.harmonics
    z = spread[:, None, None] * rng.uniform(-1, 1, (len(spread), system.nodes, balance.basis.harmonic.size))
    return balance, balance.pack(z)


def truth(balance, setting, x, complex_step=True):
    """The dense Jacobian (N n, N n) by complex step, and the rows (N n,), both in the order of BlockChain."""
    system, mean = balance.system, setting.mean
    omega = 2 * math.pi / (setting.subharmonic * system.period)
    times = 2 * math.pi / omega * np.arange(setting.samples) / setting.samples
    z = balance.unpack(x)
    columns = [(f, j, c) for j in range(system.nodes) for f, active in enumerate(balance.columns) for c in active]
    moved = np.zeros((*z.shape[:2], len(columns) if complex_step else 1, z.shape[2]), dtype=complex)
    moved[:] = z[:, :, None]
    for i, (f, j, c) in enumerate(columns if complex_step else ()):
        moved[f, j, i, c] += 1j * COMPLEX_STEP
    y, ydot = (part.reshape(*z.shape[:2], -1) for part in series(moved, omega, times, mean))
    y += system.rest_state()[..., None]
    t = np.tile(times, moved.shape[2])

    def coefficients_of(rows, active):  # rows (n_r, *nodes, S) -> (n_r coefficients, *nodes, columns)
        rows = rows.reshape(*rows.shape[:-1], moved.shape[2], setting.samples)
        parts = [coefficients(part, setting.harmonics, mean) for part in (rows.real, rows.imag / COMPLEX_STEP)]
        return [np.concatenate([part[a][..., c] for a, c in enumerate(active)], axis=-1) for part in parts]

    start = coefficients_of(system.start(y, ydot, t, False).value, balance.start_rows)
    cells = coefficients_of(system.cells_or_empty(y, ydot, t, False).value, balance.cell_rows)
    end = coefficients_of(system.end(y, ydot, t, False).value, balance.end_rows)
    parts = [np.moveaxis(p, -2, -1) for p in (start[1], *cells[1], end[1])] if complex_step else []
    value = [start[0][0], cells[0][:, 0].ravel(), end[0][0]]
    if balance.mean_constraints:
        drift = coefficients_of(system.drift(y, t)[balance.mean_constraints], [[0]] * len(balance.mean_constraints))
        parts.append(drift[1].T)
        value.append(drift[0][0])
    return (np.concatenate(parts) if parts else None), np.concatenate(value)


def assembled(balance, x):
    """The solver's Jacobian as a dense matrix."""
    rows, state = balance.rows(x, True)
    blocks = balance.jacobian(rows, balance.slope(state))
    nodes, n = blocks[3].shape[1], balance.n
    right = np.zeros(len(blocks[0])), np.zeros((nodes - 1, n)), np.zeros(len(blocks[2])), np.zeros(len(blocks[3]))
    return Chain(blocks, right).dense()[0]


def block_errors(balance, got, wanted) -> np.ndarray:
    """Largest difference in each block of one row and one field over its largest entry; inf where that is zero."""
    nodes, closed = balance.system.nodes, [[0]] * len(balance.mean_constraints)
    rows = _starts([*balance.start_rows, *(balance.cell_rows * (nodes - 1)), *balance.end_rows, *closed])
    columns = _starts(balance.columns * nodes)
    error, size = (_block_maxima(part, rows, columns) for part in (abs(got - wanted), abs(wanted)))
    return np.where(error > 0, error / np.where(size > 0, size, 1) + np.where(size > 0, 0, np.inf), 0.0)


def _starts(active):
    """Where the coefficients of each row or field begin, of those that have any."""
    sizes = np.array([len(coefficients) for coefficients in active])
    return (np.cumsum(sizes) - sizes)[sizes > 0]


def _block_maxima(matrix, rows, columns):
    return np.maximum.reduceat(np.maximum.reduceat(matrix, rows, axis=0), columns, axis=1)


# ---------------------------------------------------------------- the claims
@each_setting
@each_chain
def test_jacobian_blocks_agree_with_complex_step(name, setting):
    """Each block (72)-(74) of one row by one field of one node, those of the ends and the closing rows, to 1e-10."""
    balance, x = random_balance(name, setting)
    assert balance.symmetric == ("symmetric" in name and setting.subharmonic % 2 == 1)  # two periods on, no mirror
    wanted, _ = truth(balance, setting, x)
    errors = block_errors(balance, assembled(balance, x), wanted)
    assert errors.max() <= BLOCK, f"{(errors > BLOCK).sum()} blocks, the worst off by {errors.max():.3g}"


@each_chain
def test_rows_agree_with_the_fft(name):
    """The residual (63) is the FFT of the sampled rows, the mean of the drift in place of that of the end rows."""
    for setting in SETTINGS:
        balance, x = random_balance(name, setting)
        _, wanted = truth(balance, setting, x, complex_step=False)
        got = balance.residual(x)
        assert abs(got - wanted).max() <= RESIDUAL * abs(wanted).max(), f"{setting}"


@each_chain
def test_jacobian_agrees_with_central_differences(name):
    """The assembled matrix times a direction is the difference of the solver's own residual."""
    for setting in SETTINGS:
        balance, x = random_balance(name, setting)
        J, rng = assembled(balance, x), np.random.default_rng(5)
        scale = balance.pack(np.broadcast_to(_spread(balance)[:, None, None], balance.unpack(x).shape))
        d = DIFFERENCE_STEP * scale * rng.uniform(-1, 1, x.shape)
        wanted = (balance.residual(x + d) - balance.residual(x - d)) / 2
        error = abs(J @ d.ravel() - wanted) / (abs(J) @ abs(d.ravel()))
        assert error.max() <= DIFFERENCE, f"{setting}: {error.max():.3g}"


def _spread(balance):
    return np.array([SPREAD.get(field, 1.0) for field in balance.system.fields])


@pytest.mark.parametrize("single", [0, 10**6], ids=["single and its check", "double"])
@each_chain
def test_newton_steps_solve_the_complex_step_jacobian(name, single, monkeypatch):
    """The step that linearise gives meets J dx = F as well as LAPACK does on the whole matrix, in both precisions."""
    monkeypatch.setattr(harmonic_rows, "SINGLE_PRECISION_FROM", single)
    setting = SETTINGS[2]
    balance, x = random_balance(name, setting)
    F, solve = balance.linearise(x)
    wanted = truth(balance, setting, x)[0]
    chain = _Dense(wanted, F)
    allowed = max(NO_WORSE * backward_error(chain, np.linalg.solve(wanted, F)), BLOCK)
    assert backward_error(chain, solve(F).ravel()) <= allowed


@each_setting
@each_chain
def test_products_agree_with_complex_step(name, setting):
    """What refines a step in single precision, without making blocks, is the same matrix."""
    balance, x = random_balance(name, setting)
    d = np.random.default_rng(8).uniform(-1, 1, x.shape)
    wanted, _ = truth(balance, setting, x)
    rows, state = balance.rows(x, True)
    got = balance.product(rows, balance.slope(state), d)
    error = abs(got - wanted @ d.ravel()) / (abs(wanted) @ abs(d.ravel()))
    assert error.max() <= RESIDUAL


class _Dense:
    """A matrix and a right-hand side as ``backward_error`` takes a Chain."""

    def __init__(self, A, b):
        self.dense = lambda: (A, b)


@pytest.mark.parametrize("name", [name for name in CHAINS if "symmetric" in name])
def test_symmetric_blocks_are_part_of_all_blocks(name):
    """At a symmetric state the rows and columns that symmetry leaves out are coupled to no others."""
    setting = SETTINGS[2]
    balance, x = random_balance(name, setting)
    full = HarmonicResidual(balance.system, balance.basis)
    J = assembled(full, full.pack(balance.unpack(x)))
    every = np.arange(full.basis.harmonic.size)
    kept = np.tile(np.concatenate([np.isin(every, active) for active in balance.columns]), full.system.nodes)
    size = abs(J).max(axis=1, keepdims=True)
    rows = ~(abs(J[:, ~kept]) > RESIDUAL * size).any(axis=1)  # rows that see only what is kept
    assert rows.sum() == kept.sum()
    assert not (abs(J[~rows][:, kept]) > RESIDUAL * size[~rows]).any()


# ---------------------------------------------------------------- blocks from harmonics
def sums(basis, by_y, by_ydot, rows, columns, by_yddot=None):
    """P^T diag(g) Q + P^T diag(h) Q_t as the sums over samples that (72)-(74) say, row by row and field by field."""
    made = np.einsum("tr,abnt,tc->nabrc", basis.P, by_y, basis.Q)
    made += np.einsum("tr,abnt,tc->nabrc", basis.P, by_ydot, basis.Q_t)
    if by_yddot is not None:
        Q_tt = -basis.Q * (basis.omega * basis.harmonic) ** 2
        made += np.einsum("tr,abnt,tc->nabrc", basis.P, by_yddot, Q_tt)
    return np.concatenate(
        [
            np.concatenate([made[:, a, b][:, r][:, :, c] for b, c in enumerate(columns)], axis=2)
            for a, r in enumerate(rows)
        ],
        axis=1,
    )


def sampled_tangents(rng, shape):
    """Random ones, of which some do not change in time, some are zero, and some begin as if they were either."""
    g = rng.normal(size=shape)
    g[0, 0] = g[0, 0][:, :1]
    g[1, 0] = 0.0
    g[1, 1, :-1] = 0.0
    g[0, 1, :, :-1] = g[0, 1][:, :1]
    return g


PRECISIONS = {float: 1e-13, np.float32: 3e-6}  # of the largest number: a hundred roundings


@pytest.mark.parametrize("precision", PRECISIONS)
@each_setting
def test_blocks_are_the_sums_over_the_samples(setting, precision):
    """Made of sums and differences of harmonics they are the products of the basis, whichever coefficients count, for
    tangents that change in time and others, and in parts."""
    basis, rng, nodes = setting.basis(2.5), np.random.default_rng(12), 5
    k = basis.harmonic
    choices = [np.flatnonzero(keep) for keep in (k >= 0, k % 2 == 0, k % 2 == 1, k > 0, k < 0)]
    none, every = choices[4], choices[0]  # a row or field without any, before one with the constant
    for rows, columns in (
        (choices[:2], choices[1:4]),
        (choices[3:], choices[:3]),
        (choices[1:3], choices[2:]),
        ([none, every], choices[:3]),
        (choices[:2], [none, every, every]),
    ):
        by_y, by_ydot, by_yddot = (sampled_tangents(rng, (2, 3, nodes, basis.samples)) for _ in range(3))
        wanted, blocks = sums(basis, by_y, by_ydot, rows, columns), Blocks(basis, columns)
        given = by_y, by_ydot, blocks.harmonics(rows, basis), precision
        parts = np.concatenate([blocks(*given, 0, 2), blocks(*given, 2, 9)])
        second = sums(basis, by_y, by_ydot, rows, columns, by_yddot), blocks(*given, by_yddot=(by_yddot,))
        for exact, made in ((wanted, blocks(*given)), (wanted, parts), second):
            assert made.dtype == precision
            assert abs(made - exact).max(initial=0) <= PRECISIONS[precision] * abs(exact).max(initial=0)


def test_interpreted_blocks_are_the_same(monkeypatch):
    """The compiled loops are those on the page."""
    balance, x = random_balance("in space, all loads", SETTINGS[4])
    compiled = assembled(balance, x)
    for loop in ("_add_all", "_add", "_add_still", "_still"):
        monkeypatch.setattr(harmonic_blocks, loop, getattr(harmonic_blocks, loop).py_func)
    assert abs(assembled(balance, x) - compiled).max() <= PRECISIONS[float] * abs(compiled).max()


def test_a_planted_fault_does_not_stay():
    """Loops compiled from a text with a fault are not kept on disk for the true ones, which are written alike."""
    fault = Fault("harmonic_balance.blocks", "_add", "block.dtype.type(2.0)", "block.dtype.type(3.0)")
    basis, shape = Basis(2, 8, 1.0, True), (1, 1, 2, 8)
    tangent, every = np.random.default_rng(7).normal(size=shape), [np.arange(basis.harmonic.size)]
    made = lambda of: of(basis, every)(tangent, tangent, of.harmonics(every, basis), float)
    with planted(fault) as faulty:
        module = faulty.harmonic_balance.blocks
        wrong, kept = made(module.Blocks), module._add.stats.cache_path
    assert kept is None and abs(wrong - made(Blocks)).max() > 0.1
    assert abs(made(Blocks) - sums(basis, tangent, tangent, every, every)).max() <= PRECISIONS[float]


@pytest.mark.parametrize("shape", [(2, 3, 5, 7), (3, 3, 5, 8), (2, 2, 5, 8), (2, 3, 4, 8)], ids=str)
def test_tangents_that_do_not_fit_are_refused(shape):
    """Compiled loops do not look at their indices: of 8 samples, 2 rows and 3 fields any other number is refused."""
    basis = Basis(2, 8, 1.0, True)
    every = np.arange(basis.harmonic.size)
    blocks = Blocks(basis, [every] * 3)
    with pytest.raises(ValueError, match="do not fit to 2 rows, 3 fields and 8 samples"):
        blocks(np.ones(shape), np.ones((2, 3, 5, 8)), blocks.harmonics([every] * 2, basis), float)


@pytest.mark.parametrize("nodes", [64, 65, 66, 129])
def test_blocks_made_in_parts_are_those_made_at_once(nodes):
    """Made in parts of 64 cells, the blocks of a chain are those made at once, whatever is left for the last part."""
    chain = cubic_chain(nodes)
    balance = HarmonicResidual(chain, Basis(1, 4, 0.4, True))
    x = np.random.default_rng(4).normal(size=(nodes, balance.n))
    rows, state = balance.rows(x, True)
    whole = balance.jacobian(rows, balance.slope(state))[1]
    parts = list(balance.jacobian(rows, balance.slope(state), 64)[1])
    made = np.concatenate(parts, axis=1)
    assert made.shape == whole.shape and abs(made - whole).max() <= 100 * EPS * abs(whole).max()


# ---------------------------------------------------------------- the check turns red
class Planted:
    """A chain one of whose tangents is 1 % wrong: part, "dy" or "dydot", and the index of the entry in it."""

    def __init__(self, system, part, kind, entry):
        self._system, self._part, self._kind, self._entry = system, part, kind, entry

    def __getattr__(self, name):
        result = getattr(self._system, name)
        return result if name != self._part else self._wrong

    def _wrong(self, *args):
        result = getattr(self._system, self._part)(*args)
        if self._part == "drift_tangent":
            result = result.copy()
            result[self._entry] *= 1.01
            return result
        wrong = getattr(result, self._kind).copy()
        wrong[self._entry] *= 1.01
        return result._replace(**{self._kind: wrong})


def plants(balance, x):
    """Every tangent that is not zero: (part, kind, entry)."""
    rows, state = balance.rows(x, True)
    for part, result in zip(("start", "cells_or_empty", "end"), rows, strict=True):
        for kind in ("dy", "dydot"):
            tangent = getattr(result, kind)
            entries = tangent.any(axis=tuple(range(3 if part == "cells_or_empty" else 2, tangent.ndim)))
            yield from ((part, kind, tuple(entry)) for entry in np.argwhere(entries))
    if balance.mean_constraints:
        used = np.argwhere(balance.system.drift_tangent(state[0]).any(axis=(2, 3)))
        yield from (("drift_tangent", "", tuple(entry)) for entry in used if entry[0] in balance.mean_constraints)


@pytest.mark.parametrize("name", ["in its plane, all loads", "in space, all loads", "sway, symmetric", "masses, towed"])
def test_one_per_cent_in_any_block_is_found(name):
    """Each tangent in turn 1 % wrong, by state and by rate, left and right, at both ends and in the closing rows."""
    setting = SETTINGS[2]
    balance, x = random_balance(name, setting)
    wanted, _ = truth(balance, setting, x)
    missed, count = [], 0
    for plant in plants(balance, x):
        wrong = copy.copy(balance)
        wrong.system = Planted(balance.system, *plant)
        if not block_errors(balance, assembled(wrong, x), wanted).max() > BLOCK:
            missed.append(plant)
        count += 1
    assert not missed and count >= 15, missed


def test_one_per_cent_in_any_tangent_is_found_in_the_product():
    """The same for the product that refines a step."""
    setting = SETTINGS[2]
    balance, x = random_balance("in its plane, all loads", setting)
    d = np.random.default_rng(8).uniform(-1, 1, x.shape)
    J, _ = truth(balance, setting, x)
    for plant in plants(balance, x):
        wrong = copy.copy(balance)
        wrong.system = Planted(balance.system, *plant)
        rows, state = wrong.rows(x, True)
        got = wrong.product(rows, wrong.slope(state), d)
        assert (abs(got - J @ d.ravel()) / (abs(J) @ abs(d.ravel()))).max() > RESIDUAL, plant


@pytest.mark.parametrize("fault", [name for name in BASIS_FAULTS if "constant" not in name])
def test_a_wrong_basis_turns_the_blocks_red(fault):
    """The blocks by complex step share no basis with the solver."""
    setting = SETTINGS[4]
    balance, x = random_balance("cable in space", setting)
    wanted, _ = truth(balance, setting, x)
    BASIS_FAULTS[fault](balance.basis)
    assert block_errors(balance, assembled(balance, x), wanted).max() > BLOCK
