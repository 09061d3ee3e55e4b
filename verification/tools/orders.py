"""Observed orders of accuracy and Richardson's extrapolation, for errors that fall like C h^p."""

from __future__ import annotations

import numpy as np

BAND = 0.05
"""Allowed distance of the observed order on the finest pair from the declared one, both ways."""


def observed_orders(steps, errors) -> np.ndarray:
    """log(e_i / e_i+1) / log(h_i / h_i+1) of successive pairs, (n - 1,); nan where an error is zero or changes sign.

    steps (n,) decreasing; errors (n,) signed, or norms.
    """
    h, e = np.asarray(steps, float), np.asarray(errors, float)
    if h.ndim != 1 or h.shape != e.shape or h.size < 2 or not (h[1:] < h[:-1]).all() or h[-1] <= 0:
        raise ValueError(f"two or more positive, decreasing steps with an error each, not {steps!r} and {errors!r}")
    with np.errstate(divide="ignore", invalid="ignore"):  # no order of a zero error: nan, as promised
        ratio = np.where(e[1:] != 0, e[:-1] / np.where(e[1:] != 0, e[1:], 1.0), np.nan)
        return np.log(np.where(ratio > 0, ratio, np.nan)) / np.log(h[:-1] / h[1:])


def differences(values) -> np.ndarray:
    """Successive differences (n - 1, ...) of values (n, ...): they fall as the errors do, and know no exact value."""
    values = np.asarray(values, float)
    return values[1:] - values[:-1]


def extrapolated(steps, values, order=2):
    """The limit h -> 0 that the two finest values and the order give, shape of a value."""
    r = (steps[-2] / steps[-1]) ** order
    return np.asarray(values[-1]) + (np.asarray(values[-1]) - np.asarray(values[-2])) / (r - 1)


def assert_order(steps, errors, order, *, ceiling, floor=0.0, band=BAND, what=""):
    """The order on the finest pair is the declared one, and the last error is below a ceiling.

    Errors at or below the floor (round-off) are dropped first; two must remain.
    """
    h, e = np.asarray(steps, float), np.asarray(errors, float)
    keep = ~(abs(e) <= floor)  # nan stays, and fails
    table = "\n".join(f"  h = {a:.6g}   error = {b:.6g}" for a, b in zip(h, e, strict=True))
    assert keep.sum() >= 2, f"{what}: fewer than two errors above the floor {floor:g}\n{table}"
    result = observed_orders(h[keep], e[keep])
    assert abs(result[-1] - order) <= band, f"{what}: orders {result}, wanted {order} +- {band:g}\n{table}"
    assert abs(e[-1]) <= ceiling, f"{what}: last error {e[-1]:.6g} above the ceiling {ceiling:g}\n{table}"
