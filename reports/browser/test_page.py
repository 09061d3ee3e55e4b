"""Is the finished page whole in a real browser: at the width of a telephone and of a laptop, light and dark?

The pages are those of MOORING_PAGE (several: separated as in PATH), by default all of mooring-report. Without a
browser or without a page the tests are skipped; where the variable CI is set, they fail instead.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from . import checks

FOLDER = Path(os.environ.get("MOORING_SITE", "mooring-report"))
BUILT = sorted(FOLDER.glob("*.html")) or [FOLDER / "index.html"]
PAGES = [Path(name) for name in os.environ["MOORING_PAGE"].split(os.pathsep)] if "MOORING_PAGE" in os.environ else BUILT
WIDTHS, SCHEMES = (390, 1280), ("light", "dark")


@pytest.fixture(scope="module", params=PAGES, ids=lambda path: path.stem)
def path(request):
    """The file of the page."""
    if not request.param.is_file():
        checks.skip_or_fail(f"{request.param}: no such page; python -m reports writes it")
    return request.param


@pytest.fixture(scope="module", params=[(width, scheme) for width in WIDTHS for scheme in SCHEMES], ids=str)
def opened(request, browser, path):
    """The page in the browser."""
    result = checks.opened(browser, path, *request.param)
    yield result
    result.page.close()


def list_faults(faults: list[str]) -> str:
    """Return the first faults, one a line."""
    return "\n".join([f"{len(faults)} faults", *faults[:20]])


def test_the_page_loads_without_complaint(opened):
    """No error in the console, no script error, no request that fails."""
    assert not opened.troubles, list_faults(opened.troubles)


def test_no_figure_is_missing(opened):
    """Every picture has pixels, every drawing a size."""
    assert not (faults := checks.missing_figures(opened.page)), list_faults(faults)


def test_every_link_leads_somewhere(opened, path):
    """Every CSV, JSON, PNG and SVG that is linked lies beside the page; every link within the page has its goal."""
    assert not (faults := checks.missing_files(opened.page, path)), list_faults(faults)


def test_every_figure_has_its_data(opened):
    """The caption of every figure links a CSV."""
    assert not (faults := checks.figures_without_data(opened.page)), list_faults(faults)


def test_nothing_runs_over_the_edge(opened):
    """The page does not scroll sideways; what is wider scrolls inside a box of its own."""
    assert not (faults := checks.overflows(opened.page)), list_faults(faults)


def test_nothing_overlaps(opened):
    """No block covers another, all folds open."""
    assert not (faults := checks.overlaps(opened.page)), list_faults(faults)


def test_labels_of_figures_are_legible(opened):
    """No label of a figure lies on another or reaches beyond the drawing."""
    faults = checks.label_overlaps(opened.page) + checks.clipped_labels(opened.page)
    assert not faults, list_faults(faults)


def test_text_stands_out_from_the_paper(opened):
    """Text of page and figures has at least three times the luminance of its paper, or a third."""
    assert not (faults := checks.unreadable(opened.page)), list_faults(faults)


# ---------------------------------------------------------------- each check can turn red
STYLE = "<style>body { margin: 0; background: #fff; color: #000; } svg { width: 300px; }</style>"
PANEL = (
    '<figure class="panel"><div class="drawn"><svg viewBox="0 0 300 100" aria-label="two"><path d="M0 0H9"/>{}'
    "</svg></div>"
    '<figcaption><a href="sound.csv">CSV</a></figcaption></figure>'
)
SOUND = f'<link rel="icon" href="data:,">{STYLE}<p id="top">Sound. <a href="#top">up</a></p>' + PANEL.format(
    '<text x="10" y="50">left</text><text x="200" y="50">right</text>'
)
PLANTED = {
    "missing image": ('<img src="none.png" alt="">', "missing_figures"),
    "empty drawing": ('<figure><svg viewBox="0 0 9 9" aria-label="none"></svg></figure>', "missing_figures"),
    "missing CSV": ('<a href="none.csv">CSV</a>', "missing_files"),
    "dead anchor": ('<a href="#none">there</a>', "missing_files"),
    "dead anchor elsewhere": ('<a href="page.html#none">there</a>', "missing_files"),
    "figure without data": ('<figure class="panel"><figcaption>bare</figcaption></figure>', "figures_without_data"),
    "script error": ("<script>undefined.x</script>", "troubles"),
    "console error": ("<script>console.error('planted')</script>", "troubles"),
    "failing request": ('<link rel="stylesheet" href="none.css">', "troubles"),
    "too wide": ('<p style="width: 1500px">wide</p>', "overflows"),
    "overlapping boxes": ('<p>one</p><p style="margin-top: -2.2em">two</p>', "overlaps"),
    "overlap in a fold": ('<details><summary>s</summary><p>one</p><p style="margin-top: -2.2em">two</p></details>',
                          "overlaps"),
    "labels on each other": (PANEL.format('<text x="10" y="50">one</text><text x="12" y="50">two</text>'),
                             "label_overlaps"),
    "clipped label": (PANEL.format('<text x="280" y="50">a long label</text>'), "clipped_labels"),
    "pale text": ('<p style="color: #ddd">pale</p>', "unreadable"),
}  # fmt: skip
"""Fault -> what is added to a sound page, and the check that must find it."""


def faults_of(browser, folder: Path, text: str, width: int = 1280) -> dict[str, list[str]]:
    """Return the faults that every check finds on a page with this body."""
    (folder / "sound.csv").write_text("x\n1\n", encoding="utf-8")
    (folder / "page.html").write_text(f"<!DOCTYPE html><html><body>{text}</body></html>", encoding="utf-8")
    result = checks.opened(browser, folder / "page.html", width, "light")
    page = result.page
    faults = {name: getattr(checks, name)(page) for name in (
        "missing_figures", "figures_without_data", "overflows", "overlaps", "label_overlaps", "clipped_labels",
        "unreadable",
    )}  # fmt: skip
    faults |= {"missing_files": checks.missing_files(page, folder / "page.html"), "troubles": result.troubles}
    page.close()
    return faults


def test_a_sound_page_passes_every_check(browser, tmp_path):
    """The checks find nothing where there is nothing."""
    assert not [*filter(None, faults_of(browser, tmp_path, SOUND).values())]


@pytest.mark.parametrize("fault", PLANTED)
def test_a_planted_fault_is_found(browser, tmp_path, fault):
    """A missing picture, a script error, a wide or covered box and others: the check meant for it turns red."""
    added, check = PLANTED[fault]
    assert faults_of(browser, tmp_path, SOUND + added)[check]
