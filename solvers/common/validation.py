"""Validators of inputs: each returns the value as solvers take it, or raises InputError with field, value and unit."""

from __future__ import annotations

import math
from numbers import Complex, Real

import numpy as np

from .outcome import InputError


def real_number(name: str, value, unit: str) -> float:
    """Return ``value`` as a finite float; raises InputError naming the field, the value and its unit."""
    if type(value) is float and math.isfinite(value):  # at nearly every call
        return value
    if isinstance(value, np.ndarray) and value.ndim == 0 and not np.ma.is_masked(value):
        value = value.item()
    if isinstance(value, bool) or not isinstance(value, Real):
        article = "one" if isinstance(value, (list, tuple, np.ndarray)) else "a"
        problem = f"{value!r} must be {article} real number ({unit.strip('()')})"
        raise InputError(problem, field=name, value=value, unit=unit)
    try:
        number = float(value)
    except OverflowError:
        raise InputError(f"{value!r} {unit} must be finite", field=name, value=value, unit=unit) from None
    if not math.isfinite(number):
        raise InputError(f"{number} {unit} must be finite", field=name, value=number, unit=unit)
    return number


def positive_number(name: str, value, unit: str) -> float:
    """Return ``value`` as a finite float > 0."""
    value = real_number(name, value, unit)
    if value <= 0:
        raise InputError(f"{value:g} {unit} must be > 0", field=name, value=value, unit=unit)
    return value


def non_negative_number(name: str, value, unit: str) -> float:
    """Return ``value`` as a finite float >= 0."""
    value = real_number(name, value, unit)
    if value < 0:
        raise InputError(f"{value:g} {unit} must be >= 0", field=name, value=value, unit=unit)
    return value


def whole_number(name: str, value, least: int, most: int | None = None, unit: str | None = None) -> int:
    """Return ``value`` as an int of at least ``least`` and, if given, at most ``most``; no bool, no float."""
    is_whole = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    if not is_whole or value < least or (most is not None and value > most):
        limits = f">= {least}" if most is None else f"from {least} to {most}"
        raise InputError(f"{value!r} must be a whole number {limits}", field=name, value=value, unit=unit)
    return int(value)


def as_array(value) -> np.ndarray:
    """Return np.asarray; raises ValueError for rows of different lengths, and for masked elements, which become NaN."""
    if _is_masked(value):
        raise ValueError("masked elements")
    return np.asarray(value)


def _is_masked(value) -> bool:
    return value is np.ma.masked or (isinstance(value, (list, tuple)) and any(map(_is_masked, value)))


def real_array(value) -> np.ndarray:
    """Return a copy as floats; raises TypeError or ValueError where it is none.

    Also for complex numbers, of which numpy would drop the imaginary parts.
    """
    array = as_array(value)
    among = array.ravel().tolist() if array.dtype == object else ()
    if np.iscomplexobj(array) or any(isinstance(number, Complex) and not isinstance(number, Real) for number in among):
        raise TypeError("complex numbers")
    try:
        return np.array(value, dtype=float)
    except OverflowError as error:  # a whole number beyond 1e308
        raise ValueError(str(error)) from None


def array_of_reals(name: str, value, problem: str, unit: str | None = None) -> np.ndarray:
    """Return ``real_array``; raises InputError with the field, its problem and its unit where ``value`` is none."""
    try:
        return real_array(value)
    except (TypeError, ValueError):
        raise InputError(problem, field=name, value=value, unit=unit) from None


def instance_of(name: str, value, kind: type):
    """Raise InputError where ``value`` is not an object of a public class."""
    if not isinstance(value, kind):
        raise InputError(f"{value!r} is not a solvers.{kind.__name__}", field=name, value=value)


def one_of(name: str, value, choices):
    """Raise InputError naming the choices where ``value`` is none of them."""
    if not isinstance(value, (str, type(None))) or value not in choices:
        *most, last = map(repr, choices)
        raise InputError(f"{value!r} must be {', '.join(most)} or {last}", field=name, value=value)


def flags(**given):
    """Raise InputError naming the one of the keywords that is neither True nor False."""
    for name, value in given.items():
        if type(value) is not bool and not isinstance(value, np.bool_):
            raise InputError(f"{value!r} must be True or False", field=name, value=value)


def vector(name: str, value, unit: str, what: str = "components") -> tuple[float, float, float]:
    """Return three real numbers in x, y, z as finite floats; raises InputError naming the one that is not."""
    listed = isinstance(value, (list, tuple)) or (isinstance(value, np.ndarray) and value.ndim == 1)
    if not listed or len(value) != 3 or any(isinstance(part, (list, tuple, np.ndarray)) for part in value):
        raise InputError(f"{value!r} must be three {what} [x, y, z] ({unit})", field=name, value=value, unit=unit)
    x, y, z = (real_number(f"{name}[{i}]", v, unit) for i, v in enumerate(value))
    return x, y, z


def refuse_for_lines(*options):
    """Raise InputError for an option (name, value, default) that means nothing to a line of nodes and elements."""
    for name, value, default in options:
        if value is not default and value != default:
            problem = f"{value!r} has no meaning for a line of nodes and elements; leave it out"
            raise InputError(problem, field=name, value=value)
