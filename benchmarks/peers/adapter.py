"""What another code must say of itself to run under the same cases: one class, a method for each problem it solves.

A method that is not defined is a problem that the code does not solve. ``NotImplementedError("why")`` means that the
case is outside its model, ``Refused("why")`` that it finds no answer; any other exception is a refusal too, and so is
a value that is not finite or a call that takes longer than ``time_limits``. What it prints is not shown.
"""

from __future__ import annotations

from verification.registry import INSTANTS, SpanAnswer

LIMITS = {"span": 5.0, "network": 20.0, "cable": 120.0}
"""Problem -> s, after which one solve counts as refused: 500 times what the slowest peer takes on an everyday line."""

__all__ = ["INSTANTS", "LIMITS", "Adapter", "Refused", "SpanAnswer"]


class Refused(Exception):
    """The code gave no answer; the text says why, in its own words where there are any."""


class Adapter:
    """Another code. SI units, forces in N, z up.

    label and version as tables show them; the name in result files is that of the class in lower case.
    tolerances : False for a code that takes no tolerance: it is asked once, and not at a ladder of them
    settings : (cells, steps in a period) of moving cables, from coarse to fine; the steps divide 1000 or are a multiple
    time_limits : problem -> s, where LIMITS do not suit
    """

    label: str = ""
    version: str = ""
    tolerances: bool = True
    settings: tuple = ((25, 200), (50, 500), (100, 1000))
    time_limits: dict = {}  # noqa: RUF012 (read only)

    def span(self, case, tolerance=None) -> SpanAnswer:
        """Fairlead force SpanAnswer(H, V, iterations) of one line at rest.

        case has w, EA, L, x, z, seabed, friction, clearance as solvers.Span; tolerance is relative, None: as it comes.
        """
        raise NotImplementedError

    def network(self, network, tolerance=None):
        """Tension at the anchor and fairlead ends of every element, (e, 2), N; network as solvers.Network.

        A function of no argument may be returned instead, which solves and returns it: what came before is not timed.
        """
        raise NotImplementedError

    def cable(self, scene, time, fairlead, cells):
        """Tension at the moving fairlead at each time, (K,), N, from rest; scene as solvers.Scene.

        time (K,) in s, evenly spaced from 0; fairlead (K, 3), its places in m; cells: segments to divide the line in.
        """
        raise NotImplementedError

    def moving_network(self, network, motion, time, cells):
        """Forces of lines and loads on the coupled nodes at each time, (P, 3, K), N, from rest.

        network as solvers.Network, motion as solvers.BodyMotion, whose velocity at the start is not zero unless it is
        ramped; time (K,) in s, evenly spaced from 0; cells: segments of each element, one number or a list.
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
