"""Run every solver of a file on a few lines at rest, a network and a moving cable, before it goes into a report.

``python -m benchmarks.smoke my_code.py``; without a file: the installed peers. Exit status 2: a file brings no solver.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterator

from solvers import solve_periodic
from solvers.common.motion import Ramped
from verification.cases.spans import NAMED
from verification.reference import exact_span
from verification.registry import last_period_tension

from . import peers
from .cable import work_precision as dynamic_work
from .cable.cases import Reference, system
from .network import accuracy as network_accuracy
from .run import console, harness

LINES = ("oc3-floating", "oc3-friction-0", "oc3-friction-1", "polyester-taut")
NETWORK = "two lines, 59.1 N/m"
CABLE = "case_1"


def spans(adapter: peers.Adapter) -> Iterator[str]:
    """A sentence for each of LINES."""
    solver = harness.solvers()[adapter.name]
    for case in NAMED:
        if case.name in LINES:
            row = harness.assess(solver, case, exact_span(case))
            yield _row(f"line {case.name}", row["verdict"], row["error"], row["message"])


def networks(adapter: peers.Adapter) -> Iterator[str]:
    """A sentence for NETWORK."""
    method = next(method for method in network_accuracy.peer_methods() if method.name == adapter.name)
    (row,) = network_accuracy.ladder(NETWORK, method, (None,))
    yield _row(f"network {NETWORK}", row["verdict"], row["error"], row["message"])


def cables(adapter: peers.Adapter) -> Iterator[str]:
    """A sentence for each setting on CABLE, against harmonic balance; errors over the range of the tension."""
    chain = system(CABLE)
    reference = Reference(chain.period, last_period_tension(solve_periodic(chain, harmonics=15)), 0.0)
    ramped = Ramped(chain.scene.motion, chain.period / 2)
    for setting in adapter.settings[:2]:
        answer = dynamic_work.ask(adapter, chain.scene, ramped, chain.period, setting)
        error = None if answer.kind else dynamic_work.errors(reference, answer)["rms"]
        yield _row(
            f"cable {CABLE}, {setting[0]} cells, {setting[1]} steps", answer.kind or "rms", error, answer.message
        )


def _row(case: str, verdict: str, error, message: str) -> str:
    return f"{case}: {verdict}, {message}" if message else f"{case}: {verdict}, error {error:.2g}"


PARTS = {"span": spans, "network": networks, "cable": cables}


def main(argv=None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.smoke", description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="*", metavar="FILE.py", help="Python files with Adapter or Program classes")
    parser.add_argument("--list", action="store_true", help="say what there is and try nothing")
    arguments = parser.parse_args(argv)
    if arguments.files:
        os.environ[peers.BROUGHT] = os.pathsep.join(arguments.files)
    try:
        solvers = peers.adapters()
    except ImportError as error:
        print(error, file=sys.stderr)
        return 2
    mine = [one for one in solvers.values() if not arguments.files or type(one).__module__.startswith("brought_")]
    for adapter in mine:
        solved = [problem for problem in PARTS if adapter.solves(problem)]
        title = " ".join(filter(None, (adapter.label, adapter.version, f"({adapter.name})")))
        print(f"{title} solves {', '.join(solved)}")
        for problem in () if arguments.list else solved:
            print(*(f"  {line}" for line in PARTS[problem](adapter)), sep="\n", flush=True)
    if not mine:
        print("no other code is installed; the README says how to bring one")
    return 0


if __name__ == "__main__":
    console.run(main)
