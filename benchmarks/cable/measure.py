"""The moving cable: profile, settling, tension in space and time, orders, drift, speed beside peers: dynamics.json."""

from __future__ import annotations

import gc
from dataclasses import replace

import numpy as np

from solvers.cable.statics import solve_static
from solvers.cable.system import cable_system
from solvers.catenary.span import solve_span
from solvers.time_domain.solve import solve_time_domain
from verification.registry import instants, last_period_tension

from ..run import console, results
from ..run.harness import clock
from . import orders as dynamic_orders
from . import work_precision as dynamic_work
from .cases import DT, NODES, PERIODS, scene, system, warm_up

CASE, LARGE = "case_1", "case_1_large"

PROFILE_POINTS = 201
DRAGS = {1.6: 8, 0.1: 20}  # drag coefficient -> periods; those of Fig. 5
QUICK_DRAGS = {1.6: 5, 0.1: 12}
SETTLED = (1e-3, 1e-4)
SHOWN = 8  # periods of a history that are drawn
MAP_TIMES = 80
DRIFT_PERIODS, QUICK_DRIFT, DRIFT_DT = 50, 5, 0.2
TURNS, QUICK_TURNS = 7, 2
GROWTH = (25, 50, 100, 200, 400, 700, 1000)
QUICK_GROWTH = (50, 100, 200, 400)
FITTED_FROM = 100  # nodes: below, a step is mostly overhead that does not grow


def profile(quick: bool):
    """Fig. 2: nodes of the box scheme and the catenary; the fairlead tension by box scheme, shooting and catenary."""
    chain = system(CASE)
    state, exact = solve_static(chain), solve_span(chain.scene.spans()[0])
    shot = solve_static(chain, method="shooting")
    anchor, s = chain.scene.anchor, np.linspace(0, chain.scene.length, PROFILE_POINTS)
    x, z, tension = exact.profile(s)
    at_nodes = exact.profile(chain.s)
    off = state.r[0] - anchor[0] - at_nodes[0], state.r[2] - anchor[2] - at_nodes[1]
    yield {
        "nodes": {"s": chain.s, "x": state.r[0] - anchor[0], "z": state.r[2] - anchor[2], "tension": state.tension},
        "catenary": {"s": s, "x": x, "z": z, "tension": tension},
        "fairlead": {"box scheme": state.tension[-1], "shooting": shot.tension[-1], "catenary": tension[-1]},
        "distance": np.hypot(*off).max(),
        "iterations": state.iterations,
    }


def settling(quick: bool):
    """Fig. 5: the fairlead tension from rest with both drag coefficients, and how far each period is from the last."""
    rows = []
    for drag, periods in (QUICK_DRAGS if quick else DRAGS).items():
        case = scene(CASE)
        case = replace(case, cable=replace(case.cable, Cdn=drag, Cdb=drag))
        history = solve_time_domain(cable_system(case, NODES), dt=DT, periods=periods)
        period = history.system.period
        waves = np.array([history.fairlead_tension(k * period + instants(period, 200)) for k in range(periods)])
        away = abs(waves - waves[-1]).max(axis=1) / np.ptp(waves[-1])
        rows.append(
            {
                "drag": drag,
                "period": period,
                "periods": periods,
                "time": (instants(period, 200) + period * np.arange(SHOWN)[:, None]).ravel()[: 200 * periods],
                "tension": waves[:SHOWN].ravel(),
                "away": away,
                "settled": {f"{level:g}": first_within(away, level) for level in SETTLED},
            }
        )
        yield None
    yield rows


def first_within(away, level: float) -> int | None:
    """Number (from 1) of the first period that, with all later ones, is within the level; None if the last but one."""
    late = np.flatnonzero(np.asarray(away) > level)
    first = int(late[-1]) + 2 if late.size else 1
    return first if first < len(away) else None


def spacetime(quick: bool):
    """Tension at all nodes over the last period, 5 m and 9 m."""
    rows = []
    for name in (CASE, LARGE):
        chain = system(name)
        history = solve_time_domain(chain, dt=DT, periods=PERIODS)
        first, period = history.last_period
        t = np.linspace(0, period, MAP_TIMES + 1)
        y, ydot = history.at(first + t), history.rate_at(first + t)
        tension = chain.tension(y, ydot)
        node, k = np.unravel_index(tension.argmin(), tension.shape)
        rows.append({"case": name, "s": chain.s, "time": t, "tension": np.round(tension, -1), "least": tension.min(),
                     "node": int(node) + 1, "at": t[k]})  # fmt: skip
        yield None
    yield rows


def orders(quick: bool):
    """Statics, then dynamics in the cell and in the step."""
    parts = {"statics": dynamic_orders.statics()}
    yield None
    for name, part in (("cell", dynamic_orders.in_cell), ("step", dynamic_orders.in_step)):
        for parts[name] in part(quick):
            yield None
    yield parts


def drift(quick: bool):
    """Distance of the fairlead from its prescribed place at the end of each period, and the largest in the last one."""
    rows, periods = [], QUICK_DRIFT if quick else DRIFT_PERIODS
    for name in (CASE, LARGE):
        for hold in ("position", None):
            period = system(name).period
            every = round(period / DRIFT_DT)
            history = solve_time_domain(
                system(name), dt=DRIFT_DT, periods=periods, hold=hold, allow_invalid=True, throw=False
            )
            away = history.drift()
            rows.append({"case": name, "hold": hold, "dt": DRIFT_DT, "period": np.arange(len(away[::every])),
                         "drift": away[::every], "within": away[-every:].max(),
                         "status": history.status.name})  # fmt: skip
            yield None
    yield rows


def speed(quick: bool):
    """Three periods: planar, in six fields, and other codes that solve them, turn and turn about."""
    calls = {
        "planar": lambda: solve_time_domain(system(CASE), dt=DT, periods=PERIODS),
        "six fields": lambda: solve_time_domain(system(CASE, NODES, "spatial"), dt=DT, periods=PERIODS),
    }
    calls |= dynamic_work.peer_calls(CASE)
    responses = {name: call() for name, call in calls.items()}  # also the warm-up
    calls = {name: call for name, call in calls.items() if getattr(responses[name], "kind", "") == ""}
    seconds = {name: [] for name in calls}
    rng = np.random.default_rng(2026)
    for _ in range(QUICK_TURNS if quick else TURNS):
        for name in rng.permutation(list(calls)).tolist():
            seconds[name].append(clock(calls[name], 1))
        yield None
    waves = [last_period_tension(responses[name]) for name in ("planar", "six fields")]
    planar = responses["planar"]
    yield {
        "seconds": seconds,
        "fields_difference": abs(waves[0] - waves[1]).max() / waves[0].max(),
        "steps": planar.steps,
        "iterations": planar.iterations,
        "factorisations": planar.factorisations,
    }


def growth(quick: bool):
    """Seconds of one period by nodes, and the fitted exponent."""
    rows = []
    for nodes in QUICK_GROWTH if quick else GROWTH:
        chain = system(CASE, nodes)
        seconds, history = dynamic_work.least_seconds(lambda chain=chain: solve_time_domain(chain, dt=DT, periods=1))
        rows.append({"nodes": nodes, "seconds": seconds, "iterations": history.iterations})
        yield None
    yield {"rows": rows, "fitted_from": FITTED_FROM, "exponent": exponent(rows, "nodes", FITTED_FROM)}


def exponent(rows, key: str, least) -> float:
    """p of seconds = C size^p, least squares in logarithms, from a least size on."""
    size, seconds = np.array([(row[key], row["seconds"]) for row in rows if row[key] >= least], dtype=float).T
    return float(np.polyfit(np.log(size), np.log(seconds), 1)[0])


PARTS = {
    "profile": profile,
    "settling": settling,
    "spacetime": spacetime,
    "orders": orders,
    "drift": drift,
    "speed": speed,
    "growth": growth,
}
TIMED = ("speed", "growth")


def add_parts(parser, parts: dict):
    """The options that choose among parts."""
    choice = parser.add_mutually_exclusive_group()
    choice.add_argument("--parts", nargs="+", choices=parts, default=list(parts), help="measure only these")
    choice.add_argument("--kind", choices=("timed", "untimed"),
                        help="only what is a timing, or only the rest, in a file of its own")  # fmt: skip
    parser.add_argument("--quick", action="store_true", help="fewer settings and sizes")


def chosen(arguments, timed, stem: str) -> tuple[list[str], str]:
    """(names of the parts, name of the result file) that the options ask for."""
    if arguments.kind is None:
        return arguments.parts, f"{stem}.json"
    names = [name for name in arguments.parts if (name in timed) == (arguments.kind == "timed")]
    return names, f"{stem}.json" if arguments.kind == "timed" else f"{stem}_untimed.json"


def measured(parts: dict, chosen, label: str, *settings) -> dict:
    """The named parts of a result file; a part yields None once a step and its value last."""
    file = {}
    warm_up()

    def steps():
        for number, name in enumerate(chosen, start=1):
            for value in parts[name](*settings):
                file[name] = value
            yield number

    gc.disable()  # as timeit does: a collection in one solver's turn is not its doing
    try:
        for _ in console.progress(steps(), len(chosen), label):
            gc.collect()
    finally:
        gc.enable()
    return file


def main(argv=None) -> int:
    """Command line."""
    parser = console.parser("cable_dynamics", __doc__)
    add_parts(parser, PARTS)
    arguments = parser.parse_args(argv)
    names, output = chosen(arguments, TIMED, "dynamics")
    file = measured(PARTS, names, "dynamics", arguments.quick)
    results.write(arguments.out / output, file | {"quick": arguments.quick})
    if "speed" in file:
        for name, seconds in file["speed"]["seconds"].items():
            print(f"three periods, {name}: {min(seconds):.3g} s")
    return 0


if __name__ == "__main__":
    console.run(main)
