"""The motion of a case by the reference integrator of verification/exact: explicit, of order 14, events located.

It takes the same nodes and cells and is written apart from this project's solvers; on few cells it tells what their
equations, steps and iterations are worth where no second discretisation has a law for the case: slack, a seabed with
damping. Meshes are told by the three of the first formulation.
"""

from __future__ import annotations

from unittest import mock

import numpy as np

from verification.exact.mooring import moving_network as exact
from verification.exact.rigid_motion import RigidMotion

from .responses import Variant, moving_system, network, scene

TOLERANCE = 1e-8  # of a step; what it leaves is far below the bounds of a case


class RampedHarmonics(RigidMotion):
    """Translation by harmonics that grow from rest as ``solvers.common.motions.motion.Ramped`` has it, with rates."""

    def __new__(cls, *_):
        return object.__new__(cls)

    def __init__(self, frequency, sine, cosine, ramp):
        super().__init__()
        angular = 2 * np.pi * frequency * np.arange(1, len(sine) + 1)
        for name, value in (
            ("_angular", angular),
            ("_sine", np.array(sine)),
            ("_cosine", np.array(cosine)),
            ("_ramp", ramp),
        ):
            object.__setattr__(self, name, value)

    def coordinates(self, t, order=0):
        """Return the derivative of that order of surge, sway, heave and three angles of zero, (*t.shape, 6)."""
        t = np.asarray(t, float)[..., None]
        x = np.clip(t / self._ramp, 0.0, 1.0)
        q = (
            x**3 * (10 - 15 * x + 6 * x**2),
            30 * x**2 * (1 - x) ** 2 / self._ramp,
            60 * x * (1 - x) * (1 - 2 * x) / self._ramp**2,
        )
        waves = []
        for k in range(3):
            turn = self._angular * t + k * np.pi / 2
            waves.append(
                (np.sin(turn) * self._angular**k) @ self._sine + (np.cos(turn) * self._angular**k) @ self._cosine
            )
        product = (q[0] * waves[0], q[1] * waves[0] + q[0] * waves[1],
                   q[2] * waves[0] + 2 * q[1] * waves[1] + q[0] * waves[2])  # fmt: skip
        return np.concatenate([product[order], np.zeros_like(product[order])], axis=-1)


class BilateralForces(exact.Forces):
    """Forces of cells that bear compression: the tension is EA (e + beta e'), of either sign."""

    def _switches(self):
        law, *others = super()._switches()
        return abs(law) + 1.0, *others


def exact_line(inputs, cells) -> exact.Network:
    """Return a line as the reference integrator takes it."""
    given = scene(inputs)
    cable, environment, fairlead = given.cable, given.environment, inputs["fairlead"]
    seabed = None
    if environment.depth is not None:
        seabed = exact.Seabed(environment.depth, environment.seabed_stiffness, environment.seabed_damping,
                              inputs["friction"], inputs["slip_speed"])  # fmt: skip
    return exact.Network(
        exact.Nodes(np.array([given.anchor, given.fairlead]), ("fixed", "coupled")),
        exact.Lines([[0, 1]], given.length, cells, cable.EA, cable.damping, cable.mass_per_length,
                    cable.added_mass(environment), cable.weight_in(environment), cable.diameter, cable.Cdn, cable.Cdt),
        RampedHarmonics(fairlead["frequency"], fairlead["sin"], fairlead["cos"], fairlead["ramp"]),
        seabed, environment.current, environment.rho, environment.g)  # fmt: skip


def exact_network(inputs, cells) -> exact.Network:
    """Return a network in still water without a seabed, whose body does not turn, as the reference takes it."""
    given, body = network(inputs), inputs["body"]
    cables, water = [element.cable for element in given.elements], given.environment
    columns = [[node.mass, node.volume, node.Ca, node.CdA] for node in given.nodes]
    return exact.Network(
        exact.Nodes(np.array([node.r for node in given.nodes]), tuple(node.kind for node in given.nodes),
                    *np.array(columns).T, force=np.array([node.force for node in given.nodes])),
        exact.Lines([element.ends for element in given.elements], [element.L for element in given.elements], cells,
                    [c.EA for c in cables], [c.damping for c in cables], [c.mass_per_length for c in cables],
                    [c.added_mass(water) for c in cables], [c.weight_in(water) for c in cables],
                    [c.diameter for c in cables], [c.Cdn for c in cables], [c.Cdt for c in cables]),
        RampedHarmonics(body["frequency"], np.array(body["sin"])[:, :3], np.array(body["cos"])[:, :3], body["ramp"]),
        None, water.current, water.rho, water.g)  # fmt: skip


def _start(inputs, cells):
    """Return places (cells + 1, 3) near those at rest: both ends, then the inner nodes."""
    system = moving_system(inputs, cells, Variant(options={"mesh": "uniform", "calibrate": False}))
    places = system.positions(system.rest_state()).T
    return np.concatenate([places[[0, -1]], places[1:-1]])


def integrate(inputs, cells, first_period, *, bilateral=False) -> dict:
    """Return the answer over the period of that number, from rest, on equal cells: quantity -> array.

    bilateral: cells bear compression. Raises ArithmeticError where the integration does not get on.
    """
    of_network = "elements" in inputs
    system = exact_network(inputs, cells) if of_network else exact_line(inputs, cells)
    clock = inputs["time"]
    start = exact.solve_equilibrium(system, None if of_network else _start(inputs, cells))
    step = clock["period"] / clock["instants"]
    times = step * np.arange((first_period + 1) * clock["instants"])
    with mock.patch.object(exact, "Forces", BilateralForces if bilateral else exact.Forces):
        history = exact.simulate(system, times, start, rtol=TOLERANCE, atol=TOLERANCE)
    kept = slice(first_period * clock["instants"], None)
    if of_network:
        force = np.moveaxis(history.holder_force[kept][:, history.mesh.coupled], 0, -1)
        return {"force": force, "tension": np.moveaxis(history.end_tension[kept], 0, -1)}
    ends = history.end_tension[kept, 0]
    return {"fairlead_tension": ends[:, 1], "anchor_tension": ends[:, 0]}
