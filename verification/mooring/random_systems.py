"""Random moving networks: 2 to 20 lines of a body, joints, buoys and clump weights, slack and taut, seabed and current.

Stiffness over five decades, cells far stiffer than the tension asks for, dampers or none: what a solver meets at worst.
"""

from __future__ import annotations

import numpy as np

from solvers import BodyMotion, CableProperties, Element, Environment, Network, Node


def random_system(seed: int) -> tuple[Network, BodyMotion]:
    """Return a network and the motion of its body, in six degrees of freedom, for a seed."""
    return _Builder(np.random.default_rng([2026, seed])).build()


class _Builder:
    """Nodes and elements of a network that grows line by line."""

    def __init__(self, rng):
        self.rng, self.nodes, self.elements = rng, [], []
        self.depth = float(rng.uniform(20.0, 400.0))
        self.radius, self.z = float(rng.uniform(1.0, 20.0)), -self.depth * float(rng.uniform(0.02, 0.4))
        bed = {}
        if rng.random() < 0.6:
            bed = {"depth": self.depth, "seabed_stiffness": float(10 ** rng.uniform(3, 6)),
                   "seabed_damping": float(rng.choice([0.0, 1e3]))}  # fmt: skip
        current = (*rng.uniform(-1.0, 1.0, 2), 0.0) if rng.random() < 0.3 else (0.0, 0.0, 0.0)
        self.environment = Environment(1025.0, current=current, **bed)

    def build(self):
        """Return the network and the motion."""
        rng, count = self.rng, int(self.rng.integers(2, 21))
        while len(self.elements) < count:
            kind = rng.choice(["line", "joint", "bridle"]) if count - len(self.elements) > 2 else "line"
            getattr(self, f"add_{kind}")(float(rng.uniform(0, 2 * np.pi)))
        amplitude = 0.02 * self.depth * float(rng.uniform(0.1, 1.0))
        sizes = rng.uniform(-1, 1, 6) * [amplitude, amplitude, amplitude / 2, 0.03, 0.03, 0.05]
        phases, period = rng.uniform(0, 2 * np.pi, 6), float(rng.uniform(4.0, 25.0))
        motion = BodyMotion.harmonic(1 / period, tuple(sizes), tuple(phases), reference=(0.0, 0.0, self.z))
        return Network(self.nodes, self.elements, self.environment), motion

    def add_line(self, angle):
        """Add a line from an anchor to the body."""
        self.add_element(self.add_anchor(angle), self.add_fairlead(angle), self.slackness())

    def add_joint(self, angle):
        """Add two lines in series, with nothing, a clump weight or a buoy between."""
        anchor, fairlead = self.add_anchor(angle), self.add_fairlead(angle)
        volume = float(self.rng.uniform(0.0, 4.0)) * (self.rng.random() < 0.5)
        mass = float(self.rng.uniform(0.05, 0.9)) * 1025.0 * volume or float(self.rng.choice([0.0, 3e3]))
        load = {"mass": mass, "volume": volume, "CdA": float(self.rng.uniform(0, 3)), "Ca": float(self.rng.random())}
        joint, slackness = self.add_between(anchor, fairlead, self.rng.uniform(0.3, 0.7), **load), self.slackness()
        self.add_element(anchor, joint, slackness)
        self.add_element(joint, fairlead, slackness)

    def add_bridle(self, angle):
        """Add a line to a joint from which two taut legs lead to the body."""
        anchor, legs = self.add_anchor(angle), [self.add_fairlead(angle + turn) for turn in (-0.3, 0.3)]
        joint = self.add_between(anchor, legs[0], self.rng.uniform(0.7, 0.95))
        self.add_element(anchor, joint, self.slackness())
        for leg in legs:
            self.add_element(joint, leg, 1.002)

    def slackness(self) -> float:
        """Return an unstretched length over the chord."""
        taut = self.rng.random() < 0.5
        return float(self.rng.uniform(1.0005, 1.02) if taut else self.rng.uniform(1.02, 1.3))

    def add_node(self, node) -> int:
        """Add a node; return its index."""
        self.nodes.append(node)
        return len(self.nodes) - 1

    def add_anchor(self, angle) -> int:
        """Add an anchor at the depth of the water; return its index."""
        far = self.depth * float(self.rng.uniform(0.8, 4.0))
        return self.add_node(Node("fixed", (far * np.cos(angle), far * np.sin(angle), -self.depth)))

    def add_fairlead(self, angle) -> int:
        """Add a point of the body; return its index."""
        return self.add_node(Node("coupled", (self.radius * np.cos(angle), self.radius * np.sin(angle), self.z)))

    def add_between(self, start, end, share, **load) -> int:
        """Add a free node between two others; return its index."""
        a, b = (np.array(self.nodes[i].r) for i in (start, end))
        return self.add_node(Node("free", tuple((1 - share) * a + share * b), **load))

    def add_element(self, start, end, slackness):
        """Add an element of a random section."""
        rng, d = self.rng, float(10 ** self.rng.uniform(-1.7, -0.7))
        mass = 1025.0 * np.pi / 4 * d**2 * float(rng.uniform(1.02, 6.0))
        cable = CableProperties(
            float(10 ** rng.uniform(5.5, 10.5)), d, mass, Cdn=float(rng.uniform(0.6, 2.0)),
            Cdt=float(rng.uniform(0.0, 0.4)), Ca=float(rng.uniform(0.3, 1.2)),
            damping=float(rng.choice([0.0, 0.0, 0.01, 0.05])))  # fmt: skip
        chord = float(np.linalg.norm(np.subtract(self.nodes[start].r, self.nodes[end].r)))
        friction = float(rng.choice([0.0, 0.5])) if self.environment.depth else 0.0
        weight = cable.weight_in(self.environment)
        self.elements.append(Element(weight, cable.EA, slackness * chord, (start, end), friction, cable=cable))
