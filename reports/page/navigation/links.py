"""Links between the pages of the report: an anchor of another page becomes page.html#anchor."""

from __future__ import annotations

import re

SVG = re.compile(r"<svg\b.*?</svg>", re.DOTALL)
ID = re.compile(r'\sid="([^"]+)"')
LINK = re.compile(r'(<a\b[^>]*?\shref=")#([^"]*)"')


def ids_of(text: str) -> list[str]:
    """Return the ids on a page, those within drawings left out."""
    return ID.findall(SVG.sub(" ", text))


def link_pages(pages: dict[str, str]) -> dict[str, str]:
    """Return the pages with every link to an anchor of another page resolved.

    pages : file name -> its text. Raises ValueError where an anchor is on no page, twice on one, or on two others.
    """
    places: dict[str, list[str]] = {}
    for name, text in pages.items():
        ids = ids_of(text)
        if again := [anchor for anchor in set(ids) if ids.count(anchor) > 1]:
            raise ValueError(f"{name}: these ids occur more than once: {', '.join(sorted(again))}")
        for anchor in ids:
            places.setdefault(anchor, []).append(name)
    return {name: _resolve(name, text, places) for name, text in pages.items()}


def _resolve(name: str, text: str, places: dict[str, list[str]]) -> str:
    def target(match):
        pages = places.get(match[2], [])
        if not pages:
            raise ValueError(f"{name}: a link leads to #{match[2]}, which is on no page")
        if name not in pages and len(pages) > 1:
            raise ValueError(f"{name}: a link leads to #{match[2]}, which is on {' and '.join(pages)}")
        return f'{match[1]}{"" if name in pages else pages[0]}#{match[2]}"'

    return LINK.sub(target, text)
