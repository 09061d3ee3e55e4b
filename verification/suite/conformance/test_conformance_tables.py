"""Are the conformance tables of lines and networks at rest whole, discriminating and true?"""

from __future__ import annotations

import hashlib
import json
import math
import subprocess
import sys
from importlib.resources import files
from itertools import combinations

import numpy as np
import pytest

from verification import ROOT

from ...conformance.judge import measure_error
from ...conformance.problems import as_arguments
from ...conformance.tables import load_table
from .test_conformance_mistakes import solve_line, solve_net

LEVELS = ("statics", "network")
TABLES = {level: load_table(level) for level in LEVELS}
CASES = [case for level in LEVELS for case in TABLES[level].cases]
FEATURES = {"friction", "contact", "slack", "vertical", "taut", "buoyant", "elastic", "clearance"}
FEATURES_OF_NETWORKS = FEATURES | {"joints"}
LEAST_CASES = 3
MOVES = 20
"""How many times its right bound a case moves, at least, when a feature that it isolates is left out."""
IDS = {
    ("2026.11", "statics"): (54, "63be13db0adf"),
    ("2026.11", "network"): (18, "03163c08fea0"),
}
"""(version, level) -> number of cases and a digest of their ids: a version keeps its cases."""
INDISTINGUISHABLE: dict[str, set] = {"statics": set(), "network": set()}
"""Pairs of mistakes whose answers no case tells apart, to the right bound."""
LONGEST = 300  # s of one row and its mistakes, on a busy machine


def raw(level):
    """Return the table as it is in its file."""
    return json.loads((files("reference_data") / "conformance" / f"{level}.json").read_text(encoding="utf-8"))


# ---------------------------------------------------------------- format
@pytest.mark.parametrize("level", LEVELS)
def test_ids_are_unique_and_those_of_their_version(level):
    """Whoever cites a version, or lists expected failures by id, finds the cases again."""
    table = TABLES[level]
    ids = [case.id for case in table.cases]
    assert len(set(ids)) == len(ids)
    assert all(name == name.lower() and name.startswith(f"{level}/") and " " not in name for name in ids)
    digest = hashlib.sha256("\n".join(ids).encode()).hexdigest()[:12]
    assert (len(ids), digest) == IDS[table.version, level]


@pytest.mark.parametrize("case", CASES, ids=[case.id for case in CASES])
def test_case_is_whole(case):
    """Answers of mistakes have the shape of the truth, mistakes are described, numbers finite, words of the lists."""
    table = TABLES[case.level]
    assert case.group in ("everyday", "extreme") and case.title and case.features
    assert set(case.features) <= (FEATURES if case.level == "statics" else FEATURES_OF_NETWORKS)
    assert set(case.without) == set(case.features) and set(case.mistakes) <= set(table.mistakes)
    assert set(case.truth) == set(case.scale) == set(case.bound) == set(case.uncertainty)
    for answer in (*case.mistakes.values(), *case.without.values()):
        assert answer and set(answer) <= set(case.truth)
        for name, value in answer.items():
            assert np.shape(value) == np.shape(case.truth[name]) and np.isfinite(value).all()
    assert all(np.isfinite(value).all() for value in case.truth.values())
    assert all(case.uncertainty[name] < 0.01 * case.bound[name][0] for name in case.truth)


@pytest.mark.parametrize("level", LEVELS)
def test_words_of_the_table(level):
    """Every quantity and input has its unit, every mistake a sentence and a case that it changes."""
    table, data = TABLES[level], raw(level)
    used = {name for case in table.cases for name in (*case.truth, *case.inputs)}
    assert used <= set(table.units)
    made = {name for case in table.cases for name in case.mistakes}
    assert made == set(table.mistakes) and all(text.endswith(".") for text in data["mistakes"].values())


@pytest.mark.parametrize("case", CASES, ids=[case.id for case in CASES])
def test_weight_follows_from_mass_and_diameter(case):
    """A code may compute the weight itself: it gets the same one, to rounding."""
    parts = case.inputs["elements"] if case.level == "network" else [case.inputs]
    for part in parts:
        rho, g = case.inputs["rho"], case.inputs["g"]
        displaced = rho * math.pi * part["diameter"] ** 2 / 4
        w = g * (part["mass_per_length"] - displaced)
        assert abs(w - part["w"]) <= 4 * 2.0**-52 * g * max(part["mass_per_length"], displaced)


# ---------------------------------------------------------------- discrimination
def move(case, answer, reference=None):
    """Return the largest change of an answer over the right bound; quantities that are not listed are the truth's."""
    reference = {} if reference is None else reference
    changes = [0.0]
    for name in answer.keys() | reference.keys():
        a, b = (given.get(name, case.truth[name]) for given in (answer, reference))
        changes.append(measure_error(case, name, a, b) / case.bound[name][0])
    return max(changes)


@pytest.mark.parametrize("case", CASES, ids=[case.id for case in CASES])
def test_feature_left_out_moves_the_case(case):
    assert all(move(case, answer) >= MOVES for answer in case.without.values()), case.without.keys()


def test_each_feature_is_isolated_by_some_cases():
    """By three lines at least, and each of the features of networks by one network or more."""
    for feature in FEATURES:
        assert sum(feature in case.features for case in TABLES["statics"].cases) >= LEAST_CASES, feature
    for feature in FEATURES_OF_NETWORKS:
        assert any(feature in case.features for case in TABLES["network"].cases), feature
    assert sum("joints" in case.features for case in TABLES["network"].cases) >= LEAST_CASES


@pytest.mark.parametrize("level", LEVELS)
def test_mistakes_are_told_apart(level):
    """Two mistakes that both change some case give answers there that differ by more than both bounds."""
    alike = set()
    for a, b in combinations(TABLES[level].mistakes, 2):
        shared = [case for case in TABLES[level].cases if a in case.mistakes and b in case.mistakes]
        if shared and not any(move(case, case.mistakes[a], case.mistakes[b]) > 2 for case in shared):
            alike.add(frozenset((a, b)))
    assert alike == INDISTINGUISHABLE[level]


@pytest.mark.parametrize("level", LEVELS)
def test_mistake_listed_changes_its_case(level):
    for case in TABLES[level].cases:
        for name, answer in case.mistakes.items():
            assert move(case, answer) > 1, (case.id, name)


# ---------------------------------------------------------------- truth
@pytest.mark.parametrize("case", CASES, ids=[case.id for case in CASES])
def test_truth_agrees_with_the_solvers(case):
    """The oracle and the solvers share no formula: each quantity of each case agrees within its right bound."""
    solve = solve_line if case.level == "statics" else solve_net
    answer = solve(*as_arguments(case.problem, case.inputs))
    errors = {name: measure_error(case, name, answer[name]) / case.bound[name][0] for name in case.truth}
    assert max(errors.values()) <= 1, errors


@pytest.mark.parametrize("name", ["conformance_statics", "conformance_networks"])
def test_rows_are_those_of_the_generator(name, deep):
    """A row computed anew is the same text: the table is the generator's, not edited."""
    if name == "conformance_networks" and not deep:
        pytest.skip("a stiffness by differences at forty digits: with --deep")
    words = [sys.executable, "-m", "reference_data", "check", "--only", name, "--sample", "1", "--jobs", "1"]
    run = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, timeout=LONGEST)
    assert run.returncode == 0 and "0 differences" in run.stdout, run.stdout + run.stderr
