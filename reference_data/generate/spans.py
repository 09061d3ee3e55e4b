"""Single spans in every regime, solved to 50 digits and written to 30.

The design is dimensionless: stiffness EA/(w L), place of the fairlead (x/L, z/L), friction; sizes are dealt in turn.
"""

from dataclasses import asdict, astuple, dataclass
from itertools import chain, count, cycle, product
from math import hypot
from random import Random

from mpmath import mp

from verification.exact.cable import catenary_mp

DIGITS = 30
CONDITION_DIGITS = 3
SEED = 20190212

INPUTS = ("w", "EA", "L", "x", "z", "seabed", "friction", "clearance")
STATE = ("H", "V", "H_anchor", "V_anchor", "grounded_length")
COLUMNS = ("name", "regime", *INPUTS, *STATE, "K11", "K12", "K21", "K22", "condition")

# (w in N/m, L in m): model-basin wire, rope in a lake, OC3 chain, unit line, deep-water rope, 10 km cable.
SIZES = ((0.0125, 1.0), (3.7, 41.0), (698.094, 902.2), (1.0, 1.0), (57.475, 3500.0), (96.0, 10000.0))
STIFFNESS = (1.0, 10.0, 1e2, 1e4, 1e6, 1e9, 1e12, 1e100, 1e300)
USUAL = (10.0, 1e4, 1e9)
TRIANGLES = ((3, 4, 5), (5, 12, 13), (15, 8, 17), (24, 7, 25))
SMALL = (1e-3, 1e-6, 1e-9, 1e-12, 1e-15)

# Regimes of the oracle that a label may stand for.
PLAIN = {"suspended"}
TOUCHING = {"grounded", "grounded-anchor-slack"}
ANY = PLAIN | TOUCHING | {"slack"}
LABELS = {
    "suspended": PLAIN,
    "contact-frictionless": {"grounded"},
    "contact-anchor-tension": {"grounded"},
    "contact-anchor-slack": {"grounded-anchor-slack"},
    "slack": {"slack"},
    "slack-lying": {"slack"},
    "lying-frictionless": {"lying"},
    "lying-friction-part": {"lying"},
    "lying-friction-full": {"lying"},
    "vertical-taut": {"vertical"},
    "vertical-folded": {"vertical"},
    "vertical-slack-seabed": {"slack"},
    "chord-equals-length": PLAIN | TOUCHING,
    "near-chord": PLAIN,
    "over-stretched": PLAIN | TOUCHING,
    "fairlead-below": PLAIN,
    "floating-slack": PLAIN,
    "fairlead-on-seabed": {"grounded"},
    "lifted-contact": {"grounded"},
    "lifted-suspended": PLAIN,
    "lifted-slack": {"slack"},
    "buoyant": PLAIN | {"vertical"},
    "weightless-taut": {"weightless-taut"},
    "weightless-slack": {"weightless-slack"},
    "nearly-vertical": PLAIN | TOUCHING,
    "nearly-slack": TOUCHING,
    "just-touching": {"grounded"},
    "just-lifted": PLAIN,
    "named-line": PLAIN | TOUCHING,
    "random-seabed": ANY,
    "random-floating": PLAIN,
}


@dataclass(frozen=True)
class Row:
    """Inputs of one row: exact doubles in SI units (see `verification.exact.cable.catenary_mp`)."""

    name: str
    regime: str
    w: float
    EA: float
    L: float
    x: float
    z: float
    seabed: bool = True
    friction: float = 0.0
    clearance: float = 0.0


def _shapes():
    """(label, EA/wL, x/L, z/L, seabed, friction, clearance/L); soft lines are held further out, by 1 + 1.5 wL/EA."""
    for k in STIFFNESS:
        far = 1 + 1.5 / k
        yield from (("suspended", k, x * far, z * far) for x, z in ((0.55, 0.83), (0.72, 0.69)))
        yield from (("contact-frictionless", k, x, z) for x, z in ((0.9, 0.3), (0.97, 0.1)))
        yield "slack", k, 0.5, 0.3
        yield "lying-frictionless", k, 1 + 0.3 / k if k < 1e14 else 1.25, 0.0
        yield "vertical-folded", k, 0.0, 0.4, False
        yield "floating-slack", k, 0.3, 0.2, False
        yield "lifted-contact", k, 0.8, 0.2, True, 0.0, 0.1
        yield "fairlead-below", k, 0.5, -0.7, False
    for k, friction in product(USUAL, (1e-3, 0.1, 1.0)):
        yield "contact-anchor-tension", k, 0.99 + 1 / k, 0.12, True, friction
        yield "lying-friction-full", k, 1 + 2 * max(friction, 0.1) / k, 0.0, True, friction
    for k, friction in product((*USUAL, 1e300), (1.0, 10.0, 1e3)):
        yield "contact-anchor-slack", k, 0.75, 0.32, True, friction
        if k < 1e14:
            for part in (0.1, 0.75):  # of the stretch that friction can hold is 0.5
                yield "lying-friction-part", k, 1 + part * friction / k, 0.0, True, friction
    for k, z, friction in product(USUAL, (1e-6, 0.9), (0.0, 1.0)):
        yield "slack", k, 0.05, z, True, friction
    for x, friction in product((0.0, 0.5, 1.0), (0.0, 10.0)):
        yield "slack-lying", 1e4, x, 0.0, True, friction
    for k, far, seabed in product(USUAL, (0.6, 2.0, 100.0), (True, False)):
        yield "vertical-taut", k, 0.0, 1 + far / k, seabed
    yield from (("vertical-taut", k, 0.0, -1 - 2 / k, False) for k in USUAL)
    yield from (("vertical-folded", k, 0.0, z, False) for k, z in product(USUAL, (-0.5, 0.0, 0.99)))
    yield from (("vertical-slack-seabed", k, 0.0, z) for k, z in product((1.0, *USUAL), (1e-3, 0.5, 0.99)))
    for k, stretch in product((1.0, 1e2, 1e6, 1e100), (1.1, 2.0, 10.0, 100.0, 1000.0)):
        yield "over-stretched", k, 0.6 * stretch, 0.8 * stretch
    yield from (("fairlead-below", 1e4, x, -z, False) for x, z in ((0.99, 1e-3), (0.9, 0.4), (0.1, 0.9), (1.0, 1.0)))
    for length, aspect in product((1.1, 2.0, 20.0), (0.0, 1.0, -1.0)):
        chord = length * hypot(1, aspect)
        yield "floating-slack", 1e6, 1 / chord, aspect / chord, False
    for k, (x, z, h) in product(USUAL, ((0.95, 0.1, 1e-3), (0.75, 0.1, 0.2), (0.8, 0.02, 0.2), (0.75, -0.1, 0.25))):
        yield "lifted-contact", k, x, z, True, 0.0, h
    yield from (("fairlead-on-seabed", k, 0.9, -0.3, True, 0.0, 0.3) for k in USUAL)
    yield from (("lifted-suspended", k, 0.95, 0.1, True, f, 0.6) for k, f in product(USUAL, (0.0, 1.0)))
    yield from (("lifted-suspended", k, 1.2, -0.3, True, 0.0, 0.6) for k in USUAL)
    yield from (("lifted-slack", k, x, z, True, 0.0, 0.2) for k, x, z in product(USUAL, (0.0, 0.4), (0.1, -0.1)))
    for k, x in product((10.0, 1e6), (1e-12, 1e-9, 1e-6, 1e-4, 1e-2)):
        yield from (("nearly-vertical", k, x, z, seabed) for z, seabed in ((1 + 1 / k, True), (0.4, False)))
    yield from (("nearly-vertical", 1e12, x, 1 - x / 3) for x in (1e-9, 1e-6, 1e-4, 1e-2))
    for d, friction in product((1e-1, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14), (0.0, 1.0)):
        yield "nearly-slack", 1e100, 0.7, 0.3 + d * 0.3, True, friction


def _dealt(shapes):
    """Shapes given a size each, in turn."""
    sizes = cycle(SIZES)
    for label, k, x, z, *rest in shapes:
        w, L = next(sizes)
        seabed, friction, clearance = *rest, *(True, 0.0, 0.0)[len(rest) :]
        yield label, w, k * w * L, L, x * L, z * L, seabed, friction, clearance * L


def _chords():
    """Lines as long as their chord, exactly or nearly."""
    for (x, z, L), k in product(TRIANGLES, STIFFNESS):
        yield "chord-equals-length", 2.0, k * 2.0 * L, float(L), float(x), float(z)
    for k, d, sign in product((1e4, 1e9, 1e300), SMALL, (1, -1)):
        yield "near-chord", 698.094, k * 698.094 * 500, 500 * (1 + sign * d), 300.0, 400.0, False


def _touching():
    """Lines whose anchor end is about to lift or has just lifted: V = w L (1 -+ 1e-6) at H/(w L) = h."""
    for h, k in product((0.1, 1.0, 10.0), USUAL):
        for label, share in (("just-touching", 1 - 1e-6), ("just-lifted", 1 + 1e-6)):
            with mp.workdps(DIGITS):
                x, z = catenary_mp.excursion(h * 100, share * 100, 1.0, k * 100, 100.0)
            yield label, 1.0, k * 100, 100.0, float(x), float(z)


def _signs_of_weight():
    """Buoyant lines (no seabed) and weightless springs."""
    for k, (x, z) in product(USUAL, ((0.6, 0.5), (0.9, 0.0), (0.5, -0.8), (1.2, 0.3), (0.0, 0.5))):
        yield "buoyant", -3.7, k * 3.7 * 41, 41.0, x * 41, z * 41, False
    for EA, stretch, seabed in product((1.0, 1e9), (1 + 1e-12, 1.5, 1000.0), (True, False)):
        yield "weightless-taut", 0.0, EA, 5.0, 3 * stretch, 4 * stretch, seabed
    for stretch in (0.0, 0.5, 1.0):
        yield "weightless-slack", 0.0, 1e9, 5.0, 3 * stretch, -4 * stretch, False


def _named():
    """The OC3 Hywind line of HB and the OpenFAST r-test, taut polyester in deep water, heavy chain in 30 m."""
    for friction in (0.0, 0.001, 1.0):
        yield "named-line", 698.094, 384.243e6, 902.2, 848.67, 250.0, True, friction
        yield "named-line", 57.475, 28.9e6, 2540.0, 1620.0, 1980.0, True, friction
        yield "named-line", 1870.0, 854e6, 310.0, 296.0, 30.0, True, friction


def _random(rng):
    """Lines drawn over the range of the peers' comparison: L/chord 0.9 to 3, EA/wL 10 to 1e9, friction up to 10."""
    for i in range(60):
        seabed, (w, L) = i % 2 == 0, SIZES[i % len(SIZES)]
        chord, k, slope = L / rng.uniform(0.9, 3.0), 10 ** rng.uniform(1, 9), rng.uniform(0.0, 0.99)
        z = chord * slope * (1 if seabed else rng.choice((-1, 1)))
        friction = rng.choice((0.0, 10 ** rng.uniform(-3, 1))) if seabed else 0.0
        label = "random-seabed" if seabed else "random-floating"
        yield label, w, k * w * L, L, chord * (1 - slope**2) ** 0.5, z, seabed, friction


def design():
    """All rows, named by label and running number."""
    numbers = {label: count(1) for label in LABELS}
    rows = chain(_dealt(_shapes()), _chords(), _touching(), _signs_of_weight(), _named(), _random(Random(SEED)))
    return [Row(f"{label}-{next(numbers[label]):02d}", label, *inputs) for label, *inputs in rows]


def text(value, digits=DIGITS):
    """Scientific notation with all digits; a plain 0 for an exact zero."""
    return "0" if value == 0 else mp.nstr(value, digits, strip_zeros=False, min_fixed=0, max_fixed=0)


def compute(row):
    """The row as a dict of texts by column; raises if the oracle finds a regime that the label does not allow."""
    inputs = {name: getattr(row, name) for name in INPUTS}
    state = catenary_mp.solve(**inputs)
    if state.regime not in LABELS[row.regime]:
        raise ValueError(f"{row.name}: labelled {row.regime} but the oracle finds {state.regime}: {astuple(row)}")
    K = catenary_mp.stiffness(**inputs, solution=state)
    kappa = catenary_mp.condition_number(**inputs, solution=state)
    return (
        {name: value if isinstance(value, str) else repr(value) for name, value in asdict(row).items()}
        | {name: text(getattr(state, name)) for name in STATE}
        | {f"K{i + 1}{j + 1}": text(K[i, j]) for i in (0, 1) for j in (0, 1)}
        | {"condition": text(kappa, CONDITION_DIGITS)}
    )
