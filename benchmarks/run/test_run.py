"""The benchmarks' own checks: are the peers called rightly, is every way of failing counted, are files whole?"""

from __future__ import annotations

import importlib.util
import json
import math
import os
import subprocess
import sys
import time
import warnings
from collections import Counter
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from solvers import Status, __version__, solve_network, solve_spans
from verification.cases.spans import NAMED, SpanCase, random_arrays
from verification.reference import WRONG, exact_span
from verification.registry import SpanAnswer

from .. import peers
from ..catenary import accuracy
from ..network import accuracy as network_accuracy
from ..network import growth as network_growth
from ..network import paired_timing as network_turns
from ..network import pictures as network_pictures
from ..network import table2 as network_table2
from ..network.systems import FAMILIES, WEIGHTS, scene, two_lines, without_friction
from ..stability import maps
from . import console, harness, machine, results
from . import oracle_cache as truth

LINE = {"w": 700.0, "EA": 4e8, "L": 900.0}
ORDINARY = (
    SpanCase("hanging below a raised anchor", "", **LINE, x=800.0, z=-250.0, seabed=False),
    SpanCase("sagging", "", **LINE, x=600.0, z=100.0, seabed=False),
    SpanCase("fairlead above", "", **LINE, x=600.0, z=500.0, seabed=False),
    SpanCase("on the seabed", "", **LINE, x=840.0, z=250.0),
    SpanCase("on the seabed, slack", "", **LINE, x=500.0, z=250.0),
    SpanCase("on the seabed, friction", "", **LINE, x=840.0, z=250.0, friction=1.0),
    SpanCase("both ends raised", "", **LINE, x=840.0, z=100.0, clearance=50.0),
    SpanCase("both ends raised, fairlead lower", "", **LINE, x=840.0, z=-40.0, clearance=90.0),
    SpanCase("buoyant", "", **(LINE | {"w": -700.0}), x=600.0, z=100.0, seabed=False),
)
"""Everyday lines, one for each sign and switch that an adapter translates: a peer that misses one is called wrongly."""

ORDINARY_ERROR = {"moorpy": 1e-5, "pycatenary": 2e-2}
"""Their default tolerances, and pycatenary's treatment of stretch; a wrong sign or a missed switch gives 0.1 to 2."""

SOLVERS = harness.solvers()


def solver_of(solve):
    return harness.Solver("made up", "made up", "0", solve)


@pytest.mark.parametrize("case", ORDINARY, ids=lambda case: case.name)
@pytest.mark.parametrize("name", [name for name in SOLVERS if name in ORDINARY_ERROR])
def test_an_adapter_asks_the_question_that_was_meant(name, case):
    result = harness.assess(SOLVERS[name], case, exact_span(case))
    if result["verdict"] == "unsupported":
        pytest.skip(result["message"])
    assert result["error"] is not None
    assert result["error"] < ORDINARY_ERROR[name], result


@pytest.mark.parametrize("change", [{"z": 250.0}, {"seabed": True, "clearance": 250.0}, {"w": -700.0}])
def test_the_bound_on_adapters_can_fail(change):
    meant = ORDINARY[0]
    asked = replace(meant, **change)
    result = harness.assess(solver_of(lambda *_: SOLVERS["catenary"].solve(asked)), meant, exact_span(meant))
    assert result["error"] > max(ORDINARY_ERROR.values())


def raises(case, tolerance):
    raise ZeroDivisionError("float division by zero")


def hangs(case, tolerance):
    while True:
        try:
            time.sleep(0.01)
        except Exception:
            continue


@pytest.mark.parametrize(
    ("solve", "message"),
    [
        (raises, "ZeroDivisionError: float division by zero"),
        (hangs, "no answer within"),
        (lambda *_: SpanAnswer(math.nan, 1.0), "returned H = nan"),
        (lambda *_: SpanAnswer(math.inf, 1.0), "returned H = inf"),
        (lambda *_: SpanAnswer(1.0, 1.0, refused="it said so"), "it said so"),
        (lambda *_: (1.0, 1.0), "returned (1.0, 1.0), and SpanAnswer(H, V) is wanted"),
        (lambda *_: SpanAnswer("1", 1.0), "returned H = '1'"),
        (lambda *_: sys.exit(3), "SystemExit: 3"),
    ],
)
def test_every_way_of_failing_is_refused(monkeypatch, solve, message):
    monkeypatch.setattr(harness, "_overtime", Counter())
    case = NAMED[0]
    result = harness.assess(replace(solver_of(solve), limit=0.1), case, exact_span(case))
    assert (result["verdict"], result["message"][: len(message)]) == ("refused", message)
    assert results.plain(result)["error"] is None


@pytest.mark.parametrize(("factor", "verdict"), [(1.0, "right"), (1 + 1e-4, "right"), (1.01, "wrong"), (-1.0, "wrong")])
def test_verdict(factor, verdict):
    case, exact = NAMED[1], exact_span(NAMED[1])
    assert harness.judge(SpanAnswer(exact.H * factor, exact.V), exact, case)["verdict"] == verdict


def test_what_rounding_of_the_inputs_causes_is_not_called_wrong():
    exact = replace(exact_span(NAMED[0]), condition=1e13)
    result = harness.judge(SpanAnswer(exact.H * 1.01, exact.V), exact, NAMED[0])
    assert result["verdict"] == "right"
    assert result["error"] > harness.WRONG


def test_printing_warning_peers_stay_silent(capsys, recwarn):
    def noisy(case, tolerance):
        print("iterations are as follows")
        warnings.warn("careful", stacklevel=1)
        return SpanAnswer(float(np.float64(1.0) / np.float64(0.0)), 1.0)

    harness.ask(solver_of(noisy), NAMED[0])
    assert capsys.readouterr().out == ""
    assert not recwarn.list


def test_a_solver_that_keeps_hanging_is_not_asked_again(monkeypatch):
    """After PATIENCE times in a row; one answer in between and the count begins anew."""
    monkeypatch.setattr(harness, "_overtime", Counter())
    calls = []

    def hangs_but_once(case, tolerance):
        calls.append(case)
        return SpanAnswer(1.0, 1.0) if len(calls) == 2 else hangs(case, tolerance)

    solver = replace(solver_of(hangs_but_once), limit=0.02)
    results = [harness.ask(solver, NAMED[0]).refused for _ in range(harness.PATIENCE + 4)]
    assert len(calls) == harness.PATIENCE + 2
    assert results[1] == "" and "not asked again" not in results[harness.PATIENCE + 1]
    assert all("not asked again" in words and words.startswith(harness.OVERTIME) for words in results[-2:])


def test_a_peer_that_is_not_installed_is_left_out_and_a_broken_one_is_named(monkeypatch):
    monkeypatch.setattr(peers, "PACKAGES", ("moorpy",))
    monkeypatch.delenv(peers.BROUGHT, raising=False)
    monkeypatch.delitem(sys.modules, "benchmarks.peers.moorpy", raising=False)
    for name in [name for name in sys.modules if name.split(".")[0] == "moorpy"]:
        monkeypatch.delitem(sys.modules, name)
    finder = Finder(ModuleNotFoundError("No module named 'moorpy'", name="moorpy"))
    monkeypatch.setattr(sys, "meta_path", [finder, *sys.meta_path])
    assert peers.adapters.__wrapped__() == {}
    finder.error = ModuleNotFoundError("No module named 'scikit_missing'", name="scikit_missing")
    with pytest.raises(ImportError, match=r"moorpy is installed but cannot be imported.*scikit_missing"):
        peers.adapters.__wrapped__()


def test_own_solvers_have_the_version_of_the_package(monkeypatch):
    """And none that is known where nothing was installed."""
    assert SOLVERS["catenary"].version == harness.own_version() == __version__
    monkeypatch.setattr(harness, "DISTRIBUTION", "no such distribution")
    assert harness.own_version() == "unknown"


def test_the_machine_lists_the_version_of_every_peer():
    """peers.PACKAGES are the distributions of the other codes that adapters call."""
    described = machine.describe()["versions"]
    listed = {package: described[name] for name, package in machine.PACKAGES.items()}
    assert set(peers.PACKAGES) <= listed.keys()
    for name, adapter in peers.adapters().items():
        assert listed.get(name, adapter.version) == adapter.version


class Finder:
    """Lets the import of moorpy fail with ``error``."""

    def __init__(self, error):
        self.error = error

    def find_spec(self, name, path=None, target=None):
        if name == "moorpy":
            raise self.error
        return None


def test_a_result_file_is_strict_and_whole(tmp_path):
    path = tmp_path / "new" / "file.json"
    results.write(path, {"a": np.array([1.0, np.nan]), "b": (np.float64(-np.inf), np.int64(3)), "c": {1: np.True_}})
    assert json.loads(path.read_text()) == {"a": [1.0, None], "b": [None, 3], "c": {"1": True}}
    with pytest.raises(TypeError):
        results.write(path, {"a": object()})
    assert json.loads(path.read_text())["b"] == [None, 3]
    assert os.listdir(path.parent) == ["file.json"]


def test_exact_results_are_kept_and_a_cut_line_is_skipped(tmp_path, monkeypatch):
    known = truth.TruthCache(tmp_path)
    exact = known.get_or_compute(NAMED[0])
    with known.path.open("a") as file:
        file.write('\n["cut", {"H": 1')
    monkeypatch.setattr(truth, "oracle", None)  # a second computation would fail
    again = truth.TruthCache(tmp_path)
    assert again.get_or_compute(NAMED[0]) == exact
    assert again.get(NAMED[1]) is None


def test_an_entry_after_a_cut_line_is_found(tmp_path):
    known = truth.TruthCache(tmp_path)
    known.path.write_text('["cut", {"H": 1')
    truth.TruthCache(tmp_path).get_or_compute(NAMED[0])
    assert truth.TruthCache(tmp_path).get(NAMED[0]) == exact_span(NAMED[0])


def test_a_misled_oracle_is_asked_again_without_a_start(monkeypatch):
    def misled(case, start=None):
        if start is not None:
            raise ValueError("no bracket")
        return exact_span(case)

    monkeypatch.setattr(truth, "exact_span", misled)
    assert truth.oracle(NAMED[0]) == exact_span(NAMED[0])


def test_progress_in_lines(monkeypatch, capsys):
    monkeypatch.setenv(console.PROGRESS, "lines")
    assert list(console.progress("ab", 2, "two")) == ["a", "b"]
    assert capsys.readouterr().out == "progress 1 2\nprogress 2 2\n"


def test_the_map_holds_its_corners_and_the_chord_itself():
    cases = accuracy.map_cases()
    slackness, stiffness = zip(*((c.L / math.hypot(c.x, c.z), c.EA / (c.w * c.L)) for c in cases), strict=True)
    assert len(cases) == accuracy.GRID**2
    assert math.isclose(min(slackness), 0.9)
    assert math.isclose(max(slackness), 3.0)
    assert slackness.count(1.0) == accuracy.GRID
    assert math.isclose(min(stiffness), 10.0)
    assert math.isclose(max(stiffness), 1e9)
    assert len(set(slackness)) == len(set(accuracy.map_slackness()))


def test_mixed_lines_are_valid_repeatable_and_cover_every_regime():
    lines = random_arrays(20_000)
    batch = solve_spans(**lines)
    assert batch.success.all()
    assert {regime.name for regime in batch.regime} == set(type(batch.regime[0]).__members__)
    assert all(np.array_equal(lines[key], column) for key, column in random_arrays(20_000).items())


# ---------------------------------------------------------------- networks
SEEN = 1e-9  # of the largest length or force: what a picture may differ by from the state that it shows


def picture_misses(network, row) -> list[int]:
    """Elements whose drawn ends are not at their nodes, or not of the tension that the state has there."""
    state = solve_network(network)
    length = np.abs(state.r).max() + max(element.L for element in network.elements)
    force = max(np.abs(line["tension"]).max() for line in row["elements"])
    results = []
    for e, (element, line) in enumerate(zip(network.elements, row["elements"], strict=True)):
        drawn = np.array([line[axis] for axis in "xyz"])[:, [0, -1]].T
        apart = np.abs(drawn - state.r[list(element.ends)]).max() / length
        other = np.abs(line["tension"][[0, -1]] - line["ends"]).max() / force
        if not max(apart, other) < SEEN:
            results.append(e)
    return results


@pytest.mark.parametrize(
    "picture", [p for p in network_pictures.PICTURES if p.near is None], ids=lambda picture: picture.name
)
def test_a_picture_shows_the_solved_network(picture):
    """Every drawn line ends at its nodes, with the tension that the state of the network has there."""
    row = network_pictures.rows(picture)[0]
    assert picture_misses(picture.make(), row) == []
    row["elements"][0]["z"] += 1e-3
    row["elements"][-1]["tension"] *= 1.001
    assert picture_misses(picture.make(), row) == sorted({0, len(row["elements"]) - 1})


@pytest.mark.parametrize("w", WEIGHTS)
def test_table_2_is_right_where_it_says_so(monkeypatch, w):
    """Analytic settings in kN from both starts: the exact force; another force is seen; N is badly conditioned."""
    chosen = [o for o in network_table2.methods() if o["jacobian"] == "analytic" and o.get("units") in (None, "kN")]
    for start in ("printed", "sound"):
        for options in chosen:
            (row,) = network_table2.rows(w, start, options, 1)
            assert (row["status"], row["error"] < 1e-9) == ("SUCCESS", True)
            assert (row["inner_iterations"] or 0) > 0 or options["method"] == "monolithic"
    monkeypatch.setitem(network_table2.EXACT_H, w, 1.001 * network_table2.EXACT_H[w])
    (row,) = network_table2.rows(w, "sound", chosen[0], 1)
    assert row["error"] == pytest.approx(1e-3, rel=1e-2)
    assert network_table2.condition_number(w, "N") > 1e4 * network_table2.condition_number(w, "kN")


def test_a_method_that_is_wrong_or_gives_up_has_that_verdict(monkeypatch):
    """A tension off by 1 % is wrong, no convergence is refused, and an answer that stays the same is timed once."""
    title, method = "two lines, 59.1 N/m", network_accuracy.METHODS[0]
    tolerances = (1e-1, 1e-9, 1e-10)
    right = network_accuracy.ladder(title, method, tolerances)
    assert [row["verdict"] for row in right][1:] == ["right", "right"]
    assert right[1]["error"] > 0 and (
        right[1]["error"] != right[2]["error"] or right[1]["seconds"] == right[2]["seconds"]
    )

    def asked(change):
        def solve(*args, **kwargs):
            return change(solve_network(*args, **kwargs))

        monkeypatch.setattr("verification.registry.solve_network", solve)
        return network_accuracy.ladder(title, method, (1e-9,))[0]

    heavier = asked(lambda state: replace(state, H=1.01 * state.H))
    assert heavier["verdict"] == "wrong" and heavier["error"] > WRONG
    stopped = asked(lambda state: replace(state, status=type(state.status).NOT_CONVERGED))
    assert (stopped["verdict"], stopped["error"], stopped["seconds"]) == ("refused", None, None)


def test_a_nested_method_costs_the_lines_that_it_solves_inside():
    """A residual of the monolithic one is an evaluation of each line; of the nested one, the solve of each."""
    rows = {method.name: network_accuracy.ladder("two lines, 59.1 N/m", method, (1e-5,))[0]
            for method in network_accuracy.METHODS}  # fmt: skip
    for row in rows.values():
        assert row["lines"] == 2 and 0 < row["iterations"] < row["evaluations"]
    whole, nested = rows["monolithic-line-search"], rows["nested-analytic"]
    state = solve_network(two_lines(59.1), tolerance=1e-5, start="nodes", fallback=False)
    assert whole["catenary_evaluations"] == 2 * state.function_evaluations + state.inner_iterations
    assert nested["catenary_evaluations"] > 2 * nested["evaluations"]
    assert rows["monolithic-differences"]["evaluations"] > 4 * whole["evaluations"]


def test_the_power_of_growth_is_that_of_the_times():
    """Planted times C n^p give p; small, failed and too few sizes give none of their own."""
    row = lambda n, p, status="SUCCESS": {"family": "net", "elements": n, "seconds": 3e-5 * n**p, "status": status}
    large = [row(n, 1.17) for n in (1000, 3000, 10000)]
    noise = [row(10, 5.0), row(2000, 5.0, "NOT_CONVERGED"), row(5000, 5.0) | {"family": "tree"}]
    assert network_growth.exponent([*large, *noise], "net") == pytest.approx(1.17)
    assert network_growth.exponent(large[:2], "net") is None


ROOT = Path(str(files("benchmarks"))).parent
GREEDY = """
import numpy as np
from benchmarks.network import growth

print(growth.alone("chain", 300)["memory_MB"])
solve = growth.solve_network

def greedy(network, **options):
    held = np.ones(5_000_000 if len(network.elements) > growth.WARM_UP else 1)
    return solve(network, **options) if held.any() else None

growth.solve_network = greedy
print(growth.alone("chain", 300)["memory_MB"])
"""


@pytest.mark.skipif(network_growth.peak_MB() is None, reason="this system does not tell the peak of its memory")
def test_the_memory_of_a_large_solve_holds_all_that_it_allocates():
    """40 MB more inside a solve are 40 MB more in the row; in a process of its own, as it is measured."""
    run = subprocess.run([sys.executable, "-c", GREEDY], cwd=ROOT, capture_output=True, text=True, check=True)
    plain, more = map(float, run.stdout.split())
    assert 30 < more - plain < 50


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("size", [30, 1000, 10000])
def test_a_family_has_about_as_many_elements_as_asked(family, size):
    """Between half and twice the number, with free nodes."""
    network = FAMILIES[family](size)
    assert size / 2 <= len(network.elements) <= 2 * size
    assert any(node.kind == "free" for node in network.nodes)


def test_ratios_are_those_of_one_turn():
    """Load that falls on both solvers of a turn does not change the ratio; one interrupted turn hardly."""
    load = np.array([1.0, 5.0, 1.0, 2.0, 1.0])
    times = {"slow": 3e-3 * load, "fast": 1e-3 * load}
    assert network_turns.against(times, "slow", "fast")["ratio"] == pytest.approx(3.0)
    times["slow"][0] *= 50
    assert network_turns.against(times, "slow", "fast")["ratio"] == pytest.approx(3.0)


@pytest.mark.skipif(importlib.util.find_spec("moorpy") is None, reason="MoorPy is not installed")
def test_moorpy_is_asked_about_the_same_network():
    """At its tight tolerance its tensions are those of this project; on another network they are not."""
    from ..peers import moorpy_networks as moorpy

    network = without_friction(scene("three_bridles"))
    assert network_turns.warm(network, moorpy, moorpy.TIGHT, 1)["peer_tension_difference"] < 1e-6
    build = moorpy.build
    heavier = replace(network, elements=(replace(network.elements[0], w=710.0), *network.elements[1:]))
    other = type("other", (), {**vars(moorpy), "build": staticmethod(lambda _: build(heavier))})
    assert network_turns.warm(network, other, moorpy.TIGHT, 1)["peer_tension_difference"] > 1e-4


def test_the_two_lines_are_those_of_the_paper():
    """Anchors, lengths, stiffness and buoyancy as printed in MSQS, section 5."""
    network = two_lines(59.1)
    assert [node.r for node in network.nodes[:2]] == [(-1200.0, 0.0, -350.0), (0.0, 0.0, -350.0)]
    assert [(line.L, line.EA) for line in network.elements] == [(1175.0, 2.34e8), (300.0, 2.34e8)]
    assert network.nodes[2].force == (0.0, 0.0, 637650.0)


# ---------------------------------------------------------------- stability maps
@pytest.mark.parametrize(
    ("error", "warned", "verdict"),
    [(0.09, (), "solved"), (0.11, (), "too coarse"), (0.11, ("a coarse mesh",), "warned")],
)
def test_a_point_beyond_the_bound_of_its_map_is_not_called_solved(error, warned, verdict):
    """A success without a warning counts as solved only within the bound that the map states."""
    axis = maps.Axis("x", (1.0,))
    answer = maps.Found(Status.SUCCESS, error, warned=warned)
    one = maps.Map("planted", "time domain", "", axis, axis, "", "", lambda x, y: answer)
    (row,) = one.row(0)
    assert row["verdict"] == verdict and one.entry([row])["bound"] == one.bound == maps.BOUNDS["time domain"]
    exact = replace(one, solver="span")
    assert exact.bound is None and exact.row(0)[0]["verdict"] == ("warned" if warned else "solved")
