"""The section on networks of lines: pictures, figures, tables and paragraphs from networks.json."""

from __future__ import annotations

from ..page.numbers.formatting import across
from ..page.section import Content, Inputs, Section
from ..pipeline import published
from . import figures, paragraphs, profiles, tables
from .pictures import pictures
from .verdicts import verdicts

STARTS = ("printed", "sound")
"""Starts of Table 2 with a table; without any start all settings go through one robust start: one sentence suffices."""


def build(inputs: Inputs) -> Content:
    """Return all that the page shows about networks, of the parts that were measured."""
    data = inputs.results["networks"]
    if not data:
        return Content({"networks": None})
    drawn, table2, work, speed, peers = (
        data.get(part) or [] for part in ("pictures", "table2", "work", "speed", "peers")
    )
    printed, growth = published.msqs_table2(), data.get("growth")
    remade = {start: tables.remade_table2(table2, printed, start) for start in STARTS if table2}
    others = {
        "units": tables.unit_table(table2) if table2 else None,
        "settings": tables.setting_table(table2) if table2 else None,
        "work_table": tables.work_table(work) if work else None,
        "costs": profiles.cost_table(work) if work else None,
        "speed": tables.speed_table(speed) if speed else None,
        "peers": tables.peer_table(peers) if peers else None,
    }
    for table in filter(None, (*remade.values(), *others.values())):
        table.write(inputs.tables)
    networks = others | {
        "table2": remade,
        "pictures": pictures(drawn, inputs.figures) if drawn else None,
        "reproduction": paragraphs.reproduction(table2, printed) if table2 else [],
        "work": figures.work(work, inputs.figures) if work else None,
        "profiles": profiles.profiles(work, inputs.figures) if work else None,
        "speed_text": paragraphs.speed(speed) if speed else "",
        "gain": figures.gain(speed, inputs.figures) if speed else None,
        "peer_text": paragraphs.peers(peers, tables.SYSTEMS) if peers else "",
        "growth": figures.growth(growth, inputs.figures) if growth else None,
    }
    return Content({"networks": networks}, verdicts(speed, peers, growth), [_speed_sentence(speed)] if speed else [])


def _speed_sentence(speed: list[dict]) -> str:
    return (
        f"Networks: the nested method takes {across(row['ratio'] for row in speed)} times the time of the monolithic "
        "one, growing with the number of lines."
    )


SOLVE = "network/test_solve.py::"
NETWORKS = Section(
    id="networks",
    title="Networks",
    part="error-for-time",
    page="network",
    needs=("networks",),
    template="network/section.html.j2",
    build=build,
    tests={
        "networks": (
            f"{SOLVE}test_small_networks_to_40_digits",
            f"{SOLVE}test_methods_agree",
            f"{SOLVE}test_random_networks_from_no_guess",
            "network/test_jacobian.py::test_network_derivatives",
            "network/test_properties.py",
        ),
        "msqs-table2": (
            f"{SOLVE}test_two_line_example_to_every_digit",
            f"{SOLVE}test_from_the_start_of_the_paper",
        ),
    },
)
