"""Builds the report, a site of pages, or one page of somebody's lines: loads results, builds sections, renders them."""

from __future__ import annotations

from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from ..drawing import background, style
from ..front.answers import Answer, answer_questions
from ..pipeline.dependencies.ledger import write_atomically
from ..pipeline.running.runner import Ended
from ..pipeline.stages import Stage
from . import charts
from .navigation import search
from .navigation.claim_links import link_tests
from .navigation.claims import claim_id, file_id
from .navigation.links import link_pages
from .numbers import analysis, formatting
from .registry import SCENE_SECTIONS, SECTIONS
from .results import Results
from .section import PAGES, Content, Inputs, Section
from .section_cache import Built, SectionCache

TEMPLATES = Path(__file__).parent / "templates"
INDEX, SEARCH = "index.html", "search.js"


def build(out: Path, name: str, stages: list[Stage], ended: list[Ended], whole: bool) -> Path:
    """Write the pages with their figures and tables into ``out``; return the first one.

    name : file of the page of scenes; whole: the report instead, whose pages are named in PAGES.
    """
    results = Results(out, stages, ended)
    for folder in ("figures", "tables"):
        (out / folder).mkdir(parents=True, exist_ok=True)
    looks, environment = _assign_looks(results), _environment()
    if not whole:
        write_atomically(out / name, _scene_page(results, looks, out, environment))
        return out / name
    cache = SectionCache(out, results, looks)
    kept = {section.id: cache.load(section) for section in SECTIONS}
    built = _build_all([s for s in SECTIONS if kept[s.id] is None], results, looks, out, environment)
    sections = [(s, kept[s.id] or cache.keep(s, built[s.id])) for s in SECTIONS]
    try:
        answers = answer_questions(results, sections, out / "figures")
    finally:
        background.finish()
    cache.write()
    pages = _pages(results, sections, answers, environment)
    for file, text in pages.items():
        write_atomically(out / file, text)
    if any(map(charts.has_charts, pages.values())):
        charts.write_script(out)
    return out / INDEX


def _build_all(sections: list[Section], results: Results, looks: dict, out: Path, environment: Environment):
    """Return id -> section, rendered side by side."""
    _ = results.questions, results.stage_table  # which all ask for: read before the processes are forked
    made = background.for_each(lambda i: _build(sections[i], results, looks, out, environment), len(sections))
    return {section.id: built for section, built in zip(sections, made, strict=True)}


def _inputs(section: Section, results: Results, looks: dict, out: Path) -> Inputs:
    return Inputs(
        results={group: results.load(group) for group in section.needs},
        looks=looks,
        figures=out / "figures",
        tables=out / "tables",
        notes=results.notes,
        stages=results.stage_table,
    )


def _assign_looks(results: Results) -> dict:
    """Return one colour and marker for every solver of lines at rest, the same in all sections."""
    scenes = [scene for group in ("scenes", "moving_scene") for scene in (results.load(group) or {}).values()]
    names = {point["solver"] for scene in scenes for line in scene["lines"] for point in line["ladder"]}
    names |= set((results.load("accuracy") or {}).get("solvers", ()))
    names |= {point["solver"] for point in (results.load("work_precision") or {}).get("points", ())}
    return style.assign_looks(names | {analysis.OURS, f"{analysis.OURS}-batch"})


def _build(section: Section, results: Results, looks: dict, out: Path, environment: Environment) -> Built:
    """Return a section of the report, rendered."""
    content = section.build(_inputs(section, results, looks, out))
    links = link_tests(section.tests, results.questions)
    text = _render(section, content, environment, links=links, notes=results.notes, whole=True)
    return Built(search.name_headings(text, section.id, formatting.slug), content.verdicts, content.sentences,
                 content.figures)  # fmt: skip


def _render(section: Section, content: Content, environment: Environment, **more) -> str:
    return environment.get_template(section.template).render(content.context, **more)


def _pages(results: Results, sections: list[tuple[Section, Built]], answers: list[Answer], environment: Environment):
    """Return file -> text of every page that has a section, of the index and of what a reader can search for."""
    titles = {page: title for page, title in PAGES.items() if any(s.page == page for s, _ in sections)}
    shared = {
        **_shared_by_all(),
        "search": (TEMPLATES / "search.js").read_text(encoding="utf-8"),
        "navigation": [(INDEX, "Summary"), *((f"{page}.html", title) for page, title in titles.items())],
        "failures": results.failures(),
    }
    pages = {INDEX: environment.get_template("page/templates/index.html.j2").render(shared, current=INDEX,
                                                                                   answers=answers)}  # fmt: skip
    template = environment.get_template("page/templates/page.html.j2")
    for page, title in titles.items():
        mine = [(section, built) for section, built in sections if section.page == page]
        pages[f"{page}.html"] = template.render(
            shared | {"failures": []},
            current=f"{page}.html",
            page=page,
            title=title,
            sections=[built.text for _, built in mine],
            charts=charts.FILE if any(charts.has_charts(built.text) for _, built in mine) else "",
            sentences=[sentence for _, built in mine for sentence in built.sentences],
            verdicts=[verdict for _, built in mine for verdict in built.verdicts],
            contents=[(section.id, section.title) for section, _ in mine],
        )
    pages = link_pages(pages)
    entries = [entry for file, text in pages.items() for entry in search.titles_of(file, text)]
    tests = next((section.page for section, _ in sections if "tests" in section.needs and section.id == "claims"), None)
    entries += search.claims_of(results.questions, f"{tests}.html") if tests else []
    return pages | {SEARCH: search.script(entries)}


def _shared_by_all() -> dict[str, str]:
    """Return style and script of every page, which has no charts where it does not say so."""
    style, script = ((TEMPLATES / name).read_text(encoding="utf-8") for name in ("style.css", "page.js"))
    return {"style": style, "page_script": script, "charts": ""}


def _scene_page(results: Results, looks: dict, out: Path, environment: Environment) -> str:
    try:
        contents = [(section, section.build(_inputs(section, results, looks, out))) for section in SCENE_SECTIONS]
    finally:
        background.finish()
    more = {"notes": results.notes, "whole": False}
    return environment.get_template("page/templates/scenes.html.j2").render(
        **_shared_by_all(),
        failures=results.failures(),
        sections=[
            _render(s, content, environment, links=dict.fromkeys(s.tests, ()), **more) for s, content in contents
        ],
        titles=list(
            dict.fromkeys(
                shown["data"]["name"]
                for key in ("scenes", "networks", "tables_of_cases")
                for shown in _shown_files(contents, key)
            )
        ),
        has_scenes=bool(_shown_files(contents, "scenes")),
    )


def _shown_files(contents, key: str) -> list[dict]:
    """Return what the sections show under a key of their templates: files, each with its data."""
    return [shown for section, content in contents if section.template.startswith("scenes/")
            for shown in content.context.get(key) or ()]  # fmt: skip


def _environment() -> Environment:
    """Return the templates of all rooms, named from the folder ``reports`` on, with the filters they use."""
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES.parents[1]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "number": formatting.number,
        "seconds": formatting.seconds,
        "slug": formatting.slug,
        "plural": formatting.plural,
        "plain": "{:g}".format,
        "first_sentence": formatting.split_sentence,
        "claim_id": claim_id,
        "file_id": file_id,
    }
    return environment
