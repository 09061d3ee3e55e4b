"""Does the excursion of each line depend on its own row alone, whatever kinds of lines stand in one call?"""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from solvers.catenary.excursion import Excursion, excursion

LINES = (  # H, V, w, EA, L, can_rest, friction, clearance
    (50.0, 80.0, 1.0, 1e4, 60.0, True, 0.0, 0.0),  # hangs free
    (50.0, 40.0, 1.0, 1e4, 60.0, True, 0.0, 0.0),  # rests on a smooth seabed
    (50.0, 40.0, 1.0, 1e4, 60.0, False, 0.0, 0.0),  # the same force without a seabed
    (50.0, 40.0, 1.0, 1e4, 60.0, True, 0.5, 0.0),  # friction, tension at the anchor
    (2.0, 20.0, 1.0, 1e4, 60.0, True, 0.5, 0.0),  # friction that takes up the tension
    (50.0, 20.0, 1.0, 1e4, 60.0, True, 0.0, 5.0),  # rests below a raised anchor
    (50.0, 59.0, 1.0, 1e4, 60.0, True, 0.0, 5.0),  # does not touch below a raised anchor
    (0.0, 80.0, 1.0, 1e4, 60.0, False, 0.0, 0.0),  # vertical and taut
    (0.0, 20.0, 1.0, 1e4, 60.0, False, 0.0, 0.0),  # vertical and folded over
    (30.0, 40.0, 0.0, 1e4, 60.0, False, 0.0, 0.0),  # a spring
)


def test_rows_do_not_know_their_neighbours():
    """All kinds in one call give what each gives in a call of its own, without a floating-point error."""
    columns = [np.array(column) for column in zip(*LINES, strict=True)]
    with np.errstate(divide="ignore", invalid="ignore"):  # of the free formulas at H = 0 and w = 0, which are replaced
        together = excursion(*columns)
        alone = [excursion(*(column[i : i + 1] for column in columns)) for i in range(len(LINES))]
    for name in (field.name for field in fields(Excursion)):
        expected = np.concatenate([getattr(one, name) for one in alone])
        assert np.allclose(getattr(together, name), expected, rtol=1e-14, atol=0), name


def test_a_raised_anchor_and_one_on_the_seabed_in_one_call():
    """No division by the compliance of the end that lies on the seabed, which is zero."""
    rows = [line for line in LINES if line[0] == 50.0 and line[5] and (line[6] or line[7])]
    assert len(rows) == 3
    result = excursion(*(np.array(column) for column in zip(*rows, strict=True)))
    assert result.by_clearance[0, 2] == 0.0 and result.by_clearance[1, 2] < 0.0


@pytest.mark.parametrize(("V", "w"), [(80.0, 1.0), (-20.0, 1.0), (-80.0, -1.0), (20.0, -1.0), (20.0, 1.0)])
def test_a_vertical_line_is_the_limit_of_inclined_ones(V, w):
    """H -> 0 of a soft line that is pulled up, down, floats or folds over: there d(l)/dH grows beyond all bounds."""
    column = lambda value: np.array([value])
    line = (column(w), column(100.0), column(60.0), column(False), column(0.0), column(0.0))
    with np.errstate(divide="ignore", invalid="ignore"):  # of the free formulas at H = 0, which are replaced
        vertical, inclined = (excursion(column(H), column(V), *line) for H in (0.0, 1e-6))
    for name in (field.name for field in fields(Excursion)):
        limit, near = getattr(vertical, name), getattr(inclined, name).copy()
        if name == "C" and V * (V - w * 60.0) <= 0:
            assert limit[0, 0, 0] == np.inf and near[0, 0, 0] > 10
            near[0, 0, 0] = np.inf
        assert limit == pytest.approx(near, rel=1e-5, abs=1e-4), name
