"""What a stability map is: two axes pushed to where a solver breaks, and a verdict at every point.

Verdicts: solved (a success whose claims hold), warned (a success that warns of its error itself), refused (InputError
before any work), not converged (a status that says so, or ConvergenceError), invalid (a status that says that no
cable is like this: in compression, or stretched beyond breaking), too coarse (a success that keeps its claims, where
a finer run has no answer or is invalid, or whose error is beyond the bound of its map), wrong (a success that does not
keep its own claims), crashed (any other exception, a floating-point error or a warning among them).
"""

from __future__ import annotations

import hashlib
import math
import time
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from importlib.resources import files
from pathlib import Path

import numpy as np

from solvers import ConvergenceError, InputError, Status

INVALID = (Status.COMPRESSION, Status.OVERSTRETCHED)
BOUNDS = {"statics": 0.1, "time domain": 0.1, "harmonic balance": 0.02}
"""Solver -> largest error of an answer that counts as solved: of the moving cable in time and of its rest on a mesh
the tenth beyond which answers of other codes are called wrong, of harmonic balance what its claim says. Of lines and
networks the claim bounds the error already."""

VERDICTS = ("solved", "warned", "refused", "not converged", "invalid", "too coarse", "wrong", "crashed")
ROOT = Path(str(files("benchmarks"))).parent


@dataclass(frozen=True)
class Axis:
    """label with its unit, and the values that a map takes."""

    label: str
    values: tuple

    def thinned(self, step: int) -> Axis:
        """Every ``step``-th value, and the last."""
        kept = self.values[::step]
        return Axis(self.label, kept if kept[-1] == self.values[-1] else (*kept, self.values[-1]))


@dataclass(frozen=True)
class Found:
    """What a solver made of a point: its status, the error that the map draws, and the claims that do not hold.

    finer : status of the finer run that was to give the error, where that is no success
    warned : the warnings of the result itself
    """

    status: Status
    error: float = math.nan
    lost: Sequence[str] = ()
    finer: Status | None = None
    warned: Sequence[str] = ()
    values: dict = field(default_factory=dict)


@dataclass(frozen=True)
class Map:
    """solve(x, y) -> Found; title, what the error is (quantity) and what a success claims, as sentences.

    explained : why there are points without an answer, said where there are any
    brief : values of x and of y in the quick run, every third where not given
    skip(x, y) : points left out, left_out why; nodes : of the mesh, where the map has one
    """

    name: str
    solver: str
    title: str
    x: Axis
    y: Axis
    quantity: str
    claim: str
    solve: Callable
    explained: str = ""
    brief: tuple = ()
    skip: Callable = lambda x, y: False
    left_out: str = ""
    nodes: int | None = None

    def quick(self) -> Map:
        """The same on fewer points."""
        x, y = self.x.thinned(3), self.y.thinned(3)
        if self.brief:
            x, y = (Axis(axis.label, values) for axis, values in zip((x, y), self.brief, strict=True))
        return replace(self, x=x, y=y)

    def places(self, j: int) -> list[int]:
        """Indices of x in row j that are not left out."""
        return [i for i, x in enumerate(self.x.values) if not self.skip(x, self.y.values[j])]

    def row(self, j: int) -> list[dict]:
        """The points of row j."""
        y = self.y.values[j]
        rows = [{"x": i, "y": j} | judged(self.solve, self.x.values[i], y) for i in self.places(j)]
        return [within(row, self.bound) for row in rows]

    @property
    def bound(self) -> float | None:
        """Largest error of an answer that counts as solved; None where the claim alone bounds it."""
        return BOUNDS.get(self.solver)

    def entry(self, points: list[dict]) -> dict:
        """The map in the result file."""
        words = ("name", "solver", "title", "quantity", "claim", "explained", "left_out", "nodes", "bound")
        counts = {verdict: sum(point["verdict"] == verdict for point in points) for verdict in VERDICTS}
        axes = {key: {"label": axis.label, "values": list(axis.values)} for key, axis in (("x", self.x), ("y", self.y))}
        return {word: getattr(self, word) for word in words} | axes | {"counts": counts, "points": points}


def within(row: dict, bound: float | None) -> dict:
    """Return a point, called too coarse instead of solved where its error is beyond the bound of its map."""
    if row["verdict"] != "solved" or bound is None or row["error"] <= bound:
        return row
    message = f"error {row['error']:.3g} above {bound:g}"
    return row | {"verdict": "too coarse", "message": message}


def judged(solve, *at) -> dict:
    """Verdict, status, error and message of solve(*at), with floating-point errors and warnings raised."""
    start = time.process_time()
    try:
        with warnings.catch_warnings(), np.errstate(divide="raise", over="raise", invalid="raise"):
            warnings.simplefilter("error")
            outcome = solve(*at)
    except InputError as error:
        row = {"verdict": "refused", "status": "InputError", "message": str(error)}
    except ConvergenceError as error:
        row = {"verdict": "not converged", "status": "ConvergenceError", "message": str(error)}
    except Exception as error:
        row = {"verdict": "crashed", "status": type(error).__name__, "message": str(error)}
    else:
        message = "; ".join([*outcome.lost, *outcome.warned])
        row = {"verdict": _verdict(outcome), "status": outcome.status.name, "message": message}
        row |= {"error": outcome.error} | ({"finer": outcome.finer.name} if outcome.finer else {}) | outcome.values
    return row | {"seconds": time.process_time() - start}


def _verdict(outcome: Found) -> str:
    if outcome.status is Status.SUCCESS:
        unknown = outcome.finer is None and math.isnan(outcome.error)
        if outcome.lost or unknown:
            return "wrong"
        return "warned" if outcome.warned else "too coarse" if outcome.finer else "solved"
    return "invalid" if outcome.status in INVALID else "not converged"


@cache
def sources() -> str:
    """Digest of what the maps are made with: solvers, the oracles, these programs."""
    folders = ("solvers", "verification/exact", "benchmarks/stability")
    files = [path for folder in folders for path in (ROOT / folder).rglob("*.py")]
    digest = hashlib.sha256()
    for path in sorted(files):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
