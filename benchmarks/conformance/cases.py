"""The motion cases: inputs, the features that each isolates, and the inputs that leave one out. SI units, z up.

A line is given as ``solvers.Scene`` has it, with the periodic motion of its fairlead; a network as ``solvers.Network``,
with that of its body. Weights follow from mass, diameter, rho and g, so that a code may compute them itself.
"""

from __future__ import annotations

import copy
import math
from dataclasses import dataclass

from solvers import solve_network

from .responses import network

RHO, G = 1025.0, 9.80665
INSTANTS, FEWER_INSTANTS = 100, 50  # of the compared period: of lines, and of networks, which have many series
STEPS = 2000  # in a period, of the times at which a code is told where the fairlead is: 3 to 10 ms, as codes are
# coupled; one that moves the fairlead evenly between them then errs by less than the bound
HARD = 100.0  # times the stiffness of the seabed: what is left of a penetration is in no answer
SLIP_SPEED = 0.01  # m/s
USUAL, FINE = ((50, 200), (100, 400), (200, 800)), ((100, 400), (200, 800), (400, 1600))
COARSE = ((25, 200), (50, 400), (100, 800))
BOX, NODES, EXACT = "box scheme", "nodes and elements", "reference integrator"
"""What the second formulation is: harmonic balance of one or the other, or verification/exact on few cells."""
BILATERAL = ("slack", "snap")
"""Features whose absence is a line that bears compression."""


@dataclass(frozen=True)
class Case:
    """One case of the table.

    features: what it isolates
    levels: ((cells, steps in a period), ...) of the first formulation, each of half the lengths and steps before it
    second, harmonics: of the second formulation; of EXACT exact_cells are its cells
    laws: what a code must share to be judged; right: of the range, bound of a right answer but for the uncertainty
    """

    id: str
    title: str
    features: tuple[str, ...]
    inputs: dict
    group: str = "everyday"
    levels: tuple = USUAL
    second: str = BOX
    harmonics: int = 20
    exact_cells: int = 10
    laws: tuple[str, ...] = ()
    right: float = 0.005


def weight(mass, diameter) -> float:
    """Return the submerged weight, N/m."""
    return G * (mass - RHO * math.pi * diameter**2 / 4)


def line(
    *, anchor, fairlead, length, EA, diameter, mass, period, sin, cos=((0.0, 0.0, 0.0),), periods=6, cells=40, **changes
) -> dict:
    """Return the inputs of a moving line; changes: of what is zero, or absent, otherwise."""
    sin, cos = [list(map(float, row)) for row in sin], [list(map(float, row)) for row in cos]
    return {
        "anchor": list(anchor), "length": length, "w": weight(mass, diameter), "EA": EA, "diameter": diameter,
        "mass_per_length": mass, "Cdn": 0.0, "Cdb": changes.get("Cdn", 0.0), "Cdt": 0.0, "Ca": 0.0, "damping": 0.0,
        "rho": RHO, "g": G, "current": [0.0, 0.0, 0.0], "depth": None, "seabed_stiffness": None, "seabed_damping": 0.0,
        "friction": 0.0, "slip_speed": SLIP_SPEED, "cells": cells, "time": _clock(period, periods),
        "fairlead": {"frequency": 1 / period, "mean": list(fairlead), "cos": cos, "sin": sin, "ramp": period / 2},
    } | changes  # fmt: skip


def _clock(period, periods, instants=INSTANTS) -> dict:
    return {"dt": period / STEPS, "period": period, "periods": periods, "discard": periods - 1, "instants": instants}


# ---------------------------------------------------------------- inputs without a feature
def changed(inputs, **values) -> dict:
    """Return a copy with other values: of a network those of each element that has the key."""
    result = copy.deepcopy(inputs)
    for key, value in values.items():
        holders = result.get("elements", [result]) if key not in result else [result]
        for holder in holders:
            holder[key] = value(holder[key]) if callable(value) else value
    return result


def without_rotation(inputs) -> dict:
    """Return the inputs of a network whose body does not turn."""
    result = changed(inputs)
    for part in ("sin", "cos"):
        result["body"][part] = [[*row[:3], 0.0, 0.0, 0.0] for row in inputs["body"][part]]
    return result


def with_joints_held(inputs) -> dict:
    """Return the inputs with the free nodes fixed where they are at rest."""
    result = changed(inputs)
    for node, place in zip(result["nodes"], solve_network(network(inputs)).r.tolist(), strict=True):
        if node["kind"] == "free":
            node.update(kind="fixed", r=place)
    return result


def without_buoyancy_modules(inputs) -> dict:
    """Return the inputs with the section of the first element for all."""
    result = changed(inputs)
    for part in result["elements"]:
        part.update({key: inputs["elements"][0][key] for key in ("diameter", "mass_per_length", "w")})
    return result


def in_plane(inputs) -> dict:
    """Return the inputs with all motion and current in the plane of x and z, that of a line."""
    result = changed(inputs, current=lambda u: [u[0], 0.0, u[2]])
    rule = "body" if "body" in inputs else "fairlead"
    for part in ("sin", "cos"):
        result[rule][part] = [[row[0], 0.0, row[2], *row[3:]] for row in inputs[rule][part]]
    return result


WITHOUT = {
    "added_mass": lambda given: changed(given, Ca=0.0),
    "normal_drag": lambda given: changed(given, Cdn=0.0, Cdb=0.0),
    "tangential_drag": lambda given: changed(given, Cdt=0.0),
    "current": lambda given: changed(given, current=[0.0, 0.0, 0.0]),
    "damping": lambda given: changed(given, damping=0.0),
    "seabed_stiffness": lambda given: changed(given, seabed_stiffness=lambda k: HARD * k),
    "seabed_damping": lambda given: changed(given, seabed_damping=0.0),
    "seabed_friction": lambda given: changed(given, friction=0.0),
    "out_of_plane": in_plane,
    "body_rotation": without_rotation,
    "joints": with_joints_held,
    "buoyant": without_buoyancy_modules,
}

WATER = {"Ca": 1.0}
"""Of all sections: a cylinder across the flow."""
HOSE = {"EA": 2e7, "diameter": 0.3, "mass": 85.0} | WATER
ROPE = {"EA": 5e6, "diameter": 0.16, "mass": 24.0, "Cdn": 1.2} | WATER
POLYESTER = ROPE | {"EA": 1e7}
CHAIN = {"EA": 384.243e6, "diameter": 0.09, "mass": 77.7066, "Cdn": 1.6} | WATER
SMALL = {"EA": 6e7, "diameter": 0.05, "mass": 20.0, "Cdn": 1.6} | WATER
OC3 = {"anchor": (-853.87, 0, -320), "fairlead": (-5.2, 0, -70), "length": 902.2, "Cdt": 0.05} | CHAIN
HANGING, SHORT = {"anchor": (0, 0, -30), "fairlead": (75, 0, -5), "length": 85.0, "depth": 30.0} | SMALL, {
    "anchor": (0, 0, -20), "fairlead": (100, 0, -4), "length": 105.0, "depth": 20.0} | SMALL  # fmt: skip
MUDDY = {"EA": 6e6}  # soft, so that the explicit reference integrator takes longer steps
OBLIQUE = {"anchor": (0, 0, -120), "fairlead": (150, 0, -20)}
SEABED_LAW = "normal force (k p + c dp/dt) per unstretched length while p > 0 and it presses, p the penetration"
FRICTION_LAW = "friction mu N v / sqrt(v^2 + slip_speed^2) against the level velocity v, N the normal force"
SLACK_LAW = "tension EA (e + damping de/dt) where that is positive, else 0; no bending"


def line_cases() -> list[Case]:
    """Return the cases of single lines."""
    return [*_added_mass(), *_drag(), *_current(), *_damping(), *_seabed(), *_slack()]


def _added_mass() -> list[Case]:
    hose = {"anchor": (0, 0, -40), "fairlead": (120, 0, -10), "length": 130.0, "Cdn": 0.9} | HOSE
    buoyant = {"anchor": (0, 0, -120), "fairlead": (120, 0, -60), "length": 140.0, "EA": 5e6, "diameter": 0.3,
               "mass": 50.0, "Cdn": 0.8} | WATER  # fmt: skip
    return [
        Case("motion/added-mass-heave", "light hose, heave of 0.5 m in 8 s", ("added_mass",),
             line(**hose, period=8.0, sin=[(0, 0, 0.5)], periods=16)),
        Case("motion/added-mass-circle", "buoyant hose, ellipse of 0.5 m and 0.7 m in 8 s", ("added_mass",),
             line(**buoyant, period=8.0, sin=[(0.5, 0, 0)], cos=[(0, 0, 0.7)], periods=14)),
        Case("motion/added-mass-heave-sway", "buoyant hose, heave of 0.6 m and sway of 2 m in 7 s", ("added_mass",),
             line(**buoyant, period=7.0, sin=[(0, 0, 0.6)], cos=[(0, 2.0, 0)], periods=14), levels=FINE),
    ]  # fmt: skip


def _drag() -> list[Case]:
    steep = {"anchor": (0, 0, -250), "fairlead": (60, 0, -10), "length": 260.0, "EA": 4e7, "diameter": 0.2,
             "mass": 60.0, "Cdn": 1.0, "Cdt": 0.3} | WATER  # fmt: skip
    loop = {"anchor": (0, 0, -30), "fairlead": (40, 0, -20), "length": 220.0, "EA": 4e7, "diameter": 0.2,
            "mass": 70.0, "Cdn": 1.0, "Cdt": 0.3} | WATER  # fmt: skip
    thin = {"anchor": (0, 0, -40), "fairlead": (60, 0, -20), "length": 160.0, "EA": 4e7, "diameter": 0.15,
            "mass": 50.0, "Cdn": 1.0, "Cdt": 0.4} | WATER  # fmt: skip
    taut = {"anchor": (-200, 0, -120), "fairlead": (0, 0, -20), "length": 222.0} | POLYESTER
    return [
        Case("motion/normal-drag-surge", "suspended chain of OC3, surge of 5 m in 20 s", ("normal_drag",),
             line(**OC3, period=20.0, sin=[(5.0, 0, 0)])),
        Case("motion/normal-drag-heave", "suspended chain, heave of 3 m in 12 s", ("normal_drag",),
             line(anchor=(-400, 0, -160), fairlead=(0, 0, -20), length=450.0, **CHAIN, period=12.0, sin=[(0, 0, 3.0)])),
        Case("motion/normal-drag-seabed", "chain of OC3 on its seabed, surge of 5 m in 20 s", ("normal_drag",),
             line(**OC3, period=20.0, sin=[(5.0, 0, 0)], depth=320.0, seabed_stiffness=1e4, damping=0.01, cells=80)),
        Case("motion/sway-taut", "taut rope, sway of 8 m in 10 s", ("out_of_plane", "normal_drag"),
             line(**taut, period=10.0, sin=[(0, 8.0, 0)], cells=80)),
        Case("motion/circle-horizontal", "rope, horizontal ellipse in 12 s", ("out_of_plane", "normal_drag"),
             line(anchor=(0, 0, -120), fairlead=(125, 0, -20), length=159.5, **POLYESTER, period=12.0,
                  sin=[(0.2, 0, 0)], cos=[(0, 8.0, 0)], cells=80)),
        Case("motion/tangential-drag-heave", "steep rope, heave of 1.2 m in 8 s", ("tangential_drag",),
             line(**steep, period=8.0, sin=[(0, 0, 1.2)])),
        Case("motion/tangential-drag-loop", "hanging loop, heave of 1.5 m and surge in 10 s", ("tangential_drag",),
             line(**loop, period=10.0, sin=[(0, 0, 1.5)], cos=[(1.0, 0, 0)])),
        Case("motion/tangential-drag-thin", "hanging loop of a thin rope, heave of 1.5 m in 8 s", ("tangential_drag",),
             line(**thin, period=8.0, sin=[(0, 0, 1.5)])),
    ]  # fmt: skip


def _current() -> list[Case]:
    return [
        Case("motion/current-along", "light rope, a current of 1 m/s away from the anchor", ("current",),
             line(**OBLIQUE, length=190.0, **ROPE, period=10.0, sin=[(1.5, 0, 0)], current=[1.0, 0.0, 0.0], cells=160),
             levels=FINE),
        Case("motion/current-against", "taut rope, a current of 1.5 m/s towards the anchor", ("current",),
             line(**OBLIQUE, length=180.0, **ROPE, period=9.0, sin=[(0.5, 0, 0)], current=[-1.5, 0.0, 0.0], cells=80)),
        Case("motion/current-across", "light rope, a current of 1 m/s across it", ("current", "out_of_plane"),
             line(**OBLIQUE, length=195.0, **ROPE, period=12.0, sin=[(1.0, 1.0, 1.0)], current=[0.0, 1.0, 0.0],
                  cells=80)),
    ]  # fmt: skip


def _damping() -> list[Case]:
    steep = {"anchor": (0, 0, -150), "fairlead": (20, 0, -10), "length": 139.0, "EA": 8e6, "diameter": 0.12,
             "mass": 15.0, "Cdn": 1.2} | WATER  # fmt: skip
    return [
        Case("motion/damping-taut", "taut rope, surge of 0.8 m in 5 s", ("damping",),
             line(anchor=(-200, 0, -200), fairlead=(0, 0, -20), length=263.0, **POLYESTER, period=5.0,
                  sin=[(0.8, 0, 0)], damping=0.5)),
        Case("motion/damping-steep", "steep tether, heave of 0.8 m in 6 s", ("damping",),
             line(**steep, period=6.0, sin=[(0, 0, 0.8)], damping=0.4)),
        Case("motion/damping-two-harmonics", "taut rope, two harmonics of 10 s", ("damping",),
             line(anchor=(-200, 0, -120), fairlead=(0, 0, -20), length=220.0, **POLYESTER, period=10.0,
                  sin=[(0.6, 0, 0.3), (0, 0, 0.2)], cos=[(0, 0, 0), (0.3, 0, 0)], damping=0.5)),
    ]  # fmt: skip


def _seabed() -> list[Case]:
    laws, rough = (SEABED_LAW,), (SEABED_LAW, FRICTION_LAW)
    long = {"anchor": (0, 0, -30), "fairlead": (250, 0, -5), "length": 258.0, "depth": 30.0} | SMALL
    middle = long | {"fairlead": (200, 0, -5), "length": 208.0}
    soft = long | {"fairlead": (150, 0, -5), "length": 158.0, "EA": 2e6}
    firm = {"levels": FINE, "laws": laws}
    damped = firm | {"second": EXACT, "exact_cells": 8}
    sliding = {"levels": FINE, "second": NODES, "laws": rough}
    return [
        Case("motion/seabed-soft-heave", "chain in soft mud, heave of 1.8 m in 10 s", ("seabed_stiffness",),
             line(**HANGING, period=10.0, sin=[(0, 0, 1.8)], seabed_stiffness=80.0, cells=80), **firm),
        Case("motion/seabed-soft-surge", "chain in soft mud, surge of 1 m in 12 s", ("seabed_stiffness",),
             line(**SHORT, period=12.0, sin=[(1.0, 0, 0.3)], seabed_stiffness=100.0, cells=80), **firm),
        Case("motion/seabed-soft-circle", "chain in soft mud, circle of 1 m in 14 s", ("seabed_stiffness",),
             line(**HANGING, period=14.0, sin=[(1.0, 0, 0)], cos=[(0, 0, 1.0)], seabed_stiffness=80.0, cells=80),
             **firm),
        Case("motion/seabed-damping-heave", "chain in viscous mud, heave of 1.5 m in 8 s", ("seabed_damping",),
             line(**HANGING | MUDDY, period=8.0, sin=[(0, 0, 1.5)], seabed_stiffness=60.0, seabed_damping=1000.0,
                  cells=160),
             **damped),
        Case("motion/seabed-damping-surge", "chain in viscous mud, surge of 1 m in 8 s", ("seabed_damping",),
             line(**SHORT | MUDDY, period=8.0, sin=[(1.0, 0, 0)], seabed_stiffness=60.0, seabed_damping=1000.0,
                  cells=160),
             **damped),
        Case("motion/friction-surge", "chain on a rough seabed, surge of 1.5 m in 15 s", ("seabed_friction",),
             line(**long, period=15.0, sin=[(1.5, 0, 0)], seabed_stiffness=1000.0, friction=0.8, cells=120),
             **sliding),
        Case("motion/friction-soft-line", "soft line on a rough seabed, surge of 3 m in 20 s", ("seabed_friction",),
             line(**soft, period=20.0, sin=[(3.0, 0, 0)], seabed_stiffness=1000.0, friction=1.0, periods=12, cells=80),
             **sliding | {"levels": USUAL}),
        Case("motion/friction-two-harmonics", "chain on a rough seabed, two harmonics of 12 s", ("seabed_friction",),
             line(**middle, period=12.0, sin=[(1.5, 0, 0), (0, 0, 0.3)], cos=[(0, 0, 0.5), (0.3, 0, 0)],
                  seabed_stiffness=1000.0, friction=0.6, cells=120), **sliding),
    ]  # fmt: skip


def _slack() -> list[Case]:
    extreme = {"group": "extreme", "second": EXACT, "laws": (SLACK_LAW,), "right": 0.003, "levels": FINE}
    wire = {"anchor": (0, 0, -100), "fairlead": (60, 0, -10), "length": 112.0, "EA": 4e6, "diameter": 0.12,
            "mass": 25.0, "Cdn": 1.0, "Cdt": 0.1, "damping": 0.1} | WATER  # fmt: skip
    taut = {"anchor": (-200, 0, -120), "fairlead": (0, 0, -20), "length": 225.0, "damping": 0.1} | ROPE | {"EA": 8e6}
    return [
        Case("motion/slack-heave", "wire that goes slack and snaps, heave of 3 m in 8 s", ("slack", "snap"),
             line(**wire, period=8.0, sin=[(0, 0, 3.0)]), **extreme),
        Case("motion/slack-surge", "taut rope that goes slack and snaps, surge of 3 m in 8 s", ("slack", "snap"),
             line(**taut, period=8.0, sin=[(3.0, 0, 0)], periods=8), **extreme),
        Case("motion/slack-chain", "chain of OC3 that goes slack, surge of 13 m in 20 s", ("slack", "snap"),
             line(**OC3, period=20.0, sin=[(13.0, 0, 0)], damping=0.05), **extreme | {"exact_cells": 14}),
    ]  # fmt: skip


# ---------------------------------------------------------------- networks
def node(kind, r, mass=0.0, volume=0.0, force=(0.0, 0.0, 0.0), CdA=0.0, Ca=0.0) -> dict:
    """Return a node of a network."""
    place, load = list(map(float, r)), list(map(float, force))
    return {"kind": kind, "r": place, "mass": mass, "volume": volume, "force": load, "CdA": CdA, "Ca": Ca}


def element(L, ends, EA, diameter, mass, Cdn=1.2, Cdt=0.0, Ca=1.0, damping=0.0) -> dict:
    """Return an element of a network."""
    return {
        "w": weight(mass, diameter), "EA": EA, "L": float(L), "ends": list(ends), "friction": 0.0,
        "diameter": diameter, "mass_per_length": mass, "Cdn": Cdn, "Cdb": Cdn, "Cdt": Cdt, "Ca": Ca,
        "damping": damping,
    }  # fmt: skip


def moving(nodes, elements, period, sin, cos=((0.0,) * 6,), reference=(0, 0, 0), periods=6, cells=40) -> dict:
    """Return the inputs of a network on a moving body."""
    rows = {"sin": [list(map(float, row)) for row in sin], "cos": [list(map(float, row)) for row in cos]}
    body = {"reference": list(map(float, reference)), "frequency": 1 / period, "ramp": period / 2} | rows
    return {
        "nodes": nodes, "elements": elements, "rho": RHO, "g": G, "current": [0.0, 0.0, 0.0], "depth": None,
        "seabed_stiffness": None, "seabed_damping": 0.0, "slip_speed": SLIP_SPEED, "cells": cells,
        "time": _clock(period, periods, FEWER_INSTANTS), "body": body,
    }  # fmt: skip


LIGHT = {"EA": 1.2e8, "diameter": 0.08, "mass": 40.0}
SOFT = {"EA": 1e7, "diameter": 0.16, "mass": 26.0}


def _star(length) -> tuple[list, list]:
    """Return three suspended lines at 120 degrees, from a body of 20 m radius."""
    nodes, elements = [], []
    for i in range(3):
        c, s = math.cos(2 * math.pi * i / 3), math.sin(2 * math.pi * i / 3)
        nodes += [node("fixed", (300 * c, 300 * s, -120)), node("coupled", (20 * c, 20 * s, -14))]
        elements.append(element(length, (2 * i, 2 * i + 1), **LIGHT))
    return nodes, elements


def network_cases() -> list[Case]:
    """Return the cases of networks."""
    solved = {"second": NODES, "harmonics": 15}
    return [
        Case("motion/yaw", "three lines, yaw of 0.25 rad in 10 s", ("body_rotation",),
             moving(*_star(310), 10.0, [(0, 0, 0, 0, 0, 0.25)], periods=5), **solved),
        Case("motion/roll-pitch", "three lines, pitch of 0.12 and roll of 0.08 rad in 12 s", ("body_rotation",),
             moving(*_star(306), 12.0, [(0, 0, 0, 0, 0.12, 0)], [(0, 0, 0, 0.08, 0, 0)], periods=5), **solved),
        Case("motion/six-degrees", "three lines, a body that moves in all ways in 14 s", ("body_rotation",),
             moving(*_star(308), 14.0, [(1.0, 0, 0, 0, 0.08, 0)], [(0, 0.5, 0.5, 0, 0, 0.15)], (0, 0, -5), 5),
             **solved),
        _bridle(solved), _clump(solved), _buoy(solved), _lazy_wave(solved), _hanging_load(),
    ]  # fmt: skip


def _bridle(solved) -> Case:
    nodes = [node("fixed", (-300, 0, -120)), node("free", (-50, 0, -40), mass=4000.0, volume=0.5, CdA=2.0, Ca=1.0),
             node("coupled", (-10, 12, -14)), node("coupled", (-10, -12, -14))]  # fmt: skip
    elements = [element(264, (0, 1), **LIGHT), element(50, (1, 2), **LIGHT), element(50, (1, 3), **LIGHT)]
    rows = [(2.0, 0, 0, 0, 0, 0)], [(0, 1.0, 0, 0, 0, 0.15)]
    inputs = moving(nodes, elements, 10.0, *rows)
    return Case("motion/bridle", "a bridle of two legs, surge, sway and yaw in 10 s", ("joints",), inputs, **solved)


def _clump(solved) -> Case:
    nodes = [node("fixed", (-300, 0, -120)), node("free", (-150, 0, -100), mass=20000.0, volume=3.0, CdA=4.0, Ca=1.0),
             node("coupled", (0, 0, -14))]  # fmt: skip
    elements = [element(155, (0, 1), **LIGHT), element(170, (1, 2), **LIGHT)]
    inputs = moving(nodes, elements, 9.0, [(0, 0, 1.5, 0, 0, 0)], periods=10)
    return Case("motion/clump", "a line with a clump weight, heave of 1.5 m in 9 s", ("joints",), inputs, **solved)


def _buoy(solved) -> Case:
    nodes = [node("fixed", (-200, 0, -120)), node("free", (-100, 0, -60), mass=3000.0, volume=12.0, CdA=8.0, Ca=1.0),
             node("coupled", (0, 0, -14))]  # fmt: skip
    elements = [element(130, (0, 1), **SOFT), element(115, (1, 2), **SOFT)]
    inputs = moving(nodes, elements, 9.0, [(1.0, 0, 1.0, 0, 0, 0)], periods=8)
    return Case(
        "motion/buoy", "a line with a submerged buoy, surge and heave of 1 m in 9 s", ("joints",), inputs, **solved
    )


def _lazy_wave(solved) -> Case:
    nodes = [node("fixed", (-150, 0, -120)), node("free", (-100, 0, -80)), node("free", (-60, 0, -80)),
             node("coupled", (0, 0, -14))]  # fmt: skip
    pipe = {"EA": 5e7, "diameter": 0.2, "mass": 60.0, "Cdn": 1.0}
    elements = [element(80, (0, 1), **pipe), element(60, (1, 2), **pipe | {"diameter": 0.4, "mass": 90.0}),
                element(110, (2, 3), **pipe)]  # fmt: skip
    inputs = moving(nodes, elements, 10.0, [(1.0, 0, 1.0, 0, 0, 0)], periods=8, cells=60)
    return Case("motion/lazy-wave", "a line with a buoyant section, surge and heave of 1 m in 10 s", ("buoyant",),
                inputs,
                levels=((100, 200), (200, 400), (400, 800)), **solved)  # fmt: skip


def _hanging_load() -> Case:
    nodes = [node("coupled", (0, 0, -10)), node("free", (0, 0, -110), mass=30000.0, volume=10.0, CdA=40.0, Ca=0.5)]
    rope = element(100, (1, 0), EA=1e7, diameter=0.06, mass=4.0, Cdn=1.0, damping=0.02)
    inputs = moving(nodes, [rope], 6.0, [(0, 0, 3.0, 0, 0, 0)], periods=8, cells=8)
    return Case("motion/hanging-load", "a load on a rope that goes slack and snaps, heave of 3 m in 6 s",
                ("slack", "snap"), inputs, group="extreme", levels=((4, 400), (8, 800), (16, 1600)), second=EXACT,
                exact_cells=4, laws=(SLACK_LAW,))  # fmt: skip


def all_cases() -> list[Case]:
    """Return the cases of the table, in its order."""
    return [*line_cases(), *network_cases()]
