"""Cases of the problem type "cable": one line with its water, its ends and its fairlead's motion. Inputs only."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class CableCase:
    """Inputs of solvers.CableProperties, Environment and Motion, SI; the defaults are HB Table 1, at rest.

    Motion: amplitude sin(2 pi f t) + quadrature cos(2 pi f t), (3,) in m, of the frequency f in Hz; None: none.
    """

    name: str
    EA: float = 3.84243e8
    diameter: float = 0.09
    mass_per_length: float = 77.7066
    submerged_weight: float = 698.094
    Cdn: float = 1.6
    Cdb: float | None = None
    Cdt: float = 0.0
    Ca: float = 1.0
    damping: float = 0.0
    length: float = 902.2
    anchor: tuple[float, float, float] = (0.0, 0.0, 0.0)
    fairlead: tuple[float, float, float] = (848.67, 0.0, 250.0)
    rho: float = 1025.0
    current: tuple[float, float, float] = (0.0, 0.0, 0.0)
    depth: float | None = None
    seabed_stiffness: float | None = None
    frequency: float = 0.05
    amplitude: tuple[float, float, float] | None = None
    quadrature: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def turned(self, angle: float) -> CableCase:
        """The case seen from a frame turned about z by -angle, rad: ends, current and motion turn by angle."""
        c, s = math.cos(angle), math.sin(angle)
        turn = lambda v: (c * v[0] - s * v[1], s * v[0] + c * v[1], v[2])
        return replace(
            self,
            name=f"{self.name}, turned",
            anchor=turn(self.anchor),
            fairlead=turn(self.fairlead),
            current=turn(self.current),
            amplitude=None if self.amplitude is None else turn(self.amplitude),
            quadrature=turn(self.quadrature),
        )

    def mirrored(self) -> CableCase:
        """The case seen in a mirror, y -> -y."""
        flip = lambda v: (v[0], -v[1], v[2])
        return replace(
            self,
            name=f"{self.name}, mirrored",
            anchor=flip(self.anchor),
            fairlead=flip(self.fairlead),
            current=flip(self.current),
            amplitude=None if self.amplitude is None else flip(self.amplitude),
            quadrature=flip(self.quadrature),
        )


OC3 = CableCase("OC3 line")
"""HB section 4.1: no seabed, still water."""

SURGE_5 = replace(OC3, name="5 m surge", amplitude=(5.0, 0.0, 0.0))
SURGE_9 = replace(OC3, name="9 m surge", amplitude=(9.0, 0.0, 0.0))
SWAY_5 = replace(OC3, name="5 m sway", amplitude=(0.0, 5.0, 0.0))
HEAVE_5 = replace(OC3, name="5 m heave", amplitude=(0.0, 0.0, 5.0))
TABLE_2 = (SURGE_5, HEAVE_5, SWAY_5)
"""Cases 1 to 3 of HB Table 2; the fourth has two frequencies."""

OC3_SEABED = replace(
    OC3,
    name="OC3 line on the seabed",
    anchor=(-853.87, 0.0, -320.0),
    fairlead=(-5.2, 0.0, -70.0),
    depth=320.0,
    seabed_stiffness=3000.0,
)
SLACK_CHAIN = CableCase(
    "slack chain on a seabed",
    EA=6e8,
    diameter=0.08,
    mass_per_length=110.0,
    submerged_weight=1028.2,
    Cdn=1.4,
    length=400.0,
    anchor=(0.0, 0.0, -80.0),
    fairlead=(370.0, 0.0, -5.0),
    depth=80.0,
    seabed_stiffness=8e3,
    current=(0.4, 0.1, 0.0),
    frequency=1 / 11,
    amplitude=(1.0, 0.0, 0.5),
)
"""Two thirds of it rest; a cell of 25 nodes at the touchdown turns by 0.18 rad."""

EVERYTHING = replace(
    OC3_SEABED,
    name="every term",
    Cdb=1.2,
    Cdt=0.05,
    damping=0.02,
    current=(0.7, 0.4, 0.1),
    amplitude=(2.0, 1.0, 1.5),
    quadrature=(0.0, 0.8, 1.0),
)
LEVEL = replace(
    EVERYTHING,
    name="every term in the plane",
    current=(0.7, 0.0, 0.1),
    amplitude=(2.0, 0.0, 1.5),
    quadrature=(0.0, 0.0, 1.0),
)
"""Every term of HB (1)-(12) on: nothing symmetric, and all that a plane has."""

# ---------------------------------------------------------------- planted faults: (module, old text, new text, what)
ERRATA_FAULTS = [
    ("cable", "(1 + cable.Ca) * rho * cable.area", "(1 + cable.Ca) * rho * d**2 / 4", "HB (22): C_m rho d^2/4"),
    ("cable_planar", "F[1] += S_T * D_phi", "F[1] -= S_T * D_phi", "HB (30): f2 with -EA eps cos(theta) dphi/ds"),
    ("cable_spatial", "F[1] += S25 * D_phi", "F[1] -= S25 * D_phi", "HB (30): f2 with -EA eps cos(theta) dphi/ds"),
    ("cable_spatial", "- S65 * D_phi - S66 * D_theta", "- S65 * D_phi + S66 * D_theta", "HB (34): f6, +u dtheta/ds"),
    ("cable_planar", "F[2] += 2 * D[U]", "F[2] += 4 * D[U]", "HB (37): the constant part of K counted twice, row 4"),
    ("cable_spatial", "F[2] -= S_T * D_theta", "F[2] -= 2 * S_T * D_theta", "HB (37): the same, row 3"),
    (
        "cable_planar",
        "a[0] = m * (v * phi_t - u_t)",
        "a[0] = EA * c.beta * eps_t + m * (v * phi_t - u_t)",
        "HB (1), (28): damping EA beta d(eps)/dt in the momentum balance",
    ),
    (
        "cable_spatial",
        "a[0] = m * (v * cos_t * phi_t",
        "a[0] = EA * c.beta * eps_t + m * (v * cos_t * phi_t",
        "HB (1), (28): damping EA beta d(eps)/dt in the momentum balance",
    ),
]
"""The misprints of HB sections 2 and 3 that touch the equations of motion, as they would stand in the solvers."""

LOAD_FAULTS = [
    ("cable", "0.5 * rho * math.pi * d * cable.Cdt", "0.5 * rho * d * cable.Cdt", "tangential drag on d l, not pi d l"),
    ("cable", "0.5 * rho * d * cable.Cdn, 0.5", "rho * d * cable.Cdn, 0.5", "normal drag without its half"),
    ("cable", "0.5 * rho * d * cable.Cdb\n", "0.5 * rho * d * cable.Cdn\n", "binormal drag with C_dn"),
    ("cable", "(1 + cable.Ca) * rho", "cable.Ca * rho", "C_m = C_a: no Froude-Krylov force"),
    ("cable_planar", "F[:2] += support * S_up", "F[:2] -= support * S_up", "the seabed pulls"),
    ("cable_spatial", "F[:3] += support * S_up", "F[:3] -= support * S_up", "the seabed pulls"),
    ("cable_planar", "c.support(S[Z] / 2)", "c.support(S[Z])", "the seabed at the sum of two heights"),
    ("cable", "np.subtract(rows.value", "np.add(rows.value", "source with the wrong sign"),
    ("cable", "_over(self.ds / 2, y)", "_over(self.ds, y)", "positions twice as far"),
    ("cable", "weights[1:] += self.ds / 2", "weights[1:] += self.ds", "drift by a wrong quadrature"),
    ("cable", "value - self.axes @ self.motion.vel", "value + self.axes @ self.motion.vel", "the end runs off"),
    ("loads", "slope = -coefficient", "slope = coefficient", "(10): drag drives"),
    ("loads", "2 * slope\n", "slope\n", "(10): d|q|q/dq = |q|"),
    ("loads", "-normal * v * speed, -bin", "normal * v * speed, -bin", "(11): drag drives"),
    ("loads", ", -binormal * w * speed", ", binormal * w * speed", "(12): drag drives"),
    ("loads", "(-normal * (speed + vv), -normal * vw)", "(-normal * speed, -normal * vw)", "(11): d|q|/dq left out"),
    ("loads", "(-binormal * vw, ", "(0 * vw, ", "(12): cross tangent left out"),
    ("loads", "np.sqrt(v * v + w * w)", "np.sqrt(v * v)", "(11), (12): each component alone"),
    ("loads", "stiffness * (-depth - z)", "stiffness * (-depth + z)", "seabed above the water"),
    ("loads", "np.where(touching, support, 0.0)", "support", "the seabed holds the line down"),
    ("loads", "np.where(touching, -stiffness, 0.0)", "-stiffness + 0.0 * z", "the seabed's tangent above it"),
    ("cable_planar", "np.sqrt(1 + eps)", "(1 + eps)", "(10), (11): 1 + eps for its root"),
    ("cable_spatial", "stretch = np.sqrt(1 + eps)", "stretch = 1 + eps", "(10)-(12): 1 + eps for its root"),
    ("cable_planar", "F[1] += S_T * D_phi", "F[1] += 2 * T[1:] * D_phi", "(39): K of one node, not the mean"),
]
"""Loads, kinematics and their coefficients: each changes what a system is, not how it is solved."""

TIME_FAULTS = [
    ("generalized_alpha", "(3 - rho) / (2 + 2 * rho)", "(3 + rho) / (2 + 2 * rho)", "alpha_m"),
    ("generalized_alpha", "0.5 + alpha_m - alpha_f", "0.5 - alpha_m + alpha_f", "gamma"),
    ("generalized_alpha", "(y + f * (new - y), ydot", "(y + m * (new - y), ydot", "y at the level of ydot"),
    ("generalized_alpha", "ydot + m * (new_dot - ydot), t", "ydot + f * (new_dot - ydot), t", "ydot at the level of y"),
    ("generalized_alpha", "- ydot), t + f * h)", "- ydot), t + h)", "loads at the end of the step"),
    ("generalized_alpha", "ahead = (new, new_dot, t + h)", "ahead = (new, new_dot, t)", "the end a step late"),
    ("generalized_alpha", "(1 - g) / g * ydot", "(1 + g) / g * ydot", "the carried rate"),
    ("generalized_alpha", "-self.rate - self.gain", "-self.rate + self.gain", "the hold pushes away"),
    ("time_domain", "h * x * (1 - x) ** 2, h", "-h * x * (1 - x) ** 2, h", "Hermite's cubic"),
    (
        "time_domain",
        "self.end * self.steps / self.count if",
        "self.end * self.steps / (self.count + 1) if",
        "the clock",
    ),
]
"""The time integration: weights, levels of time, the hold, the interpolation."""

SIGNS = {
    "cable_planar": ("_loads", "_local", "cells", "velocity", "stretched_tangent"),
    "cable_spatial": ("__init__", "_local", "cells", "velocity", "stretched_tangent"),
}
"""Functions of the two modules of HB (1)-(12) in which each term in turn is planted with the wrong sign."""
