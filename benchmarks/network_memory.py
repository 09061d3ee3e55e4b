"""Memory of one large solve, measured from outside numpy: run in a process of its own, prints one line of JSON.

The peak resident memory of the process before and after the solve: what it rises by holds everything, the factors of
the sparse matrices included, which no tracer of Python's memory sees.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
from pathlib import Path

from solvers import solve_network

from . import console
from .network_systems import FAMILIES

WARM_UP = 100  # elements: a solve that loads what the large one needs

STATUS = Path("/proc/self/status")  # of Linux; elsewhere memory is not measured


def peak() -> int:
    """Most bytes of resident memory that this process has held so far.

    Not from getrusage, whose figure starts at what the parent held when it started this process.
    """
    return 1024 * int(re.search(r"VmHWM:\s*(\d+) kB", STATUS.read_text())[1])


def measured(family: str, size: int) -> dict:
    """rise_MB: of the peak by the solve; process_MB: the peak after it."""
    solve_network(FAMILIES[family](WARM_UP))
    network = FAMILIES[family](size)
    before = peak()
    solve_network(network, throw=False)
    return {"rise_MB": (peak() - before) / 1e6, "process_MB": peak() / 1e6}


def in_its_own_process(family: str, size: int) -> dict | None:
    """``measured`` in a new process; None where the system does not tell the peak."""
    if not STATUS.exists():
        return None
    command = [sys.executable, "-m", "benchmarks.network_memory", family, str(size)]
    run = subprocess.run(command, cwd=Path(__file__).parents[1], capture_output=True, text=True, check=True)
    return json.loads(run.stdout)


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.network_memory", description=__doc__.splitlines()[0])
    parser.add_argument("family", choices=FAMILIES)
    parser.add_argument("size", type=console.whole_number(1, "a number of elements"))
    arguments = parser.parse_args()
    print(json.dumps(measured(arguments.family, arguments.size)))
    return 0


if __name__ == "__main__":
    console.run(main)
