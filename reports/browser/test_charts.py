"""Do the interactive charts draw, say what their CSV says, switch, and give way to drawings where there is no script?

The report is that of MOORING_SITE, by default the folder mooring-report. Skipped or failing as test_page.py says.
"""

from __future__ import annotations

import csv
import math
import re
import shutil
from itertools import count
from pathlib import Path

import pytest

from . import checks
from .test_page import SCHEMES, WIDTHS, list_faults
from .test_site import SITE, opened

CHARTED = sorted(p for p in SITE.glob("*.html") if 'class="panel chart"' in p.read_text(encoding="utf-8"))
PATIENCE = 30_000
"""Milliseconds in which a chart is drawn or a switch takes effect, on a busy machine."""
POINTED = 3
"""Marks of every chart that the pointer is put on."""
DIGITS = 6e-3
"""Relative difference of a number that is shown with three digits from the number itself."""
TICKS = 0.06
"""The same of a place on an axis of cells, whose labels have one or two digits."""
PREFIXES = {"n": 1e-9, "µ": 1e-6, "m": 1e-3, "": 1.0}
KINDS = {"time_s": "work", "verdict": "map", "frequency_Hz": "curves"}
"""Column of a CSV -> the kind of chart that is drawn of it."""
SWITCHED = {"work": ("method",), "map": ("verdict",), "curves": ("series", "state")}
"""Kind of chart -> the columns whose values its legends switch."""
COUNTED = {"work": "points_marks", "map": "cells_marks", "curves": "points_marks"}
"""Kind of chart -> the marks that stand for the rows of its CSV, one each; of a map those with an error."""


@pytest.fixture(scope="module", params=CHARTED or [SITE], ids=lambda path: path.stem)
def path(request):
    """A page with charts."""
    if not CHARTED:
        checks.skip_or_fail(f"{SITE}: no page with a chart; python -m reports writes them")
    return request.param


@pytest.fixture(scope="module")
def page(browser, path):
    """The page at 1280 pixels, for the tests that leave it as they find it."""
    page, troubles = opened(browser, path)
    yield page
    page.close()
    assert not troubles, list_faults(troubles)


def draw_each(page):
    """Yield every chart of a page, drawn, in every choice of its list."""
    for chart in page.query_selector_all(".chart"):
        chart.scroll_into_view_if_needed()
        page.wait_for_function("chart => chart.dataset.drawn", arg=chart, timeout=PATIENCE)
        yield chart
        for k in range(1, len(chart.query_selector_all("option"))):
            chart.query_selector("select").select_option(index=k)
            wanted = chart.evaluate("(chart, k) => JSON.parse(chart.querySelector('script').textContent)[k].csv", k)
            page.wait_for_function("([chart, csv]) => chart.dataset.drawn === csv", arg=[chart, wanted],
                                   timeout=PATIENCE)  # fmt: skip
            yield chart


def read_rows(folder: Path, chart) -> list[dict]:
    """Return the rows of the CSV that a chart links."""
    name = chart.evaluate("chart => chart.querySelector('a.csv').getAttribute('href')")
    with (folder / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def kind_of(rows: list[dict]) -> str:
    """Return "work", "map" or "curves"."""
    return next(kind for column, kind in KINDS.items() if column in rows[0])


def count_marks(chart, name: str) -> int:
    """Return how many marks of a name a chart shows."""
    return chart.evaluate("(chart, name) => chart.querySelectorAll(`.${name} > path`).length", name)


def wait_for_marks(page, chart, name: str, wanted: int) -> int:
    """Return how many marks a chart shows as soon as there are as many as wanted, or after a second."""
    for _ in range(40):
        if count_marks(chart, name) == wanted:
            break
        page.wait_for_timeout(25)
    return count_marks(chart, name)


# ---------------------------------------------------------------- drawn
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("width", WIDTHS)
def test_every_chart_is_drawn(browser, path, width, scheme):
    """Every choice of every chart is drawn within its box, legibly, and nothing complains."""
    page, troubles = opened(browser, path, width, scheme)
    faults = []
    for chart in draw_each(page):
        name = chart.get_attribute("data-drawn")
        if not chart.evaluate("chart => chart.querySelectorAll('.role-mark path').length"):
            faults.append(f"{name}: no marks")
        chart_faults = checks.overflows(page) + checks.label_overlaps(page) + checks.clipped_labels(page)
        chart_faults += chart.evaluate("""chart => [chart.querySelector('svg')].filter(
            svg => svg.getBoundingClientRect().width > chart.clientWidth + 1).map(() => 'wider than its box')""")
        chart_faults += chart.evaluate("""chart => [...chart.querySelectorAll('.role-axis-label')].flatMap(axis => {
            const labels = [...axis.querySelectorAll('text')].filter(t => t.getAttribute('opacity') !== '0')
                .map(t => t.textContent.trim()).filter(t => t);
            return labels.filter((t, i) => labels.indexOf(t) < i).map(t => 'two ticks say ' + t); })""")
        faults += [f"{name}: {fault}" for fault in chart_faults]
    faults += checks.unreadable(page)
    page.close()
    assert not faults + troubles, list_faults(faults + troubles)


# ---------------------------------------------------------------- numbers
def read_number(text: str) -> float:
    """Return the number of a text such as 1.2e-5, 26µs, 4.42 ms, 1 + 2e-7 or 1 - 1e-6."""
    text = text.replace("\N{MINUS SIGN}", "-").replace(" ", "").replace("\N{THIN SPACE}", "")
    if match := re.fullmatch(r"1([+-])(\d.*)", text):
        return 1 + float(match[1] + match[2])
    if match := re.fullmatch(r"([\d.e+-]+)([nµm]?)s", text):
        return float(match[1]) * PREFIXES[match[2]]
    return float(text)


def are_near(shown: str, value: str, share: float) -> bool:
    """Return whether a number that is shown is that of the CSV; near 1 what is beside 1 counts."""
    one, other = read_number(shown), float(value)
    scale = abs(other - 1) if 0 < abs(other - 1) < 0.009 else abs(other)
    return math.isclose(one, other, rel_tol=0, abs_tol=share * scale + 1e-300)


def agrees(tooltip: dict[str, str], row: dict[str, str]) -> bool:
    """Return whether all that a tooltip says stands in a row of the CSV."""
    if "time_s" in row:
        pairs = [(tooltip["error"], row["error"], DIGITS), (tooltip["run time"], row["time_s"], DIGITS)]
        return all(tooltip[k] == row[k] for k in ("method", "setting")) and all(are_near(*pair) for pair in pairs)
    if "verdict" in row:
        x, y = [key for key in row if key not in ("verdict", "status", "error", "in_limits")]
        error = row.get("in_limits", row["error"])
        same = tooltip["verdict"] == row["verdict"] and all(are_near(tooltip[k], row[k], TICKS) for k in (x, y))
        return same and (are_near(tooltip["error"], error, DIGITS) if error else "error" not in tooltip)
    names = ("curve", "series"), ("tension, which", "bound"), ("state", "state")
    numbers = ("frequency, Hz", "frequency_Hz"), ("tension at the moved end, kN", "tension_kN")
    if "kind" in tooltip:
        return tooltip["kind"] == row["kind"] and all(are_near(tooltip[k], row[c], DIGITS) for k, c in numbers)
    return all(tooltip[k] == row[c] for k, c in names) and all(are_near(tooltip[k], row[c], DIGITS) for k, c in numbers)


def point_at_marks(page, chart, kind: str) -> list[dict[str, str]]:
    """Return what the tooltip says on some marks of a chart, from the first to the last."""
    marks = chart.query_selector_all(
        ".blank_marks > path, .cells_marks > path" if kind == "map" else ".points_marks > path"
    )
    tooltips = []
    for k in range(POINTED):
        box = marks[k * (len(marks) - 1) // (POINTED - 1)].bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        page.mouse.move(0, 0)
        page.mouse.move(x, y)
        page.mouse.move(x + 1, y)
        page.wait_for_selector("#vg-tooltip-element.visible tr", timeout=PATIENCE)
        tooltips.append(
            page.evaluate("""() => Object.fromEntries([...document.querySelectorAll(
            '#vg-tooltip-element tr')].map(row => [...row.cells].map(cell => cell.textContent.replace(/:$/, ''))))""")
        )
    return tooltips


def test_the_pointer_shows_the_numbers_of_the_csv(page, path):
    """What the tooltip says on marks of every chart stands in a row of the CSV that the chart links."""
    faults = []
    for chart in draw_each(page):
        rows = read_rows(path.parent, chart)
        tooltips = [
            each for each in point_at_marks(page, chart, kind_of(rows)) if "uncertainty of the reference" not in each
        ]
        faults += [
            f"{chart.get_attribute('data-drawn')}: {each}"
            for each in tooltips
            if not any(agrees(each, r) for r in rows)
        ]
        faults += [] if tooltips else [f"{chart.get_attribute('data-drawn')}: no tooltip"]
    assert not faults, list_faults(faults)


TOOLTIP = {"method": "MoorPy", "setting": "tolerance 0.1", "error": "0.0927", "run time": "57.1µs"}
ROW = {"method": "MoorPy", "setting": "tolerance 0.1", "error": "0.09270731", "time_s": "5.7076e-05"}


@pytest.mark.parametrize(
    "changed", [{"method": "other"}, {"error": "0.0936"}, {"time_s": "5.76e-05"}, {"setting": "-"}]
)
def test_a_wrong_number_is_noticed(changed):
    """A row with another name, error, time or setting is not what the tooltip says."""
    assert agrees(TOOLTIP, ROW) and not agrees(TOOLTIP, ROW | changed)


def test_places_near_one_are_told_apart():
    """Numbers are read as they are written; 1 + 2e-7 is neither 1 nor 1 + 3e-7."""
    assert read_number("26µs") == pytest.approx(26e-6) and read_number("4.42 ms") == pytest.approx(4.42e-3)
    assert are_near("1 + 2e-7", "1.0000002", TICKS) and are_near("1\N{MINUS SIGN}1e-6", "0.999999", TICKS)
    assert not are_near("1", "1.0000002", TICKS) and not are_near("1 + 3e-7", "1.0000002", TICKS)


# ---------------------------------------------------------------- switches
def count_wanted(rows: list[dict], kind: str, off: str) -> int:
    """Return how many marks there should be with one name of a legend off."""
    if kind == "curves":
        rows = [row for row in rows if row["state"]]  # special points have none, and no switch
    if kind == "map":
        coloured = {"solved", "warned"} if "status" in rows[0] else {"right", "wrong"}
        rows = [row for row in rows if row["verdict"] in coloured and (row.get("in_limits") or row["error"])]
    return sum(off not in (row[column] for column in SWITCHED[kind]) for row in rows)


def test_a_click_on_the_legend_switches_marks(page, path):
    """Each name of a legend takes as many marks away as the CSV has rows of it; a second click brings them back."""
    faults = []
    for chart in draw_each(page):
        rows = read_rows(path.parent, chart)
        kind, drawn = kind_of(rows), chart.get_attribute("data-drawn")
        every, clicked = count_wanted(rows, kind, "\0"), set()
        if count_marks(chart, COUNTED[kind]) != every:
            faults.append(f"{drawn}: {count_marks(chart, COUNTED[kind])} marks of {every}")
        for label in chart.query_selector_all(".role-legend-label text"):
            name = label.text_content()
            if any(name == row[column] for row in rows for column in SWITCHED[kind]) and name not in clicked:
                clicked.add(name)
                for wanted in (count_wanted(rows, kind, name), every):
                    label.click()
                    shown = wait_for_marks(page, chart, COUNTED[kind], wanted)
                    faults += [f"{drawn}: {name}: {shown} marks, wanted {wanted}"] if shown != wanted else []
        if kind != "map" and not clicked:
            faults.append(f"{drawn}: nothing can be switched")
    assert not faults, list_faults(faults)


# ---------------------------------------------------------------- elsewhere: moved, without scripts, on paper
def copy_site(path: Path, folder: Path, without: str = "") -> Path:
    """Copy a page with all that charts need to another folder, one file left out; return the page."""
    for file in [path, *path.parent.glob("*.js")]:
        if file.name != without:
            shutil.copy(file, folder)
    (folder / "figures").mkdir()
    for file in (path.parent / "figures").glob("*.csv"):
        shutil.copy(file, folder / "figures")
    return folder / path.name


def test_charts_draw_after_the_folder_moved(browser, path, tmp_path):
    """In another folder every chart is drawn, and its CSV lies where it links to."""
    page, troubles = opened(browser, copy_site(path, tmp_path))
    names = count()
    for chart in draw_each(page):
        assert read_rows(tmp_path, chart) and next(names) >= 0
    page.close()
    assert next(names) and not troubles, list_faults(troubles)


SHOWN = """() => ({
    charts: [...document.querySelectorAll('.chart')].filter(e => e.getBoundingClientRect().height).length,
    drawings: [...document.querySelectorAll('.drawings')].filter(
        e => [...e.querySelectorAll('svg')].some(svg => svg.checkVisibility({contentVisibilityAuto: true}))).length,
    folded: document.querySelectorAll('details:not([open])').length,
    all: document.querySelectorAll('.drawings').length})"""


def test_without_scripts_the_drawings_show(browser, path):
    """A browser that runs no scripts shows a drawing in place of each chart, and no empty box."""
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(path.resolve().as_uri())
    shown = [
        page.locator(".drawings").nth(k).locator("svg").first.bounding_box()
        for k in range(page.locator(".drawings").count())
    ]
    assert shown and all(box and box["height"] > 50 for box in shown)
    assert not any(chart.is_visible() for chart in page.locator(".chart").all())
    context.close()


def test_without_the_libraries_the_drawings_show(browser, path, tmp_path):
    """Where charts.js was not sent along, the drawings are unfolded again."""
    page, _ = opened(browser, copy_site(path, tmp_path, without="charts.js"))
    shown = page.evaluate(SHOWN)
    page.close()
    assert shown["charts"] == 0 and shown["drawings"] == shown["all"] > 0


def test_on_paper_there_are_drawings_and_no_closed_folds(browser, path):
    """Printing opens all folds and shows drawings for charts; afterwards the page is as it was."""
    page, _ = opened(browser, path)
    before = page.evaluate(SHOWN)
    page.emulate_media(media="print")
    page.wait_for_function("!document.querySelector('details:not([open])')", timeout=PATIENCE)
    printed = page.evaluate(SHOWN)
    page.emulate_media(media="screen")
    page.wait_for_function("n => document.querySelectorAll('details:not([open])').length === n", arg=before["folded"],
                           timeout=PATIENCE)  # fmt: skip
    page.close()
    assert before["charts"] == before["all"] > 0 and before["drawings"] == 0
    assert printed["charts"] == 0 and printed["drawings"] == printed["all"]
