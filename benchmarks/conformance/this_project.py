"""This project's own solvers behind the contract of the conformance cases, as any other code is judged.

Lines at rest by the catenary, networks by the monolithic method, motion by nodes and elements in time. Truth at rest
shares no formula with them; that in motion comes from nodes and elements, too, with a second formulation beside it.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator

from solvers import (
    BodyMotion,
    CableProperties,
    Element,
    Environment,
    Network,
    Node,
    SampledMotion,
    Scene,
    Span,
    __version__,
    mooring_system,
    solve_network,
    solve_span,
    solve_time_domain,
)
from verification.conformance.adapter import Adapter, CableAnswer, MovingNetworkAnswer, NetworkAnswer, SpanAnswer

LONGER = 5
"""Steps of the places that are given in one step of the solver: an implicit one needs no more."""
_COEFFICIENTS = ("Cdn", "Cdb", "Cdt", "Ca", "damping")


class ThisProject(Adapter):
    """Solvers with their own defaults.

    refinement : cells for each segment that is asked for, which are those of codes that take shorter steps
    """

    label, version = "this project", __version__
    refinement = 2

    def span(self, case, tolerance=None) -> SpanAnswer:
        """Return all quantities of a line at rest."""
        state = solve_span(Span(**case.inputs()))
        x, z, tension = state.profile(np.minimum(case.s, case.L))
        return SpanAnswer(
            state.H, state.V, H_anchor=state.H_anchor, V_anchor=state.V_anchor, grounded_length=state.grounded_length,
            stiffness=state.stiffness, profile=np.column_stack([x, z]), tension=tension)  # fmt: skip

    def network(self, network, tolerance=None) -> NetworkAnswer:
        """Return tensions, positions and, of a body, its stiffness."""
        state = solve_network(network_of(network), tolerance=tolerance or 1e-12)
        tension = np.column_stack([np.hypot(state.H_anchor, state.V_anchor), np.hypot(state.H, state.V)])
        return NetworkAnswer(tension, state.r, network.body and state.body_stiffness(network.body.reference))

    def cable(self, scene, time, fairlead, cells) -> CableAnswer:
        """Return the tensions of both ends and the envelope, on a mesh fitted to the line at rest."""
        motion = SampledMotion(time, fairlead - fairlead[0])
        system = self.system(scene_of(scene), self.refinement * cells, motion, scene.slip_speed)
        history = solve_time_domain(system, dt=LONGER * time[1], duration=time[-1], ramp=0.0)
        ends = [self.end_tension(history, end) for end in (0, -1)]
        within = (history.time >= scene.window[0]) & (history.time <= scene.window[1])
        s = system.s
        T = np.concatenate([ends[0][None, within], history.tension[:, within], ends[1][None, within]])
        places = np.concatenate([[0.0], (s[1:] + s[:-1]) / 2, [scene.length]])
        envelope = np.array([PchipInterpolator(places, extreme(T, axis=1))(scene.s) for extreme in (np.max, np.min)])
        anchor, top = (CubicSpline(history.time, end)(time) for end in ends)
        return CableAnswer(top, anchor, envelope)

    def moving_network(self, network, motion, time, cells) -> MovingNetworkAnswer:
        """Return the forces on the coupled nodes and the tensions of the ends of elements."""
        cells, body = self.refinement * cells, self.body_motion(motion)
        system = self.system(network_of(network), cells, body, network.slip_speed, calibrate=False)
        history = solve_time_domain(system, dt=LONGER * time[1], duration=time[-1], ramp=motion.rule["ramp"])
        force = np.swapaxes(history.forces[:, system.coupled_nodes], 0, 1)
        tension = [[np.linalg.norm(e.end_force(end), axis=0) for end in (0, -1)] for e in history.elements]
        return MovingNetworkAnswer(
            *(CubicSpline(history.time, part, axis=-1)(time) for part in (force, np.array(tension)))
        )

    def system(self, scene, cells, motion, slip_speed, **options):
        """Return the MooringSystem that is solved."""
        return mooring_system(scene, cells, motion=motion, slip_speed=slip_speed, **options)

    def body_motion(self, motion) -> BodyMotion:
        """Return the motion of a body from its rule."""
        rule = motion.rule
        return BodyMotion.periodic(rule["frequency"], rule["sin"], rule["cos"], motion.reference)

    def end_tension(self, history, end):
        """Return the magnitude of the force at an end, N, at the times of the history."""
        return np.linalg.norm(history.system.end_force(history.y, history.ydot, history.yddot, end), axis=1)


def section_of(cable, w=None) -> CableProperties:
    """Return the section of a moving line."""
    coefficients = {key: getattr(cable, key) for key in _COEFFICIENTS}
    weight = cable.submerged_weight if w is None else w
    return CableProperties(cable.EA, cable.diameter, cable.mass_per_length, weight, **coefficients)


def environment_of(environment) -> Environment:
    """Return the water, gravity and seabed."""
    more = {key: getattr(environment, key) for key in ("current", "seabed_stiffness", "seabed_damping")}
    return Environment(environment.rho, environment.g, environment.depth, **more)


def scene_of(scene) -> Scene:
    """Return one moving line."""
    return Scene("asked", section_of(scene.cable), scene.length, scene.anchor, scene.fairlead,
                 environment_of(scene.environment), tuple(scene.friction))  # fmt: skip


def network_of(network) -> Network:
    """Return a network; elements have sections where they move."""
    nodes = [Node(n.kind, n.r, n.mass, n.volume, n.force, CdA=n.CdA, Ca=n.Ca) for n in network.nodes]
    elements = []
    for e in network.elements:
        section = {} if e.cable is None else {"cable": section_of(e.cable, e.w)}
        elements.append(Element(e.w, e.EA, e.L, e.ends, e.friction, **section))
    return Network(nodes, elements, environment_of(network.environment))
