"""Names of the files that a page is about, by which their results are kept: no two files share one."""

from __future__ import annotations

import json
from itertools import chain, count
from pathlib import Path

from .dependencies.ledger import write_atomically


def name_files(paths: list[Path], record: Path) -> dict[Path, str]:
    """Return a name for each file, by which results and page are kept: its stem, with its folder where that is taken.

    record: a JSON file of the names that were given before, so that a file of the same stem elsewhere overwrites none.
    """
    try:
        given = json.loads(record.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        given = {}
    names = {}
    for path in paths:
        where = str(path.resolve())
        folder = path.resolve().parent.name
        candidates = chain([path.stem, f"{path.stem}-{folder}"], (f"{path.stem}-{folder}-{k}" for k in count(2)))
        names[path] = next(name for name in candidates if given.get(name, where) == where)
        given[names[path]] = where
    write_atomically(record, json.dumps(given, indent=1))
    return names
