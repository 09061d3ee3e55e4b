"""Conformance cases of one line at rest, and what typical mistakes make of them: conformance/statics.json.

Truth is the oracle's to 30 digits, kept as doubles. A mistake is the oracle's answer to mistaken inputs, or its answer
given out wrongly; where friction acts with the wrong sign or without a limit, the stretch of the grounded part is that
of the mistaken tension.
"""

import math
from dataclasses import dataclass, replace

from mpmath import mp, mpf

from reference_data.generate import conformance_common as common
from reference_data.generate.conformance_common import Section, as_doubles
from verification.exact.cable import catenary_mp

PATH = "conformance/statics.json"
SOURCES = (common, catenary_mp)
SEGMENTS = 20
"""Segments of the line whose last one is taken for its end in `tension_of_last_segment`."""
NUDGE = 1e-3
"""Of L: how far a code that cannot do a vertical line moves its fairlead aside."""
PLACES = (0.05, 0.3, 0.55, 0.8, 0.95)
FORCES = ("H", "V", "H_anchor", "V_anchor", "tension")
UNITS = {
    "w": "N/m",
    "EA": "N",
    "L": "m",
    "x": "m",
    "z": "m",
    "seabed": "true or false",
    "friction": "1",
    "clearance": "m, of the anchor above the seabed",
    "s": "m, unstretched from the anchor",
    "mass_per_length": "kg/m",
    "diameter": "m, volume-equivalent",
    "rho": "kg/m^3",
    "g": "m/s^2",
    "H": "N, at the fairlead",
    "V": "N, at the fairlead, positive where the line hangs below it",
    "H_anchor": "N",
    "V_anchor": "N, negative where the line leaves the anchor downwards",
    "grounded_length": "m, unstretched",
    "stiffness": "N/m, d(H, V)/d(x, z)",
    "profile": "m, (x, z) at s from the anchor, z up",
    "tension": "N, at s",
}
MISTAKES = common.COMMON_MISTAKES | {
    "friction_sign": "Friction acts the wrong way: the tension grows from touchdown to the anchor.",
    "friction_unlimited": "Friction goes on where no tension is left: the force at the anchor becomes negative.",
    "clearance_ignored": "The anchor stands on the seabed, whatever its height above it.",
    "chord_for_length": "The weight of the line is that of its chord's length.",
    "stretched_for_unstretched": "L is taken for the length of the stretched line.",
    "degrees": "The angle of the tension at the fairlead, in degrees, is given to functions that take radians.",
    "vertical_sign": "Vertical forces are positive upwards on the body.",
    "tension_for_horizontal": "The tension is given for its horizontal component.",
    "horizontal_for_tension": "The horizontal component is given for the tension along the line.",
    "tension_of_last_segment": "The force at each end is that in the middle of the last of 20 segments (half a node's "
    "weight is left out).",
    "s_from_fairlead": "Arc lengths are counted from the fairlead.",
    "flexibility_for_stiffness": "The inverse of the stiffness is given.",
    "grounded_length_suspended": "The suspended length is given for the grounded one.",
}


@dataclass(frozen=True)
class Case:
    """One line: lengths in m; features are those that the case isolates; places: s / L, None for those of a rule."""

    name: str
    group: str
    title: str
    features: tuple
    section: Section
    L: float
    x: float
    z: float
    seabed: bool = True
    friction: float = 0.0
    clearance: float = 0.0
    places: tuple = PLACES

    def line(self):
        """Return the arguments of the oracle."""
        return {
            "w": self.section.weight(),
            "EA": self.section.EA,
            "L": self.L,
            "x": self.x,
            "z": self.z,
            "seabed": self.seabed,
            "friction": self.friction,
            "clearance": self.clearance,
        }

    def arc_lengths(self):
        """Return the arc lengths asked for, m."""
        return [place * self.L for place in self.places]

    def inputs(self):
        """Return what a solver is given."""
        section = self.section
        raw = {"mass_per_length": section.mass, "diameter": section.diameter, "rho": section.rho, "g": common.GRAVITY}
        return self.line() | {"s": self.arc_lengths()} | raw


def design():
    """Return all cases, in the order of the table."""
    return [*_everyday(), *_extreme()]


def _everyday():
    oc3, c140, c84, c16, lab = (common.OC3_CHAIN, common.CHAIN_140, common.CHAIN_84, common.CHAIN_16,
                                common.LABORATORY_CHAIN)  # fmt: skip

    def case(name, title, features, *line, **options):
        return Case(f"statics/{name}", "everyday", title, tuple(features.split()), *line, **options)

    yield case("oc3", "OC3 Hywind line", "contact elastic", oc3, 902.2, 848.67, 250.0)
    yield case("oc3-friction-0001", "OC3 Hywind line, friction 0.001", "contact friction", oc3, 902.2, 848.67, 250.0,
               friction=0.001)  # fmt: skip
    yield case("oc3-friction-1", "OC3 Hywind line, friction 1", "contact friction", oc3, 902.2, 848.67, 250.0,
               friction=1.0)  # fmt: skip
    yield case("oc3-out", "OC3 Hywind line, 13 m out: nothing on the seabed", "elastic", oc3, 902.2, 861.67, 250.0)
    yield case("oc3-in", "OC3 Hywind line, 30 m in, friction 0.6", "contact friction", oc3, 902.2, 818.67, 250.0,
               friction=0.6)  # fmt: skip
    yield case("chain-50m", "140 mm chain in 50 m of water", "contact", c140, 410.0, 402.0, 50.0)
    yield case("chain-50m-friction", "140 mm chain in 50 m of water, friction 0.7", "contact friction", c140, 410.0,
               402.0, 50.0, friction=0.7)  # fmt: skip
    yield case("chain-50m-anchor-slack", "140 mm chain in 50 m of water, pulled little: friction takes all",
               "contact friction", c140, 410.0, 385.0, 50.0, friction=1.0)  # fmt: skip
    yield case("chain-200m", "140 mm chain in 200 m of water, friction 0.6", "contact friction", c140, 760.0, 715.0,
               200.0, friction=0.6)  # fmt: skip
    yield case("chain-200m-storm", "140 mm chain in 200 m of water, lifted from its anchor", "elastic", c140, 760.0,
               733.0, 200.0)  # fmt: skip
    yield case("buoy-chain", "16 mm chain of a buoy in 12 m of water, friction 0.8", "contact friction", c16, 36.0,
               32.0, 12.0, friction=0.8)  # fmt: skip
    yield case("buoy-chain-slack", "16 mm chain of a buoy, hanging slack", "slack contact", c16, 36.0, 20.0, 12.0,
               places=(0.7, 0.8, 0.9))  # fmt: skip
    yield case("laboratory-chain", "chain of a laboratory in 3 m of fresh water", "contact", lab, 33.0, 32.6, 3.3)
    yield case("laboratory-chain-friction", "chain of a laboratory, friction 0.3", "contact friction", lab, 33.0, 32.6,
               3.3, friction=0.3)  # fmt: skip
    yield case("chain-slack", "84 mm chain hanging slack in 100 m of water", "slack contact", c84, 400.0, 250.0, 100.0,
               places=(0.78, 0.85, 0.95))  # fmt: skip
    yield case("wire-hanging", "wire rope, both ends free of the seabed", "elastic", common.WIRE, 600.0, 480.0, 330.0)
    yield case("wire-ground", "wire rope on the seabed in 150 m of water", "contact friction elastic", common.WIRE,
               720.0, 680.0, 150.0, friction=0.4)  # fmt: skip
    yield case("polyester-taut", "polyester rope, taut, in 2000 m of water", "taut elastic", common.POLYESTER, 2520.0,
               1600.0, 1980.0)  # fmt: skip
    yield case("polyester-slacker", "polyester rope in 2000 m of water, 25 m in", "elastic", common.POLYESTER, 2580.0,
               1575.0, 1980.0)  # fmt: skip
    yield case("nylon", "nylon rope, stretched by a fifth", "elastic taut", common.NYLON, 60.0, 65.0, 28.0)
    yield case("nylon-steep", "nylon rope, steep, stretched by 4 %", "elastic", common.NYLON, 30.0, 8.0, 30.2)
    yield case("hose-u", "hose between two bodies, ends level", "elastic", common.HOSE, 150.0, 60.0, 0.0,
               seabed=False)  # fmt: skip
    yield case("hose-below", "hose to a fairlead 80 m below its other end", "elastic", common.HOSE, 180.0,
               110.0, -80.0, seabed=False)  # fmt: skip
    yield case("hmpe-taut", "HMPE rope, lighter than water, taut", "buoyant taut", common.HMPE, 1500.0, 900.0, 1205.0,
               seabed=False)  # fmt: skip
    yield case("floating-rope", "polypropylene rope arching between two bodies", "buoyant", common.POLYPROPYLENE, 120.0,
               95.0, 10.0, seabed=False)  # fmt: skip
    yield case("buoyant-riser", "riser section with buoyancy modules", "buoyant", common.BUOYANT_RISER, 160.0, 110.0,
               -60.0, seabed=False)  # fmt: skip
    yield case("raised-anchor", "84 mm chain from a block 4 m high, lying on the seabed", "clearance contact", c84,
               420.0, 395.0, 90.0, clearance=4.0)  # fmt: skip
    yield case("raised-anchor-sag", "wire rope from a pile 30 m high, sagging to the seabed", "clearance contact",
               common.WIRE, 440.0, 375.0, 60.0, clearance=30.0)  # fmt: skip
    yield case("raised-level", "16 mm chain between two piles, lying between them", "clearance contact", c16, 80.0,
               74.0, 0.0, clearance=6.0)  # fmt: skip
    yield case("raised-slack", "84 mm chain from a block 10 m high, hanging slack", "clearance slack contact", c84,
               300.0, 120.0, 60.0, clearance=10.0, places=(0.01, 0.8, 0.95))  # fmt: skip
    yield case("tether", "tether of a tension-leg platform", "vertical taut", common.TETHER, 480.0, 0.0, 481.1)
    yield case("tether-offset", "tether of a tension-leg platform, 24 m offset", "taut elastic", common.TETHER, 480.0,
               24.0, 480.5)  # fmt: skip
    yield case("chain-vertical", "84 mm chain straight down to its heap on the seabed", "vertical slack contact", c84,
               130.0, 0.0, 100.0, places=(0.35, 0.6, 0.9))  # fmt: skip
    yield case("rope-folded", "umbilical hanging in a fold between two points of one vertical", "vertical",
               common.UMBILICAL, 90.0, 0.0, 30.0, seabed=False)  # fmt: skip
    yield case("rope-pulled-flat", "wire rope pulled along the seabed, friction 0.5 overcome", "contact friction",
               common.WIRE, 300.0, 300.2, 0.0, friction=0.5)  # fmt: skip
    yield case("wire-slack", "wire rope hanging slack in 60 m of water", "slack contact", common.WIRE, 200.0, 90.0,
               60.0, places=(0.75, 0.85, 0.95))  # fmt: skip


def _extreme():
    oc3, c84 = common.OC3_CHAIN, common.CHAIN_84

    def case(name, title, features, *line, **options):
        return Case(f"statics/{name}", "extreme", title, tuple(features.split()), *line, **options)

    near = (246.22420940032947, 263.55766330843164)
    light = Section(1.0, 0.0293, 7e8)
    yield case("near-taut", "light rope 0.01 mm longer than its chord", "taut elastic", light,
               math.hypot(*near) + 1e-5, *near)  # fmt: skip
    yield case("chord-exact", "wire rope exactly as long as its chord (3, 4, 5)", "taut elastic", common.WIRE, 500.0,
               300.0, 400.0)  # fmt: skip
    yield case("over-stretched", "rubber line pulled to ten times its length", "elastic taut", common.RUBBER, 40.0,
               240.0, 320.0)  # fmt: skip
    yield case("rubber", "rubber line that its own weight stretches", "elastic", common.RUBBER, 40.0, 30.0, 35.0)
    yield case("cable-10km", "wire rope of 10 km in 4000 m of water", "contact friction elastic", common.WIRE, 10000.0,
               8900.0, 4000.0, friction=0.3)  # fmt: skip
    yield case("inextensible", "chain of EA 1e15 N", "contact", replace(oc3, EA=1e15), 902.2, 848.67, 250.0,
               friction=0.5)  # fmt: skip
    yield case(
        "just-touching", "OC3 Hywind line with 0.3 m on the seabed", "contact elastic", oc3, 902.2, 858.02, 250.0
    )
    yield case("nearly-slack", "84 mm chain 0.01 m from hanging slack", "contact", c84, 400.0, 300.01, 100.0)
    yield case("nearly-vertical", "wire rope 0.1 mm off the vertical, taut", "taut", common.WIRE, 200.0, 1e-4, 200.3)
    yield case("nearly-vertical-folded", "hose in a fold, its ends 0.1 mm apart", "elastic", common.HOSE, 90.0,
               1e-4, 30.0, seabed=False)  # fmt: skip
    yield case("friction-1000", "84 mm chain, friction 1000: 0.1 m before touchdown is pulled", "contact friction",
               c84, 400.0, 362.0, 100.0, friction=1000.0)  # fmt: skip
    yield case("flat-part", "wire rope pulled along the seabed: friction takes all before the anchor",
               "contact friction", replace(common.WIRE, EA=2e7), 300.0, 300.1, 0.0, friction=0.8)  # fmt: skip
    yield case("neutral-taut", "neutrally buoyant rope, stretched: a straight spring", "elastic", common.NEUTRAL, 50.0,
               31.0, 41.0, seabed=False)  # fmt: skip
    yield case("neutral-slack", "neutrally buoyant rope, slack: no force", "slack", common.NEUTRAL, 50.0, 20.0, 30.0,
               seabed=False, places=())  # fmt: skip
    yield case("buoyant-vertical", "HMPE rope straight up from its anchor, stretched", "buoyant vertical", common.HMPE,
               800.0, 0.0, 800.4, seabed=False)  # fmt: skip
    yield case("raised-below", "84 mm chain to a fairlead 3 m below its anchor, lying between", "clearance contact",
               c84, 120.0, 112.0, -3.0, clearance=8.0)  # fmt: skip
    yield case("short-stiff", "tether of 2 m, stretched by 1e-6", "taut elastic", common.TETHER, 2.0, 1.2, 1.6000032)
    yield case("free-end", "laboratory chain in a fold on the vertical, ends level", "vertical",
               common.LABORATORY_CHAIN, 33.0, 0.0, 0.0, seabed=False)  # fmt: skip


# --- answers of the oracle --------------------------------------------------------------------------------------------


def answer(line, s, stiffness=True):
    """Return all quantities of a line; stiffness only where it is asked for and finite."""
    state = catenary_mp.solve(**line, digits=common.DIGITS)
    result = {name: getattr(state, name) for name in ("H", "V", "H_anchor", "V_anchor", "grounded_length")}
    if stiffness:
        K = catenary_mp.stiffness(**line, solution=state)
        if all(mp.isfinite(K[i, j]) for i in (0, 1) for j in (0, 1)):
            result["stiffness"] = [[K[0, 0], K[0, 1]], [K[1, 0], K[1, 1]]]
    points = [catenary_mp.profile(place, **line, solution=state) for place in s]
    if points:
        result["profile"] = [[x, z] for x, z, _ in points]
        result["tension"] = [T for _, _, T in points]
    return result


def scales(case, truth):
    """Return quantity -> size by which its error is divided."""
    line = case.line()
    force = max(abs(mp.hypot(truth["H"], truth["V"])), abs(mp.hypot(truth["H_anchor"], truth["V_anchor"])))
    force = force or mpf(abs(line["w"]) * line["L"] or line["EA"])
    sizes = dict.fromkeys(FORCES, force) | dict.fromkeys(("grounded_length", "profile"), mpf(case.L))
    if "stiffness" in truth:
        sizes["stiffness"] = max(abs(k) for row in truth["stiffness"] for k in row) or mpf(line["EA"]) / line["L"]
    return {name: as_doubles(sizes[name]) for name in truth}


def bounds(case, names):
    """Return quantity -> [right, wrong]; what the rounding of the inputs alone can cause is right."""
    line = case.line()
    state = catenary_mp.solve(**line, digits=common.DIGITS)
    rounding = common.ROUNDINGS * common.EPS * float(catenary_mp.condition_number(**line, solution=state))
    result = {}
    for name in names:
        right, wrong = common.STIFFNESS_BOUND if name == "stiffness" else common.BOUND
        result[name] = [max(right, rounding), max(wrong, 10 * rounding)]
    return result


# --- features left out ------------------------------------------------------------------------------------------------


def _spring(case):
    """Return the forces of a straight spring between the ends, which pushes where it is compressed."""
    chord = mp.hypot(case.x, case.z)
    T = case.section.EA * (chord / case.L - 1)
    H, V = T * case.x / chord, T * case.z / chord
    return {"H": H, "V": V, "H_anchor": H, "V_anchor": V, "grounded_length": 0, "tension": [T] * len(case.places)}


def leave_out(feature, case):
    """Return the answer without a feature."""
    line, s = case.line(), case.arc_lengths()
    if feature == "taut" or (feature == "slack" and line["w"] == 0):
        return _spring(case) if line["w"] == 0 or feature == "slack" else answer(line | {"w": 0.0}, s)
    changed = {
        "friction": {"friction": 0.0},
        "contact": {"seabed": False, "friction": 0.0, "clearance": 0.0},
        "slack": {"seabed": False, "friction": 0.0, "clearance": 0.0},
        "vertical": {"x": NUDGE * case.L},
        "buoyant": {"w": abs(line["w"])},
        "elastic": {"EA": common.STIFF * line["EA"]},
        "clearance": {"clearance": max(0.0, -case.z)},
    }
    return answer(line | changed[feature], s)


# --- mistakes ---------------------------------------------------------------------------------------------------------


def mistaken_inputs(case):
    """Return mistake -> arguments of the oracle, of mistakes that are made with the inputs."""
    line, section = case.line(), case.section
    chord = math.hypot(case.x, case.z)
    changes = {name: {"w": w} for name, w in section.mistaken_weights().items()}
    changes |= {
        "friction_ignored": {"friction": 0.0},
        "EA_per_area": {"EA": line["EA"] / section.area},
        "seabed_ignored": {"seabed": False, "friction": 0.0, "clearance": 0.0},
        "clearance_ignored": {"clearance": 0.0},
        "chord_for_length": {"w": line["w"] * chord / case.L},
    }
    if chord < case.L * (1 - 1e-6):
        changes["elasticity_ignored"] = {"EA": common.STIFF * line["EA"]}
    mistaken = {name: line | change for name, change in changes.items()}
    return {name: inputs for name, inputs in mistaken.items() if inputs != line}


def mistaken_outputs(case, truth):
    """Return mistake -> the changed quantities, of mistakes that are made with the results."""
    T = mp.hypot(truth["H"], truth["V"])
    angle = mp.degrees(mp.atan2(truth["V"], truth["H"])) if T else mpf(0)
    half = mpf(case.line()["w"]) * case.L / (2 * SEGMENTS)
    swap = {"H": truth["H_anchor"], "V": truth["V_anchor"], "H_anchor": truth["H"], "V_anchor": truth["V"]}
    results = {
        "kN_for_N": _scaled(truth, mpf(1) / 1000),
        "kgf_for_N": _scaled(truth, 1 / mpf(common.NEWTON_PER_KGF)),
        "ends_swapped": swap,
        "anchor_force_for_fairlead": {"H": truth["H_anchor"], "V": truth["V_anchor"]},
        "vertical_sign": {"V": -truth["V"], "V_anchor": -truth["V_anchor"]},
        "degrees": {"H": T * mp.cos(angle), "V": T * mp.sin(angle)},
        "tension_for_horizontal": {"H": T, "H_anchor": mp.hypot(truth["H_anchor"], truth["V_anchor"])},
        "grounded_length_suspended": {"grounded_length": case.L - truth["grounded_length"]},
    }
    if truth["grounded_length"] == 0:
        results["tension_of_last_segment"] = {"V": truth["V"] - half, "V_anchor": truth["V_anchor"] + half}
    else:
        results["tension_of_last_segment"] = {"V": truth["V"] - half}
    if "stiffness" in truth:
        K = mp.matrix(truth["stiffness"])
        results["stiffness_sign"] = {"stiffness": -K}
        if mp.det(K) != 0:
            results["flexibility_for_stiffness"] = {"stiffness": K**-1}
    return results


def _scaled(truth, factor):
    """Return forces and stiffness in another unit."""
    result = {}
    for name, value in truth.items():
        if name == "stiffness":
            result[name] = factor * mp.matrix(value)
        elif name in FORCES:
            result[name] = [factor * v for v in value] if isinstance(value, list) else factor * value
    return result


def mistaken_places(case, truth):
    """Return mistake -> profile and tension read wrongly."""
    if "profile" not in truth:
        return {}
    mirrored = answer(case.line(), [case.L - s for s in case.arc_lengths()], stiffness=False)
    horizontal = [_horizontal(case, truth, s, T) for s, T in zip(case.arc_lengths(), truth["tension"], strict=True)]
    return {
        "s_from_fairlead": {name: mirrored[name] for name in ("profile", "tension")},
        "horizontal_for_tension": {"tension": horizontal},
    }


def _horizontal(case, truth, s, T):
    """Return the horizontal force at s: that of the fairlead, or less where friction has taken from it."""
    return min(truth["H"], T) if truth["grounded_length"] and s < truth["grounded_length"] else truth["H"]


def _on_rubbing_seabed(case, friction):
    """Return the answer for friction of any sign and without a limit.

    The grounded length B of a line without friction gains the stretch -friction w B^2 / (2 EA) of the tension that
    friction takes; so the fairlead is where that of a line without friction is at x' = x + friction w B^2 / (2 EA).
    """
    line = case.line() | {"friction": 0.0}
    w, EA = mpf(line["w"]), mpf(line["EA"])

    def without_friction(x, z):
        def gap(start):
            grounded = catenary_mp.solve(**line | {"x": start, "z": z}, digits=common.DIGITS).grounded_length
            return start - x - friction * w * grounded**2 / (2 * EA)

        with mp.workdps(common.DIGITS):
            start = mp.findroot(gap, (x, x * (1 + mpf(10) ** -6)), solver="secant", tol=mpf(10) ** -40)
        return start, catenary_mp.solve(**line | {"x": start, "z": z}, digits=common.DIGITS)

    with mp.workdps(common.DIGITS):
        x, z = mpf(case.x), mpf(case.z)
        start, state = without_friction(x, z)
        B = state.grounded_length
        step = mpf(10) ** -9 * case.L
        K = mp.matrix(2, 2)
        for column, (dx, dz) in enumerate(((step, 0), (0, step))):
            ahead, behind = without_friction(x + dx, z + dz)[1], without_friction(x - dx, z - dz)[1]
            K[0, column], K[1, column] = (ahead.H - behind.H) / (2 * step), (ahead.V - behind.V) / (2 * step)
        profile, tension = [], []
        for s in map(mpf, case.arc_lengths()):
            px, pz, T = catenary_mp.profile(s, **line | {"x": start}, solution=state)
            part = min(s, B)
            profile.append([px - friction * w * (B * part - part**2 / 2) / EA, pz])
            tension.append(T - friction * w * (B - part))
        anchor = state.H - friction * w * B
    return {
        **{"H": state.H, "V": state.V, "H_anchor": anchor, "V_anchor": state.V_anchor, "grounded_length": B},
        **{"stiffness": K, "profile": profile, "tension": tension},
    }


def mistaken_friction(case, truth):
    """Return mistake -> answer where friction acts with the wrong sign, or without a limit."""
    if not case.friction or not truth["grounded_length"] or case.z == 0:
        return {}
    results = {"friction_sign": _on_rubbing_seabed(case, -mpf(case.friction))}
    if truth["H_anchor"] == 0:
        results["friction_unlimited"] = _on_rubbing_seabed(case, mpf(case.friction))
    return results


def stretched_for_unstretched(case):
    """Return the answer for the line whose stretched length is L; None where there is none, or the line is slack."""
    line = case.line()

    def gap(L):
        state = catenary_mp.solve(**line | {"L": L}, digits=common.DIGITS)
        if state.regime not in ("suspended", "grounded", "grounded-anchor-slack") or case.clearance:
            raise ValueError("only the tension of a lifted or grounded line is written down here")
        bottom, w = state.grounded_length, mpf(line["w"])
        rub = line["friction"] * w
        first = max(bottom - state.H / rub, 0) if rub else mpf(0)
        lying = (bottom - first) * (state.H - rub * (bottom - first) / 2)
        hanging = mp.quad(lambda s: mp.hypot(state.H, state.V - w * (L - s)), mp.linspace(bottom, L, 5))
        return L + (lying + hanging) / line["EA"] - case.L

    with mp.workdps(common.DIGITS):
        try:
            L = mp.findroot(gap, (mpf(case.L) * (1 - mpf(10) ** -4), mpf(case.L)), solver="secant", tol=mpf(10) ** -34)
            return answer(line | {"L": L}, [min(s, L) for s in map(mpf, case.arc_lengths())])
        except (ValueError, ArithmeticError):
            return None


def mistakes(case, truth):
    """Yield (mistake, answer) of those that have one."""
    for name, line in mistaken_inputs(case).items():
        try:
            yield name, answer(line, case.arc_lengths())
        except (ValueError, ArithmeticError):
            continue  # a mistake without an answer: the line would be buoyant on a seabed, or too short
    yield from mistaken_outputs(case, truth).items()
    yield from mistaken_places(case, truth).items()
    yield from mistaken_friction(case, truth).items()
    stretched = stretched_for_unstretched(case)
    if stretched:
        yield "stretched_for_unstretched", stretched


def compute(case):
    """Return {"name", "text"} of a case: its line of JSON."""
    exact = answer(case.line(), case.arc_lengths())
    truth, scale, bound = as_doubles_of(exact), scales(case, exact), bounds(case, exact)

    def changed(result):
        return common.changed_quantities(result, truth, scale, bound)

    found = {name: changed(result) for name, result in mistakes(case, exact)}
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
        "without": {feature: changed(leave_out(feature, case)) for feature in case.features},
    }
    return {"name": case.name, "text": common.one_line(row)}


def as_doubles_of(answer):
    """Return the quantities of an answer as doubles."""
    return {name: as_doubles(value) for name, value in answer.items()}


def render(rows):
    """Return the text of the table from name -> row."""
    lines = [rows[case.name]["text"] for case in design() if case.name in rows]
    return common.table_text("statics", UNITS, MISTAKES, lines)
