"""The section on network files: the lines in space and motion, the body, and the setting that meets the tolerance."""

from __future__ import annotations

from pathlib import Path

from ...page.numbers.formatting import number, slug
from ...page.numbers.tables import Table
from ...page.section import Content, Inputs, Section
from .. import margins
from ..animation import animate, caption
from . import figures as figures
from . import settings as settings
from . import tables as tables


def build(inputs: Inputs) -> Content:
    """Return figures, tables and sentences of every network file that was measured."""
    reports = settings.merge_timings(inputs.results["moving_networks"])
    shown = [_show(report, stem, inputs) for stem, report in reports.items()]
    compact = {stem: report for stem, report in reports.items() if report["compact"]}
    together = tables.lines_of_all(compact)
    if together is not None:
        together.write(inputs.tables)
    return Content({"networks": shown, "lines_of_all": together}, sentences=_sentences(reports))


def _sentences(reports: dict) -> list[str]:
    """Return one sentence for the summary: which recommended settings meet the tolerance."""
    best = [report["recommended"] for report in reports.values() if report["moves"]]
    within = [row for row in best if row and row["meets"]]
    if not best:
        return []
    slowest = max((row["seconds"] for row in within), default=None)
    cost = f", each in at most {number(slowest, 2)} s" if within else ""
    return [f"Moving networks: {len(within)} of {len(best)} examples have a setting within their tolerance{cost}."]


def _show(report: dict, stem: str, inputs: Inputs) -> dict:
    name, folder = f"network_{slug(stem)}", inputs.figures
    shown = {
        "stem": stem, "data": report, "pictures": None, "tables": [], "sentence": "", "facts": [], "python": None,
        "tensions": None, "details": None, "all": not report["compact"], "views": None,
        "exports": margins.describe_exports(report.get("exports")), **tables.sort_warnings(report),
    }  # fmt: skip
    if "picture" in report and not report["compact"]:
        shown["pictures"] = figures.pictures(report, name, folder)
    if "motion" in report:
        shown |= _motion(report, name, folder)
    shown["tables"] = [table.write(inputs.tables) for table in filter(None, _tables(report, name))]
    return shown


def _motion(report: dict, name: str, folder: Path) -> dict:
    shown = {
        "sentence": settings.sentence(report),
        "facts": margins.describe_margin(report.get("margins", [])) + settings.describe_reference(report),
        "python": settings.python_to_paste(report),
        "tensions": figures.tensions(report, name, folder),
    }
    if report["compact"]:
        return shown
    return shown | {"details": figures.details(report, name, folder), "views": _views(report)}


def _views(report: dict) -> dict:
    """Return drawings of the lines that move, and their caption."""
    factor, duration = figures.enlargement(report["envelope"]), report["period"] or report["duration"]
    seabed = report["picture"]["seabed"]
    drawn = animate(report["envelope"], report["name"], duration, factor, seabed)
    return {"drawn": drawn, "caption": caption(duration, factor, "A period" if report["period"] else "The series")}


def _tables(report: dict, name: str) -> list[Table | None]:
    """Return the tables in their order; of a compact report the settings."""
    made: list[Table | None] = []
    if report["compact"]:
        return [tables.settings(report, name)] if report.get("ladder") else []
    if "motion" in report:
        made += [tables.lines(report, name), margins.margin_table(report.get("margins"), name)]
        made.append(tables.settings(report, name))
        made += [tables.peers(report, name), tables.body(report, name), *tables.matrices(report, name)]
    elif report.get("ladder"):
        made.append(tables.settings(report, name))
    if "statics" in report:
        made.append(tables.statics(report, name))
        made.append(margins.static_peers(report, name))
        made += [] if "motion" in report else [margins.margin_table(report.get("margins"), name, is_at_rest=True)]
    return made + tables.stiffness_at_rest(report, name)


MOVING_NETWORKS = Section(
    id="moving-networks",
    title="Moving networks",
    part="error-for-time",
    page="lines",
    needs=("moving_networks",),
    template="scenes/networks/section.html.j2",
    build=build,
    tests={
        "moving-networks": (
            "io/test_network_scene.py::test_the_examples_are_in_balance",
            "io/test_motion_file.py::test_what_a_moving_network_lacks_is_named",
            "mooring/test_network.py::test_harmonic_balance_and_time_integration_agree",
            "mooring/test_network.py::test_random_networks_move_as_another_program_has_them",
            "mooring/test_random_networks.py::test_random_networks_move_as_they_must",
        )
    },
)
