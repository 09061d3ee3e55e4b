"""What the sections on moving cables share: how their tables are written."""

from __future__ import annotations

from functools import partial

from ..page.numbers import tables

write_table = partial(tables.write_table, "dynamics")
"""Write and return a table under the names that all tables of moving cables have."""


def to_long_form(series: dict, **given) -> list[dict]:
    """Return a row for every index of equally long arrays, each with the given values."""
    names = list(series)
    return [given | dict(zip(names, values, strict=True)) for values in zip(*series.values(), strict=True)]
