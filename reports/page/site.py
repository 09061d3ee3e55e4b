"""Builds the page from what is in the folder of results: loads, draws, fills the template."""

from __future__ import annotations

import json
import tomllib
from dataclasses import asdict, replace
from importlib.resources import files
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from ..cable import section as dynamics
from ..cable.figures import CASES
from ..catenary import figures
from ..drawing import background, style
from ..evidence import defects, papers, peers, published
from ..network import section as networks
from ..pipeline.ledger import Ledger, write_atomically
from ..pipeline.runner import Ended
from ..pipeline.sources import ROOT
from ..pipeline.stages import DYNAMICS, GROUPS, Stage
from ..scenes import dynamics as scene_dynamics
from ..scenes import figures as scene_figures
from ..scenes import tables as scene_tables
from ..stability import section as stability
from . import analysis, summary, tables, verdicts
from . import claim_links as evidence
from . import formatting as words
from . import pareto as fronts
from .claims import OUTCOMES, questions

TEMPLATES = Path(str(files("reports") / "templates"))
_SINGLE = ("accuracy", "benchmarks", "work_precision", "speed", "networks", "defects", *DYNAMICS)
SECTIONS = {
    "verified": {"claims": "Claims and tests", "regimes": "Lines against 50 digits", "defects": "Seeded defects"},
    "error-for-time": {"work-precision": "Lines at rest", "networks": "Networks", "dynamics": "Moving cable in time",
                       "harmonic": "Harmonic balance", "scenes": "Scenes"},
    "papers": {"items": "Item by item", "errata": "Misprints", "published": "Published values"},
    "breaks": {"stability": "Stability maps"},
    "peers": {"other-codes": "Other codes"},
    "trust": {"machine": "Machine, how to repeat"},
}  # fmt: skip
"""Part of the page -> id and short title of its sections, in the order of the templates."""


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

    def json(self, name: str) -> dict | None:
        """Content of the file of a stage, or of all files of a group together; None where there is none to be read."""
        found = [self._read(stage.output) for stage in self.stages if name in (stage.name, stage.group)]
        return {key: value for file in found if file for key, value in file.items()} or None

    def _read(self, output: str) -> dict | None:
        try:
            return json.loads((self.folder / output).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None

    def outcomes(self) -> list[Path]:
        """The files that the tests left, one for each file of tests."""
        paths = (self.folder / stage.output for stage in self.stages if stage.group == "tests")
        return [path for path in paths if path.exists()]

    def scenes(self, *groups: str) -> dict[str, dict]:
        """Stem -> result of the scenes that were computed, with their file."""
        mine = [stage for stage in self.stages if stage.group in groups]
        found = {stage.name.removeprefix("scene_"): (self.json(stage.name), stage) for stage in mine}
        return {stem: data | {"path": stage.arguments[1]} for stem, (data, stage) in found.items() if data}


def build(out: Path, name: str, stages: list[Stage], ended: list[Ended], whole: bool) -> Path:
    """Write the page ``name`` with its figures and tables into ``out``; whole: the report, else a page of scenes."""
    results = Results(out, stages, ended)
    folders = [out / "figures", out / "tables"]
    for folder in folders:
        folder.mkdir(parents=True, exist_ok=True)
    try:
        context = _common(results, *folders)
        if whole:
            context |= _whole(results, context["looks"], context, *folders)
    finally:
        background.finish()
    template = _templates().get_template("index.html.j2" if whole else "scenes.html.j2")
    text = template.render(context)
    write_atomically(out / name, text)
    return out / name


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
    accuracy, scenes = results.json("accuracy"), results.scenes("scenes", "moving_scene")
    names = {p["solver"] for scene in scenes.values() for line in scene["lines"] for p in line["ladder"]}
    work = results.json("work_precision")
    names |= set((accuracy or {}).get("solvers", ())) | {p["solver"] for p in (work or {}).get("points", ())}
    looks = style.looks(names | {analysis.OURS, f"{analysis.OURS}-batch"})  # the same on every page
    return {
        "looks": looks,
        "style": (TEMPLATES / "style.css").read_text(encoding="utf-8"),
        "notes": results.notes,
        "failures": [
            {"title": end.stage.title, "command": end.stage.shown(results.folder), "tail": end.tail}
            for end in results.ended.values()
            if end.state == "failed"
        ],
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
    whole = {"title": f"verification tests, {len(ran)} of {len(tests)} stages",
             "command": "python -m pytest verification",
             "seconds": sum(entry["seconds"] for entry in ran) if ran else None,
             "finished": max((entry["finished"] for entry in ran), default=None),
             "load": ran[0]["load"] if ran else None}  # fmt: skip
    return [whole, *shown]


def _stage(results: Results, stage: Stage) -> dict:
    entry = results.ledger.entries.get(stage.name, {})
    command = replace(stage, arguments=tuple(entry.get("arguments", stage.arguments))).shown(results.folder)
    return {"title": stage.title, "command": command} | {key: entry.get(key) for key in ("seconds", "finished", "load")}


def _scene(scene: dict, stem: str, looks: dict, figure_folder: Path, table_folder: Path) -> dict:
    place = _place(Path(scene["path"]), stem)
    shown = {
        "profiles": scene_figures.profiles(scene, place, figure_folder),
        "ladder": scene_figures.ladder(scene, place, looks, figure_folder),
        "tables": scene_tables.scene_tables(scene, stem, table_folder),
        "warnings": list(dict.fromkeys(text for line in scene["lines"] for text in line["warnings"])),
        "paste": _whose_lines(scene),
        "python": _lines_to_paste(scene),
        "dynamics": scene_dynamics.section(scene, stem, figure_folder, table_folder),
    }
    return {"stem": stem, "data": scene, **shown}


def _lines_to_paste(scene: dict) -> str:
    """Python with the cheapest setting of this project that meets the tolerance, line by line."""
    text = ["from solvers import Span, solve_span", ""]
    for line in scene["lines"]:
        arguments = ", ".join(f"{key}={value!r}" for key, value in line["inputs"].items())
        best = _own_cheapest(line, scene["tolerance"])
        setting = f", tolerance={best['tolerance']!r}" if best and best["tolerance"] is not None else ""
        text += [f"line = Span({arguments})  # {line['label'] or scene['name']}",
                 f"state = solve_span(line{setting})",
                 "state.tension, state.H, state.V  # "
                 f"{line['tension']:.7g}, {line['H']:.7g}, {line['V']:.7g} N"]  # fmt: skip
    return "\n".join(text)


def _own_cheapest(line: dict, tolerance: float) -> dict | None:
    return analysis.cheapest([p for p in line["ladder"] if p["solver"] == analysis.OURS], tolerance)


def _whose_lines(scene: dict) -> str:
    """Whose setting there is to paste, and the other codes that are cheaper within the tolerance."""
    tolerance, cheaper = scene["tolerance"], {}
    for line in scene["lines"]:
        best = analysis.cheapest(line["ladder"], tolerance)
        if best and best["solver"] != analysis.OURS:
            cheaper.setdefault(best["label"], []).append(line["label"] or scene["name"])
    none = [line["label"] or scene["name"] for line in scene["lines"] if not _own_cheapest(line, tolerance)]
    said = "The line at rest, solved by this project with the cheapest of its own settings that meet the tolerance of "
    said += words.number(tolerance, 1) + (f" (its default where none does: {', '.join(none)})" if none else "")
    others = [f"cheaper still within it is {label} on {', '.join(lines)}" for label, lines in cheaper.items()]
    return "; ".join([said, *others]) + "."


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


def _whole(results: Results, looks: dict, common: dict, figure_folder: Path, table_folder: Path) -> dict:
    """All that the whole page shows beside what is common to all pages."""
    data = {name: results.json(name) for name in _SINGLE}
    outcomes = results.outcomes()
    found = questions(ROOT / "verification", outcomes)
    made = (
        _tables(data, found, common, table_folder)
        | dynamics.section({name: data[name] for name in DYNAMICS}, figure_folder, table_folder)
        | _sections(data, looks, figure_folder, table_folder)
        | _papers(data, found, table_folder)
        | {
            "questions": found,
            "counts": {outcome: sum(question.total(outcome) for question in found) for outcome in OUTCOMES},
            "evidence": evidence.links(found),
            "parts": summary.PARTS,
            "sections": SECTIONS,
            "hb": {"frequency": published.read("hb_paper")[0]["cases"]["case 1"]["Y"][1]},
            "published": _published(results, table_folder),
        }
    )
    made["verdicts"] = [
        *verdicts.strip(data["accuracy"], data["speed"], found, bool(outcomes)),
        *summary.front_verdicts(data),
        *(made["networks"] or {}).get("verdicts", ()),
        *made["dynamics_verdicts"],
        summary.paper_verdict(made["papers"]),
        *stability.verdicts(data["stability"]),
        *defects.verdicts(data["defects"]),
    ]
    return made | {"answers": summary.answers(common | made, data)}


def _tables(data: dict, found: list, common: dict, folder: Path) -> dict:
    """The tables about lines at rest, tests, misprints and other codes, written."""
    accuracy, work, speed = data["accuracy"], data["work_precision"], data["speed"]
    timings = analysis.benchmark_rows(data["benchmarks"]) if data["benchmarks"] else []
    errata = tomllib.loads((files("reference_data") / "errata.toml").read_text(encoding="utf-8"))
    versions = (common["machine"] or {}).get("versions", {})
    made = {
        "totals": tables.totals(accuracy) if accuracy else None,
        "regimes": tables.regimes(accuracy) if accuracy else None,
        "speed_table": tables.speed(speed) if speed else None,
        "timings": tables.timings(timings) if timings else None,
        "work_table": tables.work_points(work) if work else None,
        "claims_table": tables.claims(found),
        "errata": tables.errata(errata, found),
        "peers_table": peers.table(accuracy, work, data["networks"], data["harmonic_balance"], versions),
    }
    for table in made.values():
        if table:
            table.write(folder)
    return made


def _sections(data: dict, looks: dict, figure_folder: Path, table_folder: Path) -> dict:
    """The sections with figures about lines at rest, networks, limits and planted mistakes."""
    accuracy, work, moving = data["accuracy"], data["work_precision"], data["harmonic_balance"]
    timings = analysis.benchmark_rows(data["benchmarks"]) if data["benchmarks"] else []
    points = ((moving or {}).get("work") or {}).get("points")
    return {
        "accuracy": accuracy,
        "finding": verdicts.sentence(accuracy) if accuracy else None,
        "examples": _examples(accuracy) if accuracy else [],
        "speed": data["speed"],
        "work": figures.work_precision(work, looks, figure_folder) if work else None,
        "static_fronts": fronts.static(work["points"]) if work else [],
        "moving_fronts": fronts.moving(points, CASES) if points else [],
        "map": figures.error_map(accuracy, looks, figure_folder) if accuracy else None,
        "cold": figures.cold_times(timings, looks, figure_folder) if timings else None,
        "networks": networks.section(data["networks"], looks, figure_folder, table_folder),
        "stability": stability.section(data["stability"], figure_folder, table_folder),
        "defects": defects.section(data["defects"], table_folder),
    }


def _papers(data: dict, found: list, table_folder: Path) -> dict:
    """The items of the papers, the links to their tests, and their table as a file."""
    items = papers.items(data["dynamics"], data["harmonic_balance"], data["networks"])
    columns = {key: key for key in ("paper", "item", "prints", "found", "verdict", "why", "section", "tests")}
    rows = [asdict(item) | {"tests": " ".join(item.tests)} for item in items]
    return {
        "papers": items,
        "paper_tests": [[evidence.link(test, found) for test in item.tests] for item in items],
        "papers_table": tables.Table("papers", "Items of the papers", columns, rows).write(table_folder),
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
        "from benchmarks.peers import adapters\nfrom solvers import Span, solve_span\n"
        f"from verification.cases.spans import SpanCase\ninputs = dict({arguments})\n"
        f'adapters()["{name}"].span(SpanCase("example", "", **inputs)), solve_span(Span(**inputs))'
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
