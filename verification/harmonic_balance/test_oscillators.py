"""Is the harmonic balance right on oscillators? Exact solutions, shooting with Taylor series, subharmonics, branches.

A chain of masses is a ChainSystem, so the method is tested here without any cable.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
import pytest

from solvers import ConvergenceError, InputError, Status
from solvers.harmonic_balance import solve as harmonic_balance
from solvers.harmonic_balance.residual import find_mirror
from solvers.numerics.chain import Residual
from solvers.numerics.fourier import Basis
from solvers.time_domain.solve import solve_time_domain

from ..cases.oscillators import MassChain, cubic_chain, duffing, harmonic_force, towed_chain
from ..exact.oscillators import oscillators as shooting
from ..reference import EPS
from ..tools.orders import assert_order

ROUND_OFF = 1e-11  # of states of order one: the last Newton step is 1e-10 at most and the next would be its square
ORBIT = 1e-10  # of the largest value: harmonics that decay exponentially are exhausted; shooting closes to 1e-13
START = 3  # decimals that a start of the oracle keeps: what the solver found finer does not reach it
SHOTS = 200  # times in a period at which orbits are compared


def solve_periodic(system, tolerance=1e-13, **options):
    """The solver's, its last step down to rounding: its default stops at 1e-10, with a contraction of 0.1 at worst."""
    return harmonic_balance.solve_periodic(system, tolerance=tolerance, **options)


def largest(a) -> float:
    return float(abs(np.asarray(a)).max())


def times(system, periods=1, count=SHOTS):
    return periods * system.period * np.arange(count) / count


def coefficients(system, harmonics, **given):
    """z (n_f, N, C) with some coefficients of mass 0: c0=mean of q, s1, c2, ... of q; velocities fitting at nu = 1."""
    z = np.zeros((3, system.nodes, 2 * harmonics + 1))
    for name, value in given.items():
        kind, k = name[0], int(name[1:])
        z[0, 0, 2 * k - (kind == "s")] = value * (math.sqrt(2) if k == 0 else 1)
    return z


# ---------------------------------------------------------------- exact to round-off
@dataclass(frozen=True)
class Trigonometric:
    """Places q_n = sum of a few harmonics with rates and accelerations, (N, *S) at times t."""

    constant: np.ndarray  # (N,)
    sine: np.ndarray  # (K, N)
    cosine: np.ndarray
    omega: float

    def __call__(self, t, order=0):
        value = 0.0
        for k in range(len(self.sine)):
            rate, angle = (k + 1) * self.omega, (k + 1) * self.omega * np.asarray(t) + order * math.pi / 2
            turned = np.multiply.outer(self.sine[k], np.sin(angle)) + np.multiply.outer(self.cosine[k], np.cos(angle))
            value = value + rate**order * turned
        return value + (np.multiply.outer(self.constant, np.ones(np.shape(t))) if order == 0 else 0.0)


def manufactured(chain: MassChain, seed=0):
    """(chain with the force that its chosen motion takes, that motion)."""
    rng = np.random.default_rng(seed)
    N, scale = chain.nodes, 0.4
    omega = 2 * math.pi / chain.period
    q = Trigonometric(scale * rng.normal(size=N), *(scale * rng.normal(size=(2, 2, N))), omega)

    def force(t):
        column = lambda a: a.reshape(-1, *(1,) * np.ndim(t))
        v = q(t, 1)
        x = np.diff(q(t), axis=0, prepend=0.0)
        p = column(chain.k) * x + column(chain.k2) * x**2 + column(chain.k3) * x**3
        pull = p - np.concatenate([p[1:], 0 * p[:1]])
        return column(chain.m) * q(t, 2) + column(chain.c) * v + column(chain.d) * abs(v) * v + pull

    return replace(chain, force=force), q


MANUFACTURED = {
    "one mass": MassChain("", 3.0, None, 1, 1.2, 0.3, 0.0, 2.0, 0.5, 0.3),
    "one mass, quadratic damping": MassChain("", 3.0, None, 1, 1.2, 0.3, 0.6, 2.0, 0.0, 0.3),
    "four masses": MassChain("", 3.0, None, 4, 1.2, 0.3, 0.0, 2.0, 0.3, 0.2),
    "four masses, quadratic damping": MassChain("", 3.0, None, 4, 1.2, 0.3, 0.4, 2.0, 0.3, 0.2),
    "unequal masses": MassChain("", 3.0, None, 3, np.array([1.0, 3.0, 0.5]), 0.4, 0.1, np.array([2.0, 1.0, 4.0])),
}


def manufactured_error(name, **options) -> float:
    chain, q = manufactured(MANUFACTURED[name])
    response = solve_periodic(chain, **options)
    t = np.linspace(0, chain.period, 17)
    errors = response.at(t)[0] - q(t), response.at(t)[1] - q(t, 1), response.rate_at(t)[1] - q(t, 2)
    return max(map(largest, errors))


@pytest.mark.parametrize("options", [{"harmonics": 2, "samples": 5}, {"harmonics": 3}, {"harmonics": 9}], ids=str)
@pytest.mark.parametrize("name", MANUFACTURED)
def test_trigonometric_solutions_come_out_exactly(name, options):
    """A motion of two harmonics and a mean is found to round-off with two harmonics, at 2 Nh + 1 samples or more."""
    assert manufactured_error(name, **options) <= ROUND_OFF


def exact_third():
    """x = A cos(w t / 3) of x'' + k x + k3 x^3 = F cos(w t), as 4 cos^3 = 3 cos + cos of three times the angle."""
    k, k3, omega = 1.0, 0.1, 3.6
    A = math.sqrt((omega**2 / 9 - k) * 4 / (3 * k3))
    return duffing(omega, k3 * A**3 / 4, 0.0, k, k3), {"c1": A}, 3


def exact_half():
    """x = c + A cos(w t / 2) of x'' + k x + k2 x^2 = F cos(w t), as 2 cos^2 = 1 + cos of twice the angle."""
    k, k2, c = 1.0, 0.5, -0.2
    A = math.sqrt(-2 * (c * c + c * k / k2))
    return duffing(2 * math.sqrt(k + 2 * k2 * c), k2 * A * A / 2, 0.0, k, 0.0, k2), {"c0": c, "c1": A}, 2


def subharmonic_error(which) -> float:
    chain, motion, nu = which()
    start = coefficients(chain, 6, **{name: 1.04 * value for name, value in motion.items()})
    response = solve_periodic(chain, harmonics=6, subharmonic=nu, start=start)
    return largest(response.z[0] - coefficients(chain, 6, **motion)[0])


@pytest.mark.parametrize("which", [exact_half, exact_third])
def test_exact_subharmonics(which):
    """Closed forms at a half and a third of the driving frequency come out to round-off."""
    assert subharmonic_error(which) <= ROUND_OFF


# ---------------------------------------------------------------- against shooting
def oracle(system, response, chain, periods=1):
    """The orbit of the independent chain nearest to the response."""
    state = np.round(response.at(np.zeros(1))[:2, :, 0], START)
    return shooting.periodic(chain, periods=periods, start=tuple(state))


def orbit_error(system, response, orbit, periods=1, count=SHOTS) -> tuple[float, float]:
    """Largest errors of place and velocity over the largest values."""
    t = times(system, periods, count)
    pairs = (response.at(t)[0], orbit.x(t)), (response.at(t)[1], orbit.v(t))
    return tuple(largest(got - wanted) / largest(wanted) for got, wanted in pairs)


def pair(omega, F, c, k, k3, k2=0.0):
    return duffing(omega, F, c, k, k3, k2), shooting.duffing(c, k, k3, F, omega, square=k2)


def chain_pair(nodes, c=0.05, k3=1.0, d=0.0):
    """A cubic chain and the same for the oracle: no spring at the far end."""
    force = (0.0,) * (nodes - 1) + (0.5,)
    springs = {"stiffness": (1.0,) * nodes + (0.0,), "cubic": (k3,) * nodes + (0.0,)}
    return cubic_chain(nodes, c=c, k3=k3, d=d), shooting.Chain(nodes, 0.4, force, damping=c, quadratic=d, **springs)


ORBITS = {  # system and oracle, harmonics
    "Duffing, hardening": (*pair(0.8, 0.3, 0.1, 1.0, 1.0), 25),
    "Duffing, above resonance": (*pair(1.2, 0.5, 0.2, 1.0, 1.0), 25),
    "Duffing, superharmonic resonances": (*pair(0.3, 2.0, 0.1, 1.0, 1.0), 60),
    "Duffing, softening": (*pair(0.5, 0.2, 0.1, 1.0, -0.3), 25),
    "asymmetric spring": (*pair(0.9, 0.4, 0.1, 1.0, 0.1, 0.3), 25),
    "two masses": (*chain_pair(2), 40),
    "five masses": (*chain_pair(5, c=0.2), 40),
}


@pytest.mark.parametrize("case", ORBITS.values(), ids=ORBITS)
def test_orbits_agree_with_shooting(case):
    """Places and velocities over the period agree with Taylor series and shooting, where harmonics decay quickly."""
    system, chain, harmonics = case
    response = solve_periodic(system, harmonics=harmonics)
    errors = orbit_error(system, response, oracle(system, response, chain))
    assert max(errors) <= ORBIT, errors


def test_fourier_coefficients_agree_with_quadrature():
    """Mean and harmonics in the convention of (49) agree with Gauss quadrature over the orbit of the oracle."""
    system, chain, harmonics = ORBITS["asymmetric spring"]
    response = solve_periodic(system, harmonics=harmonics)
    mean, cosine, sine = oracle(system, response, chain).fourier(6)
    z = response.z[0, 0]
    assert largest([z[0] / math.sqrt(2) - mean[0], *(z[2:14:2] - cosine[:, 0]), *(z[1:13:2] - sine[:, 0])]) <= ORBIT


# |v| v is smooth but for a jump in its second derivative where v = 0: its coefficients fall as k^-3, those of v as k^-4
# and of q as k^-5, and the largest errors, sums of what is left out, as Nh^-3 and Nh^-4.
PLACE_ORDER, VELOCITY_ORDER, BAND = 4.0, 3.0, 0.15  # the band: 2.95 and 3.88 are measured, both still rising
ALGEBRAIC = (25, 45, 81)
OVERSAMPLED = 16  # samples a harmonic: aliasing then is a hundredth of truncation
CLOSE = 4000  # times in a period: the largest error of 81 harmonics is a narrow peak at the kink
CEILING = 1e-8, 1e-6  # of place and velocity with 81 harmonics
FIVE_MASSES = 3e-6  # of velocities with 60 harmonics; measured 1.3e-6, falling with the power 2.9


def test_quadratic_damping_converges_algebraically():
    """Velocities converge with the power 3 of Nh and places with 4, as the kink of |v| v implies, and no faster."""
    system, errors, orbit = duffing(0.6, 1.0, 0.0, 1.0, 0.0, d=0.5), [], None
    for Nh in ALGEBRAIC:
        response = solve_periodic(system, harmonics=Nh, samples=OVERSAMPLED * Nh)
        orbit = orbit or oracle(system, response, shooting.quadratically_damped(1.0, 0.5, 1.0, 1.0, 0.6))
        errors.append(orbit_error(system, response, orbit, count=CLOSE))
    for name, order, ceiling, of in zip(
        ("place", "velocity"), (PLACE_ORDER, VELOCITY_ORDER), CEILING, np.transpose(errors), strict=True
    ):
        assert_order(1 / np.array(ALGEBRAIC), of, order, band=BAND, ceiling=ceiling, what=name)


def test_smooth_springs_converge_exponentially():
    """With a cubic spring and linear damping, five more harmonics gain three digits, down to round-off."""
    system, chain, _ = ORBITS["Duffing, hardening"]
    orbit, errors = None, []
    for Nh in (5, 10, 15, 20, 60):
        response = solve_periodic(system, harmonics=Nh)
        orbit = orbit or oracle(system, response, chain)
        errors.append(max(orbit_error(system, response, orbit)))
    assert all(b <= max(1e-3 * a, ROUND_OFF) for a, b in pairwise(errors)), errors


def test_five_masses_with_quadratic_damping():
    """A chain whose five velocities change sign at different times agrees with shooting as far as Nh^-3 allows."""
    system, chain = chain_pair(5, d=0.3)
    response = solve_periodic(system, harmonics=60)
    assert max(orbit_error(system, response, oracle(system, response, chain))) <= FIVE_MASSES


# ---------------------------------------------------------------- aliasing
def aliasing_share(system, Nh, samples):
    """Change of the velocity by the samples over the error by truncation, both of the largest value in a period."""
    t = times(system)
    fine = solve_periodic(system, harmonics=Nh, samples=64 * Nh).at(t)[1]
    truncation = largest(fine - solve_periodic(system, harmonics=4 * Nh, samples=32 * Nh).at(t)[1])
    return largest(solve_periodic(system, harmonics=Nh, samples=samples).at(t)[1] - fine) / truncation


@pytest.mark.parametrize("Nh", [5, 9, 15])
def test_four_samples_a_harmonic_are_enough_for_drag(Nh):
    """The default, 4 Nh, leaves aliases of |v| v below half the truncation error of the state; 2 Nh + 1 above it."""
    system = duffing(0.6, 1.0, 0.0, 1.0, 0.0, d=0.5)
    assert solve_periodic(system, harmonics=Nh).basis.samples == 4 * Nh
    assert aliasing_share(system, Nh, 4 * Nh) <= 0.5
    assert aliasing_share(system, Nh, 2 * Nh + 1) >= 2


@pytest.mark.parametrize("Nh", [5, 9])
def test_four_samples_a_harmonic_are_enough_for_cubes(Nh):
    """Nt > 4 Nh samples have no aliases of cubes: the result is that of any more; 2 Nh + 1 have."""
    system = duffing(0.8, 0.8, 0.1, 1.0, 1.0, k2=0.1)
    t = times(system)
    results = {n: solve_periodic(system, harmonics=Nh, samples=n).at(t) for n in (2 * Nh + 1, 4 * Nh + 1, 16 * Nh)}
    assert largest(results[4 * Nh + 1] - results[16 * Nh]) <= ROUND_OFF
    assert largest(results[2 * Nh + 1] - results[16 * Nh]) >= 1e3 * ROUND_OFF


# ---------------------------------------------------------------- subharmonics and branches
THIRD = duffing(3.6, 3.0, 0.02, 1.0, 0.1), shooting.duffing(0.02, 1.0, 0.1, 3.0, 3.6)
MULTISTEP = 1e-3  # of the time integration, 100 steps in a driving period: (omega dt)^2 / 12 over three periods


def damped_third():
    """Response at a third of the frequency, with damping: two solutions at one driving."""
    start = coefficients(THIRD[0], 15, c1=2.4)
    return solve_periodic(THIRD[0], harmonics=15, subharmonic=3, start=start)


def test_a_subharmonic_response_is_found():
    """At three times its frequency a damped mass responds at a third, as by shooting, and at the whole."""
    system, chain = THIRD
    response = damped_third()
    orbit = oracle(system, response, chain, periods=3)
    assert response.subharmonic == 3 and response.last_period == (0.0, pytest.approx(3 * system.period))
    assert orbit.stable and max(orbit_error(system, response, orbit, 3)) <= ORBIT
    small = solve_periodic(system, harmonics=15)
    assert largest(small.z[0]) < 0.2 * largest(response.z[0])
    assert max(orbit_error(system, small, oracle(system, small, chain))) <= ORBIT


def test_time_integration_confirms_the_subharmonic():
    """Started on it, the time integration stays on the subharmonic response for three of its periods."""
    system, response = THIRD[0], damped_third()
    y, ydot = (part(np.zeros(1))[..., 0] for part in (response.at, response.rate_at))
    history = solve_time_domain(system, dt=system.period / 100, periods=9, start=(y, ydot), rho_inf=1.0)
    t = 6 * system.period + times(system, 3)
    size = largest(response.at(t)[0])
    assert largest(history.at(t)[0] - response.at(t)[0]) <= MULTISTEP * 3 * size
    assert largest(history.at(t)[0] - history.at(t - system.period)[0]) > 0.5 * size  # not of the driving's period


def test_both_branches_are_followed():
    """Started from neighbours, the upper branch is followed up and the lower one down to the same frequency."""
    forced = lambda omega: pair(omega, 0.3, 0.05, 1.0, 0.4)
    results = []
    for way in (np.arange(0.9, 1.251, 0.05), [1.5, 1.4, 1.35, 1.3]):
        response = None
        for omega in way:
            start = None if response is None else response.z
            response = solve_periodic(forced(omega)[0], harmonics=15, start=start)
        results.append(response)
    upper, lower = results
    for omega in (1.28, 1.3):
        upper = solve_periodic(forced(omega)[0], harmonics=15, start=upper.z)
    assert largest(upper.z[0]) > 2 * largest(lower.z[0])
    system, chain = forced(1.3)
    for response in (upper, lower):
        orbit = oracle(system, response, chain)
        assert orbit.stable and max(orbit_error(system, response, orbit)) <= ORBIT


def test_a_resonance_is_damped_by_drag_alone():
    """At its natural frequency a mass with quadratic damping only is found from a start that moves."""
    system = duffing(1.0, 1.0, 0.0, 1.0, 0.0, d=1.0)
    start = coefficients(system, 45, s1=1.0)
    start[1, 0, 2] = 1.0
    response = solve_periodic(system, harmonics=45, start=start)
    orbit = oracle(system, response, shooting.quadratically_damped(1.0, 1.0, 1.0, 1.0, 1.0))
    assert max(orbit_error(system, response, orbit)) <= 1e-5  # 45^-3


# ---------------------------------------------------------------- linear limit, invariance
def frequency_response(chain: MassChain, omega, force):
    """Complex places q of M q'' + C q' + K q = Re(force e^(i omega t))."""
    k = np.append(chain.k, 0.0)
    K = np.diag(k[:-1] + k[1:]) - np.diag(k[1:-1], 1) - np.diag(k[1:-1], -1)
    return np.linalg.solve(K - omega**2 * np.diag(chain.m) + 1j * omega * np.diag(chain.c), force)


LINEAR = MassChain("linear", 2 * math.pi / 0.7, harmonic_force(0.3, 0.7, 2, 5), 5, 1.3, 0.2, 0.0, 2.0)


def linear_error(chain, share=1.0) -> float:
    """Largest error of the first harmonic over the largest, one Newton step or several."""
    response = solve_periodic(chain.scaled(share), harmonics=5)
    wanted = share * frequency_response(chain, 0.7, 0.3 * np.eye(5)[2])
    return largest(response.z[0, :, 2] - 1j * response.z[0, :, 1] - wanted) / largest(wanted)


def test_linear_chain_is_its_frequency_response():
    """Without nonlinear terms the first harmonic is that of complex algebra, and no other is there."""
    assert linear_error(LINEAR) <= ROUND_OFF
    assert largest(solve_periodic(LINEAR, harmonics=5).z[0][:, [0, *range(3, 11)]]) <= ROUND_OFF


@dataclass(frozen=True, eq=False)
class Limited(MassChain):
    """A chain whose states are invalid where a mass is farther than ``limit`` m on the positive side."""

    limit: float = math.inf

    def invalid(self, y):
        farthest = np.unravel_index(y[0].argmax(), y[0].shape)
        return (Status.OVERSTRETCHED, int(farthest[0])) if y[0][farthest] > self.limit else None


@pytest.mark.parametrize("mass", range(3))
@pytest.mark.parametrize(("samples", "nu", "peak"), [(8, 1, 5.25), (8, 1, 2.5), (7, 2, 1.75), (5, 1, 3.0), (8, 1, 0.5)])
def test_a_state_that_is_invalid_between_the_samples_is_found(mass, samples, nu, peak):
    """Three masses in closed form: the driven one passes a limit for a quarter of the time between two samples.

    ``peak`` is when it is farthest, in these times; the event is that instant and that mass. With the limit above
    the peak there is none.
    """
    omega, m, k = 4.0, np.array([1.0, 0.4, 0.7]), np.array([0.8, 0.5, 0.6])  # far above resonance
    interval = nu * 2 * math.pi / omega / samples
    place = frequency_response(MassChain("", 1.0, None, 3, m, 0.3, 0.0, k), omega, np.eye(3)[mass])
    farthest = abs(place[mass])
    force = harmonic_force(1.0, omega, mass, 3, -np.angle(place[mass]) - omega * peak * interval)
    chain = Limited("limited", 2 * math.pi / omega, force, 3, m, 0.3, 0.0, k)
    options = {"harmonics": 2, "samples": samples, "subharmonic": nu, "throw": False}
    assert (np.delete(abs(place), mass) < 0.9 * farthest).all()
    passed = replace(chain, limit=farthest * math.cos(omega * interval / 8))
    response = solve_periodic(passed, **options)
    assert response.status is Status.OVERSTRETCHED and response.amplitude == 1.0
    time, node = response.event
    assert node == mass and time == pytest.approx(peak * interval, rel=1e-14)
    with pytest.raises(ConvergenceError, match=rf"invalid at t = {time:.4g} s, node {mass + 1} of 3"):
        solve_periodic(passed, **options | {"throw": True})
    above = solve_periodic(replace(chain, limit=farthest * (1 + 1e-9)), **options)
    assert above.success and above.event is None


@pytest.mark.parametrize(("term", "order"), [("k3", 2), ("k2", 2), ("d", 1)])
def test_small_amplitudes_tend_to_the_frequency_response(term, order):
    """What a nonlinear term adds to the first harmonic falls with the power of the amplitude that it must have."""
    chain = replace(LINEAR, **{term: np.full(5, 0.5)})
    a, b = (linear_error(chain, share) for share in (1e-2, 5e-3))
    assert abs(math.log2(a / b) - order) <= 0.02 and b <= 1e-2


def test_a_shift_in_time_shifts_the_response():
    """The force a third of a period later gives the response a third of a period later."""
    omega, shift = 0.8, 0.3
    chain = duffing(omega, 0.5, 0.2, 1.0, 0.5, k2=0.2, d=0.2)
    later = replace(chain, force=lambda t: chain.force(t - shift))
    first, second = (solve_periodic(c, harmonics=60, samples=960) for c in (chain, later))
    t = times(chain)
    assert largest(first.at(t - shift) - second.at(t)) <= CEILING[1]  # the samples fall elsewhere on |v| v


def test_a_mirrored_chain_has_the_mirrored_response():
    """Force and square of the spring with the other sign: the response with the other sign, to the last bit."""
    chain = duffing(0.8, 0.5, 0.2, 1.0, 0.5, k2=0.2, d=0.2)
    other = replace(chain, force=lambda t: -chain.force(t), k2=-chain.k2)
    first, second = (solve_periodic(c, harmonics=9).z for c in (chain, other))
    assert largest(first + second) <= ROUND_OFF


# ---------------------------------------------------------------- symmetry
@pytest.mark.parametrize("nodes", [1, 4])
def test_symmetry_changes_nothing_but_the_work(nodes):
    """With half the coefficients the response is the same, and even harmonics come out zero without symmetry, too."""
    chain = cubic_chain(nodes, d=0.2)
    short, full = (solve_periodic(chain, harmonics=9, symmetry=symmetry) for symmetry in (True, False))
    assert short.symmetric and not full.symmetric
    assert largest(short.z - full.z) <= ROUND_OFF
    assert not short.z[..., short.basis.harmonic % 2 == 0].any()


def test_symmetry_is_not_taken_on_trust():
    """A chain that offers a mirror that its springs or its force do not have is solved without."""
    for chain in (
        replace(duffing(0.9, 0.4, 0.1, 1.0, 0.1, k2=0.3), odd=True),
        replace(duffing(0.9, 0.4), force=lambda t: 0.4 * np.cos(0.9 * t)[None] + 0.1),
    ):
        response, wanted = (solve_periodic(chain, harmonics=9, symmetry=symmetry) for symmetry in (True, False))
        assert not response.symmetric and largest(response.z - wanted.z) <= ROUND_OFF


@pytest.mark.parametrize("samples", [64, 65])
def test_a_short_push_is_no_symmetry(samples):
    """A push as long as a sample lasts is not missed, wherever in the period it comes."""
    basis = Basis(9, samples, 0.9, True)
    chain = duffing(0.9, 0.4)
    assert find_mirror(chain, basis) is not None
    for middle in basis.times:
        push = lambda t, at=middle: np.exp((np.cos(0.9 * (t - at)) - 1) / (0.9 * basis.times[1]) ** 2)
        assert find_mirror(replace(chain, force=lambda t, push=push: chain.force(t) + push(t)), basis) is None


def test_symmetry_is_looked_at_again_in_the_solution(monkeypatch):
    """A mirror that passed by mistake is noticed by the rows that it left out."""
    monkeypatch.setattr(harmonic_balance, "find_mirror", lambda system, basis: system.mirror())
    chain = replace(duffing(0.9, 0.4, 0.1, 1.0, 0.1, k2=0.3), odd=True)
    response = solve_periodic(chain, harmonics=9)
    assert not response.symmetric
    assert largest(response.z - solve_periodic(chain, harmonics=9, symmetry=False).z) <= ROUND_OFF


# ---------------------------------------------------------------- the mean
class Placed(MassChain):
    """A towed chain whose last mass is where it is prescribed: the place itself is its end row."""

    def end(self, y, ydot, t, tangents=True, correction=0.0):
        J = np.zeros((1, 3, *y.shape[2:]), dtype=y.dtype)
        J[0, 0] = 1.0
        value = y[0, -1:] - self.load_factor * self.place(t)
        return Residual(value, J, 0 * J) if tangents else Residual(value)

    def drift(self, y, t):
        return None


def towed_error(**options) -> float:
    towed = towed_chain(4)
    placed = Placed(**{name: getattr(towed, name) for name in towed.__dataclass_fields__})
    responses = [solve_periodic(chain, harmonics=15, **options) for chain in (towed, placed)]
    return largest(responses[0].z - responses[1].z)


def test_the_mean_is_closed_by_the_place():
    """A chain towed by a velocity, its mean place given, moves as the chain whose end is put there."""
    assert towed_error() <= ROUND_OFF


def test_without_the_constant_the_mean_force_is_not_in_balance():
    """The paper's variant is marked, keeps no mean, and misses the mean that an asymmetric spring causes."""
    chain = duffing(0.9, 0.4, 0.1, 1.0, 0.1, k2=0.3)
    kept, dropped = (solve_periodic(chain, harmonics=15, mean=mean) for mean in (True, False))
    assert kept.mean and not dropped.mean
    assert kept.z.shape[2] == 31 and dropped.z.shape[2] == 30
    assert abs(kept.at(times(chain))[0].mean()) > 0.05 > 1e-12 > abs(dropped.at(times(chain))[0].mean())
    missed = [chain.start(result.y, result.ydot, result.time, False).value[1].mean() for result in (kept, dropped)]
    assert abs(missed[0]) <= ROUND_OFF and abs(missed[1]) > 1e-2  # N, of the spring


# ---------------------------------------------------------------- size, starts, methods
@pytest.mark.parametrize("nodes", [10, 50, 100, 300])
def test_long_chains_are_solved(nodes):
    """Up to 300 masses with 15 harmonics: every row is met to round-off after a dozen steps at most."""
    response = solve_periodic(cubic_chain(nodes), harmonics=15)
    assert response.iterations <= 12 and response.residual_norm <= 1e-9
    assert response.z.shape == (3, nodes, 31)


METHODS = [{"globalisation": "relaxation"}, {"multilevel": False}]


@pytest.mark.parametrize("options", METHODS, ids=str)
@pytest.mark.parametrize("name", ["Duffing, hardening", "asymmetric spring", "two masses"])
def test_methods_find_the_same_response(name, options):
    """The paper's relaxation factor and no coarse start lead where the default leads."""
    system = ORBITS[name][0]
    results = [solve_periodic(system, harmonics=15, **more) for more in ({}, options)]
    assert largest(results[0].z - results[1].z) <= ROUND_OFF
    assert results[1].coarse_iterations == 0 or "multilevel" not in options


def test_a_response_is_its_own_start():
    """Started from its own result one step confirms it, from its coefficients too, from fewer harmonics a few more."""
    system = ORBITS["asymmetric spring"][0]
    response = solve_periodic(system, harmonics=15)
    for start in (response, response.z):
        again = solve_periodic(system, harmonics=15, start=start)
        assert again.iterations == 1 and largest(again.z - response.z) <= ROUND_OFF
    refined = solve_periodic(system, harmonics=25, start=response)
    assert refined.iterations <= 3 and largest(refined.z[..., :31] - response.z) <= 1e-8
    assert largest(solve_periodic(system, harmonics=9, start=refined).at(times(system)) - refined.y[..., :1]) > 0


def test_output_is_the_series():
    """at, rate_at, y, ydot, time agree with each other; a rate is the derivative of the state by complex step."""
    response = solve_periodic(ORBITS["asymmetric spring"][0], harmonics=9)
    assert np.array_equal(response.at(response.time), response.y)
    assert np.array_equal(response.rate_at(response.time), response.ydot)
    t, h = np.array([0.3, 2.7]), 1e-5
    difference = (response.at(t + h) - response.at(t - h)) / (2 * h)
    assert largest(difference - response.rate_at(t)) <= 1e-8  # h^2, and rounding over h
    assert largest(response.ydot[0] - response.y[1]) <= ROUND_OFF


def test_a_response_without_the_constant_is_confirmed_by_one_step():
    """In the paper's variant, too, a response is confirmed by one step from itself."""
    chain = duffing(0.8, 0.3, 0.1, 1.0, 1.0)
    response = solve_periodic(chain, harmonics=9, mean=False)
    again = solve_periodic(chain, harmonics=9, mean=False, start=response)
    assert again.iterations == 1 and abs(again.z - response.z).max() <= 1e-11


@pytest.mark.parametrize(("k2", "symmetric"), [(0.0, True), (1e-10, True), (1e-3, False)])
def test_a_symmetry_may_be_missed_by_a_rounding(k2, symmetric):
    """Rows that it leaves out are compared with the driving: a part of 1e-10 of the spring is none."""
    force = harmonic_force(0.3, 0.8)
    chain = MassChain("nearly odd", 2 * math.pi / 0.8, force, c=0.1, k2=k2, k3=1.0, odd=True)
    assert solve_periodic(chain, harmonics=7).symmetric is symmetric


# ---------------------------------------------------------------- refusals and failures
GOOD = duffing(0.8, 0.3)
BAD = {
    "harmonics: 0 must be a whole number from 1 to 100000": {"harmonics": 0},
    "harmonics: 100001 must be a whole number from 1 to 100000": {"harmonics": 100001},
    "harmonics: -3 must": {"harmonics": -3},
    "harmonics: 2.5 must": {"harmonics": 2.5},
    "harmonics: True must": {"harmonics": True},
    "harmonics: '9' must": {"harmonics": "9"},
    "samples: 18 must be at least 2 harmonics [+] 1 = 19": {"harmonics": 9, "samples": 18},
    "samples: 0 must": {"samples": 0},
    "samples: 32.0 must": {"samples": 32.0},
    "subharmonic: 0 must": {"subharmonic": 0},
    "subharmonic: 1.5 must": {"subharmonic": 1.5},
    "tolerance: 0 .* must be > 0": {"tolerance": 0.0},
    "tolerance: nan": {"tolerance": float("nan")},
    "globalisation: 'newton' must be 'damped' or 'relaxation'": {"globalisation": "newton"},
    "start: coefficients of shape .3, 1, 4. must be": {"start": np.zeros((3, 1, 4))},
    "start: .* all finite": {"start": np.full((3, 1, 11), np.nan)},
}


@pytest.mark.parametrize(("message", "options"), BAD.items(), ids=BAD)
def test_bad_input_is_refused(message, options):
    """Before any work, naming what was given and what it must be."""
    with pytest.raises(InputError, match=message):
        solve_periodic(GOOD, **{"harmonics": 5, **options})


@pytest.mark.parametrize("other", [duffing(0.9, 0.3), cubic_chain(2, omega=0.8, amplitude=0.01)], ids=lambda c: c.name)
def test_a_response_of_another_chain_is_refused_as_a_start(other):
    """A start of another frequency or with other nodes is refused, naming both."""
    with pytest.raises(InputError, match=r"start: a response of .* fields and nodes at .* rad/s does not fit"):
        solve_periodic(GOOD, harmonics=5, start=solve_periodic(other, harmonics=5))


def test_a_chain_without_a_period_is_refused():
    """Nothing periodic drives it, so nothing periodic is looked for."""
    with pytest.raises(InputError, match="motion: the chain has no periodic driving"):
        solve_periodic(replace(GOOD, period=None), harmonics=5)


@pytest.mark.parametrize("globalisation", ["damped", "relaxation"])
def test_a_resonance_without_damping_has_no_response(globalisation):
    """The status says that none was found, and at which share of the driving; with throw it is raised."""
    chain = duffing(1.0, 0.3, 0.0, 1.0, 0.0)
    response = solve_periodic(chain, harmonics=5, globalisation=globalisation, throw=False)
    assert response.status is Status.NO_PERIODIC_RESPONSE and response.amplitude == 0.0 and not response.success
    with pytest.raises(ConvergenceError, match=r"no periodic response .*amplitude reached: 0\b") as raised:
        solve_periodic(chain, harmonics=5, globalisation=globalisation)
    assert raised.value.outcome.status is Status.NO_PERIODIC_RESPONSE


def test_continuation_in_amplitude_is_internal():
    """Where Newton's method from rest fails at the full force, the force is raised, and the response is the same."""
    system, _, harmonics = ORBITS["Duffing, above resonance"]
    response = solve_periodic(system, harmonics=harmonics)
    assert response.coarse_iterations > 20 and response.amplitude == 1.0 and response.success


# ---------------------------------------------------------------- the checks turn red
def _rates(factor):
    plain = Basis.functions

    def functions(self, t):
        q, q_t = plain(self, t)
        q_t[:, -1] *= factor
        return q, q_t

    return {"functions": functions}


def _patched(monkeypatch, target, **attributes):
    for name, value in attributes.items():
        monkeypatch.setattr(target, name, value)


def test_a_rate_one_per_cent_off_is_found(monkeypatch):
    """The exact trigonometric solutions see the rate of one coefficient."""
    _patched(monkeypatch, Basis, **_rates(1.01))
    assert manufactured_error("four masses", harmonics=2) > ROUND_OFF


@pytest.mark.parametrize("which", [exact_half, exact_third])
def test_a_forgotten_nu_is_found(monkeypatch, which):
    """The exact subharmonics see a basis of the driving's own frequency."""
    plain, nu = Basis.__init__, which()[2]
    _patched(monkeypatch, Basis, __init__=lambda self, Nh, Nt, omega, mean: plain(self, Nh, Nt, nu * omega, mean))
    with pytest.raises((ConvergenceError, AssertionError)):
        assert subharmonic_error(which) <= ROUND_OFF


@lru_cache
def asymmetric_orbit():
    system, chain, harmonics = ORBITS["asymmetric spring"]
    return oracle(system, solve_periodic(system, harmonics=harmonics), chain)


@pytest.mark.parametrize("name", ["m", "c", "k", "k2", "k3"])
def test_a_coefficient_off_by_a_millionth_is_found(name):
    """Shooting sees each coefficient of the chain."""
    system, _, harmonics = ORBITS["asymmetric spring"]
    wrong = replace(system, **{name: getattr(system, name) * (1 + 1e-6)})
    assert max(orbit_error(system, solve_periodic(wrong, harmonics=harmonics), asymmetric_orbit())) > 10 * ORBIT


def test_a_wrong_closing_of_the_mean_is_found(monkeypatch):
    """The place-driven chain sees the mean of the towed one 1e-6 off."""
    plain = MassChain.drift
    _patched(monkeypatch, MassChain, drift=lambda self, y, t: None if self.place is None else plain(self, y, t) - 1e-6)
    assert towed_error() > ROUND_OFF


def test_smoothed_drag_is_found(monkeypatch):
    """|v| replaced by a smooth function converges faster than the kink allows, and the order turns red."""

    def momentum(self, n, y, ydot, t):
        v = y[1, n]
        speed = np.sqrt(v * v + 0.1)
        value = ydot[1, n] + 0.5 * speed * v + y[2, n] - self.load_factor * self.force(t)[n]
        return value, 0.5 * (speed + v * v / speed), np.ones_like(v)

    _patched(monkeypatch, MassChain, _momentum=momentum)
    system = duffing(0.6, 1.0, 0.0, 1.0, 0.0, d=0.5)
    fine = solve_periodic(system, harmonics=60).at(times(system))[1]
    errors = [largest(solve_periodic(system, harmonics=Nh).at(times(system))[1] - fine) for Nh in (9, 25)]
    assert math.log(errors[0] / errors[1]) / math.log(25 / 9) > VELOCITY_ORDER + 1


def test_tolerances_are_above_rounding():
    """The named tolerances lie between rounding and what they are to find."""
    assert EPS < ROUND_OFF < ORBIT < CEILING[0] < CEILING[1] < MULTISTEP
