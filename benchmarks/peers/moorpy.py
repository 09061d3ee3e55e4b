"""MoorPy: moorpy.Catenary.catenary, its solver of one line, and moorpy.System for networks."""

from __future__ import annotations

import os
from importlib import metadata

from verification.conformance.adapter import Adapter, SpanAnswer

os.environ["PYTHONBREAKPOINT"] = "0"  # catenary() has breakpoint() calls on its error paths: they must not stop a run
os.environ.setdefault("MPLBACKEND", "Agg")  # it imports pyplot

from moorpy.Catenary import catenary

from . import moorpy_networks as systems

OUT_OF_REACH = 100.0
"""Depth of a seabed that is not there, in units of the deepest place that the line can reach."""


MOST_NODES = 202
"""Of a line whose shape is asked for."""

NODE_OFFSET = 1e-9
"""Share of the distance of two nodes by which an arc length may miss one."""


class MoorPy(Adapter):
    """Its tolerances are distances in m: ``tolerance`` times L of a line, or of the longest line of a network."""

    label = "MoorPy"
    version = metadata.version("moorpy")

    def span(self, case, tolerance=None) -> SpanAnswer:
        """Tol is 1e-6 m as it comes."""
        if case.w == 0:
            raise NotImplementedError(
                "its equations are per submerged weight (EA/W): a weightless line is outside its model"
            )
        if case.friction > 0 and case.clearance > 0:
            raise NotImplementedError("its argument CB is either the friction or the height of end A above the seabed")
        options = {} if tolerance is None else {"Tol": tolerance * case.L}
        nodes = _nodes_at(getattr(case, "s", ()), case.L)
        shape = {"plots": 1, "nNodes": nodes} if nodes else {}  # 1: with the shape in info, and no figure
        FxA, FzA, FxB, FzB, info = catenary(
            case.x, case.z, case.L, case.EA, case.w, CB=_seabed(case), **options, **shape
        )
        iterations = info["catenary"]["iter"] if "catenary" in info else 0
        # forces of the line on its ends, z up: the fairlead carries the opposite; A above B is reversed inside
        return SpanAnswer(
            float(-FxB), float(-FzB), iterations, str(info["message"]) if info["error"] else "",
            H_anchor=float(FxA), V_anchor=float(FzA), grounded_length=info.get("LBot"),
            stiffness=info.get("stiffnessB"), **_shape(info, case, nodes),
        )  # fmt: skip

    def network(self, network, tolerance=None):
        """The system is built outside the clock; solveEquilibrium's tol is 0.05 m as it comes."""
        if any(element.friction for element in network.elements):
            raise NotImplementedError("it loses seabed friction in a system of lines")
        system = systems.build(network)
        metres = systems.DEFAULT if tolerance is None else tolerance * max(element.L for element in network.elements)

        def solve():
            systems.solve(system, metres)
            return systems.tensions(system)

        return solve if not hasattr(network, "body") else lambda: systems.complete_answer(network, system, solve())


def _nodes_at(s, L: float) -> int:
    """Return the least number of nodes, equally spaced, of which some are at all arc lengths s; 0 where none is."""
    for nodes in range(2, MOST_NODES) if len(s) else ():
        if all(abs(place / L * (nodes - 1) - round(place / L * (nodes - 1))) < NODE_OFFSET for place in s):
            return nodes
    return 0


def _shape(info, case, nodes: int) -> dict:
    """Return its profile and tension at case.s, where it gives them."""
    if not nodes or len(info.get("X", ())) != nodes:
        return {}
    at = [round(place / case.L * (nodes - 1)) for place in case.s]
    if any(abs(info["s"][i] - place) > NODE_OFFSET * case.L for i, place in zip(at, case.s, strict=True)):
        return {}  # of a line that touches the seabed between raised ends the two parts have nodes of their own
    return {"profile": [[info["X"][i], info["Z"][i]] for i in at], "tension": [info["Te"][i] for i in at]}


def _seabed(case) -> float:
    """CB >= 0 is friction with end A on the seabed, CB < 0 minus the height of end A above the seabed (its docstring).

    There is no switch for "no seabed": where its own Line needs one it puts the seabed out of reach, 100 m below the
    lower end, and so does this adapter, in units that also suit long and short lines (100 and 1e6 units give the same
    verdicts; 1.5 loses one stiff line to cancellation in its test for slackness). Lines with w < 0 are mirrored inside.
    """
    if case.seabed:
        return -case.clearance if case.clearance > 0 else case.friction
    stretched = case.L * (1 + abs(case.w) * case.L / (2 * case.EA))
    return -OUT_OF_REACH * (stretched + abs(case.z))
