"""Error of a response by the harmonics that it leaves out, and how many it needs.

The coefficients of a response solve the rows of the harmonics that it has. One Newton step on the rows of a third more
harmonics, sampled as densely for their number, tells what these would change: the coefficients left out, and what they
do to the others.
"""

from __future__ import annotations

import numpy as np

MORE = 3  # a third more harmonics, and two at least: of a symmetric response every second one is zero
LEAST_MORE = 2
SPARE = 0.1  # of the accuracy: harmonics whose coefficients are together below it are left out of the next point


def more_harmonics(harmonics) -> int:
    """Return the next larger number of harmonics."""
    return harmonics + max(LEAST_MORE, -(-harmonics // MORE))


def estimate_error(tracer, point) -> float:
    """Return the change of a point that more harmonics make: norm over the largest norm so far, of the worst field.

    The parameter counts as a field, its change over its range. Raises CorrectionError where the Jacobian is singular.
    """
    finer = tracer.with_harmonics(more_harmonics(tracer.family.settings[0]))
    point = finer.resized(point)
    F, solve = finer.linearise(point.x, point.value, *finer.plane(point.t, point.u))
    dx, dp = solve(F, 0.0)
    changes = np.sqrt((finer.unpack(dx) ** 2).sum(axis=(1, 2), keepdims=True))
    sizes = np.where(finer.norms > 0, finer.norms, np.inf)
    return max(float((changes / sizes).max()), abs(dp) / finer.span)


def needed_harmonics(z, norms, accuracy) -> int:
    """Return the harmonics beyond which coefficients z (n_f, N, C) are below a share of the accuracy."""
    Nh, sizes = z.shape[-1] // 2, np.where(norms > 0, norms, np.inf)
    powers = ((z / sizes)[..., 1:] ** 2).reshape(*z.shape[:2], Nh, 2).sum(axis=(1, 3)).max(axis=0)  # (Nh,)
    beyond = np.sqrt(np.cumsum(powers[::-1])[::-1])  # [k]: of harmonics k + 1 and higher
    small = np.flatnonzero(beyond <= SPARE * accuracy)
    return max(1, int(small[0])) if small.size else Nh
