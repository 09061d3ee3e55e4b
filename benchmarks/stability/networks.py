"""Stability maps of networks: stiffness contrast by size, against forces found another way.

A chain of lines is one line with a piecewise stiffness, so two unknown forces at its end tell all of it: the oracle of
a chain walks from line to line with the closed form (2.4) in 30 digits. Of a net the claims are checked: the balance of
its nodes from the forces returned, and each line's closed form between the places returned.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import numpy as np
from mpmath import mp, mpf

from solvers import Network, Status, solve_network

from ..network.systems import chain, net
from .maps import Axis, Found, Map

BALANCE = 2e-9
"""Largest unbalanced force over the largest force: the tolerance 1e-9 of the solver, summed in another order."""
CLOSURE = 1e-9
"""By how much the closed form misses the places of the ends, over the length of the line and the network's size."""
TENSION = 1e-6
"""Largest error of an end tension over the largest one: the balance 1e-9 lost once more in three digits."""

CONTRAST = Axis("stiffest over softest line", tuple((10.0 ** np.arange(7)).tolist()))
DIGITS = 30


def alternating(network: Network, contrast: float) -> Network:
    """Every second line softer by the contrast; the others as they are."""
    lines = (replace(line, EA=line.EA / contrast if i % 2 else line.EA) for i, line in enumerate(network.elements))
    return replace(network, elements=tuple(lines))


def maps() -> list[Map]:
    """Chains and nets."""
    text = f"nodes in balance to {BALANCE:g} of the largest force, lines closed to {CLOSURE:g}"
    return [
        Map("networks_chain", "network", "Chain: stiffness contrast by lines", CONTRAST,
            Axis("lines", (2, 3, 10, 30, 100, 300)), "error of the end tensions over the largest",
            f"{text}, tensions within {TENSION:g} of 30 digits", partial(_solve, chain, _chain_error),
            brief=((1.0, 1e3, 1e6), (2, 10, 30))),
        Map("networks_net", "network", "Net: stiffness contrast by lines", CONTRAST,
            Axis("lines", (12, 40, 100, 220)), "unbalanced force over the largest", text,
            partial(_solve, net, None),
            brief=((1.0, 1e3, 1e6), (12, 40))),
        Map("networks_slack", "network", "Chain of ten: stiffness contrast by slackness", CONTRAST,
            Axis("L / chord", (0.5, 0.9, 0.999, 1.0, 1.001, 1.1, 2.0)), "error of the end tensions over the largest",
            f"{text}, tensions within {TENSION:g} of 30 digits", partial(_solve, sagging, _chain_error)),
    ]  # fmt: skip


def sagging(slackness: float) -> Network:
    """The chain of ten lines, its length the given share of its chord."""
    network = chain(10)
    reach = math.dist(network.nodes[0].r, network.nodes[-1].r)
    share = slackness * reach / sum(line.L for line in network.elements)
    return replace(network, elements=tuple(replace(line, L=share * line.L) for line in network.elements))


def _solve(family, truth, contrast, size) -> Found:
    network = alternating(family(size), contrast)
    state = solve_network(network, throw=False)
    if state.status is not Status.SUCCESS:
        return Found(state.status)
    balance, closure = unbalanced(network, state), closed(network, state)
    lost = [f"{name} {value:.3g}" for name, value, bound in (
        ("balance", balance, BALANCE), ("closure", closure, CLOSURE)) if not value <= bound]  # fmt: skip
    error = balance if truth is None else truth(network, state)
    if truth is not None and not error <= TENSION:
        lost.append(f"tensions {error:.3g}")
    return Found(state.status, error, lost, values={"balance": balance, "closure": closure})


def unbalanced(network, state) -> float:
    """Largest force that the returned forces of the lines leave on a free node, over the largest force."""
    left = np.array([node.force for node in network.nodes])
    for line, H, V, H_a, V_a in zip(network.elements, state.H, state.V, state.H_anchor, state.V_anchor, strict=True):
        (a, f), across = line.ends, state.r[line.ends[1], :2] - state.r[line.ends[0], :2]
        along = across / np.linalg.norm(across)
        left[f] -= [*(H * along), V]
        left[a] += [*(H_a * along), V_a]
    free = [node.kind == "free" for node in network.nodes]
    return float(abs(left[free]).max() / np.hypot(state.H, state.V).max())


def closed(network, state) -> float:
    """Largest distance between the end of a line by its forces and by its nodes, over line and network."""
    size, worst = np.ptp(state.r, axis=0).max(), 0.0
    for line, H, V in zip(network.elements, state.H.tolist(), state.V.tolist(), strict=True):
        reach = state.r[line.ends[1]] - state.r[line.ends[0]]
        with mp.workdps(DIGITS):
            x, z = _extent(mpf(H), mpf(V), line)
            miss = mp.hypot(x - mp.hypot(*map(mpf, reach[:2])), z - mpf(reach[2])) / (line.L + size)
        worst = max(worst, float(miss))
    return worst


def _extent(H, V, line):
    """(2.4a, b): extents of a hanging line from its fairlead force."""
    w, L, EA = map(mpf, (line.w, line.L, line.EA))
    low = V - w * L
    x = H / w * (mp.asinh(V / H) - mp.asinh(low / H)) + H * L / EA
    return x, (mp.hypot(H, V) - mp.hypot(H, low)) / w + L / EA * (V - w * L / 2)


def _chain_error(network, state) -> float:
    """Error of the tensions of a chain in a plane; Newton's method on the force at its last end, by differences."""
    lines, reach = network.elements, np.subtract(network.nodes[-1].r, network.nodes[0].r)
    goal = mp.matrix([math.hypot(*reach[:2]), reach[2]])

    def end(H, V):
        total = mp.matrix([0, 0])
        for line in reversed(lines):
            total += mp.matrix(_extent(H, V, line))
            V -= mpf(line.w) * line.L
        return total - goal

    with mp.workdps(DIGITS):
        force = mp.matrix([mpf(float(state.H[-1])), mpf(float(state.V[-1]))])
        for _ in range(8):
            miss, step = end(*force), force[0] * mpf(10) ** (-DIGITS // 2)
            columns = [(end(force[0] + step, force[1]) - miss) / step, (end(force[0], force[1] + step) - miss) / step]
            change = mp.lu_solve(mp.matrix([[columns[0][i], columns[1][i]] for i in (0, 1)]), miss)
            force -= change
            if mp.norm(change) <= mp.norm(force) * mpf(10) ** (-DIGITS + 8):
                break
        else:
            return math.nan
        H, V, exact = force[0], force[1], []
        for line in reversed(lines):
            exact.append(float(mp.hypot(H, V)))
            V -= mpf(line.w) * line.L
    return float(abs(np.hypot(state.H, state.V)[::-1] - exact).max() / max(exact))
