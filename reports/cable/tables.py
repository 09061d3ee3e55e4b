"""What the sections on moving cables share: how their tables are written."""

from __future__ import annotations

from pathlib import Path

from ..page.tables import Table


def write_table(folder: Path, name: str, title: str, rows: list[dict], columns: dict | None = None, **options) -> Table:
    """Write and return a table; by default it has a column for every key of the first row."""
    keys = columns or {key: key for key in rows[0]}
    return Table(f"dynamics_{name}", title, keys, rows, **options).write(folder)


def to_long_form(series: dict, **given) -> list[dict]:
    """Return a row for every index of equally long arrays, each with the given values."""
    names = list(series)
    return [given | dict(zip(names, values, strict=True)) for values in zip(*series.values(), strict=True)]
