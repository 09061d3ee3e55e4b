"""The script that draws interactive charts: Vega, Vega-Lite and Vega-Embed in one file, and what starts them."""

from __future__ import annotations

import os
from importlib.metadata import version
from pathlib import Path

from ..pipeline.dependencies.ledger import write_atomically

FILE = "charts.js"
SOURCE = Path(__file__).parent / "templates" / FILE
MARK = 'class="panel chart"'


def has_charts(text: str) -> bool:
    """Return whether a page has an interactive chart."""
    return MARK in text


def write_script(folder: Path):
    """Write charts.js beside the pages, so that they need no network."""
    write_atomically(folder / FILE, f"{_load_libraries()}\n{SOURCE.read_text(encoding='utf-8')}")


def _load_libraries() -> str:
    """Return the bundle of vl-convert. It takes seconds to make, so it is kept in the user's cache by its version."""
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "mooring-verification"
    file = cache / f"vega-{version('vl-convert-python')}.js"
    if file.is_file():
        return file.read_text(encoding="utf-8")
    import vl_convert

    text = vl_convert.javascript_bundle()
    try:
        cache.mkdir(parents=True, exist_ok=True)
        write_atomically(file, text)
    except OSError:  # no home that can be written to: it is made again next time
        pass
    return text
