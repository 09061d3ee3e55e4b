"""The margin of a line by hand, and the sentence on what would meet a tolerance."""

from __future__ import annotations

import pytest

from benchmarks.scenes.margin import margin, margins

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
