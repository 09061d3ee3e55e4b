"""MoorPy on networks: moorpy.System, its solver of points and lines.

Its adapter is in moorpy.py; benchmarks.network.paired_timing uses the parts here, to move the points of one system.
``build`` takes a network with ``nodes``, ``elements`` and ``environment`` as solvers.Network has them.

What to mind: solveEquilibrium(tol) is a distance in m, 0.05 by default, and its catenaries are solved to 0.01 tol, so
stiff short lines leave large forces unbalanced. staticSolve sets cb to minus the height of end A: seabed
friction is lost, compare only networks without it.
"""

from __future__ import annotations

import os
import warnings

import numpy as np

os.environ["PYTHONBREAKPOINT"] = "0"  # its error paths call breakpoint(): they must not stop a run
os.environ.setdefault("MPLBACKEND", "Agg")  # it imports pyplot

import moorpy

from verification.conformance.adapter import NetworkAnswer

TYPES = {"free": 0, "fixed": 1, "coupled": -1}
NO_SEABED = 1e6  # m: depth of a seabed that is not there

DEFAULT = 0.05
TIGHT = 1e-6
"""Tolerances in m: MoorPy's own default, and one that brings its force balance near that of this project."""


def build(network) -> moorpy.System:
    """The network as a System: points and lines in the order of its nodes and elements, numbered from 1."""
    environment = network.environment
    depth = NO_SEABED if environment.depth is None else environment.depth
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        system = moorpy.System(depth=depth, rho=environment.rho, g=environment.g)
    for node in network.nodes:
        system.addPoint(TYPES[node.kind], node.r, m=node.mass, v=node.volume, fExt=np.array(node.force))
    for i, element in enumerate(network.elements):
        diameter = 0.1  # only w counts in statics; it wants a diameter and a mass
        mass = element.w / environment.g + environment.rho * np.pi * diameter**2 / 4
        kind = {"name": str(i), "d_vol": diameter, "m": mass, "w": element.w, "EA": element.EA}
        system.lineTypes[str(i)] = kind | {"d_nom": diameter, "material": "", "cost": 0.0}
        first, last = element.ends
        system.addLine(element.L, str(i), pointA=first + 1, pointB=last + 1)
    system.initialize()
    return system


def complete_answer(network, system, tension) -> NetworkAnswer:
    """Return positions and, of the body that carries the coupled points, its analytic stiffness beside the tensions."""
    r = positions(system)
    if network.body is None:
        return NetworkAnswer(tension, r)
    body = system.addBody(TYPES["coupled"], np.array([*network.body.reference, 0.0, 0.0, 0.0]))
    for i in network.body.nodes:
        body.attachPoint(i + 1, r[i] - network.body.reference)
        system.pointList[i].type = TYPES["fixed"]  # what it calls a point that is attached
    return NetworkAnswer(tension, r, system.getCoupledStiffnessA(lines_only=True))


def place(system, positions) -> None:
    """Move the coupled points to positions (c, 3), m."""
    coupled = [point for point in system.pointList if point.type == TYPES["coupled"]]
    for point, r in zip(coupled, positions, strict=True):
        point.setPosition(np.array(r, dtype=float))


def solve(system, tolerance: float = DEFAULT):
    """Equilibrium from where the points are now, from the line forces of the last solve."""
    return system.solveEquilibrium(tol=tolerance)


def positions(system) -> np.ndarray:
    """(n, 3), m."""
    return np.array([point.r for point in system.pointList])


def tensions(system) -> np.ndarray:
    """(e, 2) at the anchor and fairlead ends, N."""
    return np.array([[line.TA, line.TB] for line in system.lineList])


def unbalanced(system) -> float:
    """Largest force that its own line forces leave on a free point, N; on the seabed an upward reaction is none."""
    worst = 0.0
    for point in system.pointList:
        if point.type == TYPES["free"]:
            force = np.array(point.getForces(xyz=True))
            if point.r[2] <= -system.depth and force[2] < 0:
                force[2] = 0.0
            worst = max(worst, float(np.abs(force).max()))
    return worst
