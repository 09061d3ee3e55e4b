"""Arrays of prescribed motions: times, rows of displacements in m, values of functions, directions."""

from __future__ import annotations

import numpy as np

from ..outcome import InputError
from ..validation import as_array

_SAME_DIRECTION = 1e-12  # share of the largest extent below which an extent is rounding: 1e4 eps


def as_times(t) -> np.ndarray:
    """Return t as an array of one axis at most."""
    t = np.asarray(t)
    if t.ndim > 1:
        raise InputError(f"shape {t.shape} must be () or (S,) (s)", field="t", value=t, unit="s")
    return t


def read_only_array(name, values, unit) -> np.ndarray:
    """Return a read-only float copy of an array of real numbers."""
    try:
        array = as_array(values)
    except ValueError:
        problem = f"rows of different lengths, or masked elements, must be real numbers ({unit}) of one shape"
        raise InputError(problem, field=name, value=values, unit=unit) from None
    if array.dtype.kind not in "iuf":
        problem = f"values of type {array.dtype} must be real numbers ({unit})"
        raise InputError(problem, field=name, value=values, unit=unit)
    array = array.astype(float)
    array.flags.writeable = False
    return array


def check_finite(name, array, unit):
    """Raise InputError naming the first entry that is not finite."""
    if not np.isfinite(array).all():
        at = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        field = f"{name}[{', '.join(map(str, at))}]"
        raise InputError(f"{array[at]} {unit} must be finite", field=field, value=float(array[at]), unit=unit)


def motion_rows(name, values, least) -> np.ndarray:
    """Return a read-only array (n, 3) of finite numbers in m, n >= least."""
    array = read_only_array(name, values, "m")
    if array.ndim != 2 or array.shape[1] != 3 or len(array) < least:
        problem = f"shape {array.shape} must be (n, 3), n >= {least} rows [x, y, z] (m)"
        raise InputError(problem, field=name, value=values, unit="m")
    check_finite(name, array, "m")
    return array


def spanning_vectors(rows) -> np.ndarray:
    """Return orthonormal vectors (k, 3), k = 0..3, that span the rows (n, 3)."""
    _, extent, axes = np.linalg.svd(rows, full_matrices=False)
    return axes[extent > _SAME_DIRECTION * max(extent[0], np.finfo(float).tiny)]


def evaluate_function(name, function, t, unit) -> np.ndarray:
    """Return function at each t, (3, *S); raises InputError naming the time where it is not three finite numbers."""
    t = as_times(t)
    values = [np.asarray(function(one)) for one in t.ravel().tolist()]
    for one, value in zip(t.ravel(), values, strict=True):
        if value.shape != (3,) or not np.isfinite(value).all():
            problem = f"{value!r} at {one:g} s must be three finite components [x, y, z] ({unit})"
            raise InputError(problem, field=name, value=value, unit=unit)
    return np.stack(values, axis=-1).reshape(3, *t.shape) if values else np.empty((3, 0))
