"""Are the values right that the tests of other codes expect? The sets of reference_data/peer_tests under the oracle."""

from __future__ import annotations

import csv
import math
import tomllib
from functools import cache
from importlib.resources import files
from types import SimpleNamespace

import numpy as np
import pytest
from mpmath import mp

from ...exact.cable import catenary_mp
from ...exact.network import network_mp

DATA = files("reference_data") / "peer_tests"
SOURCE = tomllib.loads((DATA / "source.toml").read_text(encoding="utf-8"))["sets"]

MET = 7.4e-6  # largest relative error of the nine values that MoorPy's test has right, 7.3e-6, stated in source.toml
STATED = 0.05  # of a deviation that source.toml states with two digits: half a unit of the second digit
HALF_UNIT = 0.5 * (1 + 1e-9)  # of a last printed digit, and the rounding of the subtraction


def rows(name):
    """Return the rows of a set, numbers where they are numbers."""
    with (DATA / f"{name}.csv").open(newline="", encoding="utf-8") as file:
        return [
            {key: text if key == "name" else float(text) for key, text in row.items()} for row in csv.DictReader(file)
        ]


# ---------------------------------------------------------------- MoorPy: ten catenaries
def moorpy_deviations(row):
    """Return name -> deviation from the exact value, to 50 digits, over the expected one, as MoorPy has it."""
    heavy = row["w"] > 0
    line = {name: row[name] for name in ("w", "EA", "L", "x", "z")} | {
        "seabed": heavy,
        "friction": max(row["CB"], 0.0),
        "clearance": max(-row["CB"], 0.0) if heavy else 0.0,
    }
    state = catenary_mp.solve(**line)
    exact = {"fAH": state.H_anchor, "fAV": state.V_anchor, "fBH": -state.H, "fBV": -state.V}
    exact["LBot"] = state.grounded_length
    with mp.workdps(50):
        deviations = {name: abs(row[name] - value) for name, value in exact.items()}
        return {name: float(d / abs(row[name])) if row[name] else float(d) for name, d in deviations.items()}


MOORPY = {row["name"]: row for row in rows("moorpy_catenary")}


def test_moorpy_has_ten_catenaries():
    assert len(MOORPY) == 10 and "near-taut" in MOORPY


@pytest.mark.parametrize("name", [name for name in MOORPY if name != "near-taut"])
def test_nine_catenaries_of_moorpy_are_met(name):
    """To 7.3e-6, within the 1e-5 that its test accepts."""
    deviations = moorpy_deviations(MOORPY[name])
    assert max(deviations.values()) <= MET < SOURCE["moorpy_catenary"]["accepted"], deviations


def test_the_near_taut_catenary_of_moorpy_is_wrong():
    """Off by 2.8, 1.9 and 3.7 %, thousands of times what its test accepts; both vertical forces are equal."""
    row = MOORPY["near-taut"]
    deviations = moorpy_deviations(row)
    assert [deviations["fBH"], deviations["fAH"]] == pytest.approx([0.028, 0.028], rel=STATED)
    assert deviations["fAV"] == pytest.approx(0.019, rel=STATED)
    assert deviations["fBV"] == pytest.approx(0.037, rel=STATED)
    assert row["fAV"] == -row["fBV"] and row["w"] * row["L"] > 1000  # N: the weight that has to stand between them


def test_the_judge_of_the_near_taut_catenary_is_sure():
    """An input rounded to a double moves the exact answer by less than 1e-11: no input explains the 3 %."""
    row = MOORPY["near-taut"]
    line = {name: row[name] for name in ("w", "EA", "L", "x", "z")}
    condition = catenary_mp.condition_number(**line, solution=catenary_mp.solve(**line))
    assert condition * 2.0**-52 < 1e-11


# ---------------------------------------------------------------- MoorDyn: three chains at rest
CHAINS = {row["name"]: row for row in rows("moordyn_static_chains")}
BELOW = {"WD0050": (0.0101, 0.0112), "WD0200": (0.0023, 0.0028), "WD0600": (0.00068, 0.00094)}
"""Relative, at fairlead and anchor: how far the expected tensions are below those of a line without friction."""


def chain_tensions(row, friction):
    """Return the exact tension at fairlead and anchor, kN."""
    area = math.pi / 4 * row["diameter"] ** 2
    w = (row["mass_per_length"] - row["rho"] * area) * row["g"]
    state = catenary_mp.solve(w, row["EA"], row["L"], row["distance"], row["depth"], friction=friction)
    return float(mp.hypot(state.H, state.V)) / 1e3, float(mp.hypot(state.H_anchor, state.V_anchor)) / 1e3


@pytest.mark.parametrize("name", CHAINS)
def test_chains_of_moordyn_are_lines_without_friction(name):
    """The expected tensions are within 1.2 % of those without friction, at both ends, and below them."""
    row = CHAINS[name]
    exact = chain_tensions(row, 0.0)
    below = [1 - row[key] / T for key, T in zip(("T_fairlead_kN", "T_anchor_kN"), exact, strict=True)]
    assert below == pytest.approx(BELOW[name], rel=STATED)
    assert max(below) < SOURCE["moordyn_static_chains"]["accepted"]


@pytest.mark.parametrize("name", CHAINS)
def test_friction_of_the_chains_would_show_at_the_anchor(name):
    """With the friction of 0.5 in the test's own files, the expected anchor tension is not met within 10 %."""
    anchor = chain_tensions(CHAINS[name], 0.5)[1]
    assert 0.5 < anchor / CHAINS[name]["T_anchor_kN"] < 1 - SOURCE["moordyn_static_chains"]["accepted"]


# ---------------------------------------------------------------- MAP++: three bridles
BRIDLES = SOURCE["map_bridles"]
COLUMNS = [f"c{i}" for i in range(1, 7)]
PRINTED = {
    surge: np.array([[row[c] for c in COLUMNS] for row in rows("map_bridles") if row["surge"] == surge])
    for surge in (0.0, 5.0)
}
# N/m to N m: the printed entries that the symmetry at rest makes zero are at most 85 where others are 2e8, rounding of
# differences with a step of 1e-3; they are compared with zero to this.
NOISE = 100.0


@cache
def bridles(surge):
    """Return (case, state) of MAP++'s example, its vessel moved by ``surge`` m."""
    about = BRIDLES["network"]

    def turned(r, degrees, moved=0.0):
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        return (c * r[0] - s * r[1] + moved, s * r[0] + c * r[1], r[2])

    nodes, elements = [], []
    for angle in about["angles"]:
        first = len(nodes)
        places = [("fixed", turned(about["anchor"], angle)), ("free", turned(about["joint_guess"], angle))]
        places += [("coupled", turned(r, angle, surge)) for r in about["fairleads"]]
        nodes += [SimpleNamespace(kind=kind, r=r, mass=0.0, volume=0.0, force=(0.0, 0.0, 0.0)) for kind, r in places]
        for section, ends in (("steel", (0, 1)), ("nylon", (1, 2)), ("nylon", (1, 3))):
            part = about[section]
            w = (part["mass_per_length"] - about["rho"] * math.pi / 4 * part["diameter"] ** 2) * about["g"]
            ends = tuple(first + end for end in ends)
            elements.append(SimpleNamespace(w=w, EA=part["EA"], L=part["L"], ends=ends, friction=about["friction"]))
    environment = SimpleNamespace(rho=about["rho"], g=about["g"], depth=about["depth"])
    case = SimpleNamespace(nodes=nodes, elements=elements, environment=environment)
    return case, network_mp.solve(case, [node.r for node in nodes], digits=30)


@cache
def stiffness(surge):
    """Return the 6 x 6 stiffness of MAP++'s example."""
    case, state = bridles(surge)
    return np.array(network_mp.body_stiffness(case, state, (surge, 0.0, 0.0))[0].tolist(), dtype=float)


@pytest.fixture
def long_version(deep):
    """Skip by default: half a minute of 30 digits."""
    if not deep:
        pytest.skip("in the long version")


def units(printed):
    """Return the unit of the last of three printed digits of each entry."""
    return 10.0 ** (np.floor(np.log10(np.abs(printed))) - 2)


def is_met(printed, exact):
    """Return whether each entry is met to its printed digits, or within the noise that MAP++ prints for zeros."""
    zero = np.abs(exact) < NOISE
    return np.where(zero, np.abs(printed) < NOISE, np.abs(printed - exact) <= HALF_UNIT * units(printed))


def test_force_of_map_to_all_printed_digits():
    """Eight and nine digits of the first line after 5 m of surge, through three joints with two legs each."""
    state, printed = bridles(5.0)[1], BRIDLES["printed"]
    assert abs(float(state.H[0]) - printed["H"]) <= 0.005 * (1 + 1e-9)
    assert abs(float(state.V[0]) - printed["V"]) <= 0.005 * (1 + 1e-9)


def test_stiffness_of_map_at_rest_to_all_printed_digits(long_version):
    assert is_met(PRINTED[0.0], stiffness(0.0)).all()


def test_moments_of_map_after_surge_are_those_at_rest(long_version):
    """After 5 m of surge the forces' rows are right; the moments' rows are not, and are those printed at rest."""
    exact, met = stiffness(5.0), is_met(PRINTED[5.0], stiffness(5.0))
    assert met[:3].all() and not met[3:].all(axis=1).any()
    assert is_met(PRINTED[5.0][3:], stiffness(0.0)[3:]).all()
    off = np.abs(PRINTED[5.0] - exact)
    assert off[3, 1] == pytest.approx(1.9e4, rel=STATED) and off[4, 2] == pytest.approx(1.2e4, rel=STATED)
    assert off[3, 5] == pytest.approx(6.8e6, rel=STATED)


# ---------------------------------------------------------------- the stiffness that judges
def test_stiffness_of_the_oracle_is_the_difference_of_its_forces(long_version):
    """`body_stiffness` against central differences of solved networks: surge, and a yaw about the reference."""
    (_, ahead), (_, behind) = bridles(5.0 + 1e-4), bridles(5.0 - 1e-4)
    K = stiffness(5.0)
    coupled = [i for k in range(3) for i in (4 * k + 2, 4 * k + 3)]
    total = [sum(np.array([float(c) for c in state.force[i]]) for i in coupled) for state in (ahead, behind)]
    # h^2 / 6 times a third derivative of some K / (10 m)^2 leaves 1e-11 of K; forces as doubles 1e-16 / 1e-4 of 1e6 N.
    assert -(total[0] - total[1]) / 2e-4 == pytest.approx(K[:3, 0], rel=1e-7, abs=1e-5 * abs(K[:3, :3]).max())
