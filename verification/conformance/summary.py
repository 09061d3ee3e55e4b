"""Verdicts summed: what mistakes a code makes, over all its cases, and how it does by feature."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

from .judge import INACCURATE, NOT_MODELLED, REFUSED, RIGHT, VERDICTS, WITHOUT, WRONG, Judgement, measure_error

FAULTY = (INACCURATE, WRONG)


@dataclass(frozen=True)
class Diagnosis:
    """A mistake of a code: ids of the cases that it explains; applicable : cases whose answers it would change."""

    name: str
    sentence: str
    cases: tuple[str, ...]
    applicable: int

    def text(self) -> str:
        """Return it in words."""
        what = f" ({self.sentence})" if self.sentence else ""
        many = len(self.cases) > 1
        return (
            f"{self.name}{what}: {len(self.cases)} case{'s' * many} answered so, of {self.applicable} that it changes"
        )


def name_mistakes(judgements: list[Judgement]) -> list[Diagnosis]:
    """Return the mistakes that explain the faulty cases, each case by one, those that explain most first.

    Of those that explain as many, that comes first whose answers fit the greatest share of the cases that it changes,
    then a mistake before a feature left out.
    """
    open_cases = [one for one in judgements if one.matches]
    applicable, diagnoses = _count_applicable(judgements), []
    sentences = {match.name: match.sentence for one in open_cases for match in one.matches}
    matched = Counter(match.name for one in open_cases for match in one.matches)
    while open_cases:
        count = Counter(match.name for one in open_cases for match in one.matches)
        share = {name: matched[name] / max(1, applicable[name]) for name in count}
        best = max(count, key=lambda name: (count[name], share[name], not name.startswith(WITHOUT), name))
        mine = [one for one in open_cases if best in _names(one)]
        ids = tuple(one.case.id for one in mine)
        diagnoses.append(Diagnosis(best, sentences[best], ids, max(applicable[best], len(ids))))
        open_cases = [one for one in open_cases if best not in _names(one)]
    return diagnoses


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
