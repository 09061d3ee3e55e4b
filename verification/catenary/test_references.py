"""Can the reference data be trusted? Every row is examined by routes that do not solve for the force.

The computed spans must satisfy the end point (forward quadrature), the energy integral, the balance of forces, the
unilateral contact, a double-precision quadrature of x and the definition of the stiffness. Published rows must close
within their printed digits. Planted faults show that each check can turn red.
"""

import csv
import math
import subprocess
import sys
import tomllib
from collections import Counter
from importlib.resources import files
from itertools import pairwise
from random import Random

import pytest
from mpmath import mp, mpf
from scipy.integrate import quad

from verification import ROOT
from verification.exact.cable.catenary_mp import ExactSpan, excursion, profile, solve

DATA = files("reference_data")
INPUTS = ("w", "EA", "L", "x", "z", "seabed", "friction", "clearance")
STATE = ("H", "V", "H_anchor", "V_anchor", "grounded_length")
STIFFNESS = ("K11", "K12", "K21", "K22")

# Forces carry 30 digits; an end point, an energy or a balance adds a handful of them.
EXACT = mpf("1e-27")
# Working digits of the checks: enough that their own rounding stays far below EXACT.
WORKING_DIGITS = 45
# scipy's quad asks for 1e-12 of each panel in doubles; the check is relative to the larger of x and L.
DOUBLE_QUADRATURE = 1e-9
# The stiffness is probed by a relative change of force. Curvature leaves an error of that order times T/(w L), 1e7 for
# the near-taut inextensible rows: far below the error allowed.
PROBE = mpf("1e-20")
STIFFNESS_ERROR = mpf("1e-6")
SAMPLE_SEED, SAMPLE_SIZE = 7, 12

LEAST_ROWS = {
    "suspended": 12,
    "contact-frictionless": 12,
    "contact-anchor-tension": 9,
    "contact-anchor-slack": 9,
    "slack": 12,
    "slack-lying": 6,
    "lying-frictionless": 9,
    "lying-friction-part": 9,
    "lying-friction-full": 9,
    "vertical-taut": 12,
    "vertical-folded": 12,
    "vertical-slack-seabed": 12,
    "chord-equals-length": 30,
    "near-chord": 30,
    "over-stretched": 20,
    "fairlead-below": 12,
    "floating-slack": 12,
    "fairlead-on-seabed": 3,
    "lifted-contact": 12,
    "lifted-suspended": 9,
    "lifted-slack": 12,
    "buoyant": 12,
    "weightless-taut": 12,
    "weightless-slack": 3,
    "nearly-vertical": 20,
    "nearly-slack": 12,
    "just-touching": 9,
    "just-lifted": 9,
    "named-line": 9,
    "random-seabed": 30,
    "random-floating": 30,
}


def table(name):
    with (DATA / name / "data.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def source(name):
    return tomllib.loads((DATA / name / "source.toml").read_text(encoding="utf-8"))


def inputs_of(row):
    """Return the keyword arguments of the oracle: doubles and one flag."""
    return {name: row[name] == "True" if name == "seabed" else float(row[name]) for name in INPUTS}


def state_of(row):
    return {name: mpf(row[name]) for name in (*STATE, *STIFFNESS)}


def regime_of(p, s):
    """Return the regime that the numbers of the row imply."""
    if p["w"] == 0:
        return "weightless-taut" if s["H"] or s["V"] else "weightless-slack"
    if s["H"] == 0:
        return "slack" if s["grounded_length"] or s["V"] == 0 else "vertical"
    if s["grounded_length"] == p["L"]:
        return "lying"
    if s["grounded_length"] == 0:
        return "suspended"
    return "grounded" if s["H_anchor"] else "grounded-anchor-slack"


# --- the checks: each yields a sentence for every error --------------------------------------------------------------


def close(name, got, wanted, scale, tolerance=EXACT):
    if not abs(got - wanted) <= tolerance * scale:
        yield f"{name}: got {mp.nstr(got, 32)}, wanted {mp.nstr(wanted, 32)}, scale {mp.nstr(scale, 3)}"


def end_point(p, s, regime):
    """The forward quadrature of the stored force ends at the fairlead."""
    solution = ExactSpan(regime, *(s[name] for name in STATE))
    x, z, _ = profile(p["L"], **p, solution=solution)
    scale = max(p["L"], p["x"], abs(p["z"]))
    yield from close("x at the end of the profile", x, p["x"], scale)
    yield from close("z at the end of the profile", z, p["z"], scale)


def energy(p, s, regime):
    """First integral of the equations: T + T^2/(2 EA) grows by w times the height, on every hanging piece."""
    if regime.startswith("weightless") or regime == "lying":
        return
    w, c = p["w"], p["clearance"]

    def potential(T):
        return T + T * T / (2 * p["EA"])

    top, bottom = potential(mp.hypot(s["H"], s["V"])), potential(mp.hypot(s["H_anchor"], s["V_anchor"]))
    if s["grounded_length"] == 0:
        yield from close("energy along the line", top - bottom, mpf(w) * p["z"], top + bottom)
    else:
        level = potential(s["H"])
        yield from close("energy to the fairlead", top - level, w * (mpf(p["z"]) + c), top + level)
        if c:
            yield from close("energy to the anchor", bottom - level, mpf(w) * c, bottom + level)


def balance(p, s, regime):
    """Weight of what hangs is carried by the ends; friction carries what H loses."""
    hanging = p["L"] - s["grounded_length"]
    scale = abs(s["V"]) + abs(p["w"]) * p["L"]
    yield from close("vertical balance", s["V"] - s["V_anchor"], p["w"] * hanging, scale)
    friction = min(s["H"], mpf(p["friction"]) * p["w"] * s["grounded_length"])
    yield from close("horizontal balance", s["H"] - s["H_anchor"], friction, s["H"])
    if regime.startswith("weightless"):
        chord = mp.hypot(p["x"], p["z"])
        stretched = max(chord, mpf(p["L"]))
        yield from close("spring", p["L"] * (1 + mp.hypot(s["H"], s["V"]) / p["EA"]), stretched, stretched)
        yield from close("direction", s["H"] * p["z"], s["V"] * p["x"], s["H"] * abs(p["z"]))


def contact(p, s, regime):
    """The line pulls, lies only where there is a bottom, and does not dip below it."""
    if s["H"] < 0 or s["H_anchor"] < 0 or not 0 <= s["grounded_length"] <= p["L"]:
        yield "negative tension or grounded length outside [0, L]"
    if not p["seabed"] and s["grounded_length"] != 0:
        yield "grounded without a seabed"
    if p["seabed"] and s["grounded_length"] == 0 and s["V_anchor"] < 0 < s["V"]:
        T, H = mp.hypot(s["H"], s["V_anchor"]), s["H"]
        dip = (T - H + (T * T - H * H) / (2 * p["EA"])) / p["w"]
        if dip > p["clearance"] * (1 + EXACT):
            yield f"dips {mp.nstr(dip, 8)} m, clearance {p['clearance']} m"


def double_quadrature(p, s, regime):
    """x once more by adaptive quadrature of dx/ds in doubles, split where the line is level."""
    if s["H"] == 0 or p["w"] == 0 or float(s["H"]) == math.inf:
        return
    H, V, w, L, EA = float(s["H"]), float(s["V"]), p["w"], p["L"], p["EA"]
    grounded, mean = float(s["grounded_length"]), float((s["H"] + s["H_anchor"]) / 2)
    taut = min(grounded, H / (p["friction"] * w)) if p["friction"] else grounded
    hanging = [(L - V / w, L), (0.0, L - V / w - grounded)] if grounded else [(0.0, L)]
    x = grounded + taut * mean / EA
    for start, end in hanging:
        level = (V - w * L) / -w if not grounded else start if start else end
        cuts = sorted({start, end, min(max(level, start), end)})
        for a, b in pairwise(cuts):
            near = -1 if a == level else 1 if b == level else 0
            x += half_line(H, w, a, b, near, V - w * L if not grounded else None) + (b - a) * H / EA
    scale = max(L, p["x"])
    yield from close("x by quadrature in doubles", mpf(x), mpf(p["x"]), scale, DOUBLE_QUADRATURE)


def half_line(H, w, a, b, near, V_start):
    """Integral of H/T over [a, b]; near = -1 or 1 says that the line is level at a or b, 0 that it is nowhere."""
    if near == 0:
        return quad(lambda s: H / math.hypot(H, V_start + w * s), a, b, epsrel=1e-12, epsabs=0)[0]
    length, knee = b - a, min(b - a, H / abs(w))
    near_part = quad(lambda s: H / math.hypot(H, w * s), 0, knee, epsrel=1e-12, epsabs=0)[0]
    # beyond the knee in ln s, where the integrand is smooth
    far_part = quad(
        lambda t: H * math.exp(t) / math.hypot(H, w * math.exp(t)),
        math.log(knee),
        math.log(length),
        epsrel=1e-12,
        epsabs=0,
    )[0]
    return near_part + far_part


def stiffness_probe(p, s, regime):
    """A small change of force moves the end by d(x, z) with K d(x, z) = dF; closed regimes by their own laws."""
    if regime in ("suspended", "grounded", "grounded-anchor-slack") and mp.isfinite(s["K22"]):
        yield from elastic_stiffness(p, s)
    else:
        yield from closed_stiffness(p, s, regime)
    if p["friction"] == 0 and mp.isfinite(s["K12"]):
        largest = max(abs(s[name]) for name in STIFFNESS if mp.isfinite(s[name]))
        yield from close("symmetry", s["K12"], s["K21"], largest)


def elastic_stiffness(p, s):
    """K times the motion of the end, by the forward map, is the change of force along and across the line.

    The rounding of K (30 digits) times the motion is allowed for: of a nearly taut line it is larger than K across.
    """
    line = {name: p[name] for name in ("w", "EA", "L", "seabed", "friction", "clearance")}
    (H, V), K = (s["H"], s["V"]), mp.matrix([[s["K11"], s["K12"]], [s["K21"], s["K22"]]])
    largest, T = max(abs(k) for k in K), mp.hypot(H, V)
    size = PROBE * min(H, abs(p["w"]) * p["L"], *([V] if s["grounded_length"] else []))
    with mp.workdps(WORKING_DIGITS + max(0, int(mp.log10(p["L"] * largest / size)))):
        old = excursion(H, V, **line)
        for name, dH, dV in (("along", size * H / T, size * V / T), ("across", -size * V / T, size * H / T)):
            new = excursion(H + dH, V + dV, **line)
            motion = mp.matrix([new[0] - old[0], new[1] - old[1]])
            returned, tolerance = K * motion, STIFFNESS_ERROR * size + EXACT * largest * mp.norm(motion)
            yield from close(f"H returned by K, change {name}", returned[0], dH, tolerance, 1)
            yield from close(f"V returned by K, change {name}", returned[1], dV, tolerance, 1)


def closed_stiffness(p, s, regime):
    K11, K12, K21, K22 = (s[name] for name in STIFFNESS)
    w, EA, L, V = (mpf(p[name]) if name in p else s[name] for name in ("w", "EA", "L", "V"))
    if regime == "slack":
        yield from close("slack", K22 * (1 + V / EA), w, w)
        yield from close("slack sideways", abs(K11) + abs(K12) + abs(K21), 0, 0)
    elif regime == "lying":
        pulled = min(L, s["H"] / (p["friction"] * w)) if p["friction"] else L
        yield from close("lying", K11 * pulled, EA, EA)
    elif regime == "vertical":
        folded = V * s["V_anchor"] < 0
        yield from close("vertical", (2 / abs(w) if folded else mpf(0)) + L / EA, 1 / K22, 1 / K22)
        sideways = mpf(0) if folded else 1 / (L / EA + abs(mp.log(V / s["V_anchor"]) / w))
        yield from close("vertical sideways", K11, sideways, K22)
    elif regime.startswith("weightless"):
        along, across = (EA / L, mp.hypot(s["H"], V) / mp.hypot(p["x"], p["z"])) if s["H"] or V else (0, 0)
        x, z = mpf(p["x"]), mpf(p["z"])
        scale = (along + across) * (x + abs(z))
        yield from close("along, x", K11 * x + K12 * z, along * x, scale)
        yield from close("along, z", K21 * x + K22 * z, along * z, scale)
        yield from close("across, x", K12 * x - K11 * z, -across * z, scale)
        yield from close("across, z", K22 * x - K21 * z, across * x, scale)


CHECKS = (end_point, energy, balance, contact, double_quadrature, stiffness_probe)


def refusals(check, p, s, regime):
    """Return the sentences of a check, or of the error of a state that the forward map refuses."""
    try:
        return list(check(p, s, regime))
    except (ValueError, ZeroDivisionError) as error:
        return [str(error)]


def faults(row):
    """Return a sentence for every error in one row of the spans set."""
    with mp.workdps(WORKING_DIGITS):
        p, s = inputs_of(row), state_of(row)
        regime = regime_of(p, s)
        sentences = [
            f"{row['name']} ({check.__name__}): {line}" for check in CHECKS for line in refusals(check, p, s, regime)
        ]
    sentences += [
        f"{row['name']}: {name} does not round-trip"
        for name in INPUTS
        if name != "seabed" and repr(float(row[name])) != row[name]
    ]
    return sentences


def table_faults(rows):
    """Return a sentence for every error of the set as a whole."""
    names, labels = Counter(row["name"] for row in rows), Counter(row["regime"] for row in rows)
    sentences = [f"{name} appears {n} times" for name, n in names.items() if n > 1]
    sentences += [
        f"{label}: {labels[label]} rows, at least {n} wanted" for label, n in LEAST_ROWS.items() if labels[label] < n
    ]
    return sentences + [f"unknown label {label}" for label in labels if label not in LEAST_ROWS]


# --- the computed set -------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def spans():
    return table("spans")


def test_every_span_closes(spans):
    sentences = [line for row in spans for line in faults(row)]
    assert not sentences, "\n".join(sentences[:20])


def test_table_is_complete(spans):
    assert not table_faults(spans)


def test_sample_is_recomputed_to_the_digit(spans):
    for row in Random(SAMPLE_SEED).sample(spans, SAMPLE_SIZE):
        state = solve(**inputs_of(row))
        for name in STATE:
            value = getattr(state, name)
            fresh = "0" if value == 0 else mp.nstr(value, 30, strip_zeros=False, min_fixed=0, max_fixed=0)
            assert row[name] == fresh, f"{row['name']}: {name} stored {row[name]}, computed {fresh}"


def test_all_is_recomputed_to_the_digit(request):
    if not request.config.getoption("--deep", default=False):
        pytest.skip("half a minute: run with --deep, or python -m reference_data check")
    run = subprocess.run([sys.executable, "-m", "reference_data", "check"], cwd=ROOT, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout


# --- planted faults ---------------------------------------------------------------------------------------------------


def digit_changed(text, position):
    """Return the text with one decimal digit after the point raised by one (9 becomes 0)."""
    k = text.index(".") + position
    return text[:k] + str((int(text[k]) + 1) % 10) + text[k + 1 :]


def negated(text):
    return text[1:] if text.startswith("-") else "-" + text


@pytest.mark.parametrize(
    ("name", "column", "change"),
    [
        ("suspended-07", "H", lambda t: digit_changed(t, 22)),
        ("suspended-07", "V", negated),
        ("suspended-07", "V_anchor", negated),
        ("contact-anchor-tension-05", "H", lambda t: digit_changed(t, 22)),
        ("contact-anchor-tension-05", "H_anchor", lambda t: digit_changed(t, 10)),
        ("contact-anchor-slack-04", "V", lambda t: digit_changed(t, 22)),
        ("lifted-contact-04", "V_anchor", negated),
        ("lifted-contact-04", "grounded_length", lambda t: digit_changed(t, 15)),
        ("slack-04", "V", lambda t: digit_changed(t, 22)),
        ("lying-friction-part-02", "H", lambda t: digit_changed(t, 22)),
        ("vertical-folded-05", "V", lambda t: digit_changed(t, 22)),
        ("buoyant-02", "V", negated),
        ("weightless-taut-03", "V", negated),
        ("chord-equals-length-04", "K12", negated),
        ("floating-slack-06", "K11", lambda t: digit_changed(t, 3)),
        ("lying-frictionless-04", "K11", lambda t: digit_changed(t, 3)),
        ("vertical-taut-04", "K11", lambda t: digit_changed(t, 3)),
        ("named-line-01", "x", lambda t: t + "0"),
        ("named-line-01", "w", lambda t: "226.61"),
    ],
)
def test_a_planted_fault_is_found(spans, name, column, change):
    row = next(row for row in spans if row["name"] == name)
    assert not faults(row)
    assert faults(row | {column: change(row[column])})


def test_a_doubled_and_a_missing_row_are_found(spans):
    assert table_faults([*spans, spans[0]])
    assert table_faults([row for row in spans if row["regime"] != "buoyant"])


@pytest.mark.parametrize("check", [end_point, energy, balance, double_quadrature, stiffness_probe])
def test_each_check_turns_red_alone(spans, check):
    row = next(row for row in spans if row["name"] == "named-line-01")
    with mp.workdps(WORKING_DIGITS):
        p, s = inputs_of(row), state_of(row)
        assert not list(check(p, s, "grounded"))
        assert list(check(p, s | {"V": s["V"] * (1 + mpf("1e-6")), "K11": s["K11"] * (1 + mpf("1e-5"))}, "grounded"))


def test_the_contact_check_turns_red(spans):
    row = next(row for row in spans if row["name"] == "floating-slack-06")
    with mp.workdps(WORKING_DIGITS):
        p, s = inputs_of(row), state_of(row)
        assert not list(contact(p, s, "suspended"))
        assert list(contact(p | {"seabed": True}, s, "suspended"))
        assert list(contact(p, s | {"grounded_length": mpf(1)}, "grounded"))


# --- published sets ---------------------------------------------------------------------------------------------------


def openfast_misses(row, half_unit, pi):
    """Return the printed columns that the oracle does not reproduce within half a unit, with their errors."""
    v = {name: float(text) for name, text in row.items() if name != "name"}
    w = v["g"] * (v["mass_density"] - v["rho"] * pi * v["diameter"] ** 2 / 4)
    x = math.hypot(v["x_fairlead"] - v["x_anchor"], v["y_fairlead"] - v["y_anchor"])
    s = solve(w, v["EA"], v["L"], x, v["z_fairlead"] - v["z_anchor"], friction=v["friction"])
    got = {
        "Lb": s.grounded_length,
        "H": s.H,
        "V": s.V,
        "T": mp.hypot(s.H, s.V),
        "HAnch": s.H_anchor,
        "VAnch": s.V_anchor,
    }
    return {name: float(got[name]) - v[name] for name in half_unit if abs(got[name] - v[name]) > half_unit[name]}


def test_openfast_summary_is_reproduced_to_its_last_digit():
    about = source("openfast_r_test")
    for row in table("openfast_r_test"):
        assert not openfast_misses(row, about["half_unit"], about["inferred"]["pi_in_code"])


def test_openfast_comparison_can_fail():
    about, row = source("openfast_r_test"), table("openfast_r_test")[0]
    assert openfast_misses(row, about["half_unit"], math.pi).keys() == {"HAnch"}
    assert openfast_misses(row | {"H": "736939.291"}, about["half_unit"], about["inferred"]["pi_in_code"])


def msqs_misses(rows, half_unit, w, swapped):
    """Return printed positions that the forward map of the printed forces misses by more than the printed digits allow.

    The rounding of H and V is carried through the map by evaluating it at the corners of their intervals.
    """
    verticals = [float(row["V_kN"]) for row in rows][:: -1 if swapped else 1]
    misses = []
    for row, V in zip(rows, verticals, strict=True):
        v = {name: float(text) for name, text in row.items() if name != "name"}
        ends = [
            excursion(
                1e3 * (v["H_kN"] + i * half_unit["H_kN"]),
                1e3 * (V + j * half_unit["V_kN"]),
                w,
                1e3 * v["EA_kN"],
                v["L"],
            )
            for i in (-1, 1)
            for j in (-1, 1)
        ]
        span = abs(v["x_fairlead"] - v["x_anchor"]), v["z_fairlead"] - v["z_anchor"]
        for k, name in enumerate(("x_fairlead", "z_fairlead")):
            least, most = min(e[k] for e in ends), max(e[k] for e in ends)
            if not least - half_unit[name] <= span[k] <= most + half_unit[name]:
                misses.append((row["name"], name, float(least), float(most), span[k]))
    return misses


def test_msqs_example_closes_with_its_two_misprints_corrected():
    about, rows = source("msqs_two_line"), table("msqs_two_line")
    assert not msqs_misses(rows, about["half_unit"], about["inferred"]["w"], about["inferred"]["V_swapped"])
    total = sum(float(row["V_kN"]) for row in rows)
    assert abs(total - float(rows[0]["Fz_kN"])) <= 2 * about["half_unit"]["V_kN"]


def test_msqs_example_does_not_close_as_printed():
    about, rows = source("msqs_two_line"), table("msqs_two_line")
    printed = float(rows[0]["w"])
    assert msqs_misses(rows, about["half_unit"], printed, swapped=False)
    assert msqs_misses(rows, about["half_unit"], printed, swapped=True)
    assert msqs_misses(rows, about["half_unit"], about["inferred"]["w"], swapped=False)


def test_both_forms_of_msqs_section_5_have_the_same_numbers():
    """The example as a whole and line by line hold the same printed numbers."""
    rows, lines = {(row["name"], row["quantity"]): row for row in table("msqs_paper")}, table("msqs_two_line")
    value = lambda *key: float(rows[key]["value"])
    assert len(rows) == len(table("msqs_paper"))
    for i, line in enumerate(lines, start=1):
        assert value("inputs", f"length of line {i}") == float(line["L"])
        assert value("inputs", f"anchor {i} x") == float(line["x_anchor"])
        assert (value("solution", f"H{i}"), value("solution", f"V{i}")) == (float(line["H_kN"]), float(line["V_kN"]))
        assert value("solution", "x") == float(line["x_fairlead"])
        assert value("solution", "z") == float(line["z_fairlead"])
        assert value("inputs", "Fz") == float(line["Fz_kN"]) and value("inputs", "weight") == float(line["w"])


def test_operations_of_table_2_follow_from_5_6():
    """Printed counts and sizes of matrices give the printed operations, to their printed digits."""
    value = {(row["name"], row["quantity"]): float(row["value"]) for row in table("msqs_paper")}
    cube = lambda iterations, n: iterations * value["operations", "factor of n^3"] * n**3
    nested = cube(value["nested", "iterations"], 3) + cube(value["nested", "inner iterations"], 4)
    whole = cube(value["operations", "iterations of the monolithic method"], 7)
    assert abs(nested - value["nested", "operations"]) <= 0.5 and abs(whole - value["operations", "monolithic"]) <= 50
    assert abs(value["nested", "operations"] / value["operations", "monolithic"] - 2.67) <= 0.005


@pytest.mark.parametrize("name", ["spans", "openfast_r_test", "msqs_two_line", "msqs_paper", "other_codes",
                                  "peer_tests", "conformance"])  # fmt: skip
def test_provenance_is_stated(name):
    about = source(name)
    assert {"title", "kind", "citation", "how_obtained", "uncertainty", "date", "units", "signs"} <= about.keys()
    assert about["kind"] in ("computed", "published", "measured")


def test_times_of_other_codes_say_of_what():
    """Every row is of a set and a code with version that the source describes, a positive time, and there once."""
    about, rows = source("other_codes"), table("other_codes")
    assert len({(row["name"], row["quantity"]) for row in rows}) == len(rows)
    assert {row["name"] for row in rows} == about["sets"].keys()
    for row in rows:
        code = row["name"] if row["name"] in about["codes"] else row["quantity"]
        assert about["codes"][code] and float(row["value"]) > 0 and row["bound"] in ("", "above"), row
        assert row["unit"] in ("s", "ms") and (float(row["uncertainty"]) > 0) == (not row["bound"]), row
