"""Scripts that reproduce an answer with a code's own calls, made of templates; they need nothing of this suite."""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files
from pathlib import Path
from pprint import pformat

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from ..page.numbers.formatting import slug

TEMPLATES = Path(__file__).parent / "scripts"
PACKAGES = {"moorpy": "moorpy", "pycatenary": "pycatenary", "moordyn": "moordyn"}
"""Code -> its package on the Python package index."""


def make_script(code: str, report: dict, row: dict) -> str:
    """Return the script of a case of a report, empty where there is no template for its problem."""
    case = _cases(row["level"])[row["id"]]
    template = f"{code}_{_problem(case, row['level'])}.py.j2"
    if not (TEMPLATES / template).is_file():
        return ""
    asked = {one["quantity"]: one for one in row["quantities"]}
    pick = lambda table: pformat({name: case[table][name] for name in asked}, width=116, compact=True, sort_dicts=False)
    bounds = {name: (one["right"], one["wrong"]) for name, one in asked.items()}
    return _environment().get_template(template).render(
        label=report["solver"]["label"], version=report["solver"]["version"], set=report["set"], id=row["id"],
        title=row["title"], packages=f"numpy and {PACKAGES[code]}=={report['solver']['version']}",
        inputs=pformat(case["inputs"], width=116, compact=True, sort_dicts=False), truth=pick("truth"),
        scale=pick("scale"), bounds=bounds, motion=row["level"] == "motion")  # fmt: skip


def write_scripts(folder: Path, code: str, report: dict, rows: list[dict]) -> dict[str, str]:
    """Write the scripts of these cases; return id -> file name, of those that have one."""
    names = {}
    for row in rows:
        if text := make_script(code, report, row):
            folder.mkdir(parents=True, exist_ok=True)
            names[row["id"]] = f"{slug(code)}_{slug(row['id'].replace('/', '_'))}.py"
            (folder / names[row["id"]]).write_text(text, encoding="utf-8")
    return names


def _problem(case: dict, level: str) -> str:
    if level == "motion":
        return "moving_network" if "elements" in case["inputs"] else "cable"
    return {"statics": "span"}.get(level, level)


@cache
def _cases(level: str) -> dict[str, dict]:
    """Return id -> case of a level, with its inputs, truth and scale."""
    text = (files("reference_data") / "conformance" / f"{level}.json").read_text(encoding="utf-8")
    return {case["id"]: case for case in json.loads(text)["cases"]}


@cache
def _environment() -> Environment:
    return Environment(loader=FileSystemLoader(TEMPLATES), undefined=StrictUndefined, trim_blocks=True,
                       lstrip_blocks=True, keep_trailing_newline=True)  # fmt: skip
