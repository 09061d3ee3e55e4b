"""What the pages of somebody's own lines say first, what they promise, and what they leave to a fold."""

from __future__ import annotations

import pytest

from reports.page import site
from reports.page.results import Results
from reports.pipeline.dependencies.sources import ROOT
from reports.pipeline.running.runner import REFUSED, Ended
from reports.pipeline.stages import scene_stage
from reports.scenes import dynamics, margins
from reports.scenes.load_cases import section as load_cases
from reports.scenes.networks import figures as network_figures
from reports.scenes.networks import settings as network_settings
from reports.scenes.networks import tables as network_tables

SNAPPING = {"rows": [{"status": "SUCCESS"}], "cases": None, "dt": 0.14, "cells": 17}


def accuracy(promised: float, measured: float, is_kept: bool) -> dict:
    """Return the part of a summary of load cases on its error, of a tolerance of 2 %."""
    return {"tolerance": 0.02, "promised": promised, "measured": measured, "within": int(is_kept), "sampled": 1,
            "is_kept": is_kept, "share": 0.95}  # fmt: skip


def test_a_tolerance_that_is_not_met_is_said_first():
    """With the setting that second order asks for, sqrt(0.08 / 0.02) = 2 times finer; a promise is broken elsewhere."""
    text = load_cases._sentence(SNAPPING | {"accuracy": accuracy(0.08, 0.04, is_kept=False)})
    assert text.startswith("THE TOLERANCE OF 2 % IS NOT MET") and "--dt 0.070 --cells 34" in text
    assert "PROMISE" not in text
    broken = load_cases._sentence(SNAPPING | {"accuracy": accuracy(0.018, 0.04, is_kept=False)})
    assert broken.startswith("Solved") and "THE PROMISE IS NOT KEPT" in broken and "NOT MET" not in broken


def test_suspicions_come_first_and_notes_are_folded():
    """In the terminal as on the page, each said once."""
    report = {"name": "Mine", "warnings": ["in mm", "OUTPUTS: none", "is nearly slack"], "suspected": ["in mm"],
              "notes": ["OUTPUTS: none"], "margins": []}  # fmt: skip
    kept = network_tables.sort_warnings(report)
    assert kept == {"suspected": ["in mm"], "warnings": ["is nearly slack"], "notes": ["OUTPUTS: none"]}
    lines = network_tables.summarise(report, "mine").splitlines()
    assert lines == ["Mine", "SUSPECTED: in mm", "- is nearly slack", "of the file: OUTPUTS: none."]
    template = (ROOT / "reports" / "scenes" / "networks" / "section.html.j2").read_text(encoding="utf-8")
    assert template.index("s.suspected") < template.index("s.sentence") < template.index("s.notes")


def test_a_margin_at_rest_speaks_of_no_motion():
    """Where nothing moves the largest tension is that at rest."""
    row = {"line": "one", "mean": 1e5, "dynamic": 0.0, "design": 1e5, "strength": 9e5, "utilisation": 0.11,
           "gamma_mean": 1.0, "gamma_dyn": 1.0, "given": True, "breaking_load": 1e6}  # fmt: skip
    at_rest, moving = (margins.margin_table([row], "m", is_at_rest) for is_at_rest in (True, False))
    assert "this motion" not in at_rest.note and "T_max is the tension at rest" in at_rest.note
    assert "T_max is that of this motion" in moving.note


@pytest.mark.parametrize(("errors", "hidden"), [((0.03, 2.9e-6), 0.006), ((0.03, 0.008), None), ((None,), None)])
def test_errors_below_the_reference_are_said_to_be(errors, hidden):
    """The finest setting is the reference itself, and differs from it by nothing that says how good it is."""
    ladder = [{"method": "time domain", "cells": 10, "dt": 0.1, "seconds": 0.1, "status": "SUCCESS", "error": error}
              for error in errors]  # fmt: skip
    report = {"reference": {"uncertainty": 0.006}, "ladder": ladder, "recommended": None}
    assert network_settings.find_hidden_errors(report) == hidden
    assert ("The reference is known to 0.0060" in network_tables.settings(report, "x").note) == (hidden is not None)


def test_modes_that_creep_are_no_natural_frequencies():
    """In a current the drag keeps the lowest modes from oscillating, and the list starts above them."""
    modes = {"modes": [0.1201, 0.1502]}
    assert "oscillate about rest in the current: 0.1201, 0.1502 Hz" in dynamics._describe_modes(
        modes | {"in_current": True}
    )
    assert dynamics._describe_modes(modes | {"in_current": False}).startswith("Lowest natural frequencies at rest")


def test_a_side_view_has_the_height_of_its_lines():
    """Deep water makes a tall picture, shallow water a low one, and none is cut."""
    tall, low, flat = ([[[0.0, 0.0], [1000.0, -depth]]] for depth in (2000.0, 250.0, 20.0))
    heights = [network_figures._height_of_side_view(points) for points in (tall, low, flat)]
    assert heights == [pytest.approx(4.3), pytest.approx(2.7), pytest.approx(3.2)]


def test_a_refused_file_says_why_without_a_click(tmp_path):
    """The message stands on the page, not only within the fold of the stage that failed."""
    stage = scene_stage(tmp_path / "mine.toml")
    ended = Ended(stage, "failed", ("mine.toml: likely in t/m, 287 kg/m.", "(exit status 2)"), REFUSED)
    (tmp_path / "results").mkdir()
    (failure,) = Results(tmp_path, [stage], [ended]).failures()
    text = site._environment().from_string('{% import "page/templates/macros.html.j2" as m %}{{ m.failure(end) }}')
    shown, _, fold = text.render(end=failure).partition("<details")
    assert "likely in t/m" in shown and "exit status" not in shown and "likely in t/m" in fold
