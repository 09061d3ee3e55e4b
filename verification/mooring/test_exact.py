"""Is the truth of the lumped line true? Manufactured loads against mpmath, closed forms against quadrature and by hand.

Each group ends with faults planted in the oracle itself, and shows that its comparison notices them.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from mpmath import mp, mpf

from ..exact import moving_line
from ..exact.moving_line import ALL_TERMS, BARE, ONE_TERM
from ..tools.planting import Fault

SEED = 2026
LOAD_ERROR = 1e-12  # of the largest force of the line: sums of some twenty products in doubles
SEEN = 1e-6  # of the same: what a wrong term changes at least


def with_fault(module, function, old, new):
    """Return a second copy of an oracle's module in which ``old`` became ``new`` in one function."""
    path = Path(module.__file__)
    text = Fault(path.stem, function, old, new).apply_to(path.read_text(encoding="utf-8"))
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
        normal = max(mpf(line.seabed_stiffness) * depth_in - mpf(line.seabed_damping) * v[-1], mpf(0))
    speed = mp.sqrt(dot(v[:-1], v[:-1]) + mpf(line.friction_speed) ** 2)
    seabed = [*(-mpf(line.friction) * normal * x / speed for x in v[:-1]), normal]
    weight = [0 * x for x in v[:-1]] + [mpf(line.weight)]
    return [momentum[i] - tension_slope[i] + weight[i] - drag[i] - seabed[i] for i in parts]


LINES = {
    "all": ALL_TERMS,
    **ONE_TERM,
    "across the surface of the seabed": replace(ALL_TERMS, depth=88.0),
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
        "ManufacturedLine._seabed", "self.seabed_damping * v[-1]", "(-self.seabed_damping) * v[-1]",
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
