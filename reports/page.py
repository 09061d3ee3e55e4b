"""Builds the page from what is in the folder of results: loads, draws, fills the template."""

from __future__ import annotations

import json
import tomllib
from dataclasses import replace
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from . import (
    analysis,
    defects,
    dynamics,
    figures,
    networks,
    published,
    scene_dynamics,
    scene_figures,
    scene_tables,
    stability,
    style,
    tables,
    verdicts,
    words,
)
from .claims import OUTCOMES, questions
from .ledger import Ledger, write_atomically
from .runner import Ended
from .sources import ROOT
from .stages import DYNAMICS, GROUPS, Stage

TEMPLATES = Path(__file__).parent / "templates"
_SINGLE = {"accuracy": "accuracy", "benchmarks": "benchmark", "work_precision": "work_precision", "speed": "speed"}


class Results:
    """What there is: parsed result files and, for every group of stages, what is not as it should be."""

    def __init__(self, out: Path, stages: list[Stage], ended: list[Ended]):
        self.folder, self.stages = out / "results", stages
        self.ledger = Ledger(self.folder)
        self.ended = {end.stage.name: end for end in ended}
        self.notes = {group: self._notes(group) for group in GROUPS}

    def _notes(self, group: str) -> list[str]:
        """What is not as it should be in a group of stages, each kind of trouble once."""
        troubles = {}
        for stage in self.stages:
            if stage.group == group and (trouble := self._trouble(stage)):
                troubles.setdefault(trouble, []).append(stage.title)
        return [f"{trouble}: {', '.join(titles)}." for trouble, titles in troubles.items()]

    def _trouble(self, stage: Stage) -> str:
        end, there = self.ended.get(stage.name), (self.folder / stage.output).exists()
        if end and end.state == "failed":
            return "Failed in this run; what is shown is from an earlier one" if there else "Failed; nothing to show"
        if not there:
            return "Not run yet; nothing to show"
        return "" if self.ledger.valid(stage) else "Last run on other sources or on another machine"

    def json(self, stage: str) -> dict | None:
        """Content of the stage's file; None where there is none or it cannot be read."""
        output = next((s.output for s in self.stages if s.name == stage), None)
        try:
            return json.loads((self.folder / output).read_text(encoding="utf-8")) if output else None
        except (OSError, ValueError):
            return None

    def outcomes(self) -> list[Path]:
        """The files that the tests left, one for each file of tests."""
        paths = (self.folder / stage.output for stage in self.stages if stage.group == "tests")
        return [path for path in paths if path.exists()]

    def scenes(self, group: str) -> dict[str, dict]:
        """Stem -> result of the scenes that were computed, with their file."""
        mine = [stage for stage in self.stages if stage.group == group]
        found = {stage.name.removeprefix("scene_"): (self.json(stage.name), stage) for stage in mine}
        return {stem: data | {"path": stage.arguments[1]} for stem, (data, stage) in found.items() if data}


def build(out: Path, name: str, stages: list[Stage], ended: list[Ended], whole: bool) -> Path:
    """Write the page ``name`` with its figures and tables into ``out``; whole: the report, else a page of scenes."""
    results = Results(out, stages, ended)
    folders = [out / "figures", out / "tables"]
    for folder in folders:
        folder.mkdir(parents=True, exist_ok=True)
    context = _common(results, *folders)
    if whole:
        context |= _whole(results, context["looks"], *folders)
    template = _templates().get_template("index.html.j2" if whole else "scenes.html.j2")
    text = template.render(context)
    write_atomically(out / name, _with_dynamics(text, context) if whole else text)
    return out / name


def _with_dynamics(text: str, context: dict) -> str:
    """The page with the sections on moving cables, before that on misprints, and links to them."""
    sections = _templates().get_template("dynamics.html.j2").render(context)
    links = '<a href="#dynamics">Moving cable</a><a href="#harmonic">Harmonic balance</a>'
    sections += _templates().get_template("stability.html.j2").render(context)
    links += '<a href="#stability">Stability</a><a href="#defects">Seeded defects</a>'
    sections += _templates().get_template("defects.html.j2").render(context)
    for mark, new in (('<a href="#errata">', links), ('<h2 id="errata">', sections)):
        text = text.replace(mark, new + mark, 1)
    return text


def _templates() -> Environment:
    templates = Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    templates.filters |= {
        "number": words.number,
        "seconds": words.seconds,
        "slug": words.slug,
        "plural": words.plural,
        "plain": "{:g}".format,
    }
    return templates


def _common(results: Results, figure_folder: Path, table_folder: Path) -> dict:
    """What both kinds of page show."""
    accuracy, scenes = results.json("accuracy"), results.scenes("scenes")
    names = {p["solver"] for scene in scenes.values() for line in scene["lines"] for p in line["ladder"]}
    work = results.json("work_precision")
    names |= set((accuracy or {}).get("solvers", ())) | {p["solver"] for p in (work or {}).get("points", ())}
    looks = style.looks(names | {analysis.OURS, f"{analysis.OURS}-batch"})  # the same on every page
    return {
        "looks": looks,
        "style": (TEMPLATES / "style.css").read_text(encoding="utf-8"),
        "notes": results.notes,
        "failures": [end for end in results.ended.values() if end.state == "failed"],
        "scenes": [_scene(scene, stem, looks, figure_folder, table_folder) for stem, scene in scenes.items()],
        "machine": results.json("machine"),
        "stages": _stages(results),
    }


def _stages(results: Results) -> list[dict]:
    """The stages as they were run last, the tests as one."""
    shown = [_stage(results, stage) for stage in results.stages if stage.group != "tests"]
    tests = [_stage(results, stage) for stage in results.stages if stage.group == "tests"]
    ran = [entry for entry in tests if entry["finished"]]
    if not tests:
        return shown
    whole = {"title": f"verification tests, {len(ran)} of {len(tests)} files", "command": "python -m pytest verification",
             "seconds": sum(entry["seconds"] for entry in ran) if ran else None,
             "finished": max((entry["finished"] for entry in ran), default=None),
             "load": ran[0]["load"] if ran else None}  # fmt: skip
    return [whole, *shown]


def _stage(results: Results, stage: Stage) -> dict:
    entry = results.ledger.entries.get(stage.name, {})
    command = replace(stage, arguments=tuple(entry.get("arguments", stage.arguments))).shown
    return {"title": stage.title, "command": command} | {key: entry.get(key) for key in ("seconds", "finished", "load")}


def _scene(scene: dict, stem: str, looks: dict, figure_folder: Path, table_folder: Path) -> dict:
    place = _place(Path(scene["path"]), stem)
    shown = {
        "profiles": scene_figures.profiles(scene, place, figure_folder),
        "ladder": scene_figures.ladder(scene, place, looks, figure_folder),
        "tables": scene_tables.scene_tables(scene, stem, table_folder),
        "warnings": list(dict.fromkeys(text for line in scene["lines"] for text in line["warnings"])),
        "dynamics": scene_dynamics.section(scene, stem, figure_folder, table_folder),
    }
    return {"stem": stem, "data": scene, **shown}


def _place(path: Path, stem: str) -> dict:
    """Heights that the scene file gives: those of the anchor, the seabed and the still water, m."""
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        anchor, depth = float(data["ends"]["anchor"][2]), data.get("environment", {}).get("depth")
    except (OSError, ValueError, KeyError, IndexError, TypeError):
        return {"stem": stem, "anchor_z": 0.0, "seabed": None, "water": None, "z_note": " above the anchor"}
    return {
        "stem": stem,
        "anchor_z": anchor,
        "seabed": None if depth is None else -float(depth),
        "water": 0.0,
        "z_note": "",
    }


def _whole(results: Results, looks: dict, figure_folder: Path, table_folder: Path) -> dict:
    """The sections about solvers and papers."""
    data = {name: results.json(name) for name in _SINGLE}
    accuracy, work, speed = data["accuracy"], data["work_precision"], data["speed"]
    timings = analysis.benchmark_rows(data["benchmarks"]) if data["benchmarks"] else []
    outcomes = results.outcomes()
    found = questions(ROOT / "verification", outcomes)
    errata = tomllib.loads((ROOT / "reference_data" / "errata.toml").read_text(encoding="utf-8"))
    moving = dynamics.section({name: results.json(name) for name in DYNAMICS}, figure_folder, table_folder)
    made = {
        "totals": tables.totals(accuracy) if accuracy else None,
        "regimes": tables.regimes(accuracy) if accuracy else None,
        "speed_table": tables.speed(speed) if speed else None,
        "timings": tables.timings(timings) if timings else None,
        "work_table": tables.work_points(work) if work else None,
        "claims_table": tables.claims(found),
        "errata": tables.errata(errata, found),
    }
    for table in made.values():
        if table:
            table.write(table_folder)
    return made | moving | {
        "questions": found,
        "counts": {outcome: sum(question.total(outcome) for question in found) for outcome in OUTCOMES},
        "verdicts": [*verdicts.strip(accuracy, speed, found, bool(outcomes)), *moving["dynamics_verdicts"],
                     *stability.verdicts(results.json("stability")), *defects.verdicts(results.json("defects"))],
        "accuracy": accuracy,
        "finding": verdicts.sentence(accuracy) if accuracy else None,
        "examples": _examples(accuracy) if accuracy else [],
        "speed": speed,
        "work": figures.work_precision(work, looks, figure_folder) if work else None,
        "map": figures.error_map(accuracy, looks, figure_folder) if accuracy else None,
        "cold": figures.cold_times(timings, looks, figure_folder) if timings else None,
        "networks": networks.section(results.json("networks"), looks, figure_folder, table_folder),
        "published": _published(results, table_folder),
        "stability": stability.section(results.json("stability"), figure_folder, table_folder),
        "defects": defects.section(results.json("defects"), table_folder),
    }


def _examples(accuracy: dict) -> list[dict]:
    """For every other solver: its counts and inputs that reproduce a wrong answer."""
    found = []
    for name in analysis.sort_solvers(accuracy["solvers"]):
        rows = analysis.everyday_wrong(accuracy, name)
        shown = [row | {"answer": row["answers"][name], "call": _call(name, row["inputs"])} for row in rows]
        if name != analysis.OURS:
            found.append({"name": name, **accuracy["solvers"][name], "rows": shown})
    return found


def _call(name: str, inputs: dict) -> str:
    """Python to paste: the other code and this project on the same inputs."""
    arguments = ", ".join(f"{key}={value!r}" for key, value in inputs.items())
    return (
        f"from benchmarks.peers import {name}\nfrom solvers import Span, solve_span\n"
        f"from verification.cases.spans import SpanCase\ninputs = dict({arguments})\n"
        f'{name}.solve(SpanCase("example", "", **inputs)), solve_span(Span(**inputs))'
    )


def _published(results: Results, table_folder: Path) -> list[dict]:
    """Every published set with its source and, where its lines were computed, the comparison."""
    scenes, found = results.scenes("published"), []
    for name in published.SETS:
        source, _ = published.read(name)
        rows = published.compare(name, scenes)
        if source:
            table = tables.published(name, rows).write(table_folder) if rows else None
            found.append({"name": name, "source": source, "table": table, "within": sum(row["within"] for row in rows)})
    return found
