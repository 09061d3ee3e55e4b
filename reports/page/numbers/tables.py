"""The tables of the page, each also a CSV and a JSON file with the unrounded values."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import dataclass, field
from pathlib import Path

from ...pipeline.dependencies.ledger import write_atomically
from .formatting import number


@dataclass
class Table:
    """columns : key of a row -> heading; rows : raw values; formats : key -> how the page writes it (default: number).

    groups : (heading, number of columns) over the headings, where columns belong together.
    anchors : column -> key of the row with the id that its cells link to; note : what the columns mean
    """

    name: str
    title: str
    columns: dict
    rows: list[dict]
    formats: dict = field(default_factory=dict)
    groups: tuple = ()
    anchors: dict = field(default_factory=dict)
    note: str = ""

    def is_numeric(self, key) -> bool:
        """Return whether a column holds numbers, its dashes among them."""
        values = [row.get(key) for row in self.rows]
        return any(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values)

    def cells(self) -> list[list[tuple[str, bool, str | None]]]:
        """Return (text, is in a column of numbers, id that it links to) of every cell, row by row."""
        numeric = {key: self.is_numeric(key) for key in self.columns}
        return [
            [
                (self.formats.get(key, number)(row.get(key)), numeric[key], row.get(self.anchors.get(key)))
                for key in numeric
            ]
            for row in self.rows
        ]

    def write(self, folder: Path) -> Table:
        """Write name.csv and name.json; return self."""
        text = io.StringIO()
        writer = csv.DictWriter(text, list(self.columns), extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        writer.writerows(self.rows)
        write_atomically(folder / f"{self.name}.csv", text.getvalue())
        data = [{key: row.get(key) for key in self.columns} for row in self.rows]
        write_atomically(folder / f"{self.name}.json", json.dumps(data, indent=1))
        return self


def write_table(
    section: str, folder: Path, name: str, title: str, rows: list[dict], columns: dict | None = None, **options
) -> Table:
    """Write and return a table of a section; by default it has a column for every key of the first row."""
    keys = columns or {key: key for key in rows[0]}
    return Table(f"{section}_{name}", title, keys, rows, **options).write(folder)
