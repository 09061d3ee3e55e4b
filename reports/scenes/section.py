"""The section on scenes: every line of a scene file at rest, and in motion where the file has one."""

from __future__ import annotations

import tomllib
from pathlib import Path

from ..page.numbers import analysis
from ..page.numbers.formatting import number
from ..page.section import Content, Inputs, Section
from . import dynamics, figures, margins, tables


def build(inputs: Inputs) -> Content:
    """Return figures, tables and lines to paste of every scene that was computed."""
    scenes = (inputs.results["scenes"] or {}) | (inputs.results["moving_scene"] or {})
    shown = [_show(scene, stem, inputs) for stem, scene in scenes.items()]
    return Content({"scenes": shown, "example": _read_example(scenes)})


def _read_example(scenes: dict) -> dict | None:
    """Return name and text of the first scene file, None where there is none to read."""
    path = next((Path(scene["path"]) for scene in scenes.values()), None)
    return {"name": path.name, "text": path.read_text(encoding="utf-8")} if path and path.is_file() else None


def _show(scene: dict, stem: str, inputs: Inputs) -> dict:
    surroundings = _read_surroundings(Path(scene["path"]), stem)
    is_at_rest = "motion" not in (scene.get("dynamics") or {})
    table = margins.margin_table(scene.get("margins"), f"scene_{stem}", is_at_rest)
    return {
        "stem": stem,
        "data": scene,
        "profiles": figures.profiles(scene, surroundings, inputs.figures),
        "ladder": figures.ladder(scene, surroundings, inputs.looks, inputs.figures),
        "tables": tables.scene_tables(scene, stem, inputs.tables),
        "suspected": scene.get("suspected", ()),
        "margin": table and table.write(inputs.tables),
        "margin_words": margins.describe_margin(scene.get("margins", []), is_at_rest),
        "exports": margins.describe_exports(scene.get("exports")),
        "warnings": list(dict.fromkeys(text for line in scene["lines"] for text in line["warnings"])),
        "paste": _describe_python(scene),
        "python": _python_to_paste(scene),
        "dynamics": dynamics.build(scene | {"seabed": surroundings["seabed"]}, stem, inputs.figures, inputs.tables),
    }


def _python_to_paste(scene: dict) -> str:
    """Return Python with the cheapest setting of this project that meets the tolerance, line by line."""
    text = ["from solvers import Span, solve_span", ""]
    for line in scene["lines"]:
        arguments = ", ".join(f"{key}={value!r}" for key, value in line["inputs"].items())
        best = _cheapest_of_ours(line, scene["tolerance"])
        setting = f", tolerance={best['tolerance']!r}" if best and best["tolerance"] is not None else ""
        text += [f"line = Span({arguments})  # {line['label'] or scene['name']}",
                 f"state = solve_span(line{setting})",
                 "state.tension, state.H, state.V  # "
                 f"{line['tension']:.7g}, {line['H']:.7g}, {line['V']:.7g} N"]  # fmt: skip
    return "\n".join(text)


def _cheapest_of_ours(line: dict, tolerance: float) -> dict | None:
    return analysis.find_cheapest([p for p in line["ladder"] if p["solver"] == analysis.OURS], tolerance)


def _describe_python(scene: dict) -> str:
    """Return whose settings the Python has, and the other codes that are cheaper within the tolerance."""
    tolerance, cheaper = scene["tolerance"], {}
    for line in scene["lines"]:
        best = analysis.find_cheapest(line["ladder"], tolerance)
        if best and best["solver"] != analysis.OURS:
            cheaper.setdefault(best["label"], []).append(line["label"] or scene["name"])
    none = [line["label"] or scene["name"] for line in scene["lines"] if not _cheapest_of_ours(line, tolerance)]
    default = f" (its default where none does: {', '.join(none)})" if none else ""
    text = (
        "The line at rest, solved by this project with the cheapest of its own settings that meet the tolerance of "
        f"{number(tolerance, 1)}{default}"
    )
    others = [f"cheaper still within it is {label} on {', '.join(lines)}" for label, lines in cheaper.items()]
    return "; ".join([text, *others]) + "."


def _read_surroundings(path: Path, stem: str) -> dict:
    """Return the heights that the scene file gives: those of the anchor, the seabed and the still water, m."""
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        anchor, depth = float(data["ends"]["anchor"][2]), data.get("environment", {}).get("depth")
    except (OSError, ValueError, KeyError, IndexError, TypeError):
        return {"stem": stem, "anchor_z": 0.0, "seabed": None, "water": None, "z_note": " above the anchor"}
    seabed = None if depth is None else -float(depth)
    return {"stem": stem, "anchor_z": anchor, "seabed": seabed, "water": 0.0, "z_note": ""}


SCENES = Section(
    id="scenes",
    title="Scenes",
    part="error-for-time",
    page="lines",
    needs=("scenes", "moving_scene"),
    template="scenes/section.html.j2",
    build=build,
    tests={"scenes": ("io/test_scene.py::test_every_key_arrives",)},
)
