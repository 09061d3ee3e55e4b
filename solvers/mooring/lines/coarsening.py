"""Lines on every second node: their layout, and what of nodes, loads and states belongs to them."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import make_interp_spline

from .layout import Layout, number_nodes

MIN_NODES = 4  # of a coarser segment


def coarsen(model, fine) -> Layout | None:
    """Return the Layout on every second node of each segment; None where one has too few."""
    if any(s.size + 1 < 2 * MIN_NODES for s in fine.s):
        return None
    return number_nodes(model, [s[_every_second(s)] for s in fine.s])


def common_nodes(coarse, fine) -> np.ndarray:
    """Return which nodes of a fine Layout those (N',) of its coarse one are."""
    common = np.empty(coarse.size, dtype=int)
    for coarse_nodes, s, nodes in zip(coarse.nodes, fine.s, fine.nodes, strict=True):
        common[coarse_nodes] = nodes[_every_second(s)]
    return common


def share_loads(coarse, fine) -> np.ndarray:
    """Return the part (N', N) of a load on a node of a fine Layout that each node of its coarse one takes."""
    share = np.zeros((coarse.size, fine.size))
    for coarse_s, coarse_nodes, s, nodes in zip(coarse.s, coarse.nodes, fine.s, fine.nodes, strict=True):
        share[np.ix_(coarse_nodes, nodes)] = [np.interp(s, coarse_s, unit) for unit in np.eye(coarse_s.size)]
    return share


def prolong(coarse, fine, z) -> np.ndarray:
    """Return (n, N, *S) on a fine Layout of z (n, N', *S) on its coarse one, by a cubic spline along each segment."""
    result = np.empty((z.shape[0], fine.size, *z.shape[2:]))
    for s, nodes, coarse_s, coarse_nodes in zip(fine.s, fine.nodes, coarse.s, coarse.nodes, strict=True):
        result[:, nodes] = make_interp_spline(coarse_s, z[:, coarse_nodes], axis=1)(s)
    return result


def _every_second(s) -> np.ndarray:
    return np.append(np.arange(s.size - 1)[::2], s.size - 1)
