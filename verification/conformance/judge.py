"""Verdicts: what an answer is, by the published bounds of its case, and what mistake it is the answer of.

Errors are differences from the truth over the scale of the quantity: of arrays the greatest difference, of a series of
a moving line the rms over the compared period, of several series the greatest.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from .conventions import list_conventions
from .tables import Case

RIGHT, INACCURATE, WRONG, REFUSED, NOT_MODELLED = "right", "inaccurate", "wrong", "refused", "not modelled"
VERDICTS = (RIGHT, INACCURATE, WRONG, REFUSED, NOT_MODELLED)

SERIES = ("fairlead_tension", "anchor_tension", "tension", "force")
"""Quantities of moving lines whose last axis is time."""

OF_SERIES = {"mean": "fairlead_tension", "harmonics": "fairlead_tension"}
"""Quantities that follow from a series, and that tables leave out of the answers of mistakes."""

CLOSE = 0.02
"""Share of what a mistake changes by which an answer may miss that of the mistake: a code has errors of its own."""

WITHOUT = "without "
"""How the name of a match begins that leaves a whole feature out."""


class Nonsense(ValueError):
    """What was answered cannot be judged; the text names the quantity and what is wrong with it."""


@dataclass(frozen=True)
class QuantityVerdict:
    """The error of one quantity, over its scale, with the bounds by which it is judged."""

    quantity: str
    verdict: str
    error: float
    right: float
    wrong: float

    @property
    def digits(self) -> float:
        """Correct decimal digits, relative to the scale; infinite for an exact answer."""
        return math.inf if self.error == 0 else max(0.0, -math.log10(self.error))


@dataclass(frozen=True)
class Match:
    """A mistake whose answer is that of the code.

    name : of the mistake, or "without" a feature; sentence : what is done wrong
    agreement : greatest difference from the answer of the mistake, over the scale
    quantities : those that it explains; complete : whether all that it changes is so
    """

    name: str
    sentence: str
    agreement: float
    quantities: tuple[str, ...]
    complete: bool = True

    def text(self) -> str:
        """Return the match in words."""
        part = "" if self.complete else f"in {', '.join(self.quantities)}: "
        if self.name.startswith(WITHOUT):
            return f"{part}equals the answer {self.name} to {self.agreement:.0e}"
        return f"{part}equals the answer of {self.name} ({self.sentence}) to {self.agreement:.0e}"


@dataclass(frozen=True)
class Judgement:
    """The verdict on one case: that of its worst quantity; words : of a refusal, why."""

    case: Case
    verdict: str
    quantities: tuple[QuantityVerdict, ...] = ()
    matches: tuple[Match, ...] = ()
    words: str = ""

    @property
    def unanswered(self) -> tuple[str, ...]:
        """Quantities of the truth that were not given."""
        answered = {one.quantity for one in self.quantities}
        return tuple(name for name in self.case.truth if name not in answered)

    def fails(self, strict: bool = False) -> bool:
        """Whether a test of it fails: wrong, refused on an everyday case, and if strict inaccurate, too."""
        if self.verdict == REFUSED:
            return self.case.group == "everyday"
        return self.verdict == WRONG or (strict and self.verdict == INACCURATE)

    def text(self) -> str:
        """Return the verdict with its bounds, quantity by quantity, and the mistakes that it matches."""
        lines = [f"{self.case.id}: {self.verdict} ({self.case.group}: {self.case.title})"]
        if self.words:
            return f"{lines[0]}: {self.words}"
        width = max((len(one.quantity) for one in self.quantities), default=0)
        for one in self.quantities:
            digits = f", {one.digits:.1f} digits" if one.verdict == INACCURATE else ""
            bounds = f"right up to {one.right:.0e}, wrong above {one.wrong:.0e}"
            lines.append(f"  {one.quantity:<{width}}  {one.verdict}{digits}: error {one.error:.1e} ({bounds})")
        lines += [f"  {match.text()}" for match in self.matches]
        if self.unanswered:
            asked = len(self.case.truth)
            lines.append(
                f"  {asked - len(self.unanswered)} of {asked} quantities answered, without {', '.join(self.unanswered)}"
            )
        return "\n".join(lines)


def judge(case: Case, answer: Mapping, sentences: Mapping | None = None) -> Judgement:
    """Return the judgement of an answer, quantity -> value; None is not answered.

    sentences : name of a mistake -> what is done wrong, of the table. An answer of the wrong shape, a text and a value
    that is not finite are refused.
    """
    try:
        values = {name: as_numbers(case, name, answer[name]) for name in case.truth if answer.get(name) is not None}
    except Nonsense as error:
        return Judgement(case, REFUSED, words=str(error))
    if not values:
        return Judgement(case, REFUSED, words=f"answered none of {', '.join(case.truth)}")
    verdicts = tuple(_judge_quantity(case, name, value) for name, value in values.items())
    worst = max((one.verdict for one in verdicts), key=VERDICTS.index)
    matches = () if worst == RIGHT else find_mistakes(case, values, verdicts, sentences or {})
    return Judgement(case, worst, verdicts, matches)


def as_numbers(case: Case, name: str, value) -> np.ndarray:
    """Return a quantity as an array of the shape of its truth. Raises Nonsense naming what is wrong."""
    shape = np.shape(case.truth[name])
    wanted = "a number is" if shape == () else f"numbers of shape {shape} are"
    try:
        array = np.array(value)
    except ValueError:
        raise Nonsense(f"{name} is ragged, and {wanted} wanted: {value!r:.60}") from None
    if array.dtype.kind not in "fiu":
        raise Nonsense(f"{name} = {value!r:.60}, and {wanted} wanted")
    if array.shape != shape:
        turned = ": it is transposed" if array.shape == shape[::-1] else ""
        raise Nonsense(f"{name} has the shape {array.shape}, and {wanted} wanted{turned}")
    if not np.isfinite(array).all():
        bad = array[~np.isfinite(array)].flat[0]
        raise Nonsense(f"{name} holds {bad}, and finite numbers are wanted" if shape else f"{name} = {bad}")
    return array.astype(float)


def measure_error(case: Case, name: str, value, reference=None) -> float:
    """Return the difference of a quantity from a reference (None: the truth), over its scale."""
    reference = case.truth[name] if reference is None else reference
    with np.errstate(over="ignore"):  # the square of a nonsensically large answer is infinite, and so is its error
        a, b = (_as_phasors(name, np.asarray(one, dtype=float)) for one in (value, reference))
        difference = np.abs(a - b)
        if case.level == "motion" and name in SERIES:
            difference = np.sqrt((difference**2).mean(axis=-1))
        return float(np.max(difference / np.asarray(case.scale[name])))


def _as_phasors(name: str, array):
    """Return harmonics, rows of amplitude and phase in rad, as complex numbers; all else as it is."""
    return array[..., 0] * np.exp(1j * array[..., 1]) if name == "harmonics" else array


def _judge_quantity(case: Case, name: str, value) -> QuantityVerdict:
    error, (right, wrong) = measure_error(case, name, value), case.bound[name]
    verdict = RIGHT if error <= right else WRONG if error > wrong else INACCURATE
    return QuantityVerdict(name, verdict, error, right, wrong)


# ---------------------------------------------------------------- what mistake it is
def find_mistakes(case: Case, values: Mapping, verdicts, sentences: Mapping) -> tuple[Match, ...]:
    """Return the mistakes whose answers the values are: those that explain most, the closest first.

    A mistake matches where every quantity that it changes is near its answer, and it explains all that is not right;
    then conventions.py is asked; else those count that are within the bound of a right answer in most of the quantities
    that they change, or leave something unexplained.
    """
    bad = {one.quantity for one in verdicts if one.verdict != RIGHT}
    known = {f"{WITHOUT}{feature}": answer for feature, answer in case.without.items()} | case.mistakes
    matches = [_match(case, values, bad, name, answer, sentences.get(name, "")) for name, answer in known.items()]
    matches = [one for one in matches if one is not None]
    if not any(one.complete for one in matches):
        conventions = list_conventions(case, values, bad)
        more = [_match(case, values, bad, name, answer, words) for name, (words, answer) in conventions.items()]
        matches += [one for one in more if one is not None and one.complete]
    matches = [one for one in matches if one.complete] or matches
    most = max((len(one.quantities) for one in matches), default=0)
    matches = [one for one in matches if len(one.quantities) == most]
    exact = [one for one in matches if one.agreement <= max(case.bound[name][0] for name in one.quantities)]
    return tuple(sorted(exact or matches, key=lambda one: one.agreement))


def _match(case: Case, values, bad, name, answer, sentence) -> Match | None:
    """Return the match of one mistake; None where the values are not its answer."""
    explained, missed, agreement, most = [], 0, 0.0, 0.0
    for quantity in answer.keys() & values.keys():
        right = case.bound[quantity][0]
        change = measure_error(case, quantity, answer[quantity])
        most = max(most, change)
        miss = measure_error(case, quantity, values[quantity], answer[quantity])
        if miss > max(right, CLOSE * change):
            missed += 1
        elif quantity in bad:
            explained.append((quantity, miss <= right))
            agreement = max(agreement, miss)
    names = tuple(quantity for quantity in case.truth if quantity in {one for one, _ in explained})
    open_quantities = {one for one in bad - answer.keys() if OF_SERIES.get(one) not in answer}
    others = (measure_error(case, quantity, values[quantity]) for quantity in open_quantities)
    complete = not missed and all(error <= CLOSE * most for error in others)
    if not names or not (complete or (len(names) > missed and all(exact for _, exact in explained))):
        return None
    return Match(name, sentence, agreement, names, complete)
