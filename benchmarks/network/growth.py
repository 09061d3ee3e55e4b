"""Time and memory of solves without a start against the number of elements: chains, nets and trees.

The largest are solved once each in a process of its own (``python -m benchmarks.network.growth chain 10000`` prints the
row), where the peak of the resident memory is that of one solve: it holds everything, the factors of the sparse
matrices included, which no tracer of Python's memory sees.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import re
import subprocess
from functools import partial
from pathlib import Path

import numpy as np

from solvers import solve_network

from ..run import console, results
from .systems import FAMILIES, cpu_seconds

SIZES, QUICK_SIZES = (10, 30, 100, 300, 1000, 3000, 10000), (10, 30, 100, 300, 1000)
OWN_PROCESS = 10000  # elements: solves of this size are alone in a process
FITTED_FROM, FEWEST = 1000, 3
"""Elements from which the exponent is fitted, since below a solve is mostly overhead that does not grow, and the fewest
sizes that it is fitted to: none in the quick run."""

AGAIN, LONG = 2, 1.0  # times that a solve is repeated, unless it lasts longer, s
WARM_UP = 100  # elements: a solve that loads what the large one needs

STATUS, CLEAR = Path("/proc/self/status"), Path("/proc/self/clear_refs")
"""Of Linux; elsewhere memory is not measured."""


def tasks(quick: bool) -> list:
    """Calls, each giving rows of the part "growth"."""
    return [partial(rows, family, size) for family in FAMILIES for size in (QUICK_SIZES if quick else SIZES)]


def rows(family: str, size: int) -> list[dict]:
    """One network."""
    if size < OWN_PROCESS:
        return [solved(family, size, AGAIN) | {"memory_MB": None}]
    command = [*console.MODULE, "benchmarks.network.growth", family, str(size)]
    run = subprocess.run(command, env=console.child_environment(), capture_output=True, text=True, check=True)
    return [json.loads(run.stdout)]


def solved(family: str, size: int, again: int = 0) -> dict:
    """A network and the least time of its solves."""
    network = FAMILIES[family](size)
    seconds, states = [], []
    while len(seconds) <= again and max(seconds, default=0.0) < LONG:
        seconds.append(cpu_seconds(lambda: states.append(solve_network(network, throw=False))))
    return {
        "family": family,
        "elements": len(network.elements),
        "seconds": min(seconds),
        "iterations": states[0].iterations,
        "residual_norm": states[0].residual_norm,
        "status": states[0].status.name,
    }


def whole(rows: list[dict]) -> dict:
    """The part "growth" of the file: rows, and by family the exponent p of seconds = C elements^p, None if unknown."""
    exponents = {family: exponent(rows, family) for family in FAMILIES}
    return {"rows": rows, "fitted_from": FITTED_FROM, "exponents": exponents}


def exponent(rows, family: str) -> float | None:
    """Least squares in logarithms, over the solved networks of at least FITTED_FROM elements."""
    solved_rows = [row for row in rows if row["family"] == family and row["status"] == "SUCCESS"]
    large = [(row["elements"], row["seconds"]) for row in solved_rows if row["elements"] >= FITTED_FROM]
    return float(np.polyfit(*np.log(large).T, 1)[0]) if len(large) >= FEWEST else None


# ---------------------------------------------------------------- one large solve, alone in its process
def peak_MB() -> float | None:
    """Most resident memory that this process has held; None where the system does not tell.

    Not from getrusage, whose figure starts at what the parent held when it started this process.
    """
    return int(re.search(r"VmHWM:\s*(\d+) kB", STATUS.read_text())[1]) * 1024e-6 if STATUS.exists() else None


def alone(family: str, size: int) -> dict:
    """The row of one network, with the memory that its construction and solve need beyond what was held before."""
    solve_network(FAMILIES[family](WARM_UP))
    with contextlib.suppress(OSError):
        CLEAR.write_text("5")  # the peak starts again from what is held now
    before = peak_MB()
    row = solved(family, size)
    return row | {"memory_MB": None if before is None else peak_MB() - before}


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.network.growth", description=__doc__.splitlines()[0])
    parser.add_argument("family", choices=FAMILIES)
    parser.add_argument("size", type=console.whole_number(1, "a number of elements"))
    arguments = parser.parse_args()
    print(json.dumps(results.plain(alone(arguments.family, arguments.size))))
    return 0


if __name__ == "__main__":
    console.run(main)
