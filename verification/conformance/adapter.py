"""What another code must say of itself to run under the same cases: one class, a method for each problem it solves.

A method that is not defined is a problem that the code does not solve. ``NotImplementedError("why")`` means that the
case is outside its model, ``Refused("why")`` that it finds no answer; any other exception is a refusal too, and so is
a value that is not finite or a call that takes longer than ``time_limits``. What it prints is not shown.

Every quantity of an answer beyond the first is optional: what is None is counted as not answered, and not judged.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

INSTANTS = 1000
"""Equal times of a period at which the fairlead tensions of two solvers are compared."""

LIMITS = {"span": 5.0, "network": 20.0, "cable": 120.0, "moving_network": 120.0}
"""Problem -> s, after which one solve counts as refused: 500 times what the slowest peer takes on an everyday line."""

__all__ = ["INSTANTS", "LIMITS", "Adapter", "CableAnswer", "MovingNetworkAnswer", "NetworkAnswer", "Refused",
           "SpanAnswer"]  # fmt: skip


class Refused(Exception):
    """The code gave no answer; the text says why, in its own words where there are any."""


@dataclass(frozen=True)
class SpanAnswer:
    """Forces of one line at rest as a solver returned them; z up, from the anchor to the fairlead.

    H, V : components of the tension at the fairlead, N; V > 0 where the line hangs below it
    refused : why it returned none; unsupported : why the case is outside its model
    seconds : of the solve by the solver's own clock, where it has one (a program, without its start)
    H_anchor, V_anchor : at the anchor, N; V_anchor < 0 where the line sags below it
    grounded_length : unstretched, m
    stiffness : (2, 2), d(H, V)/d(x, z) of the fairlead, N/m
    profile : (n, 2), x and z from the anchor at the unstretched arc lengths case.s, m
    tension : (n,), at case.s, N
    """

    H: float = float("nan")
    V: float = float("nan")
    iterations: int | None = None
    refused: str = ""
    unsupported: str = ""
    seconds: float | None = None
    H_anchor: float | None = None
    V_anchor: float | None = None
    grounded_length: float | None = None
    stiffness: Any = None
    profile: Any = None
    tension: Any = None


@dataclass(frozen=True)
class NetworkAnswer:
    """A network at rest.

    tension : (e, 2), at the anchor and fairlead ends of every element, N
    r : (n, 3), positions of all nodes, m
    stiffness : (6, 6), d(force, moment)/d(translation, rotation) times -1 of the coupled nodes as one rigid body about
    network.body.reference: N/m, N/rad, N m/m, N m/rad; the positive diagonal restores
    """

    tension: Any = None
    r: Any = None
    stiffness: Any = None


@dataclass(frozen=True)
class CableAnswer:
    """A moving line.

    tension : (K,), at the fairlead at each time, N; anchor_tension : (K,), at the anchor
    envelope : (2, n), greatest and least tension at the arc lengths scene.s over the times from scene.window[0] to
    scene.window[1], N
    """

    tension: Any = None
    anchor_tension: Any = None
    envelope: Any = None


@dataclass(frozen=True)
class MovingNetworkAnswer:
    """A network on a moving body.

    force : (P, 3, K), of lines and loads on the coupled nodes, N; tension : (e, 2, K), at both ends of the elements
    """

    force: Any = None
    tension: Any = None


class Adapter:
    """Another code. SI units, forces in N, z up.

    label and version as tables show them; the name in result files is that of the class in lower case.
    tolerances : False for a code that takes no tolerance: it is asked once, and not at a ladder of them
    settings : (cells, steps in a period) of moving cables, from coarse to fine; the steps divide 1000 or are a multiple
    time_limits : problem -> s, where LIMITS do not suit
    cells : segments of a moving line in the conformance cases, where their own number does not suit
    """

    label: str = ""
    version: str = ""
    tolerances: bool = True
    settings: tuple = ((25, 200), (50, 500), (100, 1000))
    time_limits: dict = {}  # noqa: RUF012 (read only)
    cells: int | None = None

    def span(self, case, tolerance=None) -> SpanAnswer:
        """Return SpanAnswer(H, V, ...) of one line at rest: the fairlead force, and what else the code gives.

        case has w, EA, L, x, z, seabed, friction, clearance as solvers.Span; tolerance is relative, None: as it comes.
        Conformance cases also have s (arc lengths from the anchor, m), mass_per_length, diameter, rho and g.
        """
        raise NotImplementedError

    def network(self, network, tolerance=None):
        """Return the tension at the anchor and fairlead ends of every element, (e, 2), N, or a NetworkAnswer.

        network as solvers.Network. Conformance cases also have network.body (or None) with ``nodes`` (the coupled
        ones) and ``reference`` (3,), m. A function of no argument may be returned instead, which solves and returns
        it: what came before is not timed.
        """
        raise NotImplementedError

    def cable(self, scene, time, fairlead, cells):
        """Return the tension at the moving fairlead at each time, (K,), N, from rest, or a CableAnswer.

        scene as solvers.Scene; time (K,) in s, evenly spaced from 0; fairlead (K, 3), its places in m; cells: segments
        to divide the line in. Conformance cases also have scene.s and scene.window (CableAnswer.envelope).
        """
        raise NotImplementedError

    def moving_network(self, network, motion, time, cells):
        """Return the forces of lines and loads on the coupled nodes at each time, (P, 3, K), N, from rest.

        Or a MovingNetworkAnswer. network as solvers.Network; motion as solvers.BodyMotion, whose velocity at the start
        is not zero unless it is ramped; time (K,) in s, evenly spaced from 0; cells: segments of each element, one
        number or a list.
        """
        raise NotImplementedError

    @property
    def name(self) -> str:
        """In result files."""
        return type(self).__name__.lower()

    def solves(self, problem: str) -> bool:
        """Whether it has a method for "span", "network", "cable" or "moving_network"."""
        return getattr(type(self), problem) is not getattr(Adapter, problem)

    def limit(self, problem: str) -> float:
        """Seconds given to one solve."""
        return self.time_limits.get(problem, LIMITS[problem])
