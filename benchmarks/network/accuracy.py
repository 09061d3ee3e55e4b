"""Error against run time of the methods for networks, a sweep of tolerances: the part "work" of networks.json.

Every method starts from the node positions of the network and does without fallback; the error is that of the end
tensions, against 40 digits. Other codes that solve networks are asked at the same ladder, by their adapters.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from solvers import solve_network
from verification.reference import WRONG, exact_network, tension_error
from verification.registry import NETWORK_METHODS, NetworkMethod

from .. import peers
from ..run import harness
from .systems import WEIGHTS, cpu_seconds, scene, two_lines, without_friction

TOLERANCES, QUICK_TOLERANCES = (1e-1, 1e-3, 1e-5, 1e-7, 1e-9, 1e-11), (1e-1, 1e-5, 1e-9)
"""Relative: of the residual norm, and times the longest line for a peer; the smallest that doubles can carry there."""

REPEATS = 3
QUICK_FROM = 1  # the quick run leaves out the first system


@dataclass(frozen=True)
class Method:
    """name and label in figures; solve: this project's NetworkMethod, or None with the adapter of another code."""

    name: str
    label: str
    solve: NetworkMethod | None = None
    adapter: peers.Adapter | None = None

    def ladder(self, tolerances) -> tuple:
        """Return the tolerances that it is asked for: none but its own where it takes none."""
        return (None,) if self.adapter and not self.adapter.tolerances else tolerances


METHODS = tuple(
    Method(method.name, method.label, method)
    for method in NETWORK_METHODS
    if method.name != "monolithic-differences-trust-region"  # Table 2 has it; a curve of its own shows nothing more
)


def peer_methods() -> list[Method]:
    """Return the other codes that solve networks."""
    return [Method(name, one.label, adapter=one) for name, one in peers.solving("network").items()]


def systems() -> dict:
    """Title -> network, on a smooth seabed."""
    lines = {f"two lines, {w} N/m": two_lines(w) for w in WEIGHTS}
    return lines | {"three lines with bridles": without_friction(scene("three_bridles"))}


def tasks(quick: bool) -> list:
    """Calls, each giving rows of the part "work": one system and method."""
    methods = [*METHODS, *peer_methods()]
    tolerances = QUICK_TOLERANCES if quick else TOLERANCES
    titles = list(systems())[QUICK_FROM if quick else 0 :]
    return [partial(ladder, title, method, tolerances) for title in titles for method in methods]


@cache
def truth(title: str):
    """40 digits, and the network."""
    network = systems()[title]
    return exact_network(network, solve_network(network).r), network


def ladder(title: str, method: Method, tolerances) -> list[dict]:
    """Points of one method; a tolerance that does not change the answer is not timed again."""
    exact, network = truth(title)
    points, before = [], {"error": None}
    for tolerance in method.ladder(tolerances):
        tension, verdict, message, clock, work = (theirs if method.adapter else ours)(network, method, tolerance)
        error = None if tension is None else tension_error(tension, exact)
        same = error is not None and error == before["error"]
        with harness.quiet():
            seconds = None if error is None else before["seconds"] if same else min(clock() for _ in range(REPEATS))
        verdict = verdict or ("wrong" if error > WRONG else "right")
        before = {"solver": method.name, "label": method.label, "case": title, "tolerance": tolerance}
        if method.adapter:
            before["code"] = f"{method.label} {method.adapter.version}".strip()
        before |= {"verdict": verdict, "message": message[:200], "error": error, "seconds": seconds} | work
        points.append(before)
        if message.startswith(harness.OVERTIME):
            break
    return points


def ours(network, method: Method, tolerance: float) -> tuple:
    """Return what a method gives and costs.

    End tensions (e, 2) in N or None; "refused" where it did not converge; message; call that times one solve, s; the
    counts of its work.
    """

    def solve():
        return method.solve(network, tolerance=tolerance, start="nodes", fallback=False, throw=False)

    with harness.quiet():
        state = solve()
    tension = np.column_stack([np.hypot(state.H_anchor, state.V_anchor), np.hypot(state.H, state.V)])
    clock = partial(cpu_seconds, solve)
    work = count_work(state, method.solve.options.get("method") == "nested")
    return (tension, "", "", clock, work) if state.success else (None, "refused", state.status.value, clock, work)


def count_work(state, is_nested: bool) -> dict:
    """Return lines, iterations, residual evaluations, and evaluations of the catenary of a line.

    Each residual of the monolithic methods evaluates every line once; nested ones solve the lines inside each residual.
    Those of the start are told with either.
    """
    lines = len(state.H)
    evaluations = state.inner_iterations + (0 if is_nested else lines * state.function_evaluations)
    return {"lines": lines, "iterations": state.iterations, "evaluations": state.function_evaluations,
            "catenary_evaluations": evaluations}  # fmt: skip


def theirs(network, method: Method, tolerance) -> tuple:
    """The same of another code, "unsupported" too; a program is timed by the wall clock, as a child of this process."""
    clock = time.perf_counter if isinstance(method.adapter, peers.Program) else time.process_time

    def once() -> tuple:
        start = clock()
        answer = method.adapter.network(network, tolerance)
        if callable(answer):
            start, answer = clock(), answer()
        return clock() - start, answer

    def asked() -> tuple:
        limit = method.adapter.limit("network")
        answer, kind, message = harness.attempt(once, limit, f"{method.name}, networks")
        return answer or (None, None), kind, message

    (_, tension), kind, message = asked()
    if not kind:
        tension, kind, message = harness.checked(tension, (len(network.elements), 2))
    work = {"lines": len(network.elements), "iterations": None, "evaluations": None, "catenary_evaluations": None}
    return tension, kind, message, lambda: asked()[0][0] or np.inf, work
