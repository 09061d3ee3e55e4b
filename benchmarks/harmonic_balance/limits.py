"""Harmonic balance at its limits: vanishing tension, growth with size, more fields, and beside other libraries."""

from __future__ import annotations

from functools import partial
from itertools import pairwise

import numpy as np

from solvers.cable.system import cable_system
from solvers.common.motions.motion import Motion
from solvers.harmonic_balance.solve import solve_periodic
from verification.cases.oscillators import cubic_chain
from verification.registry import instants, last_period_tension

from ..cable.cases import HARMONICS, NODES, SAMPLES, rms, scene, system
from ..cable.measure import exponent
from ..cable.work_precision import least_seconds
from ..run.harness import clock

CASE, FREQUENCY = "case_1", 0.05
AMPLITUDES = (5.0, 6.0, 7.0, 8.0, 9.0, 9.5, 10.0, 10.25, 10.5, 10.75)  # m
BEYOND = (11.0,)  # m, tried in the whole run: continuation in small steps takes long to give up
QUICK_AMPLITUDES = (5.0, 7.0, 9.0, 10.0, 10.25, 10.5)
RAISED = 15  # harmonics

GROWTH = {
    "nodes": ("case_1", (25, 50, 100, 200, 400, 700, 1000)),
    "harmonics": ("case_3", (9, 15, 20, 30, 45, 60)),
}
"""(case, sizes); nodes at Nh = 9, harmonics at N = 50."""
QUICK_MOST = {"nodes": 200, "harmonics": 20}
FITTED_FROM = {"nodes": 100, "harmonics": 15}
TURNS, QUICK_TURNS = 9, 3

SIZES = {"10 masses": (10, 9), "50 masses": (50, 9), "100 masses": (100, 15), "300 masses": (300, 15)}
"""Set of reference_data/other_codes, which has the times of libraries -> (masses, harmonics)."""


def limit(quick: bool, references):
    """Surge raised until the tension vanishes: each response starts from the last one."""
    rows, last = [], None
    for amplitude in QUICK_AMPLITUDES if quick else (*AMPLITUDES, *BEYOND):
        chain = cable_system(scene(CASE), NODES, motion=Motion.harmonic(FREQUENCY, (amplitude, 0.0, 0.0)))
        response = solve_periodic(chain, harmonics=RAISED, start=last, throw=False)
        t = instants(chain.period)
        tension = chain.tension(response.at(t), response.rate_at(t))
        node, k = np.unravel_index(tension.argmin(), tension.shape)
        rows.append(
            {
                "amplitude": amplitude,
                "status": response.status.name,
                "reached": response.amplitude,
                "iterations": response.iterations,
                "least": tension[node, k],
                "node": int(node) + 1,
                "s": chain.s[node],
                "at": t[k],
                "fairlead": tension[-1].min(),
            }
        )
        last = response if response.amplitude == 1.0 else last
        yield None
    yield {"rows": rows, "vanishes": vanishing(rows)}


def vanishing(rows) -> float | None:
    """Amplitude at which the least tension passes zero, m, between two converged responses."""
    full = [row for row in rows if row["reached"] == 1.0]
    for below, above in pairwise(full):
        if above["least"] < 0 <= below["least"]:
            share = below["least"] / (below["least"] - above["least"])
            return below["amplitude"] + share * (above["amplitude"] - below["amplitude"])
    return None


def growth(quick: bool, references):
    """Seconds by nodes and by harmonics, with the fitted exponents."""
    rows, exponents = [], {}
    for name, (case, sizes) in GROWTH.items():
        mine = []
        for size in sizes:
            if quick and size > QUICK_MOST[name]:
                continue
            nodes, Nh = (size, HARMONICS) if name == "nodes" else (NODES, size)
            run = partial(solve_periodic, system(case, nodes), harmonics=Nh)
            seconds, response = least_seconds(run)
            mine.append({"series": name, "case": case, "size": size, "seconds": seconds,
                         "iterations": response.iterations + response.coarse_iterations})  # fmt: skip
            yield None
        rows, exponents = rows + mine, exponents | {name: exponent(mine, "size", FITTED_FROM[name])}
    yield {"rows": rows, "exponents": exponents, "fitted_from": FITTED_FROM, "nodes": NODES, "harmonics": HARMONICS}


def fields(quick: bool, references):
    """Case 1 in four and in six fields, turn and turn about."""
    calls = {
        name: lambda name=name: solve_periodic(system(CASE, NODES, name), harmonics=HARMONICS, samples=SAMPLES)
        for name in ("planar", "spatial")
    }
    waves = {name: last_period_tension(call()) for name, call in calls.items()}
    seconds = {name: [] for name in calls}
    for _ in range(QUICK_TURNS if quick else TURNS):
        for name, call in calls.items():
            seconds[name].append(clock(call, 1))
        yield None
    difference = rms(waves["planar"] - waves["spatial"]) / waves["planar"].max()
    yield {"seconds": seconds, "difference": difference}


def oscillators(quick: bool, references):
    """Chains of masses with cubic springs, in the sizes at which libraries were measured."""
    rows = []
    for name, (masses, Nh) in SIZES.items():
        chain, row = cubic_chain(masses), {"set": name, "masses": masses, "harmonics": Nh}
        for key, symmetry in (("seconds", True), ("seconds_full", False)):
            row[key], response = least_seconds(partial(solve_periodic, chain, harmonics=Nh, symmetry=symmetry))
        row |= {"iterations": response.iterations + response.coarse_iterations, "residual_norm": response.residual_norm}
        rows.append(row | {"fields": len(chain.fields)})
        yield None
    yield rows
