"""Is the truth of the lumped line true? Manufactured loads against mpmath, closed forms against other methods.

Each group ends with faults planted in the oracle itself, and shows that its comparison notices them.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from mpmath import mp, mpf
from numpy.polynomial import legendre
from scipy.integrate import quad, solve_ivp
from scipy.linalg import eigh

from ..exact.cable import frequencies
from ..exact.mooring import elastic_bounce, lumped_node, moving_line, seabed_friction
from ..exact.mooring.elastic_bounce import ElasticBounce, SeabedBounce
from ..exact.mooring.lumped_node import Cell, Seabed, force_residual, force_terms
from ..exact.mooring.moving_line import ALL_TERMS, BARE, ONE_TERM
from ..reference import EPS
from ..tools.planting import Fault

SEED = 2026
LOAD_ERROR = 1e-12  # of the largest force of the line: sums of some twenty products in doubles
SEEN = 1e-6  # of the same: what a wrong term changes at least
SMALL_STEPS = 1e-10  # of the motion: Runge-Kutta of order 8 with rtol 1e-13 and small steps across the kinks
ROUNDED = 2e-14  # of the motion: some ten roundings each


def with_fault(module, function, old, new, occurrence=0):
    """Return a second copy of an oracle's module in which ``old`` became ``new`` in one function."""
    path = Path(module.__file__)
    text = Fault(path.stem, function, old, new, occurrence).apply_to(path.read_text(encoding="utf-8"))
    copy = ModuleType(module.__name__)
    exec(compile(text, f"<{path.name} with a fault>", "exec"), copy.__dict__)
    return copy


# ---------------------------------------------------------------- manufactured loads
def exact_position(line, s, t):
    """Return the position, a list of mpf, from the table of waves."""
    L, omega = mpf(line.length), mpf(line.omega)
    place = []
    for i in line.components:
        x = mpf(line.anchor[i]) + mpf(moving_line.DIRECTION[i]) * s
        for amplitude, k, n, phase in moving_line.WAVES:
            angle = n * omega * t + mpf(phase)
            x += L * mpf(amplitude[i]) * (mp.cos(mpf(k) * s / L + angle) - mp.cos(angle))
        place.append(x)
    return place


def exact_load(line, s, t):
    """Return q, a list of mpf: the equations read from left to right, each derivative a difference quotient."""
    s, t = mpf(float(s)), mpf(float(t))
    parts = range(len(line.components))

    def dot(a, b):
        return mp.fsum(x * y for x, y in zip(a, b, strict=True))

    def rate(orders, s, t):
        return [mp.diff(lambda s, t, i=i: exact_position(line, s, t)[i], (s, t), orders) for i in parts]

    def tangent(s, t):
        r_s = rate((1, 0), s, t)
        length = mp.sqrt(dot(r_s, r_s))
        return length, [x / length for x in r_s]

    def force(i, s, t):
        length, tau = tangent(s, t)
        strain_rate = mp.diff(lambda t: tangent(s, t)[0], t) if line.beta else 0
        return max(mpf(line.EA) * (length - 1 + mpf(line.beta) * strain_rate), mpf(0)) * tau[i]

    tension_slope = [mp.diff(lambda s, i=i: force(i, s, t), s) for i in parts] if line.EA else [mpf(0) for _ in parts]
    v, a = rate((0, 1), s, t), rate((0, 2), s, t)
    length, tau = tangent(s, t)
    added = mpf(line.Ca) * mpf(line.rho) * mp.pi * mpf(line.d) ** 2 / 4
    momentum = [(mpf(line.mass) + added) * a[i] - added * dot(a, tau) * tau[i] for i in parts]

    u = [x - mpf(line.current[i]) for x, i in zip(v, line.components, strict=True)]
    u_t = dot(u, tau)
    u_n = [x - u_t * y for x, y in zip(u, tau, strict=True)]
    size = mpf(line.rho) * mpf(line.d) * mp.sqrt(length) / 2
    across, along = mpf(line.Cdn) * mp.sqrt(dot(u_n, u_n)), mp.pi * mpf(line.Cdt) * abs(u_t) * u_t
    drag = [-size * (across * x + along * y) for x, y in zip(u_n, tau, strict=True)]

    depth_in, normal = -mpf(line.depth) - exact_position(line, s, t)[-1], mpf(0)
    if depth_in > 0:
        damping = mpf(line.seabed_damping)
        if depth_in < mpf(line.contact_depth):
            damping *= depth_in / mpf(line.contact_depth)
        normal = max(mpf(line.seabed_stiffness) * depth_in - damping * v[-1], mpf(0))
    speed = mp.sqrt(dot(v[:-1], v[:-1]) + mpf(line.friction_speed) ** 2)
    seabed = [*(-mpf(line.friction) * normal * x / speed for x in v[:-1]), normal]
    weight = [0 * x for x in v[:-1]] + [mpf(line.weight)]
    return [momentum[i] - tension_slope[i] + weight[i] - drag[i] - seabed[i] for i in parts]


LINES = {
    "all": ALL_TERMS,
    **ONE_TERM,
    "across the surface of the seabed": replace(ALL_TERMS, depth=88.0),
    "across the surface, damping from contact on": replace(ALL_TERMS, depth=88.0, contact_depth=6.0),
    "partly slack": replace(ALL_TERMS, beta=20.0),
    "at rest": replace(ALL_TERMS, omega=0.0),
}
LINES |= {f"planar, {name}": replace(line, planar=True) for name, line in LINES.items()}


@cache
def points(deep=False):
    """Return arc lengths and times (n,) of the comparison, at random places of the line and of two periods."""
    rng, count = np.random.default_rng(SEED), 40 if deep else 6
    return rng.uniform(0, ALL_TERMS.length, count), rng.uniform(0, 4 * np.pi / ALL_TERMS.omega, count)


@cache
def exact_loads(line, deep=False):
    """Return q at the points, (n, points), from differentiation to 40 digits, and the size of the largest force."""
    with mp.workdps(40):
        q = np.array([[float(x) for x in exact_load(line, s, t)] for s, t in zip(*points(deep), strict=True)]).T
    return q, max(abs(force).max() for force in line.forces(*grid(line)).values())


def grid(line, places=41, times=48):
    """Return arc lengths and times all over a line and a period."""
    period = 2 * np.pi / (line.omega or 1.0)
    return np.linspace(0, line.length, places), np.arange(times) * period / times


def load_error(line, module=moving_line, deep=False):
    """Return the largest difference of the load from mpmath over the largest force of the line."""
    q, size = exact_loads(line, deep)
    again = module.ManufacturedLine(**vars(line))
    got = np.array([again.load(s, t) for s, t in zip(*points(deep), strict=True)]).T
    return abs(got - q).max() / size


@pytest.mark.parametrize("name", LINES)
def test_manufactured_load_has_the_digits_of_mpmath(name, deep):
    """The load is what the equations leave over when the position alone is differentiated to 40 digits."""
    assert load_error(LINES[name], deep=deep) <= LOAD_ERROR


LOAD_FAULTS = {
    "no bending of the tension": (
        "_Stretch.__init__", "slope * self.tau + self.force * tau_s", "slope * self.tau", "tension"),
    "no turn of the strain rate": (
        "_Stretch.__init__", "_dot(tau_s, r_st) + _dot(self.tau, r_sst)", "_dot(self.tau, r_sst)",
        "tension and damping"),
    "compression": ("_Stretch.__init__", "self.force > 0", "self.force > -1e9", "partly slack"),
    "added mass along the line": (
        "ManufacturedLine.forces", "a - _dot(a, tau) * tau", "a", "added mass"),
    "drag of the unstretched line": (
        "ManufacturedLine._drag", "np.sqrt(stretch.length)", "1.0", "normal drag"),
    "drag without current": ("ManufacturedLine._drag", "velocity - current", "velocity", "normal drag in a current"),
    "tangential drag without pi": (
        "ManufacturedLine._drag", "size * np.pi * self.Cdt", "size * self.Cdt", "tangential drag"),
    "a damper that helps": (
        "ManufacturedLine._seabed", "damping * v[-1]", "(-damping) * v[-1]",
        "seabed and damping"),
    "a seabed that pulls": (
        "ManufacturedLine._seabed", "penetration > 0", "penetration > -1e9", "across the surface of the seabed"),
    "friction of the sinking": (
        "ManufacturedLine._seabed", "_dot(horizontal, horizontal)", "_dot(v, v)", "seabed and friction"),
    "a motion of another speed": (
        "ManufacturedLine.derivative", "k**s_order * rate**t_order", "k**s_order * abs(rate)**(0.99*t_order)",
        "inertia"),
}  # fmt: skip


@pytest.mark.parametrize("fault", LOAD_FAULTS)
def test_a_fault_of_the_manufactured_load_is_noticed(fault):
    """A planted fault changes the load of the line with that term."""
    function, old, new, line = LOAD_FAULTS[fault]
    assert load_error(LINES[line], with_fault(moving_line, function, old, new)) > SEEN


@pytest.mark.parametrize("planar", [False, True])
def test_manufactured_lines_are_as_described(planar):
    """All terms matter, the line is taut and in the seabed, relative velocities keep clear of zero; ends and period."""
    line = replace(ALL_TERMS, planar=planar)
    s, t = grid(line)
    size = {name: math.sqrt((force**2).sum(axis=0).mean()) for name, force in line.forces(s, t).items()}
    assert len(size) == 8 and max(size.values()) < 2.1 * min(size.values()), size
    v, stretch = line.velocity(s, t), line._stretch(s, t)
    u = v - np.array(line.current)[line.components].reshape(-1, 1, 1)
    u_t = (u * stretch.tau).sum(axis=0)
    assert u_t.min() > 0.3 and np.linalg.norm(u - u_t * stretch.tau, axis=0).min() > 0.25
    assert 1.2 < np.linalg.norm(v, axis=0).max() < 2.0 and line.tension(s, t).min() > 700
    penetration = -line.depth - line.position(s, t)[-1]
    assert (line.seabed_stiffness * penetration - line.seabed_damping * v[-1]).min() > 15 and penetration.min() > 25
    assert np.array_equal(line.position(0.0, t), np.array(line.anchor)[line.components, None] + 0 * t)
    assert abs(line.load(s, t + 2 * np.pi / line.omega) - line.load(s, t)).max() < 1e-9
    if not planar:
        binormal = np.cross(line.derivative(s, t, 1, 0), line.derivative(s, t, 2, 0), axis=0)
        torsion = (binormal * line.derivative(s, t, 3, 0)).sum(axis=0) / (binormal**2).sum(axis=0)
        assert abs(torsion).max() * line.length > 1.0


def test_special_lines_are_as_described():
    """One is slack in part, one crosses the seabed's surface, one stands still, one needs no load."""
    slack, crossing, still = (LINES[name] for name in ("partly slack", "across the surface of the seabed", "at rest"))
    tension = slack.tension(*grid(slack))
    assert tension.min() == 0 and tension.max() > 1e4
    penetration = -crossing.depth - crossing.position(*grid(crossing))[-1]
    assert penetration.min() < -5 and penetration.max() > 5
    assert not still.velocity(*grid(still)).any() and not still.acceleration(*grid(still)).any()
    assert not BARE.load(*grid(BARE)).any()


def test_shapes_of_a_manufactured_line():
    """Arc lengths and times of any shape give (n, *s.shape, *t.shape)."""
    s, t = grid(ALL_TERMS, 5, 6)
    assert ALL_TERMS.load(s, 1.0).shape == (3, 5) and ALL_TERMS.position(2.0, t).shape == (3, 6)
    block = ALL_TERMS.load(s, t.reshape(2, 3))
    assert block.shape == (3, 5, 2, 3) and np.array_equal(block[:, 3, 1, 0], ALL_TERMS.load(s[3], t[3]))
    assert ALL_TERMS.tension(s, t).shape == (5, 6)
    assert replace(ALL_TERMS, planar=True).velocity(s, t).shape == (2, 5, 6)


# ---------------------------------------------------------------- bounces
HANGING = ElasticBounce(mass=200.0, weight=1500.0, length=20.0, EA=1.2e5, position=-18.5, velocity=2.0)
FALLING = SeabedBounce(mass=150.0, weight=900.0, depth=30.0, stiffness=8e3, position=-28.8, velocity=-0.5)
UNIT = ElasticBounce(mass=1.0, weight=0.05, length=1.0, EA=1.0, position=-2.0, velocity=0.2, beta=2.0)
BOUNCES = {
    "elastic": HANGING,
    "elastic, taut at first": replace(HANGING, position=-21.5, velocity=0.0),
    "elastic, damped": replace(HANGING, beta=0.02),
    "elastic, much damped": replace(HANGING, beta=0.25),  # critical damping is 2 sqrt(mass / k) = 0.365 s
    "elastic, overdamped": replace(HANGING, beta=0.6),
    "elastic, overdamped, thrown up": replace(HANGING, position=-20.05, velocity=6.0, beta=0.6),
    "elastic, compressed": replace(HANGING, position=-19.99, velocity=-2.0, beta=0.1),  # taut at once by its rate
    "elastic, critically damped": UNIT,
    "elastic, overdamped, let go": replace(UNIT, beta=2.5),
    "seabed": FALLING,
    "seabed, from within": replace(FALLING, position=-31.0, velocity=1.0),
    "seabed, damped": replace(FALLING, damping=150.0),
    "seabed, much damped": replace(FALLING, damping=1200.0),  # critical damping is 2 sqrt(stiffness mass) = 2191
    "seabed, overdamped": replace(FALLING, damping=4000.0),
    "seabed, lifted within": replace(FALLING, position=-30.6, velocity=3.6, damping=1200.0),
    "seabed, jerked within": replace(FALLING, position=-31.0, velocity=1.5, damping=6000.0),  # free, and never out
}
DURATION = 12.0


def bounce_force(bounce, z, v):
    """Return the force on the mass without its limit at zero, in N, and whether it may act at this height."""
    if hasattr(bounce, "EA"):
        return bounce.EA * (-z / bounce.length - 1 + bounce.beta * -v / bounce.length), True
    return bounce.stiffness * (-bounce.depth - z) - bounce.damping * v, -bounce.depth - z > 0


def integrate_bounce(bounce, start, times, force, **options):
    """Return z, z_t (2, times) by Runge-Kutta under force(z, z_t), from start at times[0]."""
    path = solve_ivp(lambda t, y: [y[1], (force(*y) - bounce.weight) / bounce.mass], times[[0, -1]], start,
                     t_eval=times, method="DOP853", rtol=1e-13, atol=1e-13, **options)  # fmt: skip
    return path.y


def bounce_size(bounce):
    """Return the ranges of z and z_t, (2, 1)."""
    z, v, _ = bounce.motion(np.linspace(0, DURATION, 2000))
    return np.array([[np.ptp(z)], [np.ptp(v)]])


def law_error(bounce):
    """Return the largest difference from Runge-Kutta with small steps, which knows the law and no event."""
    duration = 12.0 if bounce.mass == UNIT.mass else 4.0

    def force(z, v):
        force, may_act = bounce_force(bounce, z, v)
        return max(force, 0.0) * may_act

    times = np.linspace(0, duration, 400)
    path = integrate_bounce(bounce, [bounce.position, bounce.velocity], times, force, max_step=duration / 4000)
    return (abs(path - np.array(bounce.motion(times))[:2]) / bounce_size(bounce)).max()


def force_error(bounce):
    """Return the largest difference of the force from the law over the weight, away from events, where it may jump."""
    times = np.linspace(0, DURATION, 501)[1:]
    events = np.array([float(t) for t, _ in bounce.events(DURATION)] or [-1.0])
    times = times[abs(times[:, None] - events).min(axis=1) > 1e-9]
    z, v, force = bounce.motion(times)
    wanted, may_act = bounce_force(bounce, z, v)
    return abs(force - np.maximum(wanted, 0.0) * may_act).max() / bounce.weight


def bounce_energy(bounce, t):
    """Return kinetic and potential energy in J, with that of the spring while it acts and has no damper."""
    z, v, force = bounce.motion(t)
    k = bounce.EA / bounce.length if hasattr(bounce, "EA") else bounce.stiffness
    return bounce.mass / 2 * v**2 + bounce.weight * z + force**2 / k / 2


@pytest.mark.parametrize("name", BOUNCES)
def test_bounces_obey_their_law(name):
    """Position and velocity are what Runge-Kutta makes of the law with its maximum; the force is the law's."""
    assert law_error(BOUNCES[name]) <= SMALL_STEPS
    assert force_error(BOUNCES[name]) <= 1e-11  # the stretch is a difference of lengths, 1e5 N/m times their rounding


@pytest.mark.parametrize("name", ["elastic", "elastic, taut at first", "seabed", "seabed, from within"])
def test_undamped_bounces_keep_their_energy(name):
    """Kinetic, potential and elastic energy are the same after three hundred seconds and hundreds of events."""
    bounce = BOUNCES[name]
    energy = bounce_energy(bounce, np.linspace(0, 300.0, 1201))
    assert len(bounce.events(300.0)) > 200
    assert abs(energy - energy[0]).max() <= 100 * ROUNDED * np.ptp(
        bounce.weight * bounce.motion(np.arange(0, 9, 0.01))[0]
    )


def test_undamped_bounce_by_hand():
    """Dropped by h from rest: free for sqrt(2 h / g), in contact for (2 / w) (pi - atan(v / (w W / k)))."""
    for bounce, k, start in (
        (replace(HANGING, velocity=0.0), HANGING.EA / HANGING.length, -HANGING.length),
        (replace(FALLING, velocity=0.0), FALLING.stiffness, -FALLING.depth),
    ):
        g, w = bounce.weight / bounce.mass, math.sqrt(k / bounce.mass)
        free = math.sqrt(2 * (bounce.position - start) / g)
        contact = 2 / w * (math.pi - math.atan(free * w))
        wanted = [free + n * (2 * free + contact) + part for n in range(20) for part in (0.0, contact)]
        got = [float(t) for t, _ in bounce.events(wanted[-1] + 1e-6)]
        assert np.abs(np.array(got) - wanted).max() <= ROUNDED * wanted[-1]
        # hanging and bouncing about the place where the force carries the weight
        lowest = start - bounce.weight / k * (1 + math.hypot(1, free * w))
        assert abs(bounce.motion(free + contact / 2)[0] - lowest) <= ROUNDED * abs(lowest)


@pytest.mark.parametrize("name", [name for name in BOUNCES if "damped" in name or "jerked" in name])
def test_damped_contact_ends_where_the_force_vanishes(name):
    """At a release the stretch is still positive and EA (e + beta e') or k p - c z_t is zero; it is so at a catch."""
    bounce = BOUNCES[name]
    for t, kind in bounce.events(DURATION):
        z, v, _ = bounce.motion(float(t))
        force, _ = bounce_force(bounce, z, v)
        depth_in = -z - (bounce.length if hasattr(bounce, "EA") else bounce.depth)
        if kind in ("slack", "free"):
            assert v > 0 and depth_in > 0 and abs(force) <= 1e-10 * bounce.weight
        elif hasattr(bounce, "EA") or name.endswith("jerked within"):
            assert abs(force) <= 1e-10 * bounce.weight
        else:
            assert v < 0 and abs(depth_in) <= ROUNDED * bounce.depth and force > 0


def works_by_quadrature(bounce, end):
    """Return the integrals of -N z_t and of c z_t^2 over the times of contact until `end`, J."""
    speed = lambda t: float(bounce.motion(t)[1])
    power = lambda t: -float(bounce_force(bounce, *bounce.motion(t)[:2])[0]) * speed(t)
    loss = lambda t: bounce.damping * speed(t) ** 2
    total = np.zeros(2)
    for begin, stop in pairwise([0.0, *(float(t) for t, _ in bounce.events(end)), end]):
        if bounce.motion((begin + stop) / 2)[2] > 0:
            total += [quad(part, begin, stop, epsabs=1e-9, epsrel=1e-12, limit=200)[0] for part in (power, loss)]
    return total


@pytest.mark.parametrize("name", [name for name in BOUNCES if name.startswith("seabed")])
def test_works_on_the_seabed_are_integrals(name):
    """The work on the seabed and the energy lost to the damper are the integrals of N and c z_t over the way down."""
    bounce = BOUNCES[name]
    size = bounce.weight * np.ptp(bounce.motion(np.linspace(0, DURATION, 500))[0])
    for end in (0.7, 2.5, 6.0):
        got = [float(bounce.seabed_work(end)), float(bounce.damper_work(end))]
        assert np.abs(got - works_by_quadrature(bounce, end)).max() <= 1e-11 * size, (end, got)
    assert name not in ("seabed, damped", "seabed, overdamped") or bounce.damper_work(12.0) > 0.3 * size


@pytest.mark.parametrize("damping", [30.0, 300.0, 1000.0, 1500.0])
def test_restitution_without_weight_is_the_published_one(damping):
    """Schwager and Poeschel, Granular Matter 9 (2007) 465: exp(-b t_c), contact that never pulls, for W -> 0."""
    m, k, speed = 150.0, 8e3, 2.0
    weight = 1e-9
    bounce = SeabedBounce(m, weight, 30.0, k, -30.0, -speed, damping)
    b, w0 = damping / m / 2, math.sqrt(k / m)
    w = math.sqrt(w0**2 - b**2)
    contact = (math.pi - math.atan2(2 * b * w, w**2 - b**2)) / w
    ((release, kind),) = bounce.events(10.0)
    assert kind == "free" and abs(float(release) - contact) <= 1e-9
    assert abs(bounce.motion(contact + 0.1)[1] / speed - math.exp(-b * contact)) <= 1e-9


def test_a_mass_at_rest_in_balance_stays():
    """Where the force carries the weight nothing moves, damped or not; dropped at the surface it never leaves."""
    sag = FALLING.weight / FALLING.stiffness
    for damping in (0.0, 500.0):
        resting = replace(FALLING, position=-FALLING.depth - sag, velocity=0.0, damping=damping)
        z, v, force = resting.motion(np.linspace(0, 50.0, 100))
        assert np.ptp(z) <= ROUNDED * 30 and abs(v).max() <= 1e-13 and abs(force / resting.weight - 1).max() < 1e-11
        dropped = replace(FALLING, position=-FALLING.depth, velocity=0.0, damping=damping)
        assert not dropped.events(20.0) and abs(dropped.motion(0.0)[2]) == 0
        assert -dropped.motion(np.linspace(0, 20, 2001))[0].min() - 30 == pytest.approx(
            sag
            * (
                2
                if not damping
                else 1 + math.exp(-damping / 300 * math.pi / math.sqrt(8e3 / 150 - (damping / 300) ** 2))
            ),
            rel=1e-4,
        )


def test_bounces_that_make_no_sense_are_refused():
    """A mass thrown up to its anchor, no weight, a negative time."""
    with pytest.raises(ValueError, match="reaches the anchor"):
        replace(HANGING, velocity=17.0).motion(3.0)
    assert replace(HANGING, velocity=16.6).motion(2.2)[0] < 0
    with pytest.raises(ValueError, match="must be positive"):
        replace(FALLING, weight=0.0).motion(1.0)
    with pytest.raises(ValueError, match="not be negative"):
        FALLING.motion(-1.0)


BOUNCE_FAULTS = {
    "no rate in the release": ("_Contact._until_release", "x + self.lag * v", "x", "elastic, damped"),
    "no release before the minimum": (
        "_Contact._until_release", "first + mp.pi / w", "first + mp.pi / (2 * w)", "elastic, damped"),
    "no release when overdamped": (
        "_Contact._until_release", "rate >= 0", "rate < 9",
        "elastic, overdamped, let go"),
    "no release when critical": ("_Contact._until_release", "w == 0", "w == 1", "elastic, critically damped"),
    "caught at the surface": ("_Contact._until_contact", "x + self.lag * v", "x", "elastic, damped"),
    "caught above the seabed": ("_Contact._until_contact", "self.one_sided", "False", "seabed, damped"),
    "a damper of half the size": ("_Contact.__init__", "self.c / self.M / 2", "self.c / self.M / 4", "seabed, damped"),
    "a slower fall": ("_Contact._state", "W / M / 2 * tau", "W / M / 3 * tau", "seabed"),
    "the other real wave": ("_Contact._waves", "1 + rest / 2", "1 - rest / 2", "elastic, overdamped"),
    "critical as if undamped": (
        "_Contact._waves", "self.turning == 0", "False", "elastic, critically damped"),
    "a force at the wrong time": ("_Contact.evaluate", "piece.bears", "not piece.bears", "elastic"),
}  # fmt: skip


@pytest.mark.parametrize("fault", BOUNCE_FAULTS)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # a faulty motion may overflow
def test_a_fault_of_a_bounce_is_noticed(fault):
    """A planted fault leaves the law, or leaves numbers at all."""
    function, old, new, name = BOUNCE_FAULTS[fault]
    copy = with_fault(elastic_bounce, function, old, new)
    right = BOUNCES[name]
    bounce = getattr(copy, type(right).__name__)(
        **{field: value for field, value in vars(right).items() if field != "_contact"}
    )
    try:
        error = law_error(bounce) + force_error(bounce)
    except (ArithmeticError, ValueError):
        return
    assert not error <= SEEN


# ---------------------------------------------------------------- friction
def friction_by_quadrature(friction, normal_force, speed, friction_speed, omega):
    """Return the work in a period to 25 digits, from the force itself."""
    with mp.workdps(30):
        mu, N, V, v0, w = (mpf(x) for x in (friction, normal_force, speed, friction_speed, omega))
        power = lambda t: mu * N * (V * mp.cos(w * t)) ** 2 / mp.sqrt((V * mp.cos(w * t)) ** 2 + v0**2)
        quarter = mp.pi / 2 / w
        # the power bends within v0 / V of the turn
        ends = [quarter * (1 - x) for x in (1, mpf("0.5"), min(v0 / V, mpf("0.4")), min(v0 / V, mpf("0.4")) / 8, 0)]
        return 4 * mp.quad(power, ends)


@pytest.mark.parametrize("friction_speed", [1e-3, 0.1, 0.6, 5.0, 1e4])
def test_friction_work_is_its_integral(friction_speed, module=seabed_friction):
    """The elliptic integrals are the integral of the power, for little and much smoothing."""
    case = (0.8, 1200.0, 0.6, friction_speed, 0.5)
    assert abs(module.work_per_cycle(*case) / friction_by_quadrature(*case) - 1) <= 1e-14


def test_friction_work_has_its_limits():
    """Coulomb's 4 mu N times the amplitude without smoothing; the damper mu N / v_0 for small speeds."""
    mu, N, V, w = 0.8, 1200.0, 0.6, 0.5
    coulomb = 4 * mu * N * V / w
    assert abs(seabed_friction.work_per_cycle(mu, N, V, 0.0, w) / coulomb - 1) < 1e-15
    less = [float(1 - seabed_friction.work_per_cycle(mu, N, V, v0, w) / coulomb) for v0 in (1e-4, 1e-5)]
    assert 0 < less[1] < less[0] < 1e-6
    assert abs(seabed_friction.work_per_cycle(mu, N, V, 1e7, w) / (mu * N * V**2 / 1e7 * mp.pi / w) - 1) < 1e-14


@pytest.mark.parametrize(
    ("old", "new"), [("v0 * v0 / mp.sqrt(R2)", "v0 / mp.sqrt(R2)"), ("mp.dps + lost + 5", "mp.dps")]
)
def test_a_fault_of_the_friction_work_is_noticed(old, new):
    """A lost factor, and digits lost by cancellation."""
    copy = with_fault(seabed_friction, "work_per_cycle", old, new)
    with pytest.raises(AssertionError):
        test_friction_work_is_its_integral(1e4, copy)


# ---------------------------------------------------------------- frequencies of lines in two parts and of lumped ones
PARTS = {
    # stiffness, mass, length, mass of the joint
    "string": ((5e4, 5e4), (20.0, 8.0), (60.0, 45.0), 0.0),
    "bar": ((4e8, 6e6), (80.0, 11.0), (300.0, 40.0), 0.0),
    "bar with a buoy": ((4e8, 6e6), (80.0, 11.0), (300.0, 40.0), 5e3),
    "string with a clump": ((5e4, 5e4), (20.0, 8.0), (60.0, 45.0), 3e3),
    "one material": ((5e4, 5e4), (20.0, 20.0), (60.0, 60.0), 0.0),
    "common poles and a mass": ((5e4, 2e5), (20.0, 20.0), (60.0, 240.0), 700.0),
}
FREQUENCY_ERROR = 1e-11  # relative: eigenvalues of a Galerkin method of degree 30 a part


def galerkin_frequencies(count, stiffness, mass, length, joint_mass, degree=30):
    """Return the first frequencies in Hz, by polynomials in either part that meet at the joint."""
    nodes, weights = legendre.leggauss(degree + 10)
    P, k = legendre.legvander(nodes, degree + 1), np.arange(1, degree + 1)
    bubbles, slopes = (P[:, 2:] - P[:, :-2]) / (2 * k + 1), P[:, 1:-1]
    K, M = np.zeros((2, 2 * degree + 1, 2 * degree + 1))
    for i, half in enumerate(np.array(length) / 2):
        towards = (1 + nodes if i == 0 else 1 - nodes)[:, None] / 2
        part = np.hstack([towards, bubbles])
        part_slope = np.hstack([np.full_like(towards, 0.5 - i), slopes]) / half
        rows = np.ix_(*[np.r_[0, 1 + i * degree : 1 + (i + 1) * degree]] * 2)
        K[rows] += stiffness[i] * part_slope.T @ (part_slope * (weights * half)[:, None])
        M[rows] += mass[i] * part.T @ (part * (weights * half)[:, None])
    M[0, 0] += joint_mass
    return np.sqrt(eigh(K, M, eigvals_only=True)[:count]) / (2 * np.pi)


@pytest.mark.parametrize("name", PARTS)
def test_two_part_lines_have_all_frequencies(name, module=frequencies):
    """The roots of the transcendental equation, in order and none left out, are those of a Galerkin method."""
    got = np.array([float(f) for f in module.two_part_line(9, *PARTS[name])])
    assert abs(got / galerkin_frequencies(9, *PARTS[name]) - 1).max() <= FREQUENCY_ERROR, got


def test_two_part_lines_have_their_limits():
    """One material is the uniform line; a heavy joint swings on both parts as springs; the names say what is meant."""
    tension, m, length = 5e4, 20.0, 120.0
    halves = frequencies.two_part_string(7, tension, (m, m), (50.0, 70.0))
    assert (
        max(abs(a / b - 1) for a, b in zip(halves, frequencies.taut_string(7, tension, m, length), strict=True)) < 1e-14
    )
    heavy = frequencies.two_part_bar(1, (4e8, 6e6), (80.0, 11.0), (300.0, 40.0), 1e12)[0]
    assert abs(2 * mp.pi * heavy / mp.sqrt((4e8 / 300 + 6e6 / 40) / 1e12) - 1) < 1e-7
    assert frequencies.two_part_bar(3, (4e8, 6e6), (80, 11), (300, 40)) == frequencies.two_part_line(3, *PARTS["bar"])


@pytest.mark.parametrize("cells", [2, 5, 16])
def test_lumped_lines_have_the_frequencies_of_their_matrices(cells, module=frequencies):
    """All cells - 1 frequencies are the eigenvalues of the matrix, and tend to those of the string with 1 / cells^2."""
    tension, m, length = 5e4, 20.0, 120.0
    l = length / cells
    matrix = (2 * np.eye(cells - 1) - np.eye(cells - 1, k=1) - np.eye(cells - 1, k=-1)) * tension / l / (m * l)
    got = np.array([float(f) for f in module.lumped_string(cells - 1, tension, m, length, cells)])
    assert abs(got * 2 * np.pi / np.sqrt(np.linalg.eigvalsh(matrix)) - 1).max() <= 1e-13
    deviation = [1 - float(module.lumped_bar(1, tension, m, length, n)[0] /
                           frequencies.axial_bar(1, tension, m, length)[0]) for n in (cells, 2 * cells)]  # fmt: skip
    assert 3.9 < deviation[0] / deviation[1] < 4.0


FREQUENCY_FAULTS = {
    "a massless joint": ("two_part_line", "mpf(joint_mass) * omega", "0", "bar with a buoy"),
    "a mass of half the size": (
        "two_part_line", "mpf(joint_mass) * omega", "mpf(joint_mass) / 2 * omega", "string with a clump"),
    "stiffness for impedance": ("two_part_line", "mp.sqrt(K[i] * m[i])", "K[i]", "bar"),
    "a root left out": ("two_part_line", "poles[:count]", "poles[1:][:count]", "string"),
    "no root at a common pole": (
        "two_part_line", "sorted(n * mp.pi / part for part in delay for n in range(1, count + 1))",
        "sorted({n * mp.pi / part for part in delay for n in range(1, count + 1)})", "one material"),
    "half the cells": ("lumped_string", "2 * cells", "cells", None),
}  # fmt: skip


@pytest.mark.parametrize("fault", FREQUENCY_FAULTS)
def test_a_fault_of_the_frequencies_is_noticed(fault):
    """A planted fault is seen by the Galerkin method or by the matrix."""
    function, old, new, name = FREQUENCY_FAULTS[fault]
    copy = with_fault(frequencies, function, old, new)
    with pytest.raises((AssertionError, ValueError)):
        if name:
            test_two_part_lines_have_all_frequencies(name, copy)
        else:
            test_lumped_lines_have_the_frequencies_of_their_matrices(5, copy)


# ---------------------------------------------------------------- a node between two cells
COMMON = {"mass": 10.0, "added_mass": 4.0, "weight": 20.0, "rho": 2.0, "d": 1.0, "Cdn": 1.0, "Cdt": 1.0}
CELLS = Cell(4.0, 1000.0, 2.0, **COMMON), Cell(5.0, 1000.0, 2.0, **COMMON)
PLACES = ((-3, 0, -4), (0, 0, 0), (4, 0, 3))  # chords of 5 m: strains 0.25 and 0
RESTING = ((0, 0, 0),) * 3
PUSHED = ((0, 0, 0), (1, 0, 0), (0, 0, 0))
BOTTOM = Seabed(depth=-1.0, stiffness=30.0, damping=10.0, friction=0.5, friction_speed=0.75)
ROOT = math.sqrt(1.25)
BY_HAND = {
    # strain rates 0.15 and -0.16: tensions 1000 (0.25 + 0.3) and none
    "tension": [-330.0, 0.0, -440.0],
    "inertia": [-45.0, 0.0, 0.0],
    # 8 (0.64, 0, -0.48) and 10 (0.36, 0, -0.48)
    "added mass": [-8.72, 0.0, 8.64],
    "weight": [0.0, 0.0, -90.0],
    # u_n = (0.64, 0, -0.48), (0.36, 0, -0.48) of size 0.8, 0.6 on 2 m and 2.5 m
    "normal drag": [-1.024 * ROOT - 0.54, 0.0, 0.768 * ROOT + 0.72],
    "tangential drag": [
        -math.pi * (2 * 0.36 * 0.6 * ROOT + 2.5 * 0.64 * 0.8), 0.0,
        -math.pi * (2 * 0.36 * 0.8 * ROOT + 2.5 * 0.64 * 0.6),
    ],
    "seabed": [0.0, 0.0, 135.0],  # 1 m deep, on 4.5 m
    "friction": [-54.0, 0.0, 0.0],
}  # fmt: skip


def hand_errors(module=lumped_node):
    """Return the largest difference from the numbers by hand by name, at rest too: there the tension is 250 N."""
    cells, bottom = [module.Cell(**vars(cell)) for cell in CELLS], module.Seabed(**vars(BOTTOM))
    pushed = module.force_terms(cells, PLACES, PUSHED, (1, 0, 0), seabed=bottom)
    resting = module.force_terms(cells, PLACES, RESTING, (0, 0, 0))
    drifting = module.force_terms(cells, PLACES, PUSHED, (0, 0, 0), current=(1, 0, 0))
    errors = {
        name: max(abs(float(a) - b) for a, b in zip(pushed[name], BY_HAND[name], strict=True)) for name in BY_HAND
    }
    errors["at rest"] = max(abs(a - b) for a, b in zip(resting["tension"], (-150.0, 0.0, -200.0), strict=True))
    errors["no relative velocity"] = max(abs(x) for name in drifting if "drag" in name for x in drifting[name])
    sinking = [(0, 0, 0), (1, 0, -2), (0, 0, 0)]
    caught = module.force_terms(cells, PLACES, sinking, (0, 0, 0), seabed=bottom)
    errors["caught"] = abs(caught["seabed"][2] - 4.5 * 50)
    lifted = module.force_terms(cells, PLACES, [(0, 0, 0), (1, 0, 4), (0, 0, 0)], (0, 0, 0), seabed=bottom)
    errors["lifted"] = max(abs(x) for name in ("seabed", "friction") for x in lifted[name])
    return errors


def test_two_cells_by_hand():
    """Every term of the middle node of chords of 3-4-5 is what one works out on paper."""
    errors = hand_errors()
    assert max(errors.values()) <= 1e-13 * 440, errors
    total = force_residual(CELLS, PLACES, PUSHED, (1, 0, 0), seabed=BOTTOM)
    assert all(abs(x - sum(force[i] for force in BY_HAND.values())) < 1e-12 for i, x in enumerate(total))
    flat = force_terms(CELLS, [(x, z) for x, _, z in PLACES], [(x, z) for x, _, z in PUSHED], (1, 0), seabed=BOTTOM)
    assert all(abs(a - b) < 1e-12 for name in BY_HAND for a, b in zip(flat[name], BY_HAND[name][::2], strict=True))


def test_a_turned_node_has_turned_forces():
    """Turned about the vertical, and with the ends exchanged, the forces on the node turn and stay."""
    rng = np.random.default_rng(SEED)
    places, speeds = np.cumsum(rng.normal(4, 1, (3, 3)), axis=0), rng.normal(0, 1, (3, 3))
    a, current = rng.normal(0, 1, (2, 3))
    bottom = replace(BOTTOM, depth=-places[1, 2] - 0.5, damping=0.1)
    c, s = math.cos(0.7), math.sin(0.7)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    forces = force_terms(CELLS, places, speeds, a, current=current, seabed=bottom)
    turned = force_terms(CELLS, places @ turn.T, speeds @ turn.T, turn @ a, current=turn @ current, seabed=bottom)
    exchanged = force_terms(CELLS[::-1], places[::-1], speeds[::-1], a, current=current, seabed=bottom)
    for name, force in forces.items():
        force, scale = np.array(force, float), max(abs(float(x)) for x in force)
        assert scale > 0 and abs(np.array(turned[name], float) - turn @ force).max() <= 1e-13 * scale
        assert abs(np.array(exchanged[name], float) - force).max() <= 1e-13 * scale


def node_error(line, s, t, h, module=lumped_node):
    """Return the residual of a node of a manufactured line with cells of length h, its load lumped, N/m."""
    ma = line.Ca * line.rho * math.pi * line.d**2 / 4
    cell = module.Cell(h, line.EA, line.beta, line.mass, ma, line.weight, line.rho, line.d, line.Cdn, line.Cdt)
    bottom = module.Seabed(line.depth, line.seabed_stiffness, line.seabed_damping, line.friction, line.friction_speed,
                           line.contact_depth)  # fmt: skip
    nodes = np.array([s - h, s, s + h])
    residual = module.force_residual(
        (cell, cell), line.position(nodes, t).T, line.velocity(nodes, t).T, line.acceleration(s, t),
        current=line.current, seabed=bottom,
    )  # fmt: skip
    return np.array(residual, float) / h + line.load(s, t)


def node_orders(line, module=lumped_node):
    """Return the error of a node for cells of 4, 2, 1 and 0.5 m over the largest force, and its orders."""
    places = [(23.0, 1.3), (50.0, 4.1), (81.0, 8.7)]
    size = max(abs(force).max() for force in line.forces(*grid(line, 11, 12)).values())
    errors = np.array(
        [max(abs(node_error(line, s, t, h, module)).max() for s, t in places) / size for h in (4.0, 2.0, 1.0, 0.5)]
    )
    return errors, np.log2(np.maximum(errors[:-1], EPS) / np.maximum(errors[1:], EPS))


NODE_LINES = ["all", "tension", "tension and damping", "added mass", "normal drag", "normal drag in a current",
              "tangential drag", "tangential drag in a current"]  # fmt: skip
NODE_LINES += [f"planar, {name}" for name in NODE_LINES]


@pytest.mark.parametrize("name", NODE_LINES)
def test_a_lumped_node_tends_to_the_manufactured_line(name):
    """What the load leaves over on a node falls with the square of the cell: two oracles say the same of each term."""
    errors, orders = node_orders(LINES[name])
    assert errors[-1] < 1e-3 and abs(orders[-1] - 2) < 0.05 and abs(orders - 2).max() < 0.2, (errors, orders)


@pytest.mark.parametrize("name", ["inertia", "weight", "seabed", "seabed and damping", "seabed and friction"])
def test_terms_of_the_node_alone_are_exact(name):
    """Mass, weight and seabed do not see the chords: the load of the line is theirs to round-off."""
    for planar in (False, True):
        assert node_orders(replace(LINES[name], planar=planar))[0].max() <= 1e-13


NODE_FAULTS = {
    "compression": ("_pull", "tension <= 0", "tension <= -1e9"),
    "rate over the chord": ("_pull", "mpf(cell.length)", "size", 1),
    "added mass along": ("_loads_of_half", "ax - a_t * tx", "ax"),
    "whole cells": ("_loads_of_half", "mpf(cell.length) / 2", "mpf(cell.length)"),
    "unstretched drag": ("_loads_of_half", "mp.sqrt(size / mpf(cell.length))", "1"),
    "drag on the whole velocity": ("_loads_of_half", "v - u_t * ty", "v + ty"),
    "no current": ("force_terms", "mpf(c)", "0 * mpf(c)"),
    "one half on the seabed": (
        "force_terms", "mpf(before.length) / 2 + mpf(behind.length) / 2", "mpf(before.length) / 2"),
    "a seabed that pulls": ("_seabed_forces", "normal <= 0", "normal <= -1e9"),
    "friction of the sinking": ("_seabed_forces", "u * u + v * v", "u * u + w * w"),
}  # fmt: skip


@pytest.mark.parametrize("fault", NODE_FAULTS)
def test_a_fault_of_the_lumped_node_is_noticed(fault):
    """A planted fault is seen by hand or by the manufactured line with all terms."""
    copy = with_fault(lumped_node, *NODE_FAULTS[fault])
    by_hand, by_line = max(hand_errors(copy).values()), abs(node_orders(ALL_TERMS, copy)[1][-1] - 2)
    assert by_hand > SEEN or by_line > 0.5, (by_hand, by_line)
