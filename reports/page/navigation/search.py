"""What a reader can search for: titles, figures, cases and claims, each with its address in the report."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser

from .claims import Question, claim_id, file_id

MOST_ROWS = 60
"""Rows of a table whose first column is searched: more are points of a measurement and no names of cases."""

HEADINGS = ("h1", "h2", "h3", "h4")
HEADING = re.compile(r"<(h[34])>(.*?)</\1>", re.DOTALL)

Entry = tuple[str, str, str]
"""(text, kind, address)."""


def name_headings(text: str, section: str, slug) -> str:
    """Return a rendered section in which every heading has an id, made of that of the section and its own words."""
    taken: set[str] = set(re.findall(r'\sid="([^"]+)"', text))

    def named(match):
        name = base = f"{section}-{slug(re.sub('<[^>]+>', '', match[2]))}"
        while name in taken:
            name = f"{base}-{len(taken)}"
        taken.add(name)
        return f'<{match[1]} id="{name}">{match[2]}</{match[1]}>'

    return HEADING.sub(named, text)


class _Titles(HTMLParser):
    """Headings, titles of figures and first cells of tables of one page, in their order."""

    def __init__(self, file: str):
        super().__init__()
        self.file, self.entries, self.rows = file, [], {}
        self.kind, self.anchor, self.words = "", "", []
        self.figure, self.table, self.cell = "", "", 0

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        if tag == "figure" and "panel" in (given.get("class") or ""):
            self.figure = given.get("id") or ""
        elif tag == "div" and (given.get("id") or "").startswith("table-"):
            self.table = given["id"]
        elif tag in HEADINGS and given.get("id"):
            self._start("title", given["id"])
        elif tag == "figcaption" and self.figure:
            self._start("figure", self.figure)
        elif tag == "tr":
            self.cell = 0
        elif tag == "td" and self.table:
            self.cell += 1
            if self.cell == 1:
                self._start("case", self.table)
        elif tag == "a" and self.kind == "figure":  # behind the title stand the links to its files
            self._end()

    def handle_endtag(self, tag):
        if tag == "table":
            self.table = ""
        if tag == "figcaption":
            self.figure = ""
        if tag in (*HEADINGS, "figcaption", "td"):
            self._end()

    def handle_data(self, data):
        if self.kind:
            self.words.append(data)

    def _start(self, kind: str, anchor: str):
        self.kind, self.anchor, self.words = kind, anchor, []

    def _end(self):
        text = " ".join("".join(self.words).replace("\N{SOFT HYPHEN}", "").split()).rstrip(":")
        if self.kind and re.search("[^\\W\\d_]", text):
            entry = (text, self.kind, f"{self.file}#{self.anchor}")
            if self.kind == "case":
                self.rows.setdefault(self.anchor, []).append(entry)
            else:
                self.entries.append(entry)
        self.kind = ""


def titles_of(file: str, text: str) -> list[Entry]:
    """Return the headings, titles of figures and names of cases of a page."""
    reader = _Titles(file)
    reader.feed(text)
    few = [entry for rows in reader.rows.values() if len(rows) <= MOST_ROWS for entry in rows]
    return list(dict.fromkeys([*reader.entries, *few]))


def claims_of(questions: list[Question], file: str) -> list[Entry]:
    """Return the questions of the test files and their claims, on the page of this file."""
    entries = []
    for question in questions:
        entries.append((question.text or question.module, "test file", f"{file}#{file_id(question.module)}"))
        entries += [(claim.text, "claim", f"{file}#{claim_id(question.module, claim.name)}")
                    for claim in question.claims]  # fmt: skip
    return entries


def script(entries: list[Entry]) -> str:
    """Return the file that a page loads when its reader starts to search; it works from disk, where fetch does not."""
    return f"window.ENTRIES = {json.dumps(entries, ensure_ascii=False, separators=(',', ':'))};\n"
