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
        *_, FxB, FzB, info = catenary(case.x, case.z, case.L, case.EA, case.w, CB=_seabed(case), **options)
        iterations = info["catenary"]["iter"] if "catenary" in info else 0
        # forces of the line on end B, z up: the fairlead carries the opposite; an end A above end B is reversed inside
        return SpanAnswer(float(-FxB), float(-FzB), iterations, str(info["message"]) if info["error"] else "")

    def network(self, network, tolerance=None):
        """The system is built outside the clock; solveEquilibrium's tol is 0.05 m as it comes."""
        if any(element.friction for element in network.elements):
            raise NotImplementedError("it loses seabed friction in a system of lines")
        system = systems.build(network)
        metres = systems.DEFAULT if tolerance is None else tolerance * max(element.L for element in network.elements)

        def solve():
            systems.solve(system, metres)
            return systems.tensions(system)

        return solve


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
