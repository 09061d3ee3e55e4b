"""Builds the page: loads the results that each section needs, builds the sections and renders their templates."""

from __future__ import annotations

from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from ..drawing import background, style
from ..pipeline.ledger import write_atomically
from ..pipeline.runner import Ended
from ..pipeline.stages import Stage
from . import analysis, formatting
from .claim_links import link_tests
from .claims import claim_id, file_id
from .registry import SCENE_SECTIONS, SECTIONS
from .results import Results
from .section import PARTS, Content, Inputs, Section
from .summary import answer_questions

TEMPLATES = Path(__file__).parent / "templates"


def build(out: Path, name: str, stages: list[Stage], ended: list[Ended], whole: bool) -> Path:
    """Write the page ``name`` with its figures and tables into ``out``; whole: the report, else a page of scenes."""
    results = Results(out, stages, ended)
    for folder in ("figures", "tables"):
        (out / folder).mkdir(parents=True, exist_ok=True)
    looks = _assign_looks(results)
    try:
        contents = [(section, section.build(_inputs(section, results, looks, out)))
                    for section in (SECTIONS if whole else SCENE_SECTIONS)]  # fmt: skip
    finally:
        background.finish()
    write_atomically(out / name, _render(results, contents, whole))
    return out / name


def _inputs(section: Section, results: Results, looks: dict, out: Path) -> Inputs:
    return Inputs(
        results={group: results.load(group) for group in section.needs},
        looks=looks,
        figures=out / "figures",
        tables=out / "tables",
        notes=results.notes,
        stages=results.stage_table(),
    )


def _assign_looks(results: Results) -> dict:
    """Return one colour and marker for every solver of lines at rest, the same in all sections."""
    scenes = [scene for group in ("scenes", "moving_scene") for scene in (results.load(group) or {}).values()]
    names = {point["solver"] for scene in scenes for line in scene["lines"] for point in line["ladder"]}
    names |= set((results.load("accuracy") or {}).get("solvers", ()))
    names |= {point["solver"] for point in (results.load("work_precision") or {}).get("points", ())}
    return style.assign_looks(names | {analysis.OURS, f"{analysis.OURS}-batch"})


def _render(results: Results, contents: list[tuple[Section, Content]], whole: bool) -> str:
    environment = _environment()
    parts = {part: [] for part in PARTS}
    for section, content in contents:
        links = link_tests(section.tests, results.questions) if whole else dict.fromkeys(section.tests, ())
        template = environment.get_template(section.template)
        text = template.render(content.context, links=links, notes=results.notes, whole=whole)
        parts[section.part].append((section, text))
    page = environment.get_template("page/templates/index.html.j2" if whole else "page/templates/scenes.html.j2")
    return page.render(
        style=(TEMPLATES / "style.css").read_text(encoding="utf-8"),
        failures=results.failures(),
        questions=PARTS,
        parts=parts,
        answers=answer_questions(contents),
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
        "claim_id": claim_id,
        "file_id": file_id,
    }
    return environment
