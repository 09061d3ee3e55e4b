"""What must not change and what must balance: rest, frames, mirrors, fields, time, energy, and modes of the mesh."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from ..cases.cables import EVERYTHING, LEVEL, OC3, OC3_SEABED, SURGE_5, TABLE_2
from ..reference import EPS
from ..tools.orders import assert_order
from ..tools.planting import Fault, planted
from .problems import SOLVERS, system

solve = SOLVERS.time_domain.solve.solve_time_domain
Scheme = SOLVERS.time_domain.generalized_alpha.Scheme
FIELDS = pytest.mark.parametrize("fields", ["planar", "spatial"])
TIGHT = {"dt": 0.1, "periods": 0.5, "tolerance": 1e-13}  # Newton's tolerance at rounding

# ---------------------------------------------------------------- rest
STILL = 1e-10  # m/s; measured up to 5e-11, Newton's tolerance times the speed of sound
AT_REST = [
    (OC3, "planar"),
    (OC3, "spatial"),
    (OC3_SEABED, "planar"),
    (OC3_SEABED, "spatial"),
    (replace(LEVEL, depth=None, seabed_stiffness=None), "planar"),
    (replace(EVERYTHING, depth=None, seabed_stiffness=None), "spatial"),
    (LEVEL, "planar"),
    (LEVEL, "spatial"),
    (EVERYTHING, "spatial"),
]


@pytest.mark.parametrize("dt", [0.1, 1.0])
@pytest.mark.parametrize(("case", "fields"), AT_REST, ids=lambda v: getattr(v, "name", v))
def test_a_cable_at_rest_stays_at_rest(case, fields, dt):
    """After 100 steps no velocity component of any node exceeds 1e-10 m/s, for every choice of fields and loads."""
    chain = system(replace(case, amplitude=None), 50, fields=fields)
    history = solve(chain, dt=dt, duration=100 * dt)
    assert history.steps == 100 and history.success
    assert abs(history.y[1 : 1 + chain.dimension]).max() < STILL


def test_a_start_from_elsewhere_does_not_rest():
    """The same measure sees a start from the continuous catenary, 0.26 kN from the discrete equilibrium."""
    chain = system(OC3, 50)
    statics = SOLVERS.cable.statics._Statics(chain)
    start = statics.full(statics.catenary())
    history = solve(chain, dt=0.1, duration=10.0, start=(start, np.zeros_like(start)))
    assert abs(history.y[1:3]).max() > 1e4 * STILL


# ---------------------------------------------------------------- frames, mirrors, fields
SAME = 5e-12  # of the tension: an ulp of a position, 1e-13 m, over dt by the hold, times sqrt(EA m); measured 1.2e-12
SAME_PLACE = 5e-12  # m, of positions up to 1000 m: measured 7e-13


def same(a, b, move=None, tension=SAME):
    """Two histories have the same tension, and positions moved by a matrix."""
    move = np.eye(3) if move is None else move
    assert abs(a.tension - b.tension).max() <= tension * abs(a.tension).max()
    assert abs(np.einsum("ij,jnk->ink", move, a.r) - b.r).max() <= SAME_PLACE


@pytest.mark.parametrize("angle", [0.3, 2.0, math.pi / 2, math.pi])
def test_turning_the_frame_turns_the_motion(angle):
    """Ends, current and motion turned about z: the same tension and turned positions, with every term on."""
    c, s = math.cos(angle), math.sin(angle)
    a, b = (solve(system(case, 20), **TIGHT) for case in (EVERYTHING, EVERYTHING.turned(angle)))
    same(a, b, np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))


def test_a_mirror_mirrors_the_motion():
    """y -> -y of everything: the same tension and mirrored positions, bit for bit."""
    a, b = (solve(system(case, 20), **TIGHT) for case in (EVERYTHING, EVERYTHING.mirrored()))
    assert np.array_equal(a.tension, b.tension)
    assert np.array_equal(a.r * np.array([1.0, -1.0, 1.0])[:, None, None], b.r)


def test_the_mirror_of_the_system_is_its_symmetry():
    """ChainSystem.mirror gives the signs under which the rows at a mirrored state are the mirrored rows."""
    case = replace(EVERYTHING, current=(0.7, 0.0, 0.1), amplitude=(2.0, 0.0, 1.0), quadrature=(0.0, 0.0, 0.0))
    chain = system(case, 8, fields="spatial")
    fields, *rows = (np.array(signs) for signs in chain.mirror())
    rng = np.random.default_rng(2026)
    y, ydot = chain.rest_state()[..., None] + rng.uniform(-1e-3, 1e-3, (2, 7, 8, 1))
    flip = fields[:, None, None]
    for part, signs in zip((chain.start, chain.cells, chain.end), rows, strict=True):
        got = part(flip * y, flip * ydot, np.array([1.0])).value
        wanted = part(y, ydot, np.array([1.0])).value
        assert got == pytest.approx(signs.reshape(-1, *(1,) * (got.ndim - 1)) * wanted, rel=1e-14, abs=1e-18)


def test_shifting_the_line_changes_nothing():
    """Without a seabed the position of the anchor does not enter: tensions are equal bit for bit."""
    shift = np.array([100.0, 50.0, -7.0])
    case = replace(OC3, amplitude=(3.0, 1.0, 0.0))
    moved = replace(case, anchor=tuple(shift), fairlead=tuple(case.fairlead + shift))
    a, b = (solve(system(one, 20), **TIGHT) for one in (case, moved))
    assert np.array_equal(a.tension, b.tension)


@pytest.mark.parametrize("case", [*TABLE_2[:2], LEVEL], ids=lambda case: case.name)
def test_six_fields_give_what_four_give(case):
    """A planar motion computed in space: no motion out of the plane, the same tension to 1e-12 of its largest value."""
    for hold in ("mean", "position"):
        a, b = (solve(system(case, 20, fields=fields), hold=hold, **TIGHT) for fields in ("planar", "spatial"))
        assert len(a.system.fields) == len(b.system.fields) - 2
        assert not b.field("w").any() and not b.field("theta").any()
        same(a, b, tension=1e-12)


@pytest.mark.parametrize(
    ("case", "fields"),
    [
        (OC3, ("eps", "u", "v", "phi")),
        (SURGE_5, ("eps", "u", "v", "phi")),
        (replace(OC3, current=(0.0, 0.0, 0.5)), ("eps", "u", "v", "phi")),
        (OC3_SEABED, ("eps", "u", "v", "phi", "z")),
        (replace(OC3, amplitude=(0.0, 1.0, 0.0)), ("eps", "u", "v", "w", "phi", "theta")),
        (replace(OC3, current=(0.0, 0.5, 0.0)), ("eps", "u", "v", "w", "phi", "theta")),
        (EVERYTHING, ("eps", "u", "v", "w", "phi", "theta", "z")),
        (LEVEL.turned(0.3), ("eps", "u", "v", "phi", "z")),
    ],
    ids=lambda v: getattr(v, "name", None),
)
def test_the_scene_picks_the_fields(case, fields):
    """Four fields in the line's own vertical plane, two more out of it, the height where there is a seabed."""
    assert system(case, 5).fields == fields


# ---------------------------------------------------------------- time and energy
def swing(chain) -> np.ndarray:
    """The line at rest with a transverse velocity of about 1 m/s, none at its ends: (n_f, N)."""
    y, x = chain.rest_state().copy(), chain.s / chain.s[-1]
    y[2] = np.sin(np.pi * x) ** 2 * (1 + x)
    if not chain.planar:
        y[3] = 0.5 * np.sin(np.pi * x) ** 2
    return y


def there_and_back(chain, scheme) -> float:
    """Largest departure from the start, in m/s, rad and strain, after 5 s of motion and 5 s with time reversed."""
    run = {"dt": 0.05, "duration": 5.0, "scheme": scheme, "hold": None, "tolerance": 1e-12}
    y = swing(chain)
    turn = np.ones((len(chain.fields), 1))
    turn[1 : 1 + chain.dimension] = -1.0
    there = solve(chain, start=(y, None), **run)
    back = solve(chain, start=(turn * there.y[..., -1], -turn * there.ydot[..., -1]), **run)
    return float(abs(turn * back.y[..., -1] - y).max())


REVERSED = 1e-9  # of 1 m/s: 200 Newton tolerances; measured 1e-12


@FIELDS
def test_time_reversal_without_damping(fields):
    """Without drag, velocities turned, the box method retraces 100 steps to rounding; not with drag or rho_inf < 1."""
    undamped = system(replace(OC3, Cdn=0.0), 20, fields=fields)
    assert there_and_back(undamped, Scheme.from_spectral_radius(1.0)) <= REVERSED
    assert there_and_back(undamped, Scheme.from_spectral_radius(0.5)) > 1e3 * REVERSED
    assert there_and_back(system(OC3, 20, fields=fields), Scheme.from_spectral_radius(1.0)) > 0.1


def energy(chain, y) -> np.ndarray:
    """Kinetic (with added mass across the line), potential and strain energy over time, (K,), J."""
    along, *across = y[1 : 1 + chain.dimension]
    moving = chain.m * along**2 + (chain.m + chain.ma) * sum(v * v for v in across)
    lifted = chain.w0 * chain.positions(y)[2]
    return np.trapezoid(0.5 * moving + lifted + 0.5 * chain.EA * y[0] ** 2, chain.s, axis=0)


def loss(case, chain, y, ydot) -> np.ndarray:
    """Power of drag and of the material's damping over time, (K,), W."""
    along, *across = y[1 : 1 + chain.dimension]
    stretch, normal = np.sqrt(1 + y[0]), case.rho * case.diameter / 2 * case.Cdn
    drag = normal * sum(v * v for v in across) ** 1.5 + normal * math.pi * case.Cdt / case.Cdn * abs(along) ** 3
    return np.trapezoid(-stretch * drag - case.EA * case.damping * ydot[0] ** 2, chain.s, axis=0)


def imbalance(case, fields, of=SOLVERS):
    """(energies over time, largest imbalance over the first energy) on three meshes with their time steps."""
    energies_and_gaps = []
    for nodes, dt in ((26, 0.1), (51, 0.05), (101, 0.025)):
        chain = system(case, nodes, of, fields=fields)
        start = (swing(chain), None)
        history = of.time_domain.solve.solve_time_domain(
            chain, dt=dt, duration=10.0, start=start, rho_inf=1.0, hold=None
        )
        E, P = energy(chain, history.y), loss(case, chain, history.y, history.ydot)
        work = np.concatenate([[0.0], np.cumsum((P[1:] + P[:-1]) / 2 * np.diff(history.time))])
        first = E[0] - energy(chain, chain.rest_state()[..., None])[0]
        energies_and_gaps.append((E / first, float(abs(E - E[0] - work).max() / first)))
    return energies_and_gaps


BALANCE = 6e-3  # of the first energy, on 101 nodes: twice the largest measured
DAMPED = replace(OC3, Cdt=0.05, damping=0.02)


@FIELDS
@pytest.mark.parametrize("case", [replace(OC3, Cdn=1e-9), DAMPED], ids=["undamped", "damped"])
def test_work_and_energy_of_a_swing_balance(case, fields):
    """Energy lost is work of the drag and of the material; what is missing falls with ds^2 and dt^2."""
    energies_and_gaps = imbalance(case, fields)
    assert_order([4, 2, 1], [gap for _, gap in energies_and_gaps], 2, ceiling=BALANCE, what="energy")
    if case is DAMPED:
        E = energies_and_gaps[-1][0]
        assert (np.diff(E) < 0).all() and E[0] - E[-1] > 0.9  # it decays at every step, by more than nine tenths


@pytest.mark.parametrize(
    "fault",
    [
        Fault("cable.planar", "local_terms", "v * phi_t - u_t", "-v * phi_t - u_t"),
        Fault(
            "cable.planar",
            "local_terms",
            "u_r, v_r, turning = u, v, m * u",
            "u_r, v_r, turning = u, v, -m * u",
        ),
        Fault("cable.loads", "quadratic_drag", "-coefficient", "-1.02 * coefficient"),
        Fault("cable.planar", "add_stiffness", "count * y_s[V] + u * y_s[PHI]", "count * y_s[V] + 0.9 * u * y_s[PHI]"),
    ],
    ids=str,
)
def test_a_wrong_term_spoils_the_balance(fault):
    """A sign in M, 2 % of drag or 10 % of a term of K: the balance no longer closes with order 2."""
    with planted(fault) as faulty:
        try:
            gaps = [gap for _, gap in imbalance(DAMPED, "planar", faulty)]
        except faulty.common.outcome.ConvergenceError:
            return
    with pytest.raises(AssertionError):
        assert_order([4, 2, 1], gaps, 2, ceiling=BALANCE)


# ---------------------------------------------------------------- modes of the mesh
def sawtooth(q) -> np.ndarray:
    """Odd-even content of a quantity at the nodes, (N, K) -> (K,): mean of (-1)^n times second difference over 4."""
    bend = (q[:-2] - 2 * q[1:-1] + q[2:]) / 4
    return abs(((-1.0) ** np.arange(len(bend)) @ bend) / len(bend))


@pytest.mark.parametrize("rho", [1.0, 0.9, 0.5, 0.0])
def test_a_sawtooth_decays_by_the_spectral_radius(rho):
    """An odd-even strain of 1 % is seen by no mean of a cell: after n steps rho_inf^n of it is left."""
    chain = system(OC3, 51)
    rest = chain.rest_state()
    start, size = rest.copy(), 0.01 * rest[0].mean()
    start[0] += size * (-1.0) ** np.arange(51)
    history = solve(chain, dt=0.1, duration=1.0, start=(start, 0 * start), rho_inf=rho, hold=None)
    left = sawtooth(history.y[0] - rest[0][:, None]) / size
    assert left == pytest.approx(rho ** np.arange(11.0), abs=SAW)


SAW = 1e-5  # of the sawtooth: it is not infinitely small, 1 % of the strain; measured 2e-7
CONTENT = {"tension": 2e-6, "u": 6e-5, "v": 8e-5, "phi": 2e-5}  # of the range: thrice the measured at N = 50


def test_the_sawtooth_of_a_forced_motion_is_small():
    """5 m surge, N = 50: the odd-even content of tension is 5e-7 of its range, of velocities 3e-5; it falls with N."""
    content = {}
    for nodes in (25, 50):
        history = solve(system(SURGE_5, nodes), dt=0.1, periods=3, hold="mean")
        last = history.time >= 40.0
        for name in CONTENT:
            q = (history.tension if name == "tension" else history.field(name))[:, last]
            content[nodes, name] = sawtooth(q).max() / np.ptp(q)
    for name, bound in CONTENT.items():
        assert content[50, name] <= bound, (name, content)
        assert content[50, name] <= 0.5 * content[25, name], (name, content)


def test_the_sawtooth_is_measured():
    """A planted odd-even part is found with its size, a smooth curve has none."""
    n, x = np.arange(51.0), np.linspace(0, 1, 51)
    planted_part = 3.0 * (-1.0) ** n
    assert sawtooth(planted_part[:, None])[0] == pytest.approx(3.0, rel=10 * EPS)
    assert sawtooth((1 + x + x**2)[:, None])[0] < 1e-5
    assert sawtooth((np.sin(3 * x) + planted_part)[:, None])[0] == pytest.approx(3.0, rel=1e-4)
