"""Scenes and systems of the cable cases, the manufactured problems on them, and what checks a system without solving.

The checks take the package of solvers they look at, so that they can look at one with a planted fault.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

import solvers

from ..cases.cables import EVERYTHING, LEVEL, CableCase
from ..exact.cable import cable_mp
from ..exact.cable.cable_mp import Fields

SOLVERS = solvers
"""The solvers as they are; a package with a planted fault has the same rooms."""


# ---------------------------------------------------------------- scenes and systems
def scene(case: CableCase, of=SOLVERS):
    """solvers.Scene of a case."""
    section = (case.EA, case.diameter, case.mass_per_length, case.submerged_weight)
    loads = {name: getattr(case, name) for name in ("Cdn", "Cdb", "Cdt", "Ca", "damping")}
    water = {"depth": case.depth, "current": case.current, "seabed_stiffness": case.seabed_stiffness}
    return of.io.scene.Scene(
        case.name,
        of.common.properties.CableProperties(*section, **loads),
        case.length,
        case.anchor,
        case.fairlead,
        of.common.properties.Environment(case.rho, **water),
        motion=of.common.motions.motion.Motion(case.frequency, [case.amplitude], [case.quadrature])
        if case.amplitude
        else None,
    )


def system(case: CableCase, nodes=50, of=SOLVERS, **options):
    """solvers.cable_system of a case."""
    return of.cable.system.cable_system(scene(case, of), nodes, **options)


def graded(length, nodes, ratio=4.0) -> np.ndarray:
    """Arc lengths (nodes,) of a smooth mesh whose last cell is about ``ratio`` times as long as its first, m."""
    s = length * np.expm1(np.linspace(0.0, 1.0, nodes) * math.log(ratio)) / (ratio - 1)
    s[-1] = length
    return s


def random_state(chain, seed, samples=()) -> tuple[np.ndarray, np.ndarray]:
    """(y, ydot) far from rest: velocities and angles of order one, parts of the line in the seabed and above it."""
    rng, shape = np.random.default_rng(seed), (chain.nodes, *samples)
    y, ydot = rng.uniform(-0.7, 0.7, (2, len(chain.fields), *shape))
    y[0], ydot[0] = rng.uniform(2e-3, 8e-3, shape), rng.uniform(-1e-3, 1e-3, shape)
    if chain.has_seabed:
        sink = rng.uniform(-1.5, 1.5, shape) * chain.w0 / chain.seabed_stiffness
        y[-1] = -chain.scene.environment.depth - sink
    return y, ydot


# ---------------------------------------------------------------- manufactured problems
LENGTH = 400.0  # of their line, m
_CHORD = 1.005 * LENGTH * np.array([math.cos(0.7), 0.0, math.sin(0.7)])  # taut: in equilibrium whatever the loads
_SOFT = 30.0  # seabed, N/m^2: the position row has no rate, so a stiff seabed multiplies errors of angle by k L^2 / EA
TERMS = {
    name: replace(p, seabed_stiffness=p.seabed_stiffness and _SOFT)
    for name, p in (cable_mp.ONE_TERM | {"all": cable_mp.ALL_TERMS}).items()
}
"""Loads of the manufactured problems: each term alone on the bare line, and all of them."""


def taut_case(p: cable_mp.CableParameters) -> CableCase:
    """A taut line with the parameters of the independent equations, its anchor on the seabed (if any)."""
    return CableCase(
        "taut line",
        EA=p.EA,
        diameter=p.d,
        mass_per_length=p.m,
        submerged_weight=p.w0,
        Cdn=p.Cdn,
        Cdb=p.Cdb,
        Cdt=p.Cdt,
        Ca=p.Ca,
        damping=p.beta,
        length=LENGTH,
        anchor=(0.0, 0.0, -p.depth),
        fairlead=tuple(float(c) for c in _CHORD - [0.0, 0.0, p.depth]),
        rho=p.rho,
        current=p.current,
        depth=None if p.seabed_stiffness is None else p.depth,
        seabed_stiffness=p.seabed_stiffness,
    )


def chosen_fields(p: cable_mp.CableParameters, *, space: str, time: str, planar=False, rough=False, span=1.0) -> Fields:
    """Fields at rest at s = 0 that are "linear" or "curved" in s and in t, over 0 <= t <= span s.

    The box scheme represents what is linear in s, a second-order time scheme what is linear in t: so fields curved in
    s alone show the error of the mesh, and fields curved in t alone that of the time step. Strains, angles, speeds and
    depth in the seabed as in ``cable_mp.manufactured``: no velocity through the water changes sign, unless ``rough``:
    then they do, and the line leaves the seabed.
    """
    L, zero = LENGTH, lambda s, t: 0 * s * t
    share, steady = (2.0, 0.0) if rough else (1.0, 1.0)
    sink = 1.0 if p.seabed_stiffness is None else p.w0 / p.seabed_stiffness

    def along(s, rate):
        return s * (1 / L) if space == "linear" else cable_mp.sin(rate / L * s)

    def over(t, lag):
        return (t - span / 2) * (1 / span) if time == "linear" else cable_mp.sin(4.0 / span * t + lag)

    def speed(size, part, rate, lag):
        return lambda s, t: size * along(s, rate) * (steady + share * part * over(t, lag))

    def theta(s, t):
        return 0.1 + 0.2 * along(s, 1.7) + 0.1 * over(t, 0.9) - 0.08 * along(s, 1.4) * over(t, 0.1)

    return Fields(
        eps=lambda s, t: 4.5e-3 + 1.5e-3 * along(s, 1.9) + 8e-4 * over(t, 0.3) + 3e-4 * along(s, 2.4) * over(t, 1.1),
        u=speed(0.25, 0.6, 1.2, 1.0),
        v=speed(0.4, 0.5, 1.5, -0.5),
        w=zero if planar else speed(0.3, 0.5, 1.1, 0.8),
        phi=lambda s, t: 1.1 - 0.6 * along(s, 1.3) + 0.12 * over(t, 0.2) + 0.1 * along(s, 2.1) * over(t, -0.4),
        theta=zero if planar else theta,
        z=lambda s, t: -p.depth - sink * along(s, 1.4) * (0.5 + (2.0 if rough else 0.25) * over(t, 0.6)),
    )


class Manufactured:
    """The problem that chosen fields solve on a mesh: its ``system``, and its solution by ``state``.

    by_cells: with a source for fields that the box scheme represents: the seabed, of which it takes the height in the
    middle of a cell, taken there too. Else the source is that of the nodes, as for every other term.
    """

    def __init__(self, p, fields, nodes, *, planar=False, mesh=None, by_cells=False, of=SOLVERS):
        self.p = cable_mp.in_plane(p) if planar else p
        self.fields, self.planar, self.of = fields, planar, of
        self.by_cells = by_cells and p.seabed_stiffness is not None
        self.source = _Known(self._source)
        self.system = system(
            taut_case(self.p),
            nodes,
            of,
            mesh=mesh,
            fields="planar" if planar else "spatial",
            motion=_EndOf(fields, planar),
            source=self.source,
        )

    def state(self, t):
        """y, y_s, y_t of the fields at times t of shape S, each (n_f, N, *S)."""
        return cable_mp.state_grid(self.p, self.fields, self.system.s, t, planar=self.planar)

    def _source(self, t):
        q = cable_mp.source_grid(self.p, self.fields, self.system.s, t, planar=self.planar)
        if not self.by_cells:
            return q
        y = self.state(t)[0]
        phi, theta, z = y[3 if self.planar else 4], 0 * y[0] if self.planar else y[5], y[-1]
        up = np.stack([e[0] for e in cable_mp._frame(phi, theta)[: 2 if self.planar else 3]])
        middle = cable_mp.seabed_support(self.p, (z[1:] + z[:-1]) / 2) * (up[:, 1:] + up[:, :-1])
        at_nodes = cable_mp.seabed_support(self.p, z) * up
        more = np.zeros_like(up)  # what two neighbours get in sum is what their cell lacks
        for i, lack in enumerate(np.moveaxis(middle - at_nodes[:, 1:] - at_nodes[:, :-1], 1, 0)):
            more[:, i + 1] = lack - more[:, i]
        q[: len(up)] += more
        return q

    def residual(self, t) -> np.ndarray:
        """Rows of the system at the fields, over the largest part of row 1, EA eps / ds: (N n_f,)."""
        y, _, ydot = self.state(t)
        return self.system.residual(y, ydot, t) / (self.p.EA * y[0].max() / self.system.ds.min())

    def errors(self, *, dt, duration, **options) -> np.ndarray:
        """Error of a run from the exact start, at its end: the largest over the nodes relative to the field, (n_f,)."""
        y, _, ydot = self.state(0.0)
        scheme = options.get("scheme") or self.of.time_domain.generalized_alpha.Scheme.from_spectral_radius(
            options.setdefault("rho_inf", 0.5)
        )
        steps = np.arange(round(duration / dt)) * dt
        self.source.at(steps + scheme.alpha_f * dt)
        self.system.motion.velocity.at(steps + dt)
        history = self.of.time_domain.solve.solve_time_domain(
            self.system, dt=dt, duration=duration, start=(y, ydot), hold=None, **options
        )
        exact = self.state(duration)[0]
        size = abs(exact).max(axis=1)
        return abs(history.y[..., -1] - exact).max(axis=1) / np.where(size > 0, size, 1.0)


class _Known:
    """A function of time that is evaluated at one go ``at`` the times that a run will ask for."""

    def __init__(self, function):
        self.function, self.values = function, {}

    def at(self, times):
        values = self.function(times)
        self.values = {round(t, 9): values[..., i] for i, t in enumerate(times.tolist())}

    def __call__(self, t):
        known = self.values.get(round(t, 9)) if np.ndim(t) == 0 else None
        return self.function(t) if known is None else known


class _EndOf:
    """The motion of the last node of chosen fields: its velocity is all that the rows of the end take."""

    def __init__(self, fields, planar):
        self.planar = planar
        self.velocity = _Known(lambda t: fields.velocity([LENGTH], t)[:, 0])

    def displacement(self, t):
        return np.zeros((3, *np.shape(t)))

    def directions(self):
        return np.eye(3)[::2] if self.planar else np.eye(3)


# ---------------------------------------------------------------- checks without a solve
def patch_error(p, planar, of=SOLVERS) -> float:
    """Largest residual at fields that the box scheme represents exactly, uneven mesh, two times; see ``residual``."""
    fields = chosen_fields(p, space="linear", time="curved", planar=planar, rough=True)
    problem = Manufactured(p, fields, 6, planar=planar, mesh=graded(LENGTH, 6), by_cells=True, of=of)
    return float(max(abs(problem.residual(t)).max() for t in (0.13, 0.9)))


def unequal(got, wanted) -> float:
    """Largest difference of two stacks (rows, columns, ...) over the largest entry of the same row and column.

    Infinite where an entry that is zero throughout is not zero in the other.
    """
    axes = tuple(range(2, wanted.ndim))
    size, error = abs(wanted).max(axis=axes), abs(got - wanted).max(axis=axes)
    return float(np.where(size > 0, error / np.where(size > 0, size, 1.0), np.where(error > 0, np.inf, 0.0)).max())


COMPLEX_STEP = 1e-30


def by_complex_step(function, x, of_field) -> np.ndarray:
    """d(function)/dx for node-wise fields, (rows, n_f, ...): one field (or node and field) perturbed at a time.

    of_field: (n_f, *shape of x) masks, each perturbed on its own.
    """
    columns = [function(x + 1j * COMPLEX_STEP * mask).imag / COMPLEX_STEP for mask in of_field]
    return np.stack(columns, axis=1)


def jacobian_error(case: CableCase, of=SOLVERS, *, samples=(), seed=2026, **options) -> float:
    """Largest ``unequal`` of dF/dy, dF/dydot (start, cells, end) and d(drift)/dy and their complex steps."""
    chain = system(case, 8, of, **options)
    y, ydot = (part.astype(complex) for part in random_state(chain, seed, samples))
    t = 3.3 if not samples else np.linspace(1.0, 4.0, *samples)
    fields, worst = range(len(chain.fields)), 0.0
    for rows, at in ((chain.start, 0), (chain.end, -1)):
        masks = [_mask(y, field, at) for field in fields]
        exact = rows(y, ydot, t)
        worst = max(
            worst,
            unequal(exact.dy, by_complex_step(lambda x: rows(x, ydot, t, False).value, y, masks)),  # noqa: B023
            unequal(exact.dydot, by_complex_step(lambda x: rows(y, x, t, False).value, ydot, masks)),  # noqa: B023
        )
    exact = chain.cells(y, ydot, t)
    for side in (0, 1):  # every other node moves: each cell then sees one end of it move
        for parity in (0, 1):
            masks = [_mask(y, field, slice(parity, None, 2)) for field in fields]
            seen = (slice(None),) * 2 + (slice((parity + side) % 2, None, 2),)
            for got, function, x in (
                (exact.dy[side], lambda x: chain.cells(x, ydot, t, False).value, y),
                (exact.dydot[side], lambda x: chain.cells(y, x, t, False).value, ydot),
            ):
                worst = max(worst, unequal(got[seen], by_complex_step(function, x, masks)[seen]))
    masks = [_mask(y, field, node) for field in fields for node in range(chain.nodes)]
    drift = by_complex_step(lambda x: chain.drift(x, t), y, masks)
    return max(worst, unequal(chain.drift_tangent(y).reshape(drift.shape), drift))


def _mask(y, field, nodes):
    mask = np.zeros(y.shape)
    mask[field, nodes] = 1.0
    return mask


def statics_jacobian_error(case: CableCase, of=SOLVERS, **options) -> float:
    """The same for the rows of the equilibrium, at its start moved off by some per cent."""
    chain = system(case, 8, of, **options)
    statics = of.cable.statics._Statics(chain)
    x = statics.catenary() * np.random.default_rng(2026).uniform(0.97, 1.03, (2 * chain.dimension, chain.nodes))
    exact, worst = statics.rows(x, True)[1].dy, 0.0
    full, origin = statics.full, statics.full(0 * x)

    def linear(x):  # full is affine in x and real: its linear part takes the step, enlarged to survive the constant
        return full(x.real) + 1j * COMPLEX_STEP * (full(x.imag / COMPLEX_STEP) - origin)

    def cells(x):
        statics.full = linear
        return statics.rows(x, False)[1].value

    for side in (0, 1):
        for parity in (0, 1):
            masks = [_mask(x, field, slice(parity, None, 2)) for field in range(len(x))]
            seen = (slice(None),) * 2 + (slice((parity + side) % 2, None, 2),)
            worst = max(worst, unequal(exact[side][seen], by_complex_step(cells, x, masks)[seen]))
    return worst


def geometry_error(planar, of=SOLVERS) -> float:
    """Largest difference, over the largest value, of positions, directions and drift from their definitions."""
    chain = system(LEVEL if planar else EVERYTHING, 8, of)
    y, _ = random_state(chain, 7)
    phi, theta = y[chain.fields.index("phi")], 0.0 if planar else y[chain.fields.index("theta")]
    tangent = np.array([np.sin(phi) * np.cos(theta), -np.sin(theta) + 0 * phi, np.cos(phi) * np.cos(theta)])
    step = (1 + y[0]) * tangent
    r = np.array(chain.scene.anchor)[:, None] + [
        [np.trapezoid(c[: n + 1], chain.s[: n + 1]) for n in range(chain.nodes)] for c in step
    ]
    t = 2.7
    drift = r[:, -1] - chain.scene.fairlead - chain.motion.displacement(t)
    pairs = [(chain.positions(y), r), (chain.direction(y), tangent), (chain.axes.T @ chain.drift(y, t), drift)]
    return max(float(abs(got - wanted).max() / abs(wanted).max()) for got, wanted in pairs)


# ---------------------------------------------------------------- planted faults
SEEN = 1e-11  # of every check here; they measure 1e-15, so a term of relative size 1e-11 has to be right


def red_checks(of) -> list[str]:
    """Names of the checks that a faulty package turns red; those of tangents count only where no value is wrong."""
    results = []
    for planar in (True, False):
        values = {
            "all terms": lambda: patch_error(TERMS["all"], planar, of),  # noqa: B023
            "geometry": lambda: geometry_error(planar, of),  # noqa: B023
        }
        tangents = {"jacobian": lambda: jacobian_error(LEVEL if planar else EVERYTHING, of)}  # noqa: B023
        checks = values if _changed(planar, of) else tangents
        results += [f"{name}, {'planar' if planar else 'spatial'}" for name, check in checks.items() if _is_red(check)]
    return results


def _is_red(check) -> bool:
    try:
        with np.errstate(all="ignore"):  # a planted fault may overflow
            return not check() <= SEEN  # nan is red
    except (ArithmeticError, ValueError, TypeError, IndexError):
        return True


def _changed(planar, of) -> bool:
    """Whether any value of a system, rows or geometry, differs from that of the solvers as they are."""
    with np.errstate(all="ignore"):  # a planted fault may overflow
        mine, its = (_values(planar, package) for package in (SOLVERS, of))
    return not np.array_equal(mine, its)


def _values(planar, of):
    chain = system(LEVEL if planar else EVERYTHING, 8, of, source=lambda t: 1.0 + np.zeros((1, 8)))
    y, ydot = random_state(chain, 2026)
    parts = chain.residual(y, ydot, 3.3), chain.drift(y, 3.3), chain.positions(y), chain.direction(y)
    return np.concatenate([np.ravel(part) for part in parts])
