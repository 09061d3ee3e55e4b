"""pycatenary: MooringLine, as its README uses it.

It gives the stretched line the shape of one inextensible catenary, and does not stretch the part on the floor: its
errors grow with the strain by design (0.7 % of the tension for the OC3 line); tightening ``tol`` does not remove them.
"""

from __future__ import annotations

from importlib import metadata

import numpy as np
from pycatenary import MooringLine

from verification.conformance.adapter import Adapter, SpanAnswer


class PyCatenary(Adapter):
    """Its ``tol`` is a distance in m, 1e-10 as it comes: ``tolerance`` times L."""

    label = "pycatenary"
    version = metadata.version("pycatenary")

    def span(self, case, tolerance=None) -> SpanAnswer:
        """compute_solution of a MooringLine."""
        if case.w <= 0:
            raise NotImplementedError("it divides by the submerged weight and takes it as acting downwards")
        if case.seabed and case.friction > 0:
            raise NotImplementedError("it has no seabed friction")
        if case.seabed and case.clearance > 0:
            raise NotImplementedError("its floor is at the level of the lower end")
        line = MooringLine(
            fairlead=[case.x, 0.0, case.z], anchor=[0.0, 0.0, 0.0], L=case.L, w=case.w, EA=case.EA, floor=case.seabed
        )
        if tolerance is not None:
            line.catenary.tol = tolerance * case.L
        line.compute_solution()
        force, at_anchor = line.get_fairlead_force(), line.get_anchor_force()  # of the line on its ends, z up
        s = getattr(case, "s", ())
        return SpanAnswer(
            float(-force[0]), float(-force[2]), H_anchor=float(at_anchor[0]), V_anchor=float(at_anchor[2]),
            grounded_length=float(case.L - sum(line.catenary.Ls)),
            profile=[line.get_position(place)[[0, 2]] for place in s] or None,
            tension=[float(np.linalg.norm(line.get_tension(place))) for place in s] or None,
        )  # fmt: skip
