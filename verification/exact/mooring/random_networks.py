"""Small random networks in motion, from a seed: clumps, buoys, bridles, seabed, crossings, slack, current.

Soft and short enough that `moving_network.simulate` reaches ten digits within seconds. Each starts at rest, in
equilibrium with the body where it is at t = 0; held nodes have the body's velocity from then on. The numbers come from
numpy's PCG64, whose stream is the same on any machine. SI units.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from verification.exact.mooring.moving_network import Lines, Mesh, Network, Nodes, Seabed, simulate, solve_equilibrium
from verification.exact.rigid_motion import RigidMotion

SEEDS = tuple(range(12))
FEATURES = ("clump", "buoy", "bridle", "seabed", "crossing")
SNAPPING = 10
"""What a seed's network has: that of seed % 5; from seed 10 on it goes slack and snaps. Odd seeds have a current, and
drag along the lines: in still water that would turn at every node with the motion."""
DURATION, SAMPLES = 5.0, 11
"""Seconds, and times from 0 to there, of `random_history`."""


@dataclass(frozen=True)
class RandomNetwork:
    """A network with its feature and its start: position, velocity (size, 3), m and m/s, of the nodes of its mesh."""

    feature: str
    network: Network
    position: np.ndarray
    velocity: np.ndarray


def random_network(seed):
    """Return the `RandomNetwork` of a seed, with 2 to 5 lines."""
    rng = np.random.default_rng([2026, seed])
    feature = "snap" if seed >= SNAPPING else FEATURES[seed % len(FEATURES)]
    current = tuple(rng.uniform((-0.6, -0.5, -0.05), (0.6, 0.5, 0.05)).tolist()) if seed % 2 else (0.0, 0.0, 0.0)
    nodes, ends, slack, seabed = _BUILDERS[feature](rng)
    ends = np.array(ends)
    chord = nodes.position[ends[:, 1]] - nodes.position[ends[:, 0]]
    e = len(ends)
    mass = rng.uniform(15.0, 40.0, e)
    lines = Lines(
        ends=ends,
        length=np.sqrt((chord**2).sum(axis=1)) * slack,
        cells=rng.integers(3, 6, e),
        EA=rng.uniform(2e4, 6e4, e),
        beta=rng.choice([0.0, 0.03, 0.08], e),
        mass=mass,
        added_mass=mass * rng.uniform(0.2, 0.6, e),
        weight=mass * rng.uniform(4.0, 8.0, e) * (0.2 if feature == "snap" else 1.0),
        d=rng.uniform(0.08, 0.15, e),
        Cdn=rng.uniform(0.8, 1.6, e),
        Cdt=rng.uniform(0.0, 0.1, e) * any(current),
    )
    network = Network(nodes, lines, _motion(rng, nodes, feature == "snap"), seabed, current)
    mesh, position = Mesh(network), solve_equilibrium(network)
    velocity = np.zeros((mesh.size, 3))
    velocity[mesh.coupled] = network.motion.kinematics(nodes.position[mesh.coupled], 0.0)[1]
    return RandomNetwork(feature, network, position, velocity)


def random_history(seed, *, duration=DURATION, samples=SAMPLES, **tolerances):
    """Return the `History` of the network of a seed from t = 0; tolerances : rtol, atol of `simulate`."""
    case = random_network(seed)
    times = np.linspace(0.0, duration, samples)
    return simulate(case.network, times, case.position, case.velocity, **tolerances)


def _motion(rng, nodes, inwards):
    """Return a motion of all six degrees of freedom about a point above the coupled nodes.

    inwards : whether it is large, and starts at speed back and down, so that the lines go slack
    """
    coupled = [i for i, kind in enumerate(nodes.kind) if kind == "coupled"]
    reference = nodes.position[coupled].mean(axis=0) + rng.uniform((-4, -4, 2), (4, 4, 6))
    amplitude = np.concatenate([(4.0 if inwards else 1.0) * rng.uniform(0.3, 1.0, 3), rng.uniform(0.01, 0.05, 3)])
    phase = rng.uniform(0.0, 2 * np.pi, 6)
    if inwards:
        phase[[0, 2]] = np.pi / 2
    return RigidMotion(
        tuple(reference.tolist()), rng.uniform(0.6, 1.4), tuple(amplitude.tolist()), tuple(phase.tolist())
    )


def _shaken(rng, places, by=2.0):
    return np.array(places, float) + rng.uniform(-by, by, (len(places), 3))


def _clump(rng):
    """A clump weight between an anchor and a fairlead, with or without a second anchor."""
    places = _shaken(rng, [(-25, 0, -20), (25, 4, -10), (0, 0, -26), (0, 28, -18)])
    count = int(rng.integers(3, 5))
    nodes = Nodes(
        places[:count],
        ("fixed", "coupled", "free", "fixed")[:count],
        mass=[0.0, 0.0, rng.uniform(500, 900), 0.0][:count],
        volume=[0.0, 0.0, 0.1, 0.0][:count],
        Ca=0.5,
        CdA=[0.0, 0.0, 0.4, 0.0][:count],
    )
    return nodes, [(0, 2), (1, 2), (3, 2)][: count - 1], 1.02, None


def _buoy(rng):
    """A buoy over its anchor, moored to a fairlead."""
    places = _shaken(rng, [(0, 0, -50), (2, 0, -22), (30, 5, -12)])
    nodes = Nodes(
        places,
        ("fixed", "free", "coupled"),
        mass=[0.0, rng.uniform(300, 600), 0.0],
        volume=[0.0, rng.uniform(1.4, 2.0), 0.0],
        Ca=0.5,
        CdA=[0.0, 1.2, 0.0],
    )
    return nodes, [(0, 1), (1, 2)], (1.0, 1.12), None


def _bridle(rng):
    """A line from an anchor and two from its end to a rolling body; the joint bears a constant force."""
    places = _shaken(rng, [(-35, 0, -38), (0, 0, -16), (16, -9, -8), (17, 9, -8)], 1.0)
    force = np.zeros((4, 3))
    force[1] = rng.uniform(-300, 300, 3)
    nodes = Nodes(places, ("fixed", "free", "coupled", "coupled"), mass=[0.0, rng.uniform(60, 200), 0, 0], force=force)
    return nodes, [(0, 1), (1, 2), (1, 3)], (0.99, 0.97, 0.97), None


def _seabed(rng):
    """Two slack lines that rest on the seabed, one of them with a clump between its two parts."""
    places = _shaken(rng, [(-45, 0, -30), (-22, 1, -30), (0, 0, -10), (30, 30, -30)], 0.5)
    places[[0, 1, 3], 2] = -30.0
    nodes = Nodes(
        places,
        ("fixed", "free", "coupled", "fixed"),
        mass=[0.0, rng.uniform(100, 300), 0.0, 0.0],
        volume=[0, 0.05, 0, 0],
    )
    bed = Seabed(30.0, rng.uniform(300, 800), rng.choice([0.0, 60.0]), rng.uniform(0.2, 0.8), 0.1)
    return nodes, [(0, 1), (1, 2), (2, 3)], (1.0, 1.05, 1.06), bed


def _crossing(rng):
    """Five lines: a span between two joints, each of them moored to an anchor and to the body."""
    places = _shaken(rng, [(-30, 0, -35), (30, 0, -35), (-10, 0, -20), (10, 2, -20), (-14, 6, -4), (14, 6, -4)], 1.0)
    nodes = Nodes(
        places,
        ("fixed", "fixed", "free", "free", "coupled", "coupled"),
        mass=[0, 0, *rng.uniform(80, 200, 2), 0, 0],
        volume=[0, 0, 0.05, 0.3, 0, 0],
        Ca=0.6,
        CdA=[0, 0, 0.3, 0.3, 0, 0],
    )
    return nodes, [(0, 2), (2, 3), (3, 1), (2, 4), (5, 3)], 0.98, None


def _snap(rng):
    """A light joint on three lines, one of them nearly slack under a body in large motion."""
    places = _shaken(rng, [(-20, 0, -24), (0, 0, -16), (18, 3, -8), (2, -24, -22)], 1.0)
    nodes = Nodes(places, ("fixed", "free", "coupled", "fixed"), mass=[0.0, rng.uniform(40, 80), 0.0, 0.0])
    return nodes, [(0, 1), (1, 2), (3, 1)], (1.02, 1.02, 1.05), None


_BUILDERS = dict(zip((*FEATURES, "snap"), (_clump, _buoy, _bridle, _seabed, _crossing, _snap), strict=True))
