"""Is the report whole as a site: short enough to be read, searchable, the same after its folder moved, and on paper?

The report is that of MOORING_SITE, by default the folder mooring-report. Skipped or failing as test_page.py says.
"""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest

from . import checks
from .test_page import list_faults

SITE = Path(os.environ.get("MOORING_SITE", "mooring-report"))

SCREEN = 900
"""Height of a screen, CSS pixels; its width is 1280, and 390 on a telephone."""
INDEX_SCREENS = {1280: 2, 390: 4}
PAGE_SCREENS = 12
"""Screens that a page may have as it opens: more is not read."""
WORDS = 11_250
"""Words that all pages together may show as they open: half of those that one page showed before."""
PRINTED = ("index.html", "catenary.html")
LEAST_PDF = 20_000
"""Bytes of a printed page with its figures; one without them has less."""


@pytest.fixture(scope="module")
def site():
    """The folder of the report."""
    if not (SITE / "search.js").is_file():
        checks.skip_or_fail(f"{SITE}: no report; python -m reports writes it")
    return SITE


def opened(browser, path: Path, width: int = 1280, scheme: str = "light"):
    """The page as a reader finds it, folds closed, and the troubles that it reports."""
    page, troubles = browser.new_page(viewport={"width": width, "height": SCREEN}, color_scheme=scheme), []
    page.on("console", lambda message: troubles.append(message.text))
    page.on("pageerror", lambda error: troubles.append(str(error)))
    page.on("requestfailed", lambda request: troubles.append(request.url))
    page.goto(path.resolve().as_uri(), wait_until="load")
    return page, troubles


def screens(page) -> float:
    """Height of the page in screens."""
    return page.evaluate("document.documentElement.scrollHeight") / SCREEN


def count_words(page) -> int:
    """Words that the page shows, those in drawings, in closed folds and in lists of choices left out.

    Navigation and the last line, the same on every page, count on the first page alone.
    """
    repeated = "" if page.url.endswith("/index.html") else ", nav, footer"
    page.evaluate(f"document.querySelectorAll('svg, select{repeated}').forEach(e => e.remove())")
    return len(page.evaluate("document.body.innerText").split())


@pytest.mark.parametrize("width", INDEX_SCREENS)
def test_pages_are_short(browser, site, width):
    """The index has two screens, four on a telephone; every page opens with twelve at most."""
    faults = []
    for path in sorted(site.glob("*.html")):
        if path.name.startswith(("scene-", "cases-")):
            continue
        page, troubles = opened(browser, path, width)
        most = INDEX_SCREENS[width] if path.name == "index.html" else PAGE_SCREENS * (1 if width == 1280 else 2)
        if screens(page) > most:
            faults.append(f"{path.name}: {screens(page):.1f} screens of {most}")
        faults += [f"{path.name}: {trouble}" for trouble in troubles]
        page.close()
    assert not faults, list_faults(faults)


def test_all_pages_together_are_read_in_an_hour(browser, site):
    """All pages show at most half of the words that the report had as one page."""
    total = 0
    for path in site.glob("*.html"):
        page, _ = opened(browser, path)
        total += count_words(page)
        page.close()
    assert total <= WORDS


@pytest.mark.parametrize(
    ("typed", "leads"),
    [("nearly vertical", "catenary.html"), ("orcaflex", "moving.html"), ("misprints found", "evidence.html")],
)
def test_the_search_leads_to_its_goal(browser, site, tmp_path, typed, leads):
    """A title, a case and a claim are listed and open at their place, from a folder that was moved."""
    moved = tmp_path / "moved"
    moved.mkdir()
    for path in [*site.glob("*.html"), *site.glob("*.js")]:
        shutil.copy(path, moved)
    page, troubles = opened(browser, moved / "index.html")
    page.fill("#search", typed)
    page.wait_for_selector("#search-list a")
    addresses = page.evaluate("[...document.querySelectorAll('#search-list a')].map(a => a.getAttribute('href'))")
    assert any(address.startswith(leads) for address in addresses), addresses
    page.click(f"#search-list a[href^='{leads}']")
    page.wait_for_url(f"**/{leads}*")
    assert page.evaluate("document.querySelector(decodeURIComponent(location.hash)) !== null")
    assert not troubles
    page.close()


def test_a_search_without_a_match_says_so(browser, site):
    """Words that are nowhere list nothing; Escape closes the list."""
    page, _ = opened(browser, site / "index.html")
    page.fill("#search", "xyzzyplugh")
    page.wait_for_function("document.getElementById('search-list').textContent === 'Nothing found.'")
    page.press("#search", "Escape")
    assert page.evaluate("document.getElementById('search-list').hidden")
    page.close()


def test_a_link_into_a_fold_opens_it(browser, site):
    """A link to a claim opens the folds around its row."""
    page, _ = opened(browser, site / "papers.html")
    address = page.evaluate("document.querySelector('a.test').getAttribute('href')")
    page.goto(f"{site.resolve().as_uri()}/{address}")
    page.wait_for_timeout(200)
    assert page.evaluate("document.querySelector(location.hash).getBoundingClientRect().height > 0")
    page.close()


@pytest.mark.parametrize("name", PRINTED)
def test_pages_print(browser, site, tmp_path, name):
    """On paper there are the words and figures, and no navigation or search field."""
    page, _ = opened(browser, site / name)
    page.pdf(path=tmp_path / "page.pdf", format="A4", print_background=True)
    assert (tmp_path / "page.pdf").stat().st_size > LEAST_PDF
    page.emulate_media(media="print")
    assert page.evaluate("getComputedStyle(document.querySelector('nav')).display") == "none"
    assert not checks.missing_figures(page)
    page.close()


def test_a_page_that_is_too_long_is_noticed(browser, tmp_path):
    """Planted: words in a fold and in a drawing do not count, others do; a long page has its screens."""
    text = "<p>one two</p><details><summary>three</summary>four</details><svg><text>five</text></svg>"
    (tmp_path / "page.html").write_text(f"<!DOCTYPE html><link rel=icon href='data:,'>{text}", encoding="utf-8")
    page, troubles = opened(browser, tmp_path / "page.html")
    assert screens(page) == 1 and not troubles
    assert count_words(page) == 3
    page.evaluate("document.body.style.height = '9000px'")
    assert screens(page) >= 10
    page.close()
