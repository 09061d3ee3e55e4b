"""Do published values come out to their printed digits, and is every misprint really one?

Published sets stand in ``reference_data`` with their provenance; ``test_references`` examines them without a solver.
"""

from __future__ import annotations

import ast
import csv
import math
import tomllib
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from mpmath import mp

from solvers import CableProperties, Environment, Regime, Span, solve_span
from verification import ROOT

from ..exact.cable import catenary_mp
from ..reference import EPS

DATA = files("reference_data")


def published(name: str) -> tuple[list[dict], dict]:
    """(rows with their numbers, source.toml) of a published set."""
    with (DATA / name / "data.csv").open(newline="", encoding="utf-8") as file:
        rows = [{k: v if k == "name" else float(v) for k, v in row.items()} for row in csv.DictReader(file)]
    return rows, tomllib.loads((DATA / name / "source.toml").read_text(encoding="utf-8"))


# ---------------------------------------------------------------- OpenFAST r-test: the OC3 Hywind lines
OPENFAST, OPENFAST_SOURCE = published("openfast_r_test")
LINES = pytest.mark.parametrize("row", OPENFAST, ids=[row["name"] for row in OPENFAST])


def openfast_state(row, w):
    x = math.hypot(row["x_fairlead"] - row["x_anchor"], row["y_fairlead"] - row["y_anchor"])
    return solve_span(Span(w, row["EA"], row["L"], x, row["z_fairlead"] - row["z_anchor"], friction=row["friction"]))


def openfast_differences(row, state) -> dict[str, float]:
    """Computed minus printed, in half units of the last printed digit."""
    got = {"Lb": state.grounded_length, "H": state.H, "V": state.V, "T": state.tension}
    got |= {"HAnch": state.H_anchor, "VAnch": state.V_anchor}
    return {name: (value - row[name]) / OPENFAST_SOURCE["half_unit"][name] for name, value in got.items()}


@LINES
def test_openfast_summary_to_its_printed_digits(row):
    """With MAP++'s own value of pi in the displaced volume, every printed digit of the summary comes out."""
    displaced = row["rho"] * OPENFAST_SOURCE["inferred"]["pi_in_code"] * row["diameter"] ** 2 / 4
    state = openfast_state(row, row["g"] * (row["mass_density"] - displaced))
    differences = openfast_differences(row, state)
    assert max(map(abs, differences.values())) <= 1, differences
    assert state.regime is Regime.GROUNDED


@LINES
def test_openfast_summary_from_mass_and_diameter(row):
    """From mass, diameter, density and gravity with the exact pi, the values hold to one unit of the last digit.

    One unit, not half: the eight digits of pi in MAP++ shift the last one of HAnch, V and T.
    """
    cable = CableProperties(row["EA"], diameter=row["diameter"], mass_per_length=row["mass_density"])
    w = cable.weight_in(Environment(rho=row["rho"], g=row["g"]))
    differences = openfast_differences(row, openfast_state(row, w))
    assert max(map(abs, differences.values())) <= 2, differences


def test_openfast_needs_its_own_gravity():
    """The gravity that the summary prints, 9.81, misses by 300 N: the comparison can tell."""
    row = OPENFAST[0]
    cable = CableProperties(row["EA"], diameter=row["diameter"], mass_per_length=row["mass_density"])
    state = openfast_state(row, cable.weight_in(Environment(rho=row["rho"], g=9.81)))
    assert abs(state.H - row["H"]) > 100


# ---------------------------------------------------------------- MSQS section 5: each line as a single span
MSQS, MSQS_SOURCE = published("msqs_two_line")
w_PRINTED, w_RIGHT = MSQS[0]["w"], MSQS_SOURCE["inferred"]["w"]

# Node position and forces of the two-line example solved to 14 digits: w, x, z (m), H, V of either line (kN).
TWO_LINE_DIGITS = [
    (59.1, -72.125336439007, -58.041151448209, 137.76551942683, (71.074634975925, 566.57536502408)),
    (226.61, -103.11368787518, -67.661806056975, 162.58627222711, (157.71555654983, 479.93444345017)),
]
LAST_DIGIT = (5e-13, 5e-12)  # half a unit of the last digit of the position, m, and of the force, kN


def msqs_state(row, w, x=None, z=None):
    """State of one line between its anchor and the node (x, z), printed unless given, N."""
    x, z = row["x_fairlead"] if x is None else x, row["z_fairlead"] if z is None else z
    return solve_span(Span(w, 1e3 * row["EA_kN"], row["L"], abs(x - row["x_anchor"]), z - row["z_anchor"]))


@pytest.mark.parametrize(("w", "x", "z", "H", "V"), TWO_LINE_DIGITS)
def test_two_line_example_line_by_line(w, x, z, H, V):
    """At the node of the two-line example, each line has the forces of the example, to the digits of its position."""
    for row, V_line in zip(MSQS, V, strict=True):
        state = msqs_state(row, w, x, z)
        scale = np.abs(state.stiffness).sum(axis=1)
        # the position is given to its last digit, and as a double of some 1e3 m
        bound = 1e3 * LAST_DIGIT[1] + scale * (LAST_DIGIT[0] + 4 * EPS * row["L"]) + 100 * EPS * state.tension
        assert np.all(np.abs([state.H - 1e3 * H, state.V - 1e3 * V_line]) <= bound)


def msqs_misfit(row, w, V_kN) -> float:
    """Printed minus computed force over what rounding of the printed node and force explains; <= 1 fits.

    The allowance is the largest stiffness over the corners of the printed position times half a unit of its last digit.
    """
    half = MSQS_SOURCE["half_unit"]
    x, z = row["x_fairlead"], row["z_fairlead"]
    corners = [
        msqs_state(row, w, x + i * half["x_fairlead"], z + j * half["z_fairlead"]) for i in (-1, 1) for j in (-1, 1)
    ]
    misfits = []
    for got, printed, unit in (
        ([state.H for state in corners], row["H_kN"], half["H_kN"]),
        ([state.V for state in corners], V_kN, half["V_kN"]),
    ):
        middle, reach = (max(got) + min(got)) / 2, (max(got) - min(got)) / 2
        misfits.append(abs(1e3 * printed - middle) / (reach + 1e3 * unit))
    return max(misfits)


# ---------------------------------------------------------------- errata, one test a row
TOUCHING = {"w": 2.0, "EA": 300.0, "L": 10.0}  # N/m, N, m


def dl_dV(H, V, friction) -> float:
    """d(2.23a)/dV at fixed H by central differences of the 50-digit quadrature, m/N."""
    with mp.workdps(50):
        step = mp.mpf(10) ** -15
        ends = [catenary_mp.excursion(H, V + sign * step, **TOUCHING, friction=friction)[0] for sign in (1, -1)]
        return float((ends[0] - ends[1]) / (2 * step))


def printed_dl_dV(H, V, friction_term) -> float:
    """(4.16a) with its friction term left open, m/N."""
    slope = V / H
    root = math.sqrt(1 + slope * slope)
    return friction_term + ((1 + slope / root) / (slope + root) - 1) / TOUCHING["w"]


@pytest.mark.parametrize("friction", [0.1, 5.0])
def test_erratum_friction_term_of_dl_dV(friction):
    """(4.16a): its friction term CB/EA (L - V/w) holds while the anchor is pulled; else it is H/(EA w)."""
    H, V = 8.0, 12.0
    w, EA, L = TOUCHING.values()
    rests = L - V / w
    pulled = H > friction * w * rests
    assert pulled is (friction == 0.1)
    exact = dl_dV(H, V, friction)
    printed = printed_dl_dV(H, V, friction / EA * rests)
    corrected = printed if pulled else printed_dl_dV(H, V, H / (EA * w))
    assert corrected == pytest.approx(exact, rel=1e-13)
    if not pulled:
        assert abs(printed - exact) > 0.1 * abs(exact)
    # the solver carries the corrected form: its compliance at this state is that of the quadrature
    x, z = (float(value) for value in catenary_mp.excursion(H, V, **TOUCHING, friction=friction))
    compliance = np.linalg.inv(solve_span(Span(**TOUCHING, x=x, z=z, friction=friction)).stiffness)
    assert compliance[0, 1] == pytest.approx(exact, rel=1e-11)


def test_erratum_anchor_force_depends_on_V():
    """(4.11): with H held, the anchor force follows V with slope CB while it is pulled, not with slope 0."""
    friction, H, V, dV = 0.1, 8.0, 12.0, 0.25
    anchors = []
    for force in (V, V + dV):
        x, z = (float(value) for value in catenary_mp.excursion(H, force, **TOUCHING, friction=friction))
        state = solve_span(Span(**TOUCHING, x=x, z=z, friction=friction))
        assert (state.H, state.V) == pytest.approx((H, force), rel=1e-12)
        exact = catenary_mp.solve(**TOUCHING, x=x, z=z, friction=friction)
        assert state.H_anchor == pytest.approx(float(exact.H_anchor), rel=1e-12)
        anchors.append(state.H_anchor)
    slope = (anchors[1] - anchors[0]) / dV  # exact for a straight line
    assert slope == pytest.approx(friction, rel=1e-10)
    assert abs(slope - 0.0) > 0.99 * friction


def test_erratum_weight_of_two_line_example():
    """Section 5: the printed forces follow from w = 59.1 N/m and not from the printed 226.61 N/m."""
    long, short = MSQS
    right = [msqs_misfit(row, w_RIGHT, V) for row, V in ((long, short["V_kN"]), (short, long["V_kN"]))]
    assert max(right) <= 1
    printed = [msqs_misfit(row, w_PRINTED, V) for row, V in ((long, short["V_kN"]), (short, long["V_kN"]))]
    assert max(printed) > 5
    # and 226.61 N/m is a weight in air: 23.1 kg/m times 9.81 m/s^2
    assert w_PRINTED == pytest.approx(23.1 * 9.81, abs=0.005)


def test_erratum_swapped_vertical_forces():
    """(5.4): V = 71.1 kN belongs to the 1175 m line and 566.6 kN to the 300 m line, contrary to print."""
    long, short = MSQS
    assert msqs_misfit(long, w_RIGHT, short["V_kN"]) <= 1
    assert msqs_misfit(short, w_RIGHT, long["V_kN"]) <= 1
    assert msqs_misfit(long, w_RIGHT, long["V_kN"]) > 10
    assert msqs_misfit(short, w_RIGHT, short["V_kN"]) > 10


def test_erratum_limits_of_the_profile_integral():
    """(2.18): integrated from max(x0, 0) to s it is the profile; to 0, as printed, it does not depend on s at all."""
    friction = 1.5
    span = Span(**TOUCHING, x=9.0, z=2.0, friction=friction)
    state = solve_span(span)
    x0 = state.grounded_length - state.H / (friction * span.w)
    assert 0 < x0 < state.grounded_length

    def stretched(start, end):
        """Integral of 1 + CB w (s - x0)/EA from start to end, m."""
        return (end - start) + friction * span.w / span.EA * ((end - x0) ** 2 - (start - x0) ** 2) / 2

    places = [x0 + share * (state.grounded_length - x0) for share in (0.25, 0.5, 1.0)]
    x, _, _ = state.profile(places)
    right = [x0 + stretched(x0, s) for s in places]
    printed = [x0 + stretched(x0, 0.0) for _ in places]
    assert x == pytest.approx(right, rel=1e-14)
    exact = catenary_mp.solve(**TOUCHING, x=9.0, z=2.0, friction=friction)
    quadrature = [
        float(catenary_mp.profile(s, **TOUCHING, x=9.0, z=2.0, friction=friction, solution=exact)[0]) for s in places
    ]
    assert right == pytest.approx(quadrature, rel=1e-12)
    assert min(abs(a - b) for a, b in zip(printed, quadrature, strict=True)) > 0.1 * span.L


# ---------------------------------------------------------------- the table of errata
ERRATA = tomllib.loads((DATA / "errata.toml").read_text(encoding="utf-8"))["erratum"]


def missing_tests(errata) -> list[str]:
    """Test ids named in the table of errata that no test file has."""
    missing = []
    for row in errata:
        path, _, name = row["test"].partition("::")
        file = ROOT / path
        tree = ast.parse(file.read_text(encoding="utf-8")) if file.is_file() else ast.Module([], [])
        if name not in {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}:
            missing.append(row["test"])
    return missing


def test_every_erratum_has_its_test():
    """Each row of reference_data/errata.toml names a test that exists, and each test of an erratum has its row."""
    assert not missing_tests(ERRATA)
    here = {name for name in globals() if name.startswith("test_erratum_")}
    assert here == {
        row["test"].partition("::")[2]
        for row in ERRATA
        if Path(row["test"].partition("::")[0]).stem == "test_published"
    }
    for row in ERRATA:
        assert all(row[key] for key in ("paper", "where", "printed", "right", "evidence")), row


def test_a_missing_erratum_test_is_found():
    """The check above turns red on an id whose file or function is not there."""
    assert missing_tests([{"test": "verification/suite/test_published.py::test_erratum_not_there"}])
    assert missing_tests([{"test": "verification/test_not_there.py::test_openfast_needs_its_own_gravity"}])
