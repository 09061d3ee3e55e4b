"""Does the page answer its questions in order, link every claim to its test, and quote no number that is typed in?"""

from __future__ import annotations

import ast
import csv
import html
import json
import math
import re
import shutil
import subprocess
import sys

import pytest

from .test_report import ROOT, Page, broken_anchors, broken_links, missing_files, read_site, report, section

REPORTS = ROOT / "reports"
QUESTIONS = {
    "How strongly is this verified?": "evidence.html",
    "Which method, at which error and cost?": "moving.html",
    "What breaks?": "limits.html",
    "How do other codes do, and yours?": "codes.html",
    "What will it say of your own line?": "lines.html",
}
"""Question of the first page -> the page that answers it at length."""
SCENES = ("oc3_hywind", "shallow_chain", "taut_polyester")


# ---------------------------------------------------------------- numbers that are typed in
NUMBER = re.compile(r"(?<![\w.(#&{^-])\d+(?:[.  ]\d+)*(?:e-?\d+)?(?![\w(])")
LABEL = re.compile(
    r"(?:HB |MSQS )?(?:Figs?\.|Table) \d+(?: to \d+)?|\(\d+(?:\.\d+)?\)|\b[Cc]ases? \d(?: to \d)?|\(\d{4}\)|with \d of"
)
"""Labels of figures, tables, equations, cases and years: names, no values."""

ALLOWED = {
    "to 50 digits": "the precision of the oracle, a name of the method",
    "against 50 digits": "the same",
    "40-digit solution": "the same, of networks",
    "(1, 5, 15 minutes)": "what load averages are",
    "a factor such as 2": "a kind of mistake",
    "wanted 0": "a bound that the project set itself",
    "wanted 2 within": "the order of the scheme, a bound that the project set itself",
    "near order 2": "the same",
    "Surge 9 m": "the name of a case",
    "surge 5 m": "the same",
    "heave 5 m": "the same",
    "sway 5 m": "the same",
    "at 9 m": "the name of a row of reference_data",
    "Cdn 1.6": "the same",
    "Cdn 0.1": "the same",
    "near 15 s": "the same",
    "of node 25": "the same",
    "moves by 1 %": "a setting of the benchmark of networks, in its name",
    "5 and 95": "percentiles",
    "2n³/3": "the formula (5.6)",
    "V&V 20:": "the name of a standard",
    "(rᵖ - 1)": "the formula of the numerical uncertainty",
    "out by 1 m": "a setting of the benchmark of networks",
    "per 1 % of": "a unit of the sensitivity",
    "from 0 to": "where a scale of colours begins",
    ", 1 to ": "where counting begins",
    "radius 1 it": "a property of the method",
    "net and tree of 10 000": "a size of the benchmark of networks",
    "of 1 000 000 lines": "a size of the benchmark of batches",
    "100 000 lines in": "the same",
    "over that of 100 000": "the same",
    "in 3 h": "the duration of a sea state, a name of the quantity",
    "90 %": "of a confidence interval, a name of the quantity",
    "1 Hz range": "the range of a cycle a second, a name of the quantity",
}
"""Text around a number -> why it may stand there: a name, or a bound set beforehand, and nothing measured."""


def typed(text: str) -> list[str]:
    """Numbers in a text, with what stands around them, but labels and what is allowed."""
    for known in ALLOWED:
        text = text.replace(known, " ")
    text = LABEL.sub(" ", text)
    return [text[max(0, m.start() - 30) : m.end() + 15].replace("\n", " ") for m in NUMBER.finditer(text)]


def template_text(source: str) -> str:
    """What a template shows by itself: without code, tags, styles and commands."""
    source = re.sub(r"\{#.*?#\}|\{%.*?%\}|<style>.*?</style>", " ", source, flags=re.DOTALL)
    source = re.sub(
        r"\{\{(.*?)\}\}", lambda m: " ".join(re.findall(r'"([^"]*[a-z] [^"]*)"', m[1])), source, flags=re.DOTALL
    )
    return re.sub(r"<[^>]+>", " ", re.sub(r"<code>.*?</code>", " ", source, flags=re.DOTALL))


def sentences(source: str) -> list[str]:
    """Strings with a blank in a module that are neither docstrings nor parts of formats."""
    tree, left_out = ast.parse(source), set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            left_out.add(id(node.value))
        if isinstance(node, ast.FormattedValue) and node.format_spec:
            left_out |= {id(part) for part in ast.walk(node.format_spec)}
    results = [n.value for n in ast.walk(tree) if isinstance(n, ast.Constant) and id(n) not in left_out]
    return [text for text in results if isinstance(text, str) and " " in text.strip()]


NO_PAGE = ("runner.py", "style.py", "stages.py", "__main__.py", "compare.py", "progress.py", "interactive.py")
"""Modules whose strings are messages of the program, markup or expressions of charts, not sentences of the page."""
TEMPLATES = [path for path in sorted(REPORTS.rglob("*.html.j2")) if "out" not in path.relative_to(REPORTS).parts]


@pytest.mark.parametrize("path", TEMPLATES, ids=lambda path: path.relative_to(REPORTS).as_posix())
def test_no_template_holds_a_measured_number(path):
    """A template has no number of its own but labels and the stated exceptions: values come from files."""
    assert not typed(template_text(path.read_text(encoding="utf-8")))


@pytest.mark.parametrize(
    "path",
    sorted(set(REPORTS.rglob("*.py")) - set((REPORTS / "browser").rglob("*"))),
    ids=lambda path: path.relative_to(REPORTS).as_posix(),
)
def test_no_sentence_holds_a_measured_number(path):
    """Nor has a sentence in the modules that write the page."""
    if path.name not in NO_PAGE:
        assert not [result for text in sentences(path.read_text(encoding="utf-8")) for result in typed(text)]


@pytest.mark.parametrize(
    "text", ["The error is 3.2e-15 here.", "It takes 55.3 ms.", "Faster by 12 times", "w = 226.61 N/m"]
)
def test_a_typed_number_is_found(text):
    """A planted number in a template, in an expression of one and in a sentence of a module."""
    assert typed(template_text(f"<p>{text}</p>")) and typed(template_text('{{ x or "' + text + '" }}'))
    assert any(typed(result) for result in sentences(f'said = f"{{x}} {text}"'))


def test_labels_and_exceptions_are_no_numbers():
    """Labels, classes of tags and what stands between code are left alone."""
    assert not typed(
        template_text('<td class="n2">{{ value|number(2) }}</td> HB Fig. 3 and Table 2, (5.7), case 1, to 50 digits')
    )


# ---------------------------------------------------------------- the page without results, and with some
@pytest.fixture(scope="module")
def bare(tmp_path_factory):
    """(folder, page) of the whole page with the machine and nothing else."""
    out = tmp_path_factory.mktemp("bare")
    run = report("--only", "machine", "--out", out)
    assert run.returncode == 0, run.stderr
    return out, Page(read_site(out))


def test_five_questions_in_their_order(bare):
    """The first page asks the five questions in order, each linked to the page that answers it."""
    out, _ = bare
    index = html.unescape((out / "index.html").read_text(encoding="utf-8"))
    asked = re.findall(r'<h2><a href="([\w.-]+)">(.*?)</a></h2>', index)
    assert {question: page for page, question in asked} == QUESTIONS
    assert [question for _, question in asked] == list(QUESTIONS)


def test_every_page_leads_to_every_other(bare):
    """The navigation is the same on each page, names each once, and says where the reader is."""
    out, _ = bare
    files = {path.name for path in out.glob("*.html")}
    assert len(files) >= 11
    for name in files:
        text = (out / name).read_text(encoding="utf-8")
        listed = re.findall(
            r'<a href="([\w.-]+)"( aria-current="page")?>', text.partition("<nav")[2].partition("</nav>")[0]
        )
        assert sorted(file for file, _ in listed) == sorted(files)
        assert [file for file, here in listed if here] == [name]


def test_no_link_between_pages_dangles(bare, tmp_path):
    """Every anchor is on the page that a link names, in another folder as well; a planted one is noticed."""
    out, _ = bare
    moved = shutil.copytree(out, tmp_path / "moved")
    assert broken_links(moved) == [] and missing_files(Page(read_site(moved)), moved) == []
    page = moved / "papers.html"
    page.write_text(page.read_text(encoding="utf-8").replace("evidence.html#", "cable.html#"), encoding="utf-8")
    assert broken_links(moved)


LINKS = """
from reports.page.navigation.links import link_pages
pages = {"a.html": '<h2 id="one">1</h2><a class="x" href="#two">', "b.html": '<p id="two"><a href="#two"></p>'}
print(link_pages(pages))
for bad in ({"a.html": '<a href="#none">'}, {"a.html": '<p id="x"><p id="x">'},
            {"a.html": '<a href="#x">', "b.html": '<p id="x">', "c.html": '<p id="x">'}):
    try:
        print(link_pages(bad))
    except ValueError as error:
        print(error)
"""


def test_anchors_of_other_pages_are_resolved_when_the_site_is_built():
    """A link to another page names it; one to nowhere, to two places or an id that is there twice stops the build."""
    good, *bad = subprocess_of(LINKS).stdout.splitlines()
    assert 'href="b.html#two"' in good and '<a href="#two"></p>' in good
    assert [re.search("on no page|more than once|on b.html and c.html", text) is not None for text in bad] == [True] * 3


def test_titles_cases_and_claims_are_searched(bare):
    """The index of the search holds headings, questions and claims, each with an address that is there."""
    out, page = bare
    script = (out / "search.js").read_text(encoding="utf-8")
    entries = json.loads(script.removeprefix("window.ENTRIES = ").removesuffix(";\n"))
    assert {"title", "claim", "test file"} <= {kind for _, kind, _ in entries}
    assert ["Lines at rest against 50 digits", "title", "catenary.html#regimes"] in entries
    ids = {e.attributes.get("id") for e in page.elements}
    assert all((out / a.partition("#")[0]).is_file() and a.partition("#")[2] in ids for _, _, a in entries)
    titles = re.findall(r"<h2 id=[^>]*>(.*?)</h2>", page.text)
    assert {html.unescape(title) for title in titles} <= {text for text, _, _ in entries}


CACHE = """
import sys
from pathlib import Path
from reports.page import site
from reports.pipeline.stages import plan
out, names = Path(sys.argv[1]), []
plain = site._build_all
site._build_all = lambda sections, *rest: names.extend(s.id for s in sections) or plain(sections, *rest)
site.build(out, "index.html", plan(True, []), [], True)
print(*names)
"""


def test_only_sections_with_changed_results_are_drawn_again(tmp_path):
    """A second build draws nothing; a changed result its own sections, and so does a figure that was deleted."""
    results = tmp_path / "results"
    results.mkdir()
    (results / "stability.json").write_text('{"maps": [], "verdicts": ["solved"]}', encoding="utf-8")
    first, again = (subprocess_of(CACHE, tmp_path).stdout.split() for _ in range(2))
    assert {"stability", "networks", "machine"} <= set(first)
    assert "machine" in again and not {"stability", "networks", "regimes"} & set(again)
    (results / "stability.json").write_text('{"maps": [], "verdicts": ["solved", "wrong"]}', encoding="utf-8")
    changed = subprocess_of(CACHE, tmp_path).stdout.split()
    assert "stability" in changed and "networks" not in changed
    (tmp_path / "tables" / "stability_counts.csv").unlink()
    without = subprocess_of(CACHE, tmp_path).stdout.split()
    assert "stability" in without and "networks" not in without


def test_the_page_without_results_is_whole(bare):
    """Without results it says so, and no link leads nowhere."""
    out, page = bare
    assert broken_anchors(page) == [] and broken_links(out) == [] and missing_files(page, out) == []
    assert page.text.count("Not measured yet.") >= 2


def test_claims_link_their_tests(bare):
    """Sections say which tests show them, and every item of the papers has at least one test, as a link to its row."""
    _, page = bare
    assert page.text.count("Shown by") >= 10
    rows = re.findall(r"<tr>(.*?)</tr>", section(page.text, "items"), re.DOTALL)[1:]
    assert len(rows) == 17 and all('class="test' in row and 'href="evidence.html#claim-' in row for row in rows)


def test_every_item_of_the_papers_is_listed(bare):
    """HB Table 1, Figs. 2 to 9, Table 2; MSQS Figs. 2 and 12, Table 2, (5.3) to (5.7): each with what it says."""
    out, _ = bare
    with (out / "tables" / "papers.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    wanted = [f"HB Fig. {n}" for n in range(2, 10)] + [
        "HB Table 1",
        "HB Table 2",
        "MSQS Fig. 2",
        "MSQS Fig. 12",
        "MSQS Table 2",
    ]
    wanted += ["MSQS (5.3)", "MSQS (5.4)", "MSQS (5.5)", "MSQS (5.6), (5.7)"]
    assert sorted(f"{row['paper']} {row['item']}" for row in rows) == sorted(wanted)
    assert all(row["prints"] and row["verdict"] and row["why"] for row in rows)
    assert next(row for row in rows if row["item"] == "Table 1")["verdict"] == "agrees"


SECTION = """
import sys
from dataclasses import replace
from pathlib import Path
from reports.page import site
from reports.page.section import Content
from reports.papers.errata import ERRATA
build = lambda inputs: Content({"value": len(inputs.results[sys.argv[3]])}, sentences=["A planted sentence."])
planted = replace(ERRATA, id="planted", title="Planted", needs=tuple(sys.argv[2].split()), build=build)
site.SECTIONS = (planted, *site.SECTIONS)
site.build(Path(sys.argv[1]), "index.html", [], [], True)
"""
"""Builds the page with one more section, with the template of that on misprints."""


@pytest.mark.parametrize(
    ("needs", "used", "says"),
    [
        ("tests", "tests", "UndefinedError: 'errata' is undefined"),
        ("tests", "accuracy", "KeyError: 'accuracy'"),
        ("misprints", "misprints", "no such group of stages: 'misprints'"),
    ],
)
def test_a_section_gets_what_it_declares(tmp_path, needs, used, says):
    """A result it does not name, a group that is not there or a variable that it does not give stop the page."""
    run = subprocess_of(SECTION, tmp_path, needs, used)
    assert run.returncode == 1 and says in run.stderr


# ---------------------------------------------------------------- lines to paste
@pytest.fixture(scope="module")
def scene_page(tmp_path_factory):
    """The page of the three shipped scenes at rest."""
    out = tmp_path_factory.mktemp("scenes")
    run = report(*(ROOT / "reference_data" / "scenes" / f"{name}.toml" for name in SCENES), "--out", out)
    assert run.returncode == 0, run.stderr
    return out, (out / f"scene-{'-'.join(SCENES)}.html").read_text(encoding="utf-8")


def test_lines_to_paste_run(scene_page):
    """The Python of every scene runs and gives the forces written beside it, within the tolerance of the scene."""
    _, text = scene_page
    blocks = [html.unescape(block) for block in re.findall(r"<pre>(.*?)</pre>", text, re.DOTALL)]
    assert len(blocks) == len(SCENES)
    for block in blocks:
        printed = [[float(v) for v in line.split("# ")[1].removesuffix(" N").split(", ")]
                   for line in block.splitlines() if line.startswith("state.tension")]  # fmt: skip
        results = []
        exec(
            block.replace("state.tension, state.H, state.V", "found.append((state.tension, state.H, state.V))"),
            {"found": results},
        )
        for got, wanted in zip(results, printed, strict=True):
            assert all(
                math.isclose(a, b, rel_tol=1e-5, abs_tol=1e-5 * wanted[0]) for a, b in zip(got, wanted, strict=True)
            )


def test_lines_to_paste_say_whose_they_are(scene_page, tmp_path):
    """They are of this project, also where another code that is brought is cheaper; then that code is named."""
    shipped, text = scene_page
    assert text.count("solved by this project with the cheapest of its own settings") == len(SCENES)
    (name, *_), out = SCENES, tmp_path / "out"
    shutil.copytree(shipped, out)
    path = out / "results" / f"scene_{name}.json"
    data = json.loads(path.read_text(encoding="utf-8"))
    row = {"solver": "theirs", "label": "another code", "tolerance": None, "error": 0.0, "seconds": 1e-9}
    data["lines"][0]["ladder"].append(row | {"verdict": "right", "message": ""})
    path.write_text(json.dumps(data), encoding="utf-8")
    run = report(ROOT / "reference_data" / "scenes" / f"{name}.toml", "--only", "machine", "--out", out)
    assert run.returncode == 0, run.stderr
    text = (out / f"scene-{name}.html").read_text(encoding="utf-8")
    assert f"cheaper still within it is another code on {data['lines'][0]['label']}." in text
    assert "solve_span(line" in text and "another code" not in re.search(r"<pre>(.*?)</pre>", text, re.DOTALL)[1]


def test_figures_have_their_data(scene_page):
    """Every figure has a CSV beside it that names its axes and holds as many values as are drawn."""
    out, text = scene_page
    names = set(re.findall(r'href="figures/([\w.-]+)\.svg"', text))
    assert len(names) >= 9
    for name in names:
        assert f'<a href="figures/{name}.csv">' in text
        with (out / "figures" / f"{name}.csv").open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        assert len(rows) >= 3 and all(row["x axis"] and row["y axis"] and row["x"] for row in rows)


def test_a_figure_without_units_is_refused(tmp_path):
    """An axis that does not say what it shows stops the page, and the message names figure and axis."""
    code = (
        "from pathlib import Path\nfrom reports.drawing import style\nfigure, axes = style.plt.subplots()\n"
        f"axes.plot([1, 2]); axes.set_xlabel('x, m')\nstyle.save(figure, Path({str(tmp_path)!r}), 'bare', 'Bare', "
        "'Bare.')"
    )
    run = subprocess_of(code)
    assert run.returncode == 1 and "figure 'bare': axes without a label" in run.stderr and ": y" in run.stderr


CHARTS = """
import json
import altair
from jsonschema import ValidationError
from reports.drawing import interactive
from reports.drawing.style import INK, PALETTE
looks = {"a": {"color": PALETTE[0], "marker": "o"}, "b": {"color": INK, "marker": "X"}}
point = {"method": "a", "setting": "</script>", "time_s": 1e-4, "error": 0.0, "front": "yes", "wrong": "yes", "rank": 0}
other = point | {"method": "b", "time_s": 1e-2, "error": 1e-3}
work = interactive.draw_work([point, other], looks, ("x", "y"), band=1e-5)
look = {"marker": "s", "size": 30, "fill": INK, "stroke": INK}
cells = [{"x": "1", "y": "2", "verdict": "solved", "error": 1e-3},
         {"x": "2", "y": "1", "verdict": "refused", "error": None}]
colours = interactive.Colours((-7, 1), "error", ("solved",))
ticks = ["1", "2"], ["1", "2"]
drawn = interactive.draw_map(cells, ("x", "y"), ticks, {"refused": look}, colours, ("y", 0.3))
point = {"series": "1 m", "bound": "least", "frequency_Hz": 0.1, "tension_kN": 9.0, "state": "stable"}
rows = [point, point | {"frequency_Hz": 0.2, "state": "unstable"}, point | {"frequency_Hz": 0.3, "state": "unstable"}]
special = [{"series": "1 m", "kind": "fold", "frequency_Hz": 0.15, "tension_kN": 9.0, "marker": "v"}]
curves = interactive.draw_curves(rows, special, {"1 m": PALETTE[0]}, ("x", "y"))
for text in (work, drawn, curves):
    assert "</" not in text and INK not in text, text
    spec = json.loads(text)
    altair.LayerChart.from_dict(spec, validate=True)
    try:
        altair.LayerChart.from_dict(spec | {"layer": [{"mark": "planted"}]}, validate=True)
    except ValidationError:
        continue
    raise SystemExit("a planted mark is no fault")
pieces = json.loads(curves)["datasets"]["pieces"]
print([(row["frequency_Hz"], row["state"], row["piece"]) for row in pieces])
print(interactive.list_decades(1e-16, 1.0), interactive.list_decades(3.0, 60.0))
try:
    interactive.draw_map(cells, ("x", "y"), (["1", "1"], ["1", "2"]), {}, colours)
except ValueError as error:
    print(error)
"""


def test_charts_are_vega_lite():
    """Every kind of chart is valid Vega-Lite in the colours of the page; lines change where stability does."""
    run = subprocess_of(CHARTS)
    assert run.returncode == 0, run.stderr
    pieces, ticks, error = run.stdout.splitlines()
    assert pieces == "[(0.1, 'stable', 0), (0.1, 'unstable', 1), (0.2, 'unstable', 1), (0.3, 'unstable', 1)]"
    assert ticks == "[1e-16, 1e-14, 1e-12, 1e-10, 1e-08, 1e-06, 0.0001, 0.01, 1.0] [5.0, 10.0, 20.0, 50.0]"
    assert error == "x: two cells have the same label: 1, 1"


def subprocess_of(code: str, *arguments):
    """A process of its own: verification imports no reports."""
    command = [sys.executable, "-c", code, *map(str, arguments)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60)


# ---------------------------------------------------------------- fronts
FRONTS = """
from reports.page.numbers.pareto import moving_fronts
P = lambda who, seconds, rms: {"method": who, "case": "c", "seconds": seconds, "rms": rms, "error": 3 * rms}
ours = [P("harmonic balance", 1.0, 1e-2), P("time domain", 4.0, 1e-4)]
ahead, = moving_fronts(ours + [P("MoorDyn", 5.0, 1e-3)], {"c": "C"})
print(ahead.sentence)
behind, = moving_fronts(ours + [P("MoorDyn", 2.0, 1e-3)], {"c": "C"})
print(behind.ours, behind.points, behind.sentence)
alone, = moving_fronts(ours + [P("MoorDyn", 9.0, 1e-6)], {"c": "C"})
print(alone.sentence)
wrong, = moving_fronts(ours + [P("MoorDyn", 0.1, 0.5)], {"c": "C"})
print(wrong.points, wrong.sentence)
"""


def test_words_on_the_front_follow_the_points():
    """Ahead at every error; behind at some, with both times, or with no setting; a wrong answer is ahead of nobody."""
    ahead, behind, alone, wrong = subprocess_of(FRONTS).stdout.splitlines()
    assert wrong == f"2 {ahead}"
    assert ahead == "C: this project is the fastest at every error that any code reaches"
    assert behind == ("2 3 C: from an error of 0.0010 up to 0.010 MoorDyn takes 2.00 s, this project 4.00 s (2 times)")
    assert alone == "C: from an error of 1.0e-6 up to 1.0e-4 MoorDyn takes 9.00 s, this project has no setting"


PACK = "import sys; from pathlib import Path; from reports.pipeline.pack import pack; print(pack(Path(sys.argv[1])))"


def test_the_packed_report_is_whole_elsewhere(bare, tmp_path):
    """The zip unpacks to the folder of the report, in which every link leads to a file or an anchor."""
    out, _ = bare
    path = subprocess_of(PACK, out).stdout.strip()
    shutil.unpack_archive(path, tmp_path)
    unpacked = tmp_path / out.name
    assert (unpacked / "search.js").is_file() and len(list(unpacked.glob("*.html"))) == len(list(out.glob("*.html")))
    assert broken_links(unpacked) == [] and missing_files(Page(read_site(unpacked)), unpacked) == []
    (unpacked / "figures").mkdir(exist_ok=True)
    next(unpacked.glob("tables/*.csv")).unlink()
    assert missing_files(Page(read_site(unpacked)), unpacked)


CLAIM_MAP = """
import sys
from pathlib import Path
from reports.evidence.claim_map import CLAIM_MAP
from reports.page.section import Inputs
names = dict.fromkeys(CLAIM_MAP.needs)
laboratory = {"greatest": float(sys.argv[2]), "band": 0.06, "rows": [1]}
inputs = Inputs(names | {"mooring": {"laboratory": laboratory}}, {}, Path(), Path(sys.argv[1]), {}, [])
for row in CLAIM_MAP.build(inputs).context["claim_map"].rows:
    print(row["kind"], row["value"], row["within"], sep="; ")
print(CLAIM_MAP.build(Inputs(names, {}, Path(), Path(sys.argv[1]), {}, [])).context["claim_map"])
"""


@pytest.mark.parametrize(("deviation", "words"), [("0.012", "1.2 %; yes"), ("0.34", "34.0 %; no")])
def test_the_map_of_claims_follows_the_results(tmp_path, deviation, words):
    """A measured history is validation, with its deviation and whether it is within its bound; without results none."""
    row, nothing = subprocess_of(CLAIM_MAP, tmp_path, deviation).stdout.splitlines()
    assert row == f"validation: measured; {words}" and nothing == "None"
