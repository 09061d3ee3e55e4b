"""Cases of the problem type "span": one mooring line between two ends. Inputs only; truth is in reference.py."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

INPUTS = ("w", "EA", "L", "x", "z", "seabed", "friction", "clearance")


@dataclass(frozen=True)
class SpanCase:
    """Inputs of one line, as solvers.Span: N/m, N, m; ``regime`` is the label of its author, not of a solver."""

    name: str
    regime: str
    w: float
    EA: float
    L: float
    x: float
    z: float
    seabed: bool = True
    friction: float = 0.0
    clearance: float = 0.0

    def inputs(self) -> dict:
        """The arguments of solvers.Span."""
        return {name: getattr(self, name) for name in INPUTS}


OC3 = {"w": 698.094, "EA": 384.243e6, "L": 902.2, "x": 848.67, "z": 250.0}

NAMED = (
    SpanCase("oc3-friction-0", "grounded", **OC3),
    SpanCase("oc3-friction-0.001", "grounded", **OC3, friction=0.001),
    SpanCase("oc3-friction-1", "grounded", **OC3, friction=1.0),
    SpanCase("oc3-floating", "floating", **OC3, seabed=False),
    SpanCase("polyester-taut", "suspended", w=62.0, EA=1.9e8, L=2290.0, x=1700.0, z=1560.0),
    SpanCase("chain-shallow", "grounded", w=2485.0, EA=1.22e9, L=420.0, x=405.0, z=28.0, friction=0.7),
    SpanCase("chord-equal-to-length", "suspended", w=100.0, EA=1e9, L=500.0, x=400.0, z=300.0),
    SpanCase("over-stretched", "steep", w=50.0, EA=2e7, L=300.0, x=100.0, z=320.0),
)
"""The lines that are timed one by one."""


def random_cases(n: int, seed: int = 2026) -> list[SpanCase]:
    """n valid spans over every regime, from everyday lines to the extremes; the same list for the same (n, seed).

    Half of each quantity is drawn from everyday ranges, half log-uniform far beyond them; one row in ten is moved onto
    an exact special case (chord equal to L, l = 0, h = 0, w = 0, lying taut, just slack).
    """
    rng = np.random.default_rng(seed)
    return [_random_case(rng, f"random-{seed}-{i}") for i in range(n)]


def _log(rng, low, high):
    return float(10 ** rng.uniform(low, high))


def _random_case(rng, name) -> SpanCase:
    everyday = rng.random() < 0.5
    L = _log(rng, 1.5, 3.3) if everyday else _log(rng, -1, 4.3)
    w = _log(rng, 1, 3.5) if everyday else _log(rng, -6, 5)
    stiffness = _log(rng, 2, 5) if everyday else rng.choice([_log(rng, 0, 3), _log(rng, 3, 12), _log(rng, 12, 280)])
    near = 1 + _log(rng, -14, -1) * rng.choice([-1, 1])
    chord = L * float(rng.choice([rng.uniform(0.3, 1.0), near, _log(rng, -3, 2)]))
    steep = rng.choice([_log(rng, -9, 0), 1 - _log(rng, -9, 0)])
    angle = np.pi / 2 * (rng.uniform() if rng.random() < 0.7 else steep)
    x, z = chord * float(np.cos(angle)), chord * float(np.sin(angle))
    seabed, friction, clearance = bool(rng.random() < 0.6), 0.0, 0.0
    if seabed and rng.random() < 0.25:
        clearance = L * _log(rng, -4, 0)
        z = z if rng.random() < 0.6 else -min(z, clearance)
    elif seabed and rng.random() < 0.7:
        friction = float(rng.choice([rng.uniform(0, 1), _log(rng, -4, 3)]))
    if not seabed:
        z, w = z * rng.choice([-1, 1]), w * rng.choice([-1, 1, 1])
    special = rng.integers(0, 60)
    if special == 0:
        x, z, L = 3 * L, 4 * L, 5 * L
    elif special == 1:
        x = 0.0
    elif special == 2:
        z = 0.0
    elif special == 3:
        w = 0.0
    elif special == 4:
        z, x, clearance = 0.0, L * (1 + _log(rng, -6, -1)), 0.0
    elif special == 5 and seabed:
        x = max(L - abs(z), 0.0)
    EA = abs(float(w)) * L * float(stiffness) or 1e6
    return SpanCase(name, "random", float(w), EA, L, x, float(z), seabed, friction, clearance)


def random_arrays(n: int, seed: int = 2026) -> dict[str, np.ndarray]:
    """n valid spans as arrays (n,), arguments of solvers.solve_spans: the mixture of ``random_cases``, drawn at once.

    For timing many lines; the same arrays for the same (n, seed), but other lines than ``random_cases``.
    """
    rng = np.random.default_rng(seed)

    def log(low, high):
        return 10 ** rng.uniform(low, high, n)

    def one_of(*columns):
        return np.choose(rng.integers(0, len(columns), n), columns)

    everyday = rng.random(n) < 0.5
    L = np.where(everyday, log(1.5, 3.3), log(-1, 4.3))
    w = np.where(everyday, log(1, 3.5), log(-6, 5))
    stiffness = np.where(everyday, log(2, 5), one_of(log(0, 3), log(3, 12), log(12, 280)))
    near = 1 + log(-14, -1) * rng.choice([-1, 1], n)
    chord = L * one_of(rng.uniform(0.3, 1.0, n), near, log(-3, 2))
    angle = np.pi / 2 * np.where(rng.random(n) < 0.7, rng.uniform(0, 1, n), one_of(log(-9, 0), 1 - log(-9, 0)))
    x, z = chord * np.cos(angle), chord * np.sin(angle)
    seabed = rng.random(n) < 0.6
    raised = seabed & (rng.random(n) < 0.25)
    clearance = np.where(raised, L * log(-4, 0), 0.0)
    z = np.where(raised & (rng.random(n) < 0.4), -np.minimum(z, clearance), z)
    rough = seabed & ~raised & (rng.random(n) < 0.7)
    friction = np.where(rough, one_of(rng.uniform(0, 1, n), log(-4, 3)), 0.0)
    z = np.where(seabed, z, z * rng.choice([-1, 1], n))
    w = np.where(seabed, w, w * rng.choice([-1, 1, 1], n))
    special = rng.integers(0, 60, n)
    triangle, lying, just_slack = special == 0, special == 4, (special == 5) & seabed
    x, z, L = np.where(triangle, 3 * L, x), np.where(triangle, 4 * L, z), np.where(triangle, 5 * L, L)
    x, z = np.where(special == 1, 0.0, x), np.where((special == 2) | lying, 0.0, z)
    w, clearance = np.where(special == 3, 0.0, w), np.where(lying, 0.0, clearance)
    x = np.where(lying, L * (1 + log(-6, -1)), np.where(just_slack, np.maximum(L - abs(z), 0.0), x))
    EA = np.where(w == 0, 1e6, abs(w) * L * stiffness)
    names = ("w", "EA", "L", "x", "z", "seabed", "friction", "clearance")
    return dict(zip(names, (w, EA, L, x, z, seabed, friction, clearance), strict=True))
