"""Conformance cases of networks at rest, and what typical mistakes make of them: conformance/network.json.

Truth is the oracle's to 24 digits, kept as doubles. The oracle needs a start near the equilibrium: `Case.start` gives
it; what a solver is given as a guess is coarse. A mistaken network is solved from the true one, in steps if need be.
"""

import math
from dataclasses import dataclass, field, replace

from mpmath import mp, mpf

from reference_data.generate import conformance_common as common
from reference_data.generate.conformance_common import Section, as_doubles, namespace
from verification.exact.cable import catenary_mp
from verification.exact.network import network_mp

PATH = "conformance/network.json"
SOURCES = (common, catenary_mp, network_mp)
DIGITS = 24
STEPS = (1, 8)
"""Steps from the true network to a mistaken one: at once, then in eight."""
STIFF = 1e6
"""Factor on EA that stands for lines that do not stretch."""
LIFT = 0.5
"""m: where a node that would leave the seabed starts again."""
NUDGE = 1e-3
"""Of the length of a line: how far a code that cannot do a vertical line moves its end aside."""
UNITS = {
    "rho": "kg/m^3",
    "g": "m/s^2",
    "depth": "m, null: no seabed",
    "nodes": "r m, mass kg, volume m^3, force N; r of a free node is a guess",
    "elements": "w N/m, EA N, L m, ends (anchor node, fairlead node), friction 1, mass_per_length kg/m, diameter m; "
    "friction acts where the anchor node lies on the seabed",
    "body": "the coupled nodes as one rigid body: their numbers, and the point about which it turns, m",
    "r": "m, of all nodes",
    "tension": "N, at the anchor end and the fairlead end of every element",
    "stiffness": "6 x 6, -d(force, moment on the body)/d(translation, rotation): N/m, N, N m; radians",
}
MISTAKES = common.COMMON_MISTAKES | {
    "point_mass_ignored": "The masses of nodes have no weight.",
    "volume_ignored": "The volumes of nodes have no buoyancy.",
    "mass_for_weight": "Masses and displaced masses of nodes, in kg, are taken for their weight in N.",
    "node_force_sign": "External forces on nodes act the other way.",
    "anchors_on_seabed": "Raised anchors stand on the seabed.",
    "joints_not_moved": "Free nodes stay where they were guessed.",
    "horizontal_for_tension": "The horizontal component is given for the tension.",
    "stiffness_per_degree": "Rotations of the stiffness are in degrees.",
    "stiffness_about_origin": "The body turns about the origin, not about its reference point.",
    "stiffness_of_held_joints": "Free nodes do not follow when the body is moved for the stiffness.",
    "moments_of_translations": "The moment of the mean forces about the turned arms is left out of the stiffness.",
}


@dataclass(frozen=True)
class Node:
    """Inputs of a node: r m, mass kg, volume m^3, force N; r of a free one is a guess."""

    kind: str
    r: tuple
    mass: float = 0.0
    volume: float = 0.0
    force: tuple = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Line:
    """Section, unstretched length m, (anchor node, fairlead node), friction."""

    section: Section
    L: float
    ends: tuple
    friction: float = 0.0


@dataclass(frozen=True)
class Case:
    """One network; start: places of the free nodes near the equilibrium, in their order, m."""

    name: str
    group: str
    title: str
    features: tuple
    depth: float | None
    nodes: tuple
    lines: tuple
    start: tuple = ()
    reference: tuple = (0.0, 0.0, 0.0)
    rho: float = field(default=common.SEA_WATER)

    @property
    def body(self):
        """Numbers of the coupled nodes."""
        return [i for i, node in enumerate(self.nodes) if node.kind == "coupled"]

    def physics(self):
        """Return the network as the oracle takes it."""
        return namespace(
            nodes=tuple(self.nodes),
            elements=tuple(
                namespace(w=line.section.weight(), EA=line.section.EA, L=line.L, ends=line.ends, friction=line.friction)
                for line in self.lines
            ),
            environment=namespace(rho=self.rho, g=common.GRAVITY, depth=self.depth),
        )

    def inputs(self):
        """Return what a solver is given."""
        elements = [
            {**vars(element), "ends": list(element.ends)}
            | {"mass_per_length": line.section.mass, "diameter": line.section.diameter}
            for element, line in zip(self.physics().elements, self.lines, strict=True)
        ]
        nodes = [{**vars(node), "r": list(node.r), "force": list(node.force)} for node in self.nodes]
        body = {"nodes": self.body, "reference": list(self.reference)} if self.body else None
        head = {"rho": self.rho, "g": common.GRAVITY, "depth": self.depth}
        return head | {"nodes": nodes, "elements": elements, "body": body}


def _polar(radius, degrees, z):
    """Return a point of a circle to the millimetre."""
    turn = math.radians(degrees)
    return round(radius * math.cos(turn), 3), round(radius * math.sin(turn), 3), z


def _moved(r, offset):
    return tuple(round(a + b, 3) for a, b in zip(r, offset, strict=True))


def _fixed(*r):
    return Node("fixed", tuple(map(float, r)))


def _coupled(*r):
    return Node("coupled", tuple(map(float, r)))


def _free(*r, **loads):
    return Node("free", tuple(map(float, r)), **loads)


def _spread(radius, fairlead, depth, fairlead_z, section, L, angles, friction=0.0, offset=(0.0, 0.0, 0.0)):
    """Return nodes and lines of a body with one line at each angle."""
    anchors = [_fixed(*_polar(radius, angle, -depth)) for angle in angles]
    ends = [_coupled(*_moved(_polar(fairlead, angle, fairlead_z), offset)) for angle in angles]
    lines = [Line(section, L, (i, len(angles) + i), friction) for i in range(len(angles))]
    return tuple(anchors + ends), tuple(lines)


def _three_bridles(friction):
    depth, turns = 320.0, (0, 120, 240)
    nodes = (
        *(_fixed(*_polar(853.87, turn, -depth)) for turn in turns),
        *(_free(*_polar(55.0, turn, -90.0)) for turn in turns),
        *(_coupled(*_moved(_polar(5.2, turn + 60, -70.0), (4.0, 2.0, 0.0))) for turn in turns),
    )
    lower = [Line(common.OC3_CHAIN, 857.0, (i, 3 + i), friction) for i in range(3)]
    legs = [Line(common.OC3_CHAIN, 51.0, (3 + i, 6 + j)) for i in range(3) for j in (i, (i + 2) % 3)]
    return nodes, (*lower, *legs)


def design():
    """Return all cases, in the order of the table."""
    return [*_bodies(), *_joints(), *_extreme()]


def _case(name, title, features, depth, nodes, lines, group="everyday", **options):
    return Case(f"network/{name}", group, title, tuple(features.split()), depth, tuple(nodes), tuple(lines), **options)


def _bodies():
    """Bodies on lines without joints."""
    oc3, polyester, c84, c140 = common.OC3_CHAIN, common.POLYESTER, common.CHAIN_84, common.CHAIN_140
    three, four = (0, 120, 240), (45, 135, 225, 315)
    yield _case("oc3", "OC3 Hywind, three lines", "contact elastic", 320.0,
                *_spread(853.87, 5.2, 320.0, -70.0, oc3, 902.2, three))  # fmt: skip
    yield _case("oc3-offset", "OC3 Hywind, 12 m out, friction 0.7", "contact friction", 320.0,
                *_spread(853.87, 5.2, 320.0, -70.0, oc3, 902.2, three, 0.7, (-9.0, 8.0, 0.5)),
                reference=(-9.0, 8.0, -10.0))  # fmt: skip
    yield _case("semi-lee", "semi-submersible pushed 95 m: its lee line hangs slack", "slack contact friction", 200.0,
                *_spread(760.0, 40.0, 200.0, -14.0, c140, 815.0, three, 0.6, (95.0, 0.0, 0.0)),
                reference=(95.0, 0.0, 0.0))  # fmt: skip
    yield _case("polyester", "platform on four taut polyester lines, 10 m out", "taut elastic", 2000.0,
                *_spread(1640.0, 40.0, 2000.0, -20.0, polyester, 2540.0, four, 0.0, (10.0, 0.0, 0.0)),
                reference=(10.0, 0.0, 0.0))  # fmt: skip
    nodes, lines = _spread(395.0, 10.0, 100.0, -10.0, c84, 410.0, three)
    heights = (4.0, 9.0, 15.0)  # of the anchors above the flat seabed, as on a slope
    raised = [replace(node, r=_moved(node.r, (0.0, 0.0, h))) for node, h in zip(nodes[:3], heights, strict=True)]
    yield _case("raised-anchors", "three lines from blocks 4, 9 and 15 m high", "clearance contact", 100.0,
                [*raised, *nodes[3:]], lines)  # fmt: skip
    nodes, lines = _spread(30.0, 30.0, 480.0, 1.1, common.TETHER, 480.0, three)
    yield _case("tethers", "tension-leg platform on three tethers", "vertical taut elastic", 480.0, nodes, lines)


def _joints():
    """Networks with free nodes."""
    oc3, wire, c84, c140 = common.OC3_CHAIN, common.WIRE, common.CHAIN_84, common.CHAIN_140
    paper = Section(23.107, 0.14566, 2.34e8)
    yield _case("two-line-buoy", "two lines that hold a buoy, 350 m", "joints", 350.0,
                (_fixed(-1200, 0, -350), _fixed(0, 0, -350), _free(-20, 0, -80, force=(0.0, 0.0, 637.65e3))),
                (Line(paper, 1175.0, (0, 2)), Line(paper, 300.0, (1, 2))), start=((-71.97, 0.0, -58.0),))  # fmt: skip
    yield _case("bridle", "line and two legs, a buoy at the joint", "joints elastic", None,
                (_fixed(-400, 30, -200), _free(-55, 5, -70, mass=500.0, volume=2.0), _coupled(-5, 8, -20),
                 _coupled(-5, -9, -22)),
                (Line(wire, 385.0, (0, 1)), Line(wire, 61.0, (1, 2)), Line(wire, 62.0, (1, 3))),
                reference=(0.0, 0.0, -10.0), start=((-51.061, 6.776, -59.957),))  # fmt: skip
    yield _case("three-bridles", "three lines on the seabed, two legs each", "joints contact friction", 320.0,
                *_three_bridles(0.8), reference=(4.0, 2.0, 0.0), start=(
                    (45.819, 1.985, -102.351), (-17.566, 39.285, -100.781), (-18.043, -36.141, -99.461)))  # fmt: skip
    clump = (_fixed(-300, 40, -100), _free(-130, 18, -100, mass=3e4, volume=4.0), _coupled(-4, 7, -20),
             _coupled(-3, -6, -22))  # fmt: skip
    yield _case("clump", "clump weight that rests on the seabed, friction 0.6 behind it", "joints contact friction",
                100.0, clump,
                (Line(replace(c84, EA=2e6), 172.0, (0, 1), 0.6), Line(wire, 152.0, (1, 2)), Line(wire, 151.5, (1, 3))),
                reference=(0.0, 0.0, -5.0), start=((-127.684, 16.573, -100.0),))  # fmt: skip
    yield _case("clump-hanging", "clump weight that hangs in a chain", "joints contact friction", 120.0,
                (_fixed(0, 0, -120), _free(230, 3, -60, mass=2e4, volume=2.5), _coupled(320, 10, -12)),
                (Line(c84, 260.0, (0, 1), 0.5), Line(c84, 100.0, (1, 2))), reference=(325.0, 10.0, 0.0),
                start=((255.007, 7.969, -87.963),))  # fmt: skip
    yield _case("buoy", "chain, buoy of 12 t, wire", "joints contact", 200.0,
                (_fixed(0, 0, -200), _free(280, 0, -90, mass=4e3, volume=15.6), _coupled(420, 20, -8)),
                (Line(c84, 380.0, (0, 1)), Line(wire, 185.0, (1, 2))), reference=(430.0, 20.0, 0.0),
                start=((313.272, 14.918, -116.533),))  # fmt: skip
    chain_wire = (Line(c140, 200.0, (0, 1), 0.6), Line(wire, 220.0, (1, 2)), Line(c140, 60.0, (2, 3)))
    yield _case("chain-wire-chain", "ground chain, wire, upper chain; a joint on the seabed, friction 0.6",
                "joints contact friction", 100.0,
                (_fixed(0, 0, -100), _free(199, 2, -100, mass=100.0), _free(390, 8, -30), _coupled(440, 10, -10)),
                chain_wire, reference=(450.0, 10.0, 0.0),
                start=((199.949, 4.544, -100.0), (412.853, 9.383, -62.065)))  # fmt: skip
    yield _case("chain-wire-chain-out", "the same, 20 m out: the joint is lifted", "joints contact friction", 100.0,
                (_fixed(0, 0, -100), _free(195, 4, -90, mass=100.0), _free(400, 9, -30), _coupled(462, 10, -10)),
                chain_wire, reference=(472.0, 10.0, 0.0),
                start=((199.902, 4.327, -98.772), (412.585, 8.93, -43.131)))  # fmt: skip
    yield _case("chain-fibre", "ground chain and buoyant HMPE rope", "joints buoyant contact", 300.0,
                (_fixed(0, 0, -300), _free(180, 0, -285), _coupled(700, 30, -15)),
                (Line(oc3, 220.0, (0, 1), 0.5), Line(common.HMPE, 560.0, (1, 2))),
                reference=(700.0, 30.0, 0.0), start=((219.214, 9.395, -297.533),))  # fmt: skip
    yield _case("floating-hose", "floating rope and hose between a pile and a body", "joints buoyant", None,
                (_fixed(0, 0, -5), _free(60, 4, -15), _coupled(150, 10, -12)),
                (Line(common.POLYPROPYLENE, 80.0, (0, 1)), Line(common.HOSE, 120.0, (1, 2))),
                start=((61.373, 4.092, -56.454),))  # fmt: skip


def _extreme():
    """Networks that are harder to solve than what is built."""
    wire, rubber = common.WIRE, common.RUBBER
    yield _case("hanging-mass", "mass at the end of a vertical wire", "joints", None,
                (_fixed(3, -2, -5), _free(6, 0, -50, mass=2000.0, volume=0.5)), (Line(wire, 50.0, (1, 0)),),
                group="extreme", start=((3.0, -2.0, -55.003),))  # fmt: skip
    yield _case("rubber-v", "two rubber lines and a load that stretches them threefold", "joints elastic taut", None,
                (_fixed(-50, 0, 0), _fixed(50, 0, 0), _free(3, 1, -60, force=(50.0, 100.0, -900.0))),
                (Line(rubber, 40.0, (0, 2)), Line(rubber, 45.0, (1, 2))), group="extreme",
                start=((-0.467, 8.499, -101.057),))  # fmt: skip


# --- answers of the oracle --------------------------------------------------------------------------------------------


def equilibrium(physics, start):
    """Return the state of a network from positions of all nodes; a node may leave the seabed or come to rest on it."""
    start = [[float(c) for c in r] for r in start]
    for _ in range(3):
        try:
            return network_mp.solve(physics, start, digits=DIGITS)
        except ArithmeticError as error:
            bottom = physics.environment.depth and -physics.environment.depth
            if "would leave" not in str(error) and "would sink" not in str(error):
                raise
            node = int(str(error).split()[1]) if "would leave" in str(error) else None
            for i, r in enumerate(start):
                if physics.nodes[i].kind == "free" and node is None and r[2] < bottom + 5 * LIFT:
                    r[2] = bottom
                elif i == node:
                    r[2] = bottom + LIFT
    raise ArithmeticError("a node keeps changing between seabed and water")


def answer(case, physics, state):
    """Return the quantities of a solved network, stiffness last and only if there is a body."""
    result = {"r": state.r, "tension": _tensions(state)}
    if case.body:
        result["stiffness"] = network_mp.body_stiffness(physics, state, case.reference)[0]
    return result


def _tensions(state):
    forces = zip(state.H, state.V, state.H_anchor, state.V_anchor, strict=True)
    return [[mp.hypot(HA, VA), mp.hypot(H, V)] for H, V, HA, VA in forces]


def true_state(case):
    """Return the oracle's state of a case."""
    places = iter(case.start or [node.r for node in case.nodes if node.kind == "free"])
    return equilibrium(case.physics(), [next(places) if node.kind == "free" else node.r for node in case.nodes])


def scales(case, truth):
    """Return quantity -> size by which its error is divided; of the stiffness one for each of its blocks."""
    sizes = {"r": max(line.L for line in case.lines), "tension": max(t for row in truth["tension"] for t in row)}
    if "stiffness" in truth:
        K = truth["stiffness"]
        along, turning = (max(abs(K[i][j]) for i in rows for j in rows) for rows in (range(3), range(3, 6)))
        mixed = max(math.sqrt(along * turning), max(abs(K[i][j]) for i in range(3) for j in range(3, 6)))
        sizes["stiffness"] = [[along] * 3 + [mixed] * 3] * 3 + [[mixed] * 3 + [turning] * 3] * 3
    return sizes


# --- mistakes and features left out -----------------------------------------------------------------------------------


def changed_physics(case, **changes):
    """Return the network with w, EA, friction (a value a line), or rho, g, depth, nodes of its environment changed."""
    physics = case.physics()
    for name in ("w", "EA", "friction"):
        for element, value in zip(physics.elements, changes.get(name, ()), strict=name in changes):
            setattr(element, name, value)
    for name in ("rho", "g", "depth"):
        if name in changes:
            setattr(physics.environment, name, changes[name])
    physics.nodes = tuple(changes.get("nodes", physics.nodes))
    return physics


def blend(a, b, t):
    """Return the network a fraction t of the way from a to b, EA in equal factors."""
    mix = lambda p, q: p + (q - p) * t
    vector = lambda p, q: tuple(map(mix, p, q))
    nodes = []
    for p, q in zip(a.nodes, b.nodes, strict=True):
        loads = {name: mix(getattr(p, name), getattr(q, name)) for name in ("mass", "volume")}
        nodes.append(replace(q, r=vector(p.r, q.r), force=vector(p.force, q.force), **loads))
    elements = []
    for p, q in zip(a.elements, b.elements, strict=True):
        mixed = {name: mix(getattr(p, name), getattr(q, name)) for name in ("w", "friction")}
        elements.append(namespace(EA=p.EA * (q.EA / p.EA) ** t, L=q.L, ends=q.ends, **mixed))
    p, q = a.environment, b.environment
    environment = namespace(rho=mix(p.rho, q.rho), g=mix(p.g, q.g), depth=q.depth)
    return namespace(nodes=nodes, elements=elements, environment=environment)


def mistaken_state(case, physics, state):
    """Return the state of a mistaken network, reached from the true one; None where there is none to be had."""
    for count in STEPS:
        try:
            r = state.r
            for step in range(1, count + 1):
                target = blend(case.physics(), physics, step / count) if step < count else physics
                places = [place if node.kind == "free" else node.r for node, place in zip(target.nodes, r, strict=True)]
                solved = equilibrium(target, places)
                r = solved.r
            return solved
        except (ArithmeticError, ValueError):
            continue
    return None


def _each(case, change):
    """Return a value a line."""
    return [change(line) for line in case.lines]


def mistaken_networks(case):
    """Return mistake -> mistaken network, of mistakes that are made with the inputs."""
    nodes, results = case.nodes, {}
    for name in ("weight_in_air", "g_9_81", "radius_for_diameter", "rho_1000", "nominal_diameter"):
        weights = _each(case, lambda line, name=name: line.section.mistaken_weights().get(name, line.section.weight()))
        changes = {"g_9_81": {"g": common.GRAVITY_ROUNDED}, "rho_1000": {"rho": common.FRESH_WATER}}
        results[name] = changed_physics(case, w=weights, **changes.get(name, {}))
    results["friction_ignored"] = changed_physics(case, friction=_each(case, lambda line: 0.0))
    results["elasticity_ignored"] = changed_physics(case, EA=_each(case, lambda line: STIFF * line.section.EA))
    results["EA_per_area"] = changed_physics(case, EA=_each(case, lambda line: line.section.EA / line.section.area))
    if case.depth is not None:
        results["seabed_ignored"] = changed_physics(case, depth=None)
        results["anchors_on_seabed"] = changed_physics(case, nodes=_lowered(case))
    changed_nodes = {
        "point_mass_ignored": [replace(node, mass=0.0) for node in nodes],
        "volume_ignored": [replace(node, volume=0.0) for node in nodes],
        "mass_for_weight": [
            replace(node, mass=node.mass / common.GRAVITY, volume=node.volume / common.GRAVITY) for node in nodes
        ],
        "node_force_sign": [replace(node, force=tuple(-f for f in node.force)) for node in nodes],
        "joints_not_moved": _held(case),
    }
    results |= {name: changed_physics(case, nodes=changed) for name, changed in changed_nodes.items()}
    true = case.physics()
    return {name: physics for name, physics in results.items() if physics != true}


def _lowered(case):
    """Return the nodes with every fixed one on the seabed."""
    return [replace(n, r=(*n.r[:2], -case.depth)) if n.kind == "fixed" else n for n in case.nodes]


def _held(case):
    """Return the nodes with every free one held at its guess."""
    return [replace(node, kind="fixed") if node.kind == "free" else node for node in case.nodes]


def mistaken_outputs(case, physics, state, truth):
    """Return mistake -> the changed quantities, of mistakes that are made with the results."""
    horizontal = [[HA, H] for HA, H in zip(state.H_anchor, state.H, strict=True)]
    results = {
        "kN_for_N": {"tension": _times(truth["tension"], mpf(1) / 1000)},
        "kgf_for_N": {"tension": _times(truth["tension"], 1 / mpf(common.NEWTON_PER_KGF))},
        "ends_swapped": {"tension": [[b, a] for a, b in truth["tension"]]},
        "anchor_force_for_fairlead": {"tension": [[a, a] for a, _ in truth["tension"]]},
        "horizontal_for_tension": {"tension": horizontal},
    }
    if not case.body:
        return results
    K, held = network_mp.body_stiffness(physics, state, case.reference)
    degrees = mp.diag([1, 1, 1, mp.pi / 180, mp.pi / 180, mp.pi / 180])
    arms = [[c - mpf(o) for c, o in zip(state.r[i], case.reference, strict=True)] for i in case.body]
    turned = mp.matrix(K)
    for arm, i in zip(arms, case.body, strict=True):
        part = network_mp._cross(state.force[i]) * network_mp._cross(arm)
        for row in range(3):
            for column in range(3):
                turned[3 + row, 3 + column] += part[row, column]
    results["kN_for_N"]["stiffness"] = K / 1000
    results["kgf_for_N"]["stiffness"] = K / mpf(common.NEWTON_PER_KGF)
    return results | {
        "stiffness_sign": {"stiffness": -K},
        "stiffness_per_degree": {"stiffness": K * degrees},
        "stiffness_about_origin": {"stiffness": network_mp.body_stiffness(physics, state, (0.0, 0.0, 0.0))[0]},
        "stiffness_of_held_joints": {"stiffness": held},
        "moments_of_translations": {"stiffness": turned},
    }


def _times(rows, factor):
    return [[factor * value for value in row] for row in rows]


def leave_out(feature, case, state):
    """Return the answer without a feature."""
    changes = {
        "friction": lambda: {"friction": _each(case, lambda line: 0.0)},
        "contact": lambda: {"depth": None},
        "slack": lambda: {"depth": None},
        "elastic": lambda: {"EA": _each(case, lambda line: STIFF * line.section.EA)},
        "taut": lambda: {"w": _each(case, lambda line: 0.0)},
        "buoyant": lambda: {"w": _each(case, lambda line: abs(line.section.weight()))},
        "clearance": lambda: {"nodes": _lowered(case)},
        "joints": lambda: {"nodes": _held(case)},
        "vertical": lambda: {"nodes": _aside(case)},
    }
    physics = changed_physics(case, **changes[feature]())
    return answer(case, physics, mistaken_state(case, physics, state))


def _aside(case):
    """Return the nodes with the coupled ones moved aside."""
    step = NUDGE * case.lines[0].L
    return [replace(node, r=_moved(node.r, (step, 0, 0))) if node.kind == "coupled" else node for node in case.nodes]


def compute(case):
    """Return {"name", "text"} of a case: its line of JSON."""
    physics, state = case.physics(), true_state(case)
    exact = answer(case, physics, state)
    truth = {name: as_doubles(value) for name, value in exact.items()}
    scale = scales(case, truth)
    bound = {name: list(common.STIFFNESS_BOUND if name == "stiffness" else common.BOUND) for name in truth}

    def changed(result):
        return common.changed_quantities(result, truth, scale, bound)

    found = {name: changed(result) for name, result in mistaken_outputs(case, physics, state, exact).items()}
    for name, mistaken in mistaken_networks(case).items():
        solved = mistaken_state(case, mistaken, state)
        found[name] = changed(answer(case, mistaken, solved)) if solved else {}
    row = {
        "id": case.name,
        "group": case.group,
        "title": case.title,
        "features": list(case.features),
        "inputs": case.inputs(),
        "truth": truth,
        "scale": scale,
        "uncertainty": dict.fromkeys(truth, common.UNCERTAINTY),
        "bound": bound,
        "mistakes": {name: found[name] for name in MISTAKES if found.get(name)},
        "without": {feature: changed(leave_out(feature, case, state)) for feature in case.features},
    }
    return {"name": case.name, "text": common.one_line(row)}


def render(rows):
    """Return the text of the table from name -> row."""
    lines = [rows[case.name]["text"] for case in design() if case.name in rows]
    return common.table_text("network", UNITS, MISTAKES, lines)
