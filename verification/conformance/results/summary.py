"""Verdicts summed: what mistakes a code makes, over all its cases, and how it does by feature."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

from ..judge import INACCURATE, NOT_MODELLED, REFUSED, RIGHT, VERDICTS, WITHOUT, WRONG, Judgement, measure_error

FAULTY = (INACCURATE, WRONG)
LEAST_SHARE = 0.25
"""Of the faulty cases that a mistake changes, those whose answers it has: with fewer the code does not make it."""


@dataclass(frozen=True)
class Diagnosis:
    """A mistake of a code: ids of the cases that it explains; applicable : cases whose answers it would change.

    alike : other mistakes that explain the same cases as well, and cannot be told from it by what was answered
    """

    name: str
    sentence: str
    cases: tuple[str, ...]
    applicable: int
    alike: tuple[str, ...] = ()

    def text(self) -> str:
        """Return it in words."""
        what = f" ({self.sentence})" if self.sentence else ""
        names = " or ".join((self.name, *self.alike))
        return f"{names}{what}: {len(self.cases)} of the {self.applicable} cases that it changes are answered so"


def name_mistakes(judgements: list[Judgement]) -> list[Diagnosis]:
    """Return the mistakes that explain the faulty cases, each case by one, those that explain most first.

    One that explains fewer than LEAST_SHARE of the faulty cases that it changes is left out: the match stands with its
    case, and may be chance.

    Of those that explain as many, that comes first whose answers fit the greatest share of the cases that it changes,
    then a mistake before a feature left out.
    """
    faulty = [one for one in judgements if one.verdict in FAULTY]
    sentences = {match.name: match.sentence for one in faulty for match in one.matches}
    matched, applicable = Counter(name for one in faulty for name in _names(one)), _count_applicable(judgements)
    changed = _count_applicable(faulty)
    likely = {name for name in matched if matched[name] >= LEAST_SHARE * changed.get(name, len(faulty))}
    names = {one.case.id: _names(one) & likely for one in faulty if _names(one) & likely}
    diagnoses = []
    while names:
        count = Counter(name for mine in names.values() for name in mine)
        share = {name: matched[name] / max(1, applicable[name]) for name in count}
        best = max(count, key=lambda name: (count[name], share[name], _is_mistake(name), name))
        mine = {case: own for case, own in names.items() if best in own}
        alike = sorted(name for name in set.intersection(*mine.values()) if _is_mistake(name) and name != best)
        many = max(applicable.get(best, len(faulty)), len(mine))
        diagnoses.append(Diagnosis(best, sentences[best], tuple(mine), many, tuple(alike)))
        names = {case: own for case, own in names.items() if best not in own}
    return diagnoses


def count_unexplained(judgements, diagnoses) -> int:
    """Return how many inaccurate and wrong cases no diagnosis explains."""
    explained = {case for one in diagnoses for case in one.cases}
    return sum(one.verdict in FAULTY and one.case.id not in explained for one in judgements)


def _is_mistake(name: str) -> bool:
    return not name.startswith(WITHOUT)


def _names(judgement: Judgement) -> set[str]:
    return {match.name for match in judgement.matches}


def _count_applicable(judgements) -> Counter:
    """Return how many judged cases each mistake changes, in a quantity that was answered."""
    count = Counter()
    for one in judgements:
        known = {f"{WITHOUT}{feature}": answer for feature, answer in one.case.without.items()} | one.case.mistakes
        for name, answer in known.items():
            count[name] += any(
                measure_error(one.case, verdict.quantity, answer[verdict.quantity]) > verdict.right
                for verdict in one.quantities
                if verdict.quantity in answer
            )
    return count


def count_verdicts(judgements) -> dict[str, int]:
    """Return verdict -> number of cases, those that occur."""
    count = Counter(one.verdict for one in judgements)
    return {verdict: count[verdict] for verdict in VERDICTS if count[verdict]}


def summarise_features(judgements) -> dict[str, str]:
    """Return feature -> one sentence on the cases that isolate it."""
    features = dict.fromkeys(feature for one in judgements for feature in one.case.features)
    return {
        feature: _feature_text(feature, [one for one in judgements if feature in one.case.features])
        for feature in features
    }


def _feature_text(feature: str, judgements: list[Judgement]) -> str:
    total, count = len(judgements), count_verdicts(judgements)
    order = sorted(count, key=lambda verdict: (WRONG, REFUSED, INACCURATE, RIGHT, NOT_MODELLED).index(verdict))
    parts = [f"{count[verdict]} of {total} {verdict}" if i == 0 else f"{count[verdict]} {verdict}"
             for i, verdict in enumerate(order)]  # fmt: skip
    faulty = [one for one in judgements if one.verdict in FAULTY]
    absent = sum(f"{WITHOUT}{feature}" in _names(one) for one in faulty)
    if absent:
        parts.append(f"{'all' if absent == len(faulty) else absent} as if there were none")
    else:
        for diagnosis in name_mistakes(faulty)[:1]:
            many, name = len(diagnosis.cases), diagnosis.name
            name = name if name.startswith(WITHOUT) else f"with {name}"
            parts.append(f"{'all' if many == len(faulty) else many} as {name}")
    return ", ".join(parts)


def count_answered(judgements) -> tuple[int, int]:
    """Return how many quantities were answered, of those asked, over the cases that were answered."""
    answered = [one for one in judgements if one.quantities]
    return sum(len(one.quantities) for one in answered), sum(len(one.case.truth) for one in answered)
