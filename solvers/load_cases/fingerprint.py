"""Digests of inputs, by which a resumed table knows the rows that it has."""

from __future__ import annotations

import hashlib
import pkgutil
import sys
from dataclasses import fields, is_dataclass
from functools import cache

import numpy as np

from ..common.outcome import InputError


def fingerprint(*values) -> str:
    """Return a digest of values: numbers, texts, arrays, lists, tables and dataclasses of these, and of the solvers.

    Raises InputError for what has no content to read, such as a function.
    """
    digest = hashlib.sha256(_sources().encode())
    for value in values:
        _add(digest, value)
    return digest.hexdigest()


def _add(digest, value):
    if is_dataclass(value) and not isinstance(value, type):
        digest.update(f"{type(value).__qualname__}(".encode())
        for part in fields(value):
            digest.update(part.name.encode())
            _add(digest, getattr(value, part.name))
        digest.update(b")")
    elif isinstance(value, np.ndarray):
        digest.update(f"{value.dtype}{value.shape}".encode() + np.ascontiguousarray(value).tobytes())
    elif isinstance(value, (list, tuple)):
        digest.update(f"[{len(value)}".encode())
        for part in value:
            _add(digest, part)
    elif isinstance(value, dict):
        _add(digest, sorted(value.items()))
    elif value is None or isinstance(value, (bool, int, float, complex, str, np.generic)):
        digest.update(f"{type(value).__name__}:{value!r};".encode())
    else:
        problem = f"{value!r} has no content that a later run could compare: leave out output, or give a SampledMotion"
        raise InputError(problem, field="motion", value=value)


@cache
def _sources() -> str:
    """Return a digest of the text of all solvers: a row of another version is none of this one."""
    digest, package = hashlib.sha256(), __name__.partition(".")[0]
    for module in sorted(pkgutil.walk_packages(sys.modules[package].__path__, f"{package}."), key=lambda m: m.name):
        loader = module.module_finder.find_spec(module.name, None).loader  # type: ignore[union-attr]
        digest.update((loader.get_source(module.name) or "").encode())  # type: ignore[union-attr]
    return digest.hexdigest()
