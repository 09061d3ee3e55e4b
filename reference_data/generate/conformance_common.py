"""What the conformance tables of lines and networks share: their words, their bounds, and how they are written.

A case is one line of JSON. A mistake or a feature left out lists the quantities that it changes; what is not listed
keeps the value of the truth.
"""

import json
import math
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
from mpmath import mp

VERSION = "2026.11"
DIGITS = 30
"""Significant digits of the oracle; the tables keep doubles."""
GRAVITY, SEA_WATER, FRESH_WATER = 9.80665, 1025.0, 1000.0
GRAVITY_ROUNDED = 9.81
NOMINAL = 1.8
"""Volume-equivalent over nominal diameter of studless chain."""
STIFF = 1e9
"""Factor on EA that stands for a line that does not stretch."""
EPS = 2.0**-52
MISTAKE_DIGITS = 12
NEWTON_PER_KGF = GRAVITY

# Relative to the scale of the quantity: an error up to the first is right, one above the second wrong.
BOUND, STIFFNESS_BOUND = (1e-6, 1e-3), (1e-4, 1e-2)
# Of a condition number: eps times this much is forgiven, for a solver's own rounding at every input.
ROUNDINGS = 10.0
UNCERTAINTY = EPS
"""Of truths that were rounded to doubles, relative to their scale."""

COMMON_MISTAKES = {
    "friction_ignored": "The seabed has no friction.",
    "weight_in_air": "The weight of the line is that in air: buoyancy is left out.",
    "g_9_81": "Gravity is 9.81 m/s^2, not the 9.80665 m/s^2 of the case.",
    "rho_1000": "The density of water is 1000 kg/m^3, not that of the case.",
    "nominal_diameter": "The displaced volume of a chain is that of its nominal diameter, diameter / 1.8.",
    "radius_for_diameter": "The diameter is taken for the radius: the line displaces four times its volume.",
    "elasticity_ignored": "The line does not stretch (EA times 1e9).",
    "EA_per_area": "EA is divided by the area of the section, as if the code wanted a modulus in Pa.",
    "seabed_ignored": "There is no seabed: the line hangs through it.",
    "kN_for_N": "Forces and stiffnesses are in kN, kN/m.",
    "kgf_for_N": "Forces and stiffnesses are in kilogram-force (divided by 9.80665).",
    "ends_swapped": "What belongs to the anchor is given for the fairlead, and the reverse.",
    "anchor_force_for_fairlead": "The force at the anchor is given at both ends.",
    "stiffness_sign": "The stiffness has the opposite sign: that of the force on the line, or of the restoring force.",
}


@dataclass(frozen=True)
class Section:
    """Section of a line: kg/m, m (volume-equivalent), N; whether it is a chain; density of the water, kg/m^3."""

    mass: float
    diameter: float
    EA: float
    chain: bool = False
    rho: float = SEA_WATER

    def weight(self, rho=None, g=GRAVITY, diameter=None):
        """Return the submerged weight, N/m, of this section, or with another density, gravity or diameter."""
        rho = self.rho if rho is None else rho
        return (self.mass - rho * math.pi / 4 * (diameter or self.diameter) ** 2) * g

    def mistaken_weights(self):
        """Return mistake -> submerged weight, N/m, of those that concern the weight."""
        weights = {
            "weight_in_air": self.mass * GRAVITY,
            "g_9_81": self.weight(g=GRAVITY_ROUNDED),
            "radius_for_diameter": self.weight(diameter=2 * self.diameter),
        }
        if self.rho != FRESH_WATER:
            weights["rho_1000"] = self.weight(rho=FRESH_WATER)
        if self.chain:
            weights["nominal_diameter"] = self.weight(diameter=self.diameter / NOMINAL)
        return weights

    @property
    def area(self):
        """Area of the volume-equivalent section, m^2."""
        return math.pi / 4 * self.diameter**2


OC3_CHAIN = Section(77.7066, 0.09, 384.243e6, chain=True)
CHAIN_140 = Section(390.0, 0.252, 1.674e9, chain=True)
CHAIN_84 = Section(141.0, 0.1512, 6.03e8, chain=True)
CHAIN_16 = Section(5.1, 0.0288, 21.9e6, chain=True)
LABORATORY_CHAIN = Section(0.0818, 0.0022, 1.0e4, chain=True, rho=FRESH_WATER)
WIRE = Section(31.0, 0.0767, 4.0e8)
POLYESTER = Section(17.9, 0.1264, 1.1e8)
NYLON = Section(4.1, 0.068, 1.2e6)
HMPE = Section(7.6, 0.1, 2.0e8)
POLYPROPYLENE = Section(1.6, 0.06, 3.0e6)
BUOYANT_RISER = Section(350.0, 0.9, 5.0e8)
UMBILICAL = Section(50.0, 0.2, 3.0e8)
HOSE = Section(50.0, 0.2, 2.0e6)
TETHER = Section(680.0, 0.6, 1.2e10)
NEUTRAL = Section(SEA_WATER * math.pi / 4 * 0.1**2, 0.1, 1.0e6)
RUBBER = Section(2.0, 0.04, 400.0)


def as_doubles(value, digits=None):
    """Return numbers (mpf or float, nested in lists or tuples or an mp matrix) as doubles, rounded to ``digits``."""
    if isinstance(value, (list, tuple)):
        return [as_doubles(item, digits) for item in value]
    if isinstance(value, mp.matrix):
        return as_doubles(value.tolist(), digits)
    number = float(value)
    return (number if digits is None else float(f"{number:.{digits - 1}e}")) + 0.0  # no negative zero


def change_over_scale(value, truth, scale):
    """Return the largest |value - truth| / scale of nested lists of doubles."""
    return float(np.max(np.abs(np.asarray(value) - np.asarray(truth)) / np.asarray(scale)))


def changed_quantities(answer, truth, scale, bound):
    """Return the quantities of an answer that leave the truth, rounded; {} where none leaves its right bound.

    A quantity that moves by less than a hundredth of its bound is left out: it counts as the truth.
    """
    answer = {name: as_doubles(answer[name], MISTAKE_DIGITS) for name in truth if name in answer}
    moves = {
        name: change_over_scale(value, truth[name], scale[name]) / bound[name][0] for name, value in answer.items()
    }
    if not all(math.isfinite(move) for move in moves.values()) or max(moves.values(), default=0.0) <= 1.0:
        return {}
    return {name: value for name, value in answer.items() if moves[name] > 0.01}


def one_line(case):
    """Return a case as one line of JSON."""
    return json.dumps(case, allow_nan=False, ensure_ascii=False)


def table_text(level, units, mistakes, lines):
    """Return the text of a table from its cases, each one line of JSON."""
    head = {"version": VERSION, "level": level, "units": units, "mistakes": mistakes}
    return json.dumps(head, indent=1, ensure_ascii=False)[:-2] + ',\n "cases": [\n' + ",\n".join(lines) + "\n]}\n"


def without_cases(text, names):
    """Return the text of a table with the cases of these names alone."""
    table = json.loads(text)
    lines = [one_line(case) for case in table["cases"] if case["id"] in names]
    return table_text(table["level"], table["units"], table["mistakes"], lines)


def table_rows(text):
    """Return case id -> {path of an entry: its text} of a table."""
    return {case["id"]: dict(_entries("", case)) for case in json.loads(text)["cases"]}


def _entries(path, value):
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _entries(f"{path}/{key}" if path else key, item)
    else:
        yield path, json.dumps(value, ensure_ascii=False)


def namespace(**values):
    """Return an object with these attributes."""
    return SimpleNamespace(**values)
