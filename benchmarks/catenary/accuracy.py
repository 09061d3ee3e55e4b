"""Every solver on every case against 50 digits: right, wrong, refused or unsupported, and by how much: accuracy.json.

Sets: the reference table; random lines from everyday to extreme; a map over slackness and stiffness.
"""

from __future__ import annotations

import math
import signal
from concurrent.futures import ProcessPoolExecutor

import numpy as np
from threadpoolctl import threadpool_limits

from verification.cases.spans import SpanCase, random_cases
from verification.reference import WRONG, span_references

from ..run import console, harness, results
from ..run import oracle_cache as truth

SEED = 2026
GRID = 32
CHUNK = 4  # cases handed to a process at a time: exact results take 0.01 to 1 s each

MAP_ENDS = {"x": 864.0, "z": 252.0}  # m: nearly OC3 (848.67, 250), with a chord of exactly 900
MAP_CHORD = 900.0
MAP_WEIGHT = 698.094  # N/m


def map_slackness() -> np.ndarray:
    """GRID values of L/chord from 0.9 to 3, dense on both sides of 1, with 1 itself."""
    below = 1 - np.logspace(-1, -7, 9)
    above = 1 + np.logspace(-7, math.log10(2), GRID - 10)
    return np.concatenate([below, [1.0], above])


def map_cases(step: int = 1) -> list[SpanCase]:
    """The map: GRID x GRID lines between two fixed ends, slackness by EA/(w L); or every ``step``-th each way."""
    cases, stiffnesses = [], list(enumerate(np.logspace(1, 9, GRID)))
    for i, slackness in list(enumerate(map_slackness()))[step - 1 :: step]:
        L = float(slackness * MAP_CHORD)
        for j, stiffness in stiffnesses[step - 1 :: step]:
            EA = float(stiffness * MAP_WEIGHT * L)
            cases.append(SpanCase(f"map-{i}-{j}", "map", MAP_WEIGHT, EA, L, **MAP_ENDS, friction=0.1))
    return cases


def tasks(random: int, step: int, known: truth.TruthCache) -> list[tuple]:
    """(set, case, truth or None) of every row, in the order of the file."""
    jobs = [("reference", case, exact) for case, exact in span_references()]
    jobs += [("random", case, known.get(case)) for case in random_cases(random, SEED)]
    return jobs + [("map", case, known.get(case)) for case in map_cases(step)]


def row(task) -> tuple:
    """(truth, row of the file); runs in one of the processes."""
    group, case, exact = task
    exact = exact or truth.oracle(case)
    chord = math.hypot(case.x, case.z)
    answers = {name: harness.assess(solver, case, exact) for name, solver in _SOLVERS.items()}
    return exact, {
        "set": group,
        "case": case.name,
        "regime": case.regime,
        "inputs": case.inputs(),
        "slackness": case.L / chord if chord else None,
        "stiffness": case.EA / (abs(case.w) * case.L) if case.w else None,
        "condition": exact.condition,
        "limit": exact.limit,
        "answers": answers,
    }


_SOLVERS: dict[str, harness.Solver] = {}


def _start_process():
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends its processes
    threadpool_limits(1)
    _SOLVERS.update(harness.solvers())


def measured(work: list[tuple], known: truth.TruthCache, jobs: int) -> list[dict]:
    """The rows, from ``jobs`` processes; new exact results are kept as they come."""
    rows = []
    with ProcessPoolExecutor(jobs, initializer=_start_process) as pool:
        try:
            steps = console.progress(pool.map(row, work, chunksize=CHUNK), len(work), "accuracy")
            for (group, case, _), (exact, line) in zip(work, steps, strict=True):
                if group != "reference":
                    known.put(case, exact)
                rows.append(line)
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    return rows


def report(rows: list[dict]) -> dict:
    """The file."""
    counts = {name: sum(line["set"] == name for line in rows) for name in ("reference", "random", "map")}
    grid = [line for line in rows if line["set"] == "map"]
    axes = {"L/chord": "slackness", "EA/wL": "stiffness"}
    reach = ", ".join(f"{axis} {min(line[key] for line in grid):.3g} to {max(line[key] for line in grid):.3g}"
                      for axis, key in axes.items())  # fmt: skip
    side = math.isqrt(len(grid))
    sets = {
        "reference": {"title": "reference table, every regime", "count": counts["reference"]},
        "random": {
            "title": "random lines, from everyday to extreme",
            "count": counts["random"],
            "seed": SEED,
        },
        "map": {
            "title": f"{side} x {side} lines between two fixed ends on a seabed: {reach}",
            "count": counts["map"],
        },
    }
    solvers = {name: {"label": one.label, "version": one.version} for name, one in harness.solvers().items()}
    return {"solvers": solvers, "sets": sets, "wrong_bound": WRONG, "excused_limits": harness.EXCUSED, "rows": rows}


def summary(file: dict) -> str:
    """One line for each set and solver."""
    lines = []
    for group in file["sets"]:
        for name, solver in file["solvers"].items():
            answers = [line["answers"][name] for line in file["rows"] if line["set"] == group]
            count = {verdict: sum(a["verdict"] == verdict for a in answers) for verdict in VERDICTS}
            errors = [a["error"] for a in answers if a["verdict"] in ("right", "wrong")]
            counts = ", ".join(f"{number} {verdict}" for verdict, number in count.items())
            middle = f"{np.median(errors):.2g}" if errors else "-"
            tiny = sum(a["verdict"] == "wrong" and (a["in_weights"] or 1) < TINY for a in answers)
            counts += f" ({tiny} of the wrong by less than {TINY:g} of the line's weight)" if tiny else ""
            lines.append(f"{group:10} {solver['label']:14} {counts}; median error {middle}")
    return "\n".join(lines)


TINY = 1e-5
"""Part of the line's weight: MoorPy drops a fairlead this little above the seabed, in units of L, on purpose."""

VERDICTS = ("right", "wrong", "refused", "unsupported")


def main(argv=None) -> int:
    """Command line."""
    parser = console.parser("accuracy", __doc__)
    parser.add_argument("--random", type=console.whole_number(0, "a number of random lines"), default=1000, metavar="N")
    parser.add_argument("--coarse", action="store_true", help="every second line of the map each way")
    console.add_jobs(parser)
    arguments = parser.parse_args(argv)
    harness.solvers()  # a peer that is installed but broken is named here, not by every process
    known = truth.TruthCache(arguments.out)
    file = report(measured(tasks(arguments.random, 2 if arguments.coarse else 1, known), known, arguments.jobs))
    results.write(arguments.out / "accuracy.json", file)
    print(summary(file))
    return 0


if __name__ == "__main__":
    console.run(main)
