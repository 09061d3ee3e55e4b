"""Is the truth of the dynamics true? Oracles against closed forms, printed digits, each other and the paper's rows.

The component form of Chen, Basu and Nielsen (2019) is typed here from the page, (27)-(34), and compared with the vector
form of ``exact/cable_mp``; each misprint is shown to matter, and each entry of M, K and f to be seen.
"""

from __future__ import annotations

import csv
import math
import tomllib
from dataclasses import replace
from functools import cache
from importlib.resources import files

import numpy as np
import pytest
from mpmath import mp, mpf
from scipy.integrate import solve_ivp

from ..exact.cable import cable_mp, catenary_mp, frequencies, travelling_wave
from ..exact.cable.cable_mp import ALL_TERMS, ONE_TERM, Jet, source_grid
from ..exact.oscillators import oscillators
from ..exact.oscillators.oscillators import CASES, case, duffing, quadratically_damped, trajectory
from ..reference import EPS

DATA = files("reference_data")
PERIOD, LENGTH = 20.0, 400.0  # of the manufactured fields, s and m
S, T = np.linspace(0.0, LENGTH, 9), np.linspace(0.3, PERIOD, 7)
GRID_ERROR = 1e-13  # of the largest term of a row: a sum of some twenty products in doubles
MP_ERROR = mpf("1e-25")  # of the same, by difference quotients of mpmath to 30 digits
SEEN = 1e-6  # of the largest term of a row: what a wrong term changes at least
ORBIT_ERROR = 2e-14  # of the size of the motion: some hundred steps of a few roundings each
OC3 = (3.84243e8, 77.7066, 1025 * math.pi * 0.09**2 / 4, 698.094, 902.2, (848.67, 250.0))  # EA, m, ma, w0, L, span
EIGHT_DIGITS = 1e-9
SHOOTING = 3e-10  # relative: Runge-Kutta of order 8 with rtol 1e-12 over some ten waves


def table(name):
    """Rows and source.toml of a reference set."""
    with (DATA / name / "data.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file)), tomllib.loads((DATA / name / "source.toml").read_text(encoding="utf-8"))


# ---------------------------------------------------------------- the paper's rows
MISPRINTS = {"(22)": [3], "(28) damping": [1, 2, 3], "(30)": [2], "(34)": [6]}  # where -> the rows that it spoils


def paper_rows(p, fields, s, t, misprints=(), entry=None):
    """Rows 1 to 6 (6, N, nt), M y_t + K (y - y_bar)_s + f, as printed in (27)-(34), and the size of their terms.

    y_bar: the fields frozen at t = 0. entry = ("M", i, j), ("K", i, j) or ("f", i, k) changes the sign of one entry,
    one term of f. Seabed weight (section 2.5) for w0; Kelvin-Voigt damping where the misprint is not asked for.
    """
    y, y_s, y_t = (part[:6] for part in cable_mp.derivatives(fields, s, t))
    bar_s = cable_mp.derivatives(fields.at_rest(), s, t)[1][:6]
    eps, u, v, w, phi, theta = y
    sp, cp, st, ct = np.sin(phi), np.cos(phi), np.sin(theta), np.cos(theta)
    V_c, W_c, U_c = p.current
    area = math.pi * p.d**2 / 4
    ma, inertia = p.Ca * p.rho * area, (1 + p.Ca) * p.rho * area
    M, K = np.zeros((2, 6, 6, *eps.shape))
    M[0, 1], M[0, 4], M[0, 5] = -p.m, p.m * v * ct, -p.m * w
    M[1, 2], M[1, 4] = -(p.m + ma), -p.m * (w * st + u * ct) - inertia * (U_c * cp + V_c * sp)
    M[2, 3], M[2, 4] = -(p.m + ma), p.m * v * st - inertia * (U_c * sp * st - V_c * cp * st)
    along = U_c * cp * ct + V_c * sp * ct - W_c * st
    M[2, 5] = p.m * u + inertia * (1 / math.pi if "(22)" in misprints else 1) * along
    M[3, 0], M[4, 4], M[5, 5] = -1, -(1 + eps) * ct, 1 + eps
    K[0, 0], K[1, 4], K[2, 5] = p.EA, p.EA * eps * ct, -p.EA * eps
    K[3, 1], K[3, 4], K[3, 5] = 1, -v * ct, w
    K[4, 2], K[4, 4] = 1, u * ct + w * st
    K[5, 3], K[5, 4], K[5, 5] = 1, -v * st, -u
    ur, vr, wr = u - along, v - (-U_c * sp + V_c * cp), w - (U_c * cp * st + V_c * sp * st + W_c * ct)
    drag = -0.5 * p.rho * p.d * np.sqrt(1 + eps)
    across = np.sqrt(vr**2 + wr**2)
    weight = p.w0
    if p.seabed_stiffness is not None:
        z = cable_mp.derivatives(fields, s, t)[0][6]
        weight = p.w0 - np.maximum(p.seabed_stiffness * (-p.depth - z), 0)
    f = [
        [-weight * cp * ct, drag * math.pi * p.Cdt * abs(ur) * ur, p.EA * bar_s[0]],
        [weight * sp, drag * p.Cdn * vr * across, (-1 if "(30)" in misprints else 1) * p.EA * eps * ct * bar_s[4]],
        [-weight * cp * st, drag * p.Cdb * wr * across, -p.EA * eps * bar_s[5]],
        [-v * ct * bar_s[4], w * bar_s[5]],
        [(u * ct + w * st) * bar_s[4]],
        [-v * st * bar_s[4], (1 if "(34)" in misprints else -1) * u * bar_s[5]],
    ]
    if "(28) damping" in misprints:
        M[0, 0] = p.EA * p.beta
    else:
        rate = fields.eps(Jet(s[:, None], 1, 0, 0), Jet(t[None], 0, 1, 0)).e
        kelvin_voigt = p.EA * p.beta * np.array([rate, y_t[0] * ct * y_s[4], -y_t[0] * y_s[5]])
        for terms, term in zip(f, kelvin_voigt, strict=False):
            terms.append(term)
    if entry:
        {"M": M, "K": K, "f": f}[entry[0]][entry[1]][entry[2]] *= -1
    parts = [M * y_t, K * (y_s - bar_s)]
    total = sum(part.sum(axis=1) for part in parts) + np.array([sum(terms) for terms in f])
    size = [max(abs(part).max() for part in (parts[0][i], parts[1][i], *f[i])) for i in range(6)]
    return total, np.array(size)


def row_errors(p, fields, **changed):
    """Largest difference of each row (6,) from the vector form over the largest term of the row."""
    rows, size = paper_rows(p, fields, S, T, **changed)
    return abs(rows - source_grid(p, fields, S, T)[:6]).max(axis=(1, 2)) / np.where(size > 0, size, 1)


def fields_of(p, **options):
    return cable_mp.manufactured(p, LENGTH, 2 * math.pi / PERIOD, **options)


@pytest.mark.parametrize("name", [*ONE_TERM, "all"])
@pytest.mark.parametrize("oscillating", [False, True])
def test_the_vector_form_gives_the_rows_of_the_paper(name, oscillating):
    """Momentum and compatibility in vectors, projected on t, n, b, are rows (27)-(34), misprints corrected."""
    p = (ONE_TERM | {"all": ALL_TERMS})[name]
    errors = row_errors(p, fields_of(p, oscillating=oscillating))
    assert errors.max() <= GRID_ERROR, errors


@pytest.mark.parametrize(("where", "rows"), MISPRINTS.items())
def test_each_misprint_spoils_its_rows_alone(where, rows):
    """With one misprint left in, its rows no longer hold, and the others do."""
    errors = row_errors(ALL_TERMS, fields_of(ALL_TERMS), misprints=(where,))
    assert [row for row in range(1, 7) if errors[row - 1] > SEEN] == rows, errors
    assert all(errors[row - 1] <= GRID_ERROR for row in range(1, 7) if row not in rows), errors


ENTRIES = (
    *(("M", i, j) for i, j in ((0, 1), (0, 4), (0, 5), (1, 2), (1, 4), (2, 3), (2, 4), (2, 5), (3, 0), (4, 4), (5, 5))),
    *(("K", i, j) for i, j in ((0, 0), (1, 4), (2, 5), (3, 1), (3, 4), (3, 5), (4, 2), (4, 4), (5, 3), (5, 4), (5, 5))),
    *(("f", i, k) for i, n in enumerate((4, 4, 4, 2, 1, 2)) for k in range(n)),
)


def test_every_entry_of_M_K_and_f_is_seen():
    """The sign of any single entry of M and K, or of a term of f, changed: the comparison turns red in that row."""
    fields = fields_of(ALL_TERMS)
    unseen = [e for e in ENTRIES if not row_errors(ALL_TERMS, fields, entry=e)[e[1]] > SEEN]
    assert not unseen, unseen


FAULTS = {
    "binormal reversed": ("_frame", lambda f: lambda *a: (*f(*a)[:2], tuple(-1 * c for c in f(*a)[2]))),
    "drag 0.1 % large": ("_drag", lambda f: lambda *a: [1.001 * x for x in f(*a)]),
    "inertia 1 % large": ("_hydrodynamic_inertia", lambda f: lambda *a: [1.01 * x for x in f(*a)]),
    "a seabed that holds the line down": ("seabed_support", lambda f: lambda p, z: p.seabed_stiffness * (-p.depth - z)),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_of_the_vector_form_is_noticed(monkeypatch, fault):
    """So is a fault on the other side of the comparison."""
    fields = fields_of(ALL_TERMS, oscillating=True)
    name, spoilt = FAULTS[fault]
    monkeypatch.setattr(cable_mp, name, spoilt(getattr(cable_mp, name)))
    assert row_errors(ALL_TERMS, fields).max() > SEEN


def test_a_wrong_product_rule_is_noticed(monkeypatch):
    """Jets that forget the mixed derivative do not agree with mpmath."""
    right = Jet.__mul__

    def wrong(self, other):
        jet = right(self, other)
        return Jet(jet.a, jet.b, jet.c, self.a * cable_mp._jet(other).e + self.e * cable_mp._jet(other).a)

    monkeypatch.setattr(Jet, "__mul__", wrong)
    with pytest.raises(AssertionError):
        test_fast_source_has_the_digits_of_mpmath(False)


def test_the_position_row_is_the_height():
    """The last row is dz/ds - (1 + eps) cos(phi) cos(theta)."""
    fields = fields_of(ALL_TERMS)
    y, y_s, _ = cable_mp.derivatives(fields, S, T)
    wanted = y_s[6] - (1 + y[0]) * np.cos(y[4]) * np.cos(y[5])
    assert abs(source_grid(ALL_TERMS, fields, S, T)[6] - wanted).max() <= GRID_ERROR


def test_a_planar_source_is_rows_1_2_4_5():
    """In a plane the rows 3 and 6 vanish, and the others are the planar source, in order, with the seabed's last."""
    p = cable_mp.in_plane(ALL_TERMS)
    fields = fields_of(p, planar=True)
    whole, planar = source_grid(p, fields, S, T), source_grid(p, fields, S, T, planar=True)
    assert np.array_equal(planar, whole[[0, 1, 3, 4, 6]]) and not whole[[2, 5]].any()
    states = cable_mp.state_grid(p, fields, S, T, planar=True)
    assert all(
        np.array_equal(a, b[[0, 1, 2, 4, 6]]) for a, b in zip(states, cable_mp.derivatives(fields, S, T), strict=True)
    )


def test_velocity_is_that_of_the_boundary_equations():
    """x, y, z of the velocity are V, W, U of (43)-(45)."""
    fields = fields_of(ALL_TERMS)
    _, u, v, w, phi, theta, _ = cable_mp.derivatives(fields, [LENGTH], T)[0]
    sp, cp, st, ct = np.sin(phi), np.cos(phi), np.sin(theta), np.cos(theta)
    up, along, out = u * cp * ct - v * sp + w * cp * st, u * sp * ct + v * cp + w * sp * st, -u * st + w * ct
    assert abs(fields.velocity([LENGTH], T) - [along, out, up]).max() < 10 * EPS


def test_shapes_of_a_source():
    """One time, or times of any shape, give (n_f, N, *S)."""
    p = replace(ALL_TERMS, seabed_stiffness=None)
    fields = fields_of(p)
    assert source_grid(p, fields, S, 1.0).shape == (6, 9)
    block = source_grid(p, fields, S, T[:6].reshape(2, 3), planar=True)
    assert block.shape == (4, 9, 2, 3)
    assert np.array_equal(block[:, :, 1, 0], source_grid(p, fields, S, T[3], planar=True))


def test_fast_source_has_the_digits_of_mpmath(deep):
    """Exact derivatives in doubles against difference quotients of mpmath, each row relative to its largest term."""
    fields = fields_of(ALL_TERMS)
    places = [(S[i], T[j]) for i in range(0, 9, 1 if deep else 4) for j in range(0, 7, 1 if deep else 3)]
    size = np.append(paper_rows(ALL_TERMS, fields, S, T)[1], 1.0)
    for s, t in places:
        by_quotients = cable_mp.source(ALL_TERMS, fields, s, t)
        by_jets = cable_mp.source_by_jets(ALL_TERMS, fields, s, t)
        fast = source_grid(ALL_TERMS, fields, [s], t)[:, 0]
        with mp.workdps(30):
            exact = cable_mp.source(ALL_TERMS, fields, s, t, digits=40)
            assert all(abs(a - b) <= MP_ERROR * c for a, b, c in zip(by_quotients, exact, size, strict=True))
        assert max(abs(float(a) - b) / c for a, b, c in zip(exact, fast, size, strict=True)) <= GRID_ERROR
        assert max(abs(float(a - b)) / c for a, b, c in zip(exact, by_jets, size, strict=True)) <= GRID_ERROR


def test_manufactured_fields_are_as_described():
    """No relative velocity along t or n changes sign, the seabed carries part of the weight and never all, eps > 0."""
    s, t = np.linspace(0, LENGTH, 41), np.linspace(0, PERIOD, 81)
    for p in (ALL_TERMS, ONE_TERM["seabed"], ONE_TERM["normal drag"]):
        fields = fields_of(p)
        y = cable_mp.derivatives(fields, s, t)[0]
        frame = cable_mp._frame(y[4], y[5])
        V_c, W_c, U_c = p.current
        ahead = [y[1 + k] - (U_c * e[0] + V_c * e[1] + W_c * e[2]) for k, e in enumerate(frame[:2])]
        assert all(a[1:].min() > 0 for a in ahead) and y[0].min() > 3e-3 and abs(y[1:4, 0]).max() == 0
        if p.seabed_stiffness:
            share = p.seabed_stiffness * (-p.depth - y[6]) / p.w0
            assert share[0].max() == 0 and share[1:].min() > 0 and share.max() < 0.76


def test_an_oscillating_line_leaves_the_seabed_and_is_pressed_into_it():
    """With oscillating=True the support is nothing, more than the weight w0, and everything between."""
    fields = fields_of(ALL_TERMS, oscillating=True)
    with_seabed = source_grid(ALL_TERMS, fields, S, T)[:6]
    without = source_grid(replace(ALL_TERMS, seabed_stiffness=None), fields, S, T)
    support = (with_seabed - without)[0] / np.prod(np.cos(cable_mp.derivatives(fields, S, T)[0][4:6]), axis=0)
    share = support / ALL_TERMS.w0
    assert share.min() > -1e-8 and share.max() > 1.2
    assert (share < 1e-8).any() and ((share > 0.1) & (share < 0.9)).any()


# ---------------------------------------------------------------- the paper's Fourier formulas
def fourier_basis(nu, harmonics, samples):
    """Q (70) at samples of nu drive periods, omega = 1."""
    t = 2 * np.pi * nu * np.arange(samples) / samples
    k = np.arange(1, harmonics + 1) / nu
    waves = np.stack([np.sin(np.outer(t, k)), np.cos(np.outer(t, k))], axis=2).reshape(samples, -1)
    return t, np.hstack([np.full((samples, 1), math.sqrt(0.5)), waves])


def test_erratum_57_the_constant_has_a_block_of_its_own():
    """q' = q Theta needs a leading 1x1 zero block: without it Theta does not even have the size of q."""
    nu, harmonics = 2, 3
    t, Q = fourier_basis(nu, harmonics, 16)
    blocks = [np.array([[0, -k / nu], [k / nu, 0]]) for k in range(1, harmonics + 1)]
    theta = np.zeros((2 * harmonics + 1,) * 2)
    for k, block in enumerate(blocks):
        theta[1 + 2 * k : 3 + 2 * k, 1 + 2 * k : 3 + 2 * k] = block
    k = np.arange(1, harmonics + 1) / nu
    rates = np.stack([k * np.cos(np.outer(t, k)), -k * np.sin(np.outer(t, k))], axis=2).reshape(16, -1)
    assert abs(Q[:, 1:] @ theta[1:, 1:] - rates).max() < 10 * EPS and not (Q @ theta)[:, 0].any()
    assert sum(block.shape[0] for block in blocks) == Q.shape[1] - 1


def test_erratum_61_the_integral_runs_over_the_whole_subharmonic_period():
    """2/(nu T_f) times the integral over nu T_f of q' q is the identity; over one drive period it is not for nu > 1."""
    for nu in (1, 2, 3):
        _, Q = fourier_basis(nu, 4, 48)
        whole = 2 / 48 * Q.T @ Q
        one = 2 / (48 // nu) * Q[: 48 // nu].T @ Q[: 48 // nu]
        assert abs(whole - np.eye(9)).max() < 10 * EPS
        assert (abs(one - np.eye(9)).max() < 10 * EPS) == (nu == 1)


def test_erratum_71_the_printed_Gram_matrix_is_singular():
    """For more samples than coefficients F- F-^T has no inverse; (F-^T F-)^-1 F-^T recovers the coefficients."""
    _, Q = fourier_basis(1, 3, 16)
    assert np.linalg.matrix_rank(Q @ Q.T) == 7 < 16
    z = np.arange(1.0, 8.0)
    assert abs(np.linalg.solve(Q.T @ Q, Q.T) @ (Q @ z) - z).max() < 100 * EPS


# ---------------------------------------------------------------- exact waves
TENSION = 2e6
WAVES = {
    "pulse to the anchor": ({}, travelling_wave.pulse, (TENSION,), {"start": 250.0, "width": 80.0}),
    "pulse to the fairlead": (
        {}, travelling_wave.pulse, (TENSION,), {"start": 150.0, "width": 80.0, "towards": 1, "angles": (0.7, 0.2)}
    ),
    "axial wave": ({}, travelling_wave.axial_wave, (5e-3, 2e-3), {"start": 250.0, "width": 60.0}),
    "axial decay": ({"beta": 0.01}, travelling_wave.axial_decay, (0.01, LENGTH, 5e-3, 2e-3), {"mode": 2}),
}  # fmt: skip


def wave_source(name, EA=1.0, m=1.0):
    """Largest row of the source over that of EA eps / 100 m (rows 1-3) and of a speed over 100 m (rows 4-6)."""
    switched, make, numbers, options = WAVES[name]
    p = replace(cable_mp.BARE, **switched)
    fields = make(p.EA * EA, p.m * m, *numbers, **options)
    grid = np.linspace(0, LENGTH, 81), np.linspace(0, 0.03 if "axial" in name else 1.0, 13)
    rows, y = source_grid(p, fields, *grid)[:6], cable_mp.derivatives(fields, *grid)[0]
    size = np.repeat([p.EA * abs(y[0]).max() / 100, abs(y[1:4]).max() / 100], 3)
    return (abs(rows).max(axis=(1, 2)) / size).max()


@pytest.mark.parametrize("name", WAVES)
def test_exact_waves_need_no_source(name):
    """Bends of any size, strain waves and damped standing waves solve the full equations to round-off."""
    assert wave_source(name) <= 100 * GRID_ERROR


@pytest.mark.parametrize("name", WAVES)
def test_a_wave_of_another_speed_needs_one(name):
    """With 1 % more mass in the wave than in the equations the source is no round-off."""
    assert wave_source(name, m=1.01) > SEEN


def test_a_pulse_is_at_rest_outside_its_bend():
    """So the ends may be held while the bend is between them."""
    fields = travelling_wave.pulse(3.84e8, 77.7, TENSION, start=250.0, width=80.0)
    speed = abs(fields.velocity(np.array([0.0, 165.0, 250.0, 335.0, LENGTH]), 0.0)).max(axis=0)
    assert speed[[0, 1, 3, 4]].max() < 1e-12 * speed[2] and speed[2] > 10


def test_plucked_string_is_a_standing_wave():
    """From a sine, d'Alembert's two waves make a standing wave; displacement and velocity agree with it."""
    L, c, k = 7.0, 3.0, 3 * math.pi / 7.0
    s, t = np.linspace(0, L, 40)[:, None], np.linspace(0, 11.0, 50)[None]
    x = travelling_wave.plucked_string(lambda s: np.sin(k * s), c, L, s, t)
    v = travelling_wave.plucked_string_velocity(lambda s: k * np.cos(k * s), c, L, s, t)
    assert abs(x - np.sin(k * s) * np.cos(k * c * t)).max() < 1e-13
    assert abs(v + k * c * np.sin(k * s) * np.sin(k * c * t)).max() < 1e-12


# ---------------------------------------------------------------- natural frequencies
def test_hanging_chain_printed_digits():
    """omega sqrt(L/g) = j0n / 2: 1.202413, 2.760039, 4.326864, 5.895767; the shape's power series vanishes there."""
    got = [2 * mp.pi * f for f in frequencies.hanging_chain(4)]
    for x, printed in zip(got, (1.202413, 2.760039, 4.326864, 5.895767), strict=True):
        assert abs(x - printed) <= 0.5e-6
        top = mp.nsum(lambda k, x=x: (-x * x) ** k / mp.factorial(k) ** 2, [0, 80])
        assert abs(top) < 1e-12


def test_irvine_printed_digits():
    """x/pi of the first symmetric mode: 1.0402, 1.3451, 2.0, 2.5972, 2.8606; antisymmetric 2 n."""
    printed = {1: 1.0402, 10: 1.3451, 4 * mp.pi**2: 2.0, 100: 2.5972, mp.inf: 2.8606}
    for lambda2, x in printed.items():
        (first,) = frequencies.irvine_symmetric(1, lambda2)
        assert abs(first - x) <= 0.5e-4, (lambda2, first)
        half, stiff = first * mp.pi / 2, 0 if lambda2 == mp.inf else 4 / mpf(lambda2)
        assert abs(mp.tan(half) - half + stiff * half**3) < 1e-9 or abs(first - 2) < 1e-12
    assert frequencies.irvine_antisymmetric(3) == [2, 4, 6]
    assert frequencies.irvine_symmetric(2, 0) == [1, 3]


def test_straight_line_has_string_and_bar_frequencies():
    """A weightless taut line: transverse n/2L sqrt(T/((1 + eps) m)), axial n/2L sqrt(EA/m), to ten digits."""
    EA, m, ma, L, tension = 1e8, 50.0, 20.0, 300.0, 2e6
    chord = L * (1 + tension / EA)
    modes = frequencies.frequencies(EA, m, ma, 0.0, L, (0.8 * chord, 0.6 * chord), degree=60)
    string = [float(f) for f in frequencies.taut_string(6, tension / (1 + tension / EA), m + ma, L)]
    bar = float(frequencies.axial_bar(1, EA, m, L)[0])
    assert abs(modes.out_of_plane[:6] / string - 1).max() < EIGHT_DIGITS
    assert abs(modes.in_plane[:6] / string - 1).max() < EIGHT_DIGITS and abs(modes.first_axial / bar - 1) < EIGHT_DIGITS


def test_vertical_string_has_bessel_frequencies():
    """A nearly inextensible vertical line: zeros of cross products of Bessel functions, to the stretch T/EA."""
    tension, w0, m, L, EA = 1e4, 500.0, 60.0, 100.0, 1e13
    span = (0.0, L * (1 + (tension + w0 * L / 2) / EA))
    modes = frequencies.frequencies(EA, m, 0.0, w0, L, span)
    exact = [float(f) for f in frequencies.vertical_string(4, tension, w0, m, L)]
    assert abs(modes.out_of_plane[:4] / exact - 1).max() < 10 * (tension + w0 * L) / EA


@pytest.mark.parametrize("lambda2", [1.0, 10.0, 4 * math.pi**2, 100.0])
def test_shallow_lines_tend_to_irvine(lambda2):
    """The difference from Irvine's first two frequencies of each kind falls fourfold when the sag is halved."""
    exact = np.sort(
        [float(x) for x in (*frequencies.irvine_symmetric(2, lambda2), *frequencies.irvine_antisymmetric(2))]
    )
    differences = []
    for sag in (1 / 80, 1 / 160):
        EA, m, w0, L, span, H = frequencies.irvine_line(lambda2, sag)
        modes = frequencies.frequencies(EA, m, 0.0, w0, L, span)
        x = 2 * modes.in_plane[:4] * span[0] * math.sqrt(m / H)
        differences.append(abs(x / exact - 1).max())
    assert 3.5 < differences[0] / differences[1] < 4.5 and differences[1] < 2e-3, differences


@cache
def oc3_modes(degree=80):
    return frequencies.frequencies(*OC3, degree=degree)


def test_in_water_frequencies_of_the_OC3_line():
    """They come out in the printed digits, agree with the stored ten digits and do not depend on the degree."""
    rows, _ = table("oc3_dynamics")
    modes, finer = oc3_modes(), oc3_modes(110)
    assert abs(modes.in_plane[:12] / finer.in_plane[:12] - 1).max() < EIGHT_DIGITS / 10
    assert abs(modes.out_of_plane[:12] / finer.out_of_plane[:12] - 1).max() < EIGHT_DIGITS / 10
    assert np.array_equal(np.round(modes.in_plane[:4], 4), [0.1068, 0.1538, 0.2187, 0.2502])
    assert np.array_equal(np.round(modes.out_of_plane[:3], 4), [0.0555, 0.1105, 0.1656])
    stored = {r["quantity"]: (float(r["value"]), float(r["uncertainty"])) for r in rows if r["name"] == "frequencies"}
    got = {f"in plane {n + 1}": f for n, f in enumerate(finer.in_plane[:8])}
    got |= {f"out of plane {n + 1}": f for n, f in enumerate(finer.out_of_plane[:6])}
    got |= {
        "mostly axial 1": finer.first_axial,
        "straight bar 1": float(frequencies.axial_bar(1, OC3[0], OC3[1], OC3[4])[0]),
    }
    assert got.keys() == stored.keys()
    assert all(abs(got[k] - value) <= error for k, (value, error) in stored.items())


def test_the_axial_frequency_of_the_straight_bar_is_no_mode_of_the_line():
    """sqrt(EA/m)/2L is 1.232 Hz; the first mode that moves mostly along the sagging line has 1.261 Hz."""
    bar, modes = float(frequencies.axial_bar(1, OC3[0], OC3[1], OC3[4])[0]), oc3_modes()
    assert round(bar, 3) == 1.232 and round(modes.first_axial, 3) == 1.261
    assert abs(modes.in_plane / bar - 1).min() > 0.01


def shot(frequency, beta=0.0):
    """q and force (2, 2) at the fairlead, in plane, of the two solutions with q = 0 and unit force at the anchor."""
    EA, m, ma, w0, L, span = OC3
    state = catenary_mp.solve(w0, EA, L, *span, seabed=False, digits=20)
    H, V0, omega = float(state.H), float(state.V_anchor), 2 * math.pi * frequency

    def rate(s, y):
        q, force = y[:4].reshape(2, 2), y[4:].reshape(2, 2)
        T = math.hypot(H, V0 + w0 * s)
        t = np.array([H, V0 + w0 * s]) / T
        along, across = np.outer(t, t), np.eye(2) - np.outer(t, t)
        q_s = (along / (EA * (1 + 1j * omega * beta)) + across * (1 + T / EA) / T) @ force
        return np.concatenate([q_s.ravel(), (-(omega**2) * (m * along + (m + ma) * across) @ q).ravel()])

    start = np.concatenate([np.zeros(4), 1e6 * np.eye(2).ravel()]).astype(complex)
    end = solve_ivp(rate, (0, L), start, method="DOP853", rtol=1e-12, atol=1e-9).y[:, -1]
    return end[:4].reshape(2, 2), end[4:].reshape(2, 2)


def test_modes_agree_with_shooting(deep):
    """At each frequency the determinant of the shot displacements vanishes, to the change it makes over 1e-9 of it."""
    results = [*oc3_modes().in_plane[: 12 if deep else 3], oc3_modes().first_axial]
    for f in results:
        below, at, above = (np.linalg.det(shot(f * (1 + d))[0]).real for d in (-1e-5, 0, 1e-5))
        slope = (above - below) / 2e-5
        assert abs(at / slope) < EIGHT_DIGITS, (f, at / slope)


@pytest.mark.parametrize(("frequency", "beta"), [(0.05, 0.0), (0.5, 0.02), (1.25, 0.01)])
def test_fairlead_response_agrees_with_shooting(frequency, beta):
    """Galerkin and Runge-Kutta give the same force and tension per metre of surge and of heave."""
    q, force = shot(frequency, beta)
    wanted = force @ np.linalg.inv(q)
    EA, _, _, w0, L, span = OC3
    state = catenary_mp.solve(w0, EA, L, *span, seabed=False, digits=20)
    t = np.array([float(state.H), float(state.V)])
    t /= np.hypot(*t)
    for j, direction in enumerate(((1, 0, 0), (0, 0, 1))):
        got = frequencies.fairlead_response(*OC3, frequency, direction, beta=beta)
        size = abs(wanted).max()
        assert abs(got.force[[0, 2]] - wanted[:, j]).max() < 10 * SHOOTING * size
        assert abs(got.tension[0] - t @ wanted[:, j]) < 10 * SHOOTING * size


def test_fairlead_response_is_reciprocal_static_at_zero_and_loses_energy():
    """Force z per surge = force x per heave; at zero frequency it is the static stiffness; damping takes work."""
    w0, EA, L = OC3[3], OC3[0], OC3[4]
    state = catenary_mp.solve(w0, EA, L, *OC3[5], seabed=False, digits=30)
    K = np.array(catenary_mp.stiffness(w0, EA, L, *OC3[5], seabed=False, solution=state).tolist(), float)
    surge, sway, heave = (frequencies.fairlead_response(*OC3, 1e-6, e) for e in np.eye(3))
    got = np.array([surge.force, heave.force])[:, [0, 2]].real
    assert abs(got - K).max() < 1e-8 * K.max()
    assert abs(sway.force[1] - float(state.H) / OC3[5][0]) < 1e-8 * K.max() and sway.tension == 0
    for frequency in (0.05, 0.3, 1.0):
        surge, _, heave = (frequencies.fairlead_response(*OC3, frequency, e, beta=0.05) for e in np.eye(3))
        assert abs(surge.force[2] - heave.force[0]) < 1e-8 * abs(surge.force).max()
        assert surge.force[0].imag > 0 and heave.force[2].imag > 0


# ---------------------------------------------------------------- oscillators
QUICK = ("duffing large branch", "duffing unstable branch", "square", "ueda third", "quadratic below", "two masses")


@pytest.mark.parametrize("name", CASES)
def test_orbits_close_by_another_integrator(name):
    """A Runge-Kutta run in first-order form, typed from the equation, comes back to the start after the period."""
    orbit = case(name)
    c = orbit.chain
    m, d, q, f, F = (np.array(getattr(c, k)) for k in ("mass", "damping", "quadratic", "constant", "force"))

    def rate(t, y):
        x, v = y[: c.n], y[c.n :]
        force = f + F * math.cos(c.omega * t) - d * v - q * abs(v) * v
        for j in range(c.n + 1):
            left, right = x[j - 1] if j else 0.0, x[j] if j < c.n else 0.0
            e = right - left
            pull = c.stiffness[j] * e + c.square[j] * e**2 + c.cubic[j] * e**3
            if j:
                force[j - 1] += pull
            if j < c.n:
                force[j] -= pull
        return np.concatenate([v, force / m])

    start = np.concatenate(orbit.start)
    run = solve_ivp(rate, (0, float(orbit.period)), start, method="DOP853", rtol=1e-12, atol=1e-12, dense_output=True)
    assert abs(run.y[:, -1] - start).max() < 1e-9
    t = np.linspace(0, float(orbit.period), 33)[:-1]
    assert abs(run.sol(t)[: c.n] - orbit.x(t)).max() < 1e-8 and np.array_equal(orbit.samples(32), orbit.x(t))


def test_doubles_agree_with_thirty_digits(deep):
    """Start and Fourier coefficients in doubles agree with those of 30 digits; in the long version these with 40."""
    for name in CASES if deep else ("ueda small", "quadratic below"):
        low, high = case(name), case(name, 30)
        assert high.error < 1e-30 and abs(np.array(high.start, float) - np.array(low.start)).max() < ORBIT_ERROR
        for a, b in zip(low.fourier(20), high.fourier(20), strict=True):
            assert abs(a - b).max() < ORBIT_ERROR, name
    if deep:
        high, higher = case("ueda small", 30), case("ueda small", 40)
        assert max(abs(a - b)[0] for a, b in zip(high.start, higher.start, strict=True)) < mpf("1e-29")


@pytest.mark.parametrize("name", QUICK)
def test_fourier_series_solves_the_equation(name):
    """Mean, cosines and sines put together are the motion; without kinks they fall off exponentially."""
    orbit = case(name)
    mean, cosine, sine = orbit.fourier(40)
    t = np.linspace(0, float(orbit.period), 20)
    angle = 2 * np.pi / float(orbit.period) * np.arange(1, 41)[:, None] * t
    series = mean[:, None] + cosine.T @ np.cos(angle) + sine.T @ np.sin(angle)
    kinks = any(orbit.chain.quadratic)
    assert abs(series - orbit.x(t)).max() < (1e-6 if kinks else 100 * ORBIT_ERROR)


def test_free_duffing_is_a_jacobi_function():
    """x'' + a x + b x^3 = 0 from rest at A: x = A cn(sqrt(a + b A^2) t, m), m = b A^2 / 2 (a + b A^2), to 30 digits."""
    a, b, A, t = 1.0, 0.5, 2.0, 7.0
    x, _ = trajectory(duffing(0.0, a, b, 0.0, 1.0), ([A], [0.0]), t, digits=30)
    with mp.workdps(40):
        square = mpf(a) + mpf(b) * A**2
        exact = A * mp.ellipfun("cn", mp.sqrt(square) * t, m=mpf(b) * A**2 / 2 / square)
        assert abs(x[0] - exact) < mpf("1e-29")
    assert abs(trajectory(duffing(0.0, a, b, 0.0, 1.0), ([A], [0.0]), t)[0][0] - float(exact)) < ORBIT_ERROR


def test_frequency_of_the_purely_cubic_oscillator():
    """x'' + x^3 = 0 with amplitude 1 has the frequency 0.8472130848 of the textbooks: after its period it is back."""
    period = 2 * math.pi / 0.8472130848
    x, v = trajectory(duffing(0.0, 0.0, 1.0, 0.0, 1.0), ([1.0], [0.0]), period)
    assert abs(x[0] - 1) < ORBIT_ERROR and abs(v[0]) < period * 0.5e-10 / 0.847  # half a unit of the last digit


def test_exact_subharmonic_of_the_undamped_duffing():
    """x'' + a x + b x^3 = (b A^3 / 4) cos(3 w t) has the solution A cos(w t) where w^2 = a + 3 b A^2 / 4."""
    a, b, A = 1.0, 0.4, 1.5
    w = math.sqrt(a + 0.75 * b * A**2)
    orbit = oscillators.periodic(duffing(0.0, a, b, b * A**3 / 4, 3 * w), periods=3, start=([A + 0.01], [0.0]))
    t = np.linspace(0, float(orbit.period), 50)
    assert abs(orbit.x(t)[0] - A * np.cos(w * t)).max() < 1e-12
    mean, cosine, sine = orbit.fourier(9)
    assert abs(cosine[0, 0] - A) < 1e-12 and max(abs(cosine[1:]).max(), abs(sine).max(), abs(mean)[0]) < 1e-12


def test_linear_response_in_closed_form():
    """Without nonlinear terms every mass follows the complex response of the matrices."""
    n, w = 3, 1.1
    chain = oscillators.Chain(
        n, w, (0.0, 0.3, 1.0), mass=(1.0, 2.0, 0.5), damping=0.1, spring_damping=0.05, stiffness=2.0
    )
    K = 2.0 * (2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1))
    C = 0.1 * np.eye(n) + 0.05 / 2.0 * K
    z = np.linalg.solve(K + 1j * w * C - w**2 * np.diag(chain.mass), np.array(chain.force))
    _, cosine, sine = oscillators.periodic(chain).fourier(3)
    assert abs(cosine[0] - z.real).max() < ORBIT_ERROR * 10 and abs(sine[0] + z.imag).max() < ORBIT_ERROR * 10
    assert abs(cosine[1:]).max() < ORBIT_ERROR * 10


def turning_point(a, c):
    """Turning point -b of x'' + c |x'| x' + x = 0 after rest at a: (1 - g b) e^(g b) = (1 + g a) e^(-g a), g = 2c."""
    g = 2 * mpf(c)
    wanted = (1 + g * a) * mp.exp(-g * a)
    return -mp.findroot(lambda b: (1 - g * b) * mp.exp(g * b) - wanted, (0, a), solver="anderson", tol=mpf("1e-60"))


def swing_error(c=0.3, a=2.0):
    """Distance of the second turning point by series from the closed form, 30 digits, and of the speed from zero."""
    with mp.workdps(40):
        second = -turning_point(-turning_point(mpf(a), c), c)
        chain = quadratically_damped(1.0, c, 1.0, 0.0, 1.0)
        march = oscillators._Integrator(chain, 30)
        x, v = march.array([a])[:, None], march.array([0.0])[:, None]
        turns = [s.x[0, 0] for s in march.march(x, v, mpf(0), mpf(7))[2] if s.v[0, 0] == 0]
        return abs(turns[2] - second) if len(turns) > 2 else mpf(1)


def test_quadratically_damped_swing_turns_where_energy_says():
    """The kinks are found and passed: the second turning point of a free swing has the digits of its closed form."""
    assert swing_error() < mpf("1e-28")


def test_a_missed_kink_is_noticed(monkeypatch):
    """With turning points located 1e-6 late the swing misses the closed form."""
    right = oscillators._Integrator.root
    monkeypatch.setattr(oscillators._Integrator, "root", lambda self, *a: right(self, *a) * (1 + mpf("1e-6")))
    assert swing_error() > mpf("1e-20")


def test_a_wrong_cubic_is_noticed(monkeypatch):
    """With 1e-6 more cubic stiffness the free oscillation misses the Jacobi function."""
    right = oscillators._Integrator.__init__

    def wrong(self, chain, digits):
        right(self, chain, digits)
        self.b = self.b * (1 + 1e-6)

    monkeypatch.setattr(oscillators._Integrator, "__init__", wrong)
    with pytest.raises(AssertionError):
        test_free_duffing_is_a_jacobi_function()


@pytest.mark.parametrize("name", [name for name, (chain, _) in CASES.items() if not any(chain.quadratic)])
def test_multipliers_obey_liouville(name):
    """The product of the Floquet multipliers is exp(-period times the sum of d/m), to the differenced matrix."""
    orbit = case(name)
    rate = sum(d / m for d, m in zip(orbit.chain.damping, orbit.chain.mass, strict=True))
    assert abs(np.prod(orbit.multipliers) - math.exp(-rate * float(orbit.period))) < 1e-6
    assert orbit.stable == (name != "duffing unstable branch")


def test_ueda_has_five_attractors():
    """x'' + 0.08 x' + x^3 = 0.2 cos t: five stable motions, two of one, two of two and one of three drive periods."""
    orbits = [case(name) for name in CASES if name.startswith("ueda")]
    assert sorted(o.periods for o in orbits) == [1, 1, 2, 2, 3] and all(o.stable for o in orbits)
    drive = 2 * math.pi
    points = [(round(float(x), 6), round(float(v), 6)) for o in orbits for x, v in
              zip(o.x(drive * np.arange(o.periods))[0], o.v(drive * np.arange(o.periods))[0], strict=True)]  # fmt: skip
    assert len(set(points)) == 9


def test_an_even_force_shifts_the_mean():
    """x^2 and a constant force leave a mean, so constant terms may not be dropped; odd forces leave none."""
    assert abs(case("square").fourier(1)[0][0]) > 0.02 and case("duffing biased").fourier(1)[0][0] > 0.2
    assert abs(case("two masses").fourier(1)[0]).max() < ORBIT_ERROR


def test_an_orbit_that_does_not_close_is_refused():
    """An undamped resonance has no periodic motion: ArithmeticError and not a number."""
    with pytest.raises((ArithmeticError, np.linalg.LinAlgError)):
        oscillators.periodic(duffing(0.0, 1.0, 0.0, 1.0, 1.0), start=([1.0], [0.0]))


# ---------------------------------------------------------------- reference data of the dynamics
def values(name):
    """(name, quantity) -> (value, uncertainty) of a reference set."""
    rows, _ = table(name)
    return {
        (r["name"], r["quantity"]): (float(r["value"]), float(r.get("uncertainty") or r["half_unit"])) for r in rows
    }


@pytest.mark.parametrize("name", ["oc3_dynamics", "hb_paper"])
def test_provenance_of_dynamic_sets_is_stated(name):
    """Both sets say what they are, where from, in which units and signs; no row appears twice."""
    rows, about = table(name)
    assert {"title", "kind", "citation", "how_obtained", "uncertainty", "date", "units", "signs"} <= about.keys()
    assert about["kind"] in ("computed", "published")
    assert len(values(name)) == len(rows)
    if name == "oc3_dynamics":
        assert {r["name"] for r in rows} == about["sets"].keys()


def test_both_reference_sets_describe_the_same_line():
    """Table 1 is the line of the computed set and of the oracle's frequencies."""
    paper, about = values("hb_paper"), table("oc3_dynamics")[1]["line"]
    names = {
        "diameter": "diameter", "mass per length": "mass_per_length", "submerged weight": "submerged_weight",
        "unstretched length": "length", "EA": "EA", "Ca": "Ca", "Cdt": "Cdt", "Cdn": "Cdn", "Cdb": "Cdb",
    }  # fmt: skip
    assert all(paper["line", key][0] == about[name] for key, name in names.items())
    assert [paper["line", "radius"][0], paper["line", "depth"][0]] == about["span"] == list(OC3[5])
    assert (about["EA"], about["mass_per_length"], about["submerged_weight"], about["length"]) == (
        OC3[0],
        OC3[1],
        *OC3[3:5],
    )


def test_static_tension_of_the_reference_set():
    """The catenary of Table 1 pulls the fairlead with 961.530 kN."""
    value, error = values("oc3_dynamics")["statics", "catenary fairlead tension"]
    assert abs(oc3_modes().tension[1] / 1e3 - value) <= error


def test_reference_tensions_are_consistent():
    """Extremes lie within mean and harmonics, nodes converge with order 2, and dropping the mean shows."""
    got = {key: value for key, (value, _) in values("oc3_dynamics").items()}
    for name in ("reference", "hb_mean_9", "hb_mean_30", "hb_paper_9", "time_domain"):
        swing = sum(got[name, f"harmonic {k}"] for k in range(1, 6))
        for extreme in ("maximum", "minimum"):
            reach = abs(got[name, extreme] - got[name, "mean"])
            assert abs(got[name, "mean"] - 970.7) < 10 and reach < 1.05 * swing
    for extreme in ("maximum", "minimum"):
        by_nodes = [got[f"hb_mean_9_nodes_{n}", extreme] for n in (25, 50, 100, 200)]
        coarse, middle, fine = np.diff(by_nodes)
        assert 3 < coarse / middle < 5 and 3 < middle / fine < 5
    assert got["hb_paper_9", "mean"] < got["reference", "mean"] - 8
    assert got["hb_mean_9m", "minimum"] > 200 and got["hb_paper_9m", "minimum"] < 0


def test_table_2_of_the_paper():
    """Harmonic balance took 2.2 to 4.4 times less than three periods in the time domain: less than 1.4 periods."""
    got = values("hb_paper")
    ratios = [got[f"case {c}", "time domain"][0] / got[f"case {c}", "harmonic balance"][0] for c in (1, 2, 3, 4)]
    assert min(ratios) > 2.2 and max(ratios) < 4.4


def test_node_25_of_the_paper_is_not_on_an_even_mesh():
    """Fifty even nodes put node 25 at 441.89 m; the captions of Figs. 6 to 9 print 441.11 m."""
    got, about = values("hb_paper"), table("hb_paper")[1]
    printed, half_unit = got["statement", "arc length of node 25"]
    even = 24 * got["line", "unstretched length"][0] / got["statement", "segments"][0]
    assert abs(even - about["inferred"]["arc_length_of_node_25"]) <= 0.005 and abs(printed - even) > 50 * half_unit
