"""The process in which a solver runs: it reads requests and writes answers, one JSON object a line.

What the solver prints, or reads, is kept apart from that; where it hangs or crashes, session.py starts another.
"""

from __future__ import annotations

import json
import os
import sys
import time

from ..adapter import LIMITS, Refused
from ..answers import ask
from .loading import load_solver
from .program import Program

SHOWN = 300
"""Characters of what a solver says, in a verdict."""


def main(name: str):
    """Load the solver, say what it is, and answer until there are no more requests."""
    requests, answers = _own_pipes()
    try:
        adapter = load_solver(name)
        hello = {
            "label": adapter.label,
            "version": str(adapter.version),
            "is_program": isinstance(adapter, Program),
            "is_command": type(adapter) is Program,
            "limits": {problem: adapter.limit(problem) for problem in LIMITS if adapter.solves(problem)},
        }
    except Exception as error:
        hello = {"error": f"{error}" if isinstance(error, ImportError) else f"{type(error).__name__}: {error}"}
    _write(answers, hello)
    if "error" in hello:
        return
    for line in requests:
        request = json.loads(line)
        _write(answers, _answer(adapter, request["problem"], request["inputs"]))


def _answer(adapter, problem: str, inputs: dict) -> dict:
    """Return the quantities, or what was refused and why, with the seconds that it took."""
    begin = time.perf_counter()
    try:
        reply = {"answer": ask(adapter, problem, inputs)}
    except NotImplementedError as error:
        reply = {"not modelled": _words(error) or "it does not model this case"}
    except Refused as error:
        reply = {"refused": _words(error) or "it gave no reason"}
    except (Exception, SystemExit, KeyboardInterrupt) as error:  # whatever it raises is its way of refusing
        reply = {"refused": f"{type(error).__name__}: {_words(error)}"}
    return reply | {"seconds": time.perf_counter() - begin}


def _words(error) -> str:
    return " ".join(str(error).split())[:SHOWN]


def _write(pipe, reply: dict):
    pipe.write(json.dumps(reply) + "\n")
    pipe.flush()


def _own_pipes():
    """Return the pipes to the parent; standard input is at its end and standard output is nowhere, for the solver."""
    pipes = os.fdopen(os.dup(0), encoding="utf-8"), os.fdopen(os.dup(1), "w", encoding="utf-8")
    nowhere = os.open(os.devnull, os.O_RDWR)
    os.dup2(nowhere, 0)
    os.dup2(nowhere, 1)
    sys.stdin = open(os.devnull, encoding="utf-8")  # noqa: SIM115 (for as long as the process runs)
    return pipes
