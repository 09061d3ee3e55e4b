"""Does the motion table hold what its generator gives: the inputs, and the truth of each by both formulations?"""

from __future__ import annotations

import numpy as np
import pytest

from verification.conformance.tables import load_table

from . import motion
from .cases import BOX, EXACT, NODES, all_cases
from .responses import spread

CASES = {case.id: case for case in all_cases()}
ROWS = {case.id: case for case in load_table("motion").cases}
QUICK = {BOX: "motion/damping-steep", NODES: "motion/friction-soft-line"}
"""One case of each second formulation; those of EXACT take minutes."""
REPEATED = 1e-4  # of the range: six digits of a tension ten times its range, and the rounding of another machine
KEPT = 0.1  # of a quantity's uncertainty: numbers stay within a version where a better solver moves them by less


@pytest.fixture
def wanted(request):
    """Whether a case is recomputed: a quick one, or any with --deep."""
    return lambda name: name in QUICK.values() or request.config.getoption("--deep")


def test_the_table_has_the_inputs_of_the_generator():
    """All cases, with the inputs, features and titles that stand in cases.py: nothing was changed by hand."""
    assert list(ROWS) == list(CASES)
    for name, case in CASES.items():
        row = ROWS[name]
        assert row.inputs == case.inputs and row.features == case.features and row.title == case.title, name


@pytest.mark.parametrize("name", CASES)
def test_truth_by_both_formulations(name, wanted):
    """The truth again, and what mesh and second formulation leave: within what the table says."""
    if not wanted(name):
        pytest.skip("with --deep")
    case, row = CASES[name], ROWS[name]
    truth, before = motion.first_formulation(case)
    known = {key: np.array(row.truth[key]) for key in truth}
    for key, moved in spread(truth, known, row.scale).items():
        assert moved <= max(REPEATED, KEPT * row.uncertainty[key]), key
    again = motion.uncertainty_of(case, truth, before, row.scale)
    for key, u in again.items():
        assert u <= 1.05 * row.uncertainty[key] + REPEATED, key


def test_each_second_formulation_is_there():
    """The box scheme, nodes and elements, and the reference integrator each check some case."""
    assert {case.second for case in CASES.values()} == {BOX, NODES, EXACT}
