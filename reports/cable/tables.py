"""What the sections on moving cables share: figures with the table of what they draw."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ..drawing.style import Group
from ..page.tables import Table


@dataclass
class Shown:
    """Figures with the table of what they draw."""

    group: Group
    table: Table


def written(folder: Path, name: str, title: str, rows: list[dict], columns: dict | None = None, **options) -> Table:
    """A table, written; by default with a column for every key of the first row."""
    keys = columns or {key: key for key in rows[0]}
    return Table(f"dynamics_{name}", title, keys, rows, **options).write(folder)


def long(series: dict, **given) -> list[dict]:
    """Rows of equally long arrays by name, each with the given values."""
    names = list(series)
    return [given | dict(zip(names, values, strict=True)) for values in zip(*series.values(), strict=True)]


def condition(status: str) -> str:
    """NO_PERIODIC_RESPONSE: no periodic response."""
    return {"SUCCESS": "solved"}.get(status, status.lower().replace("_", " "))
