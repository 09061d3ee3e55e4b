"""The networks that are measured: the paper's two lines, families of any size, scene files; and the clock."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from importlib.resources import files

import numpy as np

from solvers import Element, Environment, Network, Node
from solvers.io.network_scene import load_network

SCENES = files("reference_data") / "scenes" / "networks"

WEIGHTS = (59.1, 226.61)
"""N/m: the one that reproduces the paper's solution, and the one that it prints (see the errata of MSQS)."""

JOINT_GUESS = (-26.0, 0.0, -65.0)  # m, (5.2)


def two_lines(w: float) -> Network:
    """MSQS Fig. 12: w in N/m."""
    joint = Node("free", JOINT_GUESS, force=(0.0, 0.0, 637650.0))
    nodes = (Node("fixed", (-1200.0, 0.0, -350.0)), Node("fixed", (0.0, 0.0, -350.0)), joint)
    lines = (Element(w, 2.34e8, 1175.0, (0, 2)), Element(w, 2.34e8, 300.0, (1, 2)))
    return Network(nodes, lines, Environment(depth=350.0))


def chain(n: int) -> Network:
    """n elements from a fixed to a coupled node, 1000 m over 800 m, hanging free."""
    x = np.linspace(0.0, 800.0, n + 1)
    kinds = ["fixed", *["free"] * (n - 1), "coupled"]
    nodes = [Node(kind, (xi, 0.0, 0.0)) for kind, xi in zip(kinds, x.tolist(), strict=True)]
    return Network(nodes, [Element(100.0, 1e8, 1000.0 / n, (i, i + 1)) for i in range(n)])


def net(n: int) -> Network:
    """A square net of about n elements, 100 m wide, its lines 5 % longer than flat, held at its four edges."""
    k = max(3, round((1 + (1 + 2 * n) ** 0.5) / 2))  # 2 k (k - 1) = n
    x = np.linspace(0.0, 100.0, k)
    inside = range(1, k - 1)
    nodes = [
        Node("free" if i in inside and j in inside else "fixed", (x[i], x[j], 0.0)) for i in range(k) for j in range(k)
    ]
    pairs = [(i * k + j, (i + 1) * k + j) for i in range(k - 1) for j in range(k)]
    pairs += [(i * k + j, i * k + j + 1) for i in range(k) for j in range(k - 1)]
    return Network(nodes, [Element(20.0, 1e6, 1.05 * 100.0 / (k - 1), pair) for pair in pairs])


def tree(n: int) -> Network:
    """A binary tree of about n elements under a coupled node: level by level 20 m lower, its leaves anchored."""
    levels = max(2, round(np.log2(n + 2) - 1))
    nodes, lines, parents = [Node("coupled", (0.0, 0.0, 0.0))], [], [(0, 0.0, 0.0)]
    for level in range(1, levels + 1):
        reach, children = 200.0 * 0.7**level, []
        for parent, px, py in parents:
            for side in (-1.0, 1.0):
                x, y = (px + side * reach, py) if level % 2 else (px, py + side * reach)
                lines.append(Element(50.0, 1e7, 1.02 * float(np.hypot(reach, 20.0)), (len(nodes), parent)))
                children.append((len(nodes), x, y))
                nodes.append(Node("fixed" if level == levels else "free", (x, y, -20.0 * level)))
        parents = children
    return Network(nodes, lines)


FAMILIES = {"chain": chain, "net": net, "tree": tree}


def scene(name: str) -> Network:
    """A network file of reference_data/scenes/networks."""
    return load_network(SCENES / f"{name}.toml")


def without_friction(network: Network) -> Network:
    """The same network on a smooth seabed, as MoorPy has it: it loses seabed friction at system level."""
    return replace(network, elements=tuple(replace(element, friction=0.0) for element in network.elements))


def cpu_seconds(call: Callable[[], object]) -> float:
    """CPU time of one call: what else the machine does is not counted, and all solvers here run in one thread."""
    start = time.process_time()
    call()
    return time.process_time() - start
