"""Does the report build a page that stands by itself? It is run as its reader runs it, from the command line."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from dataclasses import dataclass
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from verification import ROOT

SCENE = ROOT / "reference_data" / "scenes" / "shallow_chain.toml"

EMBEDDED = {("link", "href"), ("script", "src"), ("img", "src"), ("iframe", "src"), ("object", "data"), ("use", "href"),
            ("use", "xlink:href"), ("image", "href"), ("image", "xlink:href"), ("source", "src")}  # fmt: skip
"""What a browser fetches to show a page; a link of the text, <a href>, is followed only when clicked."""


@dataclass(frozen=True)
class Element:
    """A tag of the page with its attributes."""

    tag: str
    attributes: dict


class Page(HTMLParser):
    """All elements of a page."""

    def __init__(self, text: str):
        super().__init__()
        self.elements, self.text = [], text
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.elements.append(Element(tag, dict(attrs)))

    def of(self, *tags) -> list[dict]:
        """Attributes of every element with one of these tags."""
        return [element.attributes for element in self.elements if element.tag in tags]


def fetched(page: Page) -> list[str]:
    """Addresses that a browser fetches from elsewhere while it shows the page."""
    results = [e.attributes.get(name) for e in page.elements for tag, name in EMBEDDED if e.tag == tag]
    return [address for address in results if address and not address.startswith(("#", "data:"))]


def undescribed(page: Page) -> list[dict]:
    """Pictures without words for those who cannot see them."""
    pictures = [a for a in page.of("img") if not a.get("alt")]
    return pictures + [a for a in page.of("svg") if not (a.get("role") == "img" and a.get("aria-label"))]


def missing_files(page: Page, folder: Path) -> list[str]:
    """Links to files beside the page that are not there or are empty."""
    links = [a["href"] for a in page.of("a") if a.get("href") and not urlsplit(a["href"]).scheme]
    paths = [link.split("#")[0] for link in links]
    return [path for path in paths if path and not ((folder / path).is_file() and (folder / path).stat().st_size)]


def read_site(folder: Path) -> str:
    """All pages of a report, one after the other, the index first."""
    pages = sorted(folder.glob("*.html"), key=lambda path: (path.name != "index.html", path.name))
    return "\n".join(path.read_text(encoding="utf-8") for path in pages)


def broken_links(folder: Path) -> list[str]:
    """Links of the pages of a report to an anchor that is not on the page that they name."""
    pages = {path.name: Page(path.read_text(encoding="utf-8")) for path in folder.glob("*.html")}
    ids = {name: {e.attributes.get("id") for e in page.elements} for name, page in pages.items()}
    results = []
    for name, page in pages.items():
        for href in (a.get("href", "") for a in page.of("a")):
            file, mark, anchor = href.partition("#")
            if mark and not urlsplit(href).scheme and anchor not in ids.get(file or name, ()):
                results.append(f"{name}: {href}")
    return results


def broken_anchors(page: Page) -> list[str]:
    """Links within the page that lead nowhere."""
    ids = {e.attributes.get("id") for e in page.elements}
    targets = [a["href"][1:] for a in page.of("a") if a.get("href", "").startswith("#")]
    return [target for target in targets if target not in ids]


def misaligned(text: str) -> list[str]:
    """Cells of tables whose alignment is not that of the heading of their column."""
    results = []
    for table in re.findall(r"<table>(.*?)</table>", text, re.DOTALL):
        head, _, body = table.partition("</thead>")
        columns = [is_number(tag) for tag in re.findall(r"<th[ >][^>]*>?", head.rpartition("<tr>")[2])]
        for row in re.findall(r"<tr>(.*?)</tr>", body, re.DOTALL):
            cells = re.findall(r"(<td[^>]*>)(.*?)</td>", row, re.DOTALL)
            results += [cell for (tag, cell), column in zip(cells, columns, strict=True) if is_number(tag) != column]
    return results


def is_number(tag: str) -> bool:
    """A cell or heading of the class of numbers, which stand at the right."""
    return 'class="n"' in tag


def section(text: str, name: str) -> str:
    """What stands under the heading with that id, up to the next of the same rank."""
    return text.partition(f'<h2 id="{name}">')[2].partition("<h2 ")[0]


def report(*arguments) -> subprocess.CompletedProcess:
    return subprocess.run(
        [sys.executable, "-m", "reports", *map(str, arguments)], cwd=ROOT, capture_output=True, text=True, timeout=60
    )


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """(folder, page) of one shipped scene."""
    out = tmp_path_factory.mktemp("report")
    run = report(SCENE, "--out", out)
    assert run.returncode == 0, run.stderr
    path = Path(run.stdout.strip().splitlines()[-1])
    return out, Page(path.read_text(encoding="utf-8"))


def test_page_of_a_scene_is_self_contained(built):
    """The page of a scene needs nothing that is not in it: no script, style, font or picture from elsewhere."""
    _, page = built
    assert page.of("title") and "Shallow chain" in page.text
    assert not any("src" in attributes for attributes in page.of("script"))
    assert fetched(page) == []
    assert "@import" not in page.text and "url(http" not in page.text


def test_figures_and_tables_of_the_page_exist(built):
    """Every figure and table that the page links lies beside it, as PNG and SVG, as CSV and JSON."""
    folder, page = built
    assert missing_files(page, folder) == []
    assert broken_anchors(page) == []
    kinds = {Path(a["href"]).suffix for a in page.of("a") if not a["href"].startswith("#")}
    assert {".png", ".svg", ".csv", ".json"} <= kinds


def test_every_picture_is_described(built):
    """Every picture has words for those who cannot see it."""
    _, page = built
    assert len(page.of("svg", "img")) >= 3
    assert undescribed(page) == []


def test_forces_on_the_page_are_those_of_the_result(built):
    """The table of forces holds what the solver wrote, unrounded, in its JSON file."""
    folder, _ = built
    written = json.loads((folder / "results" / "scene_shallow_chain.json").read_text(encoding="utf-8"))
    shown = json.loads((folder / "tables" / "scene_shallow_chain_forces.json").read_text(encoding="utf-8"))
    assert [row["H"] for row in shown] == [line["H"] for line in written["lines"]]
    assert [row["tension"] for row in shown] == [line["tension"] for line in written["lines"]]


def test_second_run_measures_nothing_again(built):
    """A second run of the same scene reuses the result and leaves it untouched."""
    folder, _ = built
    result = folder / "results" / "scene_shallow_chain.json"
    for _ in range(2):  # a source edited between two runs is rightly measured again, so it gets a second try
        before = result.stat().st_mtime_ns
        assert report(SCENE, "--out", folder).returncode == 0
        if result.stat().st_mtime_ns == before:
            return
    pytest.fail("the second and the third run measured again what had not changed")


SOME_NETWORKS = """
import sys
from benchmarks.network import measure as networks

CHOSEN = {"pictures": slice(1), "table2": slice(0, 84, 3), "example": slice(2), "work": slice(1), "speed": slice(4),
          "growth": slice(0, 15, 5), "peers": slice(1)}
some = lambda name, tasks: lambda quick: tasks(True)[CHOSEN[name]]
networks.PARTS = {name: some(name, tasks) for name, tasks in networks.PARTS.items()}
networks.main(["--quick", "--out", sys.argv[1]])
"""
"""A few of the tasks of every part of the benchmark of networks: what it writes, in seconds."""

NETWORK_HEADINGS = ("What is solved", "The paper's two-line example", "Error against run time",
                    "Monolithic and nested, side by side", "Growth with size")  # fmt: skip
NETWORK_FIGURES = ("two_lines", "work_two-lines-226.61-n-m", "gain", "growth")


@pytest.fixture(scope="module")
def whole_pages(tmp_path_factory):
    """(folder, text) of the whole page without any result, and of the same with some networks."""
    pages = []
    for measured in (False, True):
        out = tmp_path_factory.mktemp("whole")
        if measured:
            command = [sys.executable, "-c", SOME_NETWORKS, str(out / "results")]
            subprocess.run(command, cwd=ROOT, check=True, capture_output=True, timeout=60)
        run = report("--only", "machine", "--out", out)
        assert run.returncode == 0, run.stderr
        pages.append((out, read_site(out)))
    return pages


def test_networks_are_on_the_page(whole_pages):
    """With results there are all parts of the section, figures, tables and verdicts; without, a note that says so."""
    (_, without), (folder, text) = whole_pages
    assert "Not run yet" in section(without, "networks") and "<h3" not in section(without, "networks")
    result = section(text, "networks")
    headings = [heading for heading in re.findall(r"<h3[^>]*>(.*?)</h3>", result) if heading != "Compared with MoorPy"]
    assert [heading.replace("&#39;", "'") for heading in headings] == list(NETWORK_HEADINGS)
    for name in NETWORK_FIGURES:
        assert f'href="figures/networks_{name}.png"' in result
    page = (folder / "network.html").read_text(encoding="utf-8")
    strip = page.partition('<ul class="strip">')[2].partition("</ul>")[0]
    assert 'href="#networks"' in strip and "over monolithic analytic" in strip
    assert missing_files(Page(text), folder) == [] and undescribed(Page(text)) == []
    assert "None" not in re.sub(r"<svg.*?</svg>", "", result, flags=re.DOTALL)


def test_cells_stand_as_their_headings(whole_pages):
    """In every table numbers and the dashes among them stand at the right like their heading, words at the left."""
    (_, _), (_, text) = whole_pages
    assert "<td" in text and misaligned(text) == []


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["no_such_scene.toml"], "no_such_scene.toml: there is no such scene file"),
        (["--only", "nonsense"], "unknown stage 'nonsense'; the stages are tests, machine"),
        ([SCENE, SCENE], "a scene file is given twice"),
    ],
)
def test_bad_arguments_end_with_a_clear_message(arguments, message):
    """A scene that is not there or an unknown stage ends with status 2 and says what is wrong."""
    run = report(*arguments)
    assert run.returncode == 2
    assert message in run.stderr
    assert "Traceback" not in run.stderr


def test_failing_child_is_reported_and_the_page_still_built(tmp_path):
    """A scene with an unknown key: status 1, the child's own message, and a page that says what failed."""
    scene = tmp_path / "misspelt.toml"
    scene.write_text(SCENE.read_text(encoding="utf-8").replace("friction", "fricton"), encoding="utf-8")
    run = report(scene, "--out", tmp_path / "out")
    assert run.returncode == 1
    assert "unknown key 'fricton'" in run.stderr and f"--out {tmp_path / 'out' / 'results'}" in run.stderr
    page = (tmp_path / "out" / "scene-misspelt.html").read_text(encoding="utf-8")
    assert "failed" in page and "unknown key" in page and f"--out {tmp_path / 'out' / 'results'}" in page


def test_help_names_the_stages():
    """--help works without results and lists what can be run alone."""
    run = report("--help")
    assert run.returncode == 0
    assert "--quick" in run.stdout and "work_precision" in run.stdout


def test_the_checks_of_the_page_can_fail(tmp_path):
    """Planted faults: a fetched script, a picture without words, a missing file and a dead anchor are all found."""
    bad = Page(
        '<script src="https://example.org/a.js"></script><img src="data:,"><svg></svg><a href="x.png"></a><a href="#y">'
    )
    assert fetched(bad) == ["https://example.org/a.js"]
    assert len(undescribed(bad)) == 2
    assert missing_files(bad, tmp_path) == ["x.png"]
    assert broken_anchors(bad) == ["y"]
    table = '<table><thead>\n<tr><th class="n">a</th><th>b</th></tr></thead><tr>{}<td class="text">c</td></tr></table>'
    assert misaligned(table.format('<td class="text short">-</td>')) == ["-"]
    assert misaligned(table.format('<td class="n">-</td>')) == []
