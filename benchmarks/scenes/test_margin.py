"""The margin of a line by hand, and the sentence on what would meet a tolerance."""

from __future__ import annotations

import pytest

from benchmarks.scenes.margin import margin, margins, margins_of_cases
from solvers.load_cases import CaseResult
from solvers.load_cases.results import LineResult

ROUNDING = 1e-14  # relative


def test_margin_by_hand():
    """Mean 1 MN, greatest 1.6 MN, breaking load 4 MN: 1.1 + 1.5 0.6 = 2.0 MN of 3.8 MN."""
    part = margin(1.0e6, 1.6e6, 4.0e6, (1.1, 1.5))
    assert part["design"] == pytest.approx(2.0e6, rel=ROUNDING) and part["strength"] == pytest.approx(3.8e6)
    assert part["utilisation"] == pytest.approx(2.0 / 3.8, rel=ROUNDING) and part["given"]


def test_without_factors_forces_are_compared():
    """Both factors one, and said not to be given; a line without a breaking load has no margin."""
    part = margin(1.0e6, 1.6e6, 4.0e6, None)
    assert part["utilisation"] == pytest.approx(1.6 / 3.8, rel=ROUNDING) and not part["given"]
    rows = [{"line": "a", "mean": 1.0, "max": 2.0}, {"line": "b", "mean": 1.0, "max": 2.0}]
    assert [row["line"] for row in margins(rows, [None, 4.0], None)] == ["b"]


def case(name: str, *lines: tuple) -> CaseResult:
    """Return a case of lines (mean, maximum, extreme) in N; without lines it failed."""
    rows = tuple(LineResult(f"line {k}", 0.0, mean, maximum, 0.0, 0.0, extreme, None, None, 0.0, 0.0, 0.0, 0.0)
                 for k, (mean, maximum, extreme) in enumerate(lines))  # fmt: skip
    return CaseResult(0, name, "SUCCESS" if lines else "FAILED", "", rows)


def test_of_load_cases_the_one_that_leaves_least_counts():
    """By the extreme where it is the larger, else by the greatest tension; mean 1, extreme 2: 1.1 + 1.5 of 3.8 MN."""
    cases = [case("calm", (1e6, 1.2e6, 1.3e6), (1e6, 1.1e6, None)), case("failed"),
             case("storm", (1e6, 1.8e6, 2e6), (1e6, 1.5e6, 1.4e6))]  # fmt: skip
    first, second = margins_of_cases(cases, [4e6, 4e6], (1.1, 1.5))
    assert (first["case"], first["basis"]) == ("storm", "extreme")
    assert first["utilisation"] == pytest.approx(2.6 / 3.8, rel=ROUNDING)
    assert (second["case"], second["basis"], second["dynamic"]) == ("storm", "greatest", pytest.approx(0.5e6))
    assert [row["line"] for row in margins_of_cases(cases, [None, 4e6], None)] == ["line 1"]
    assert margins_of_cases(cases, [], None) == []
