"""The sections of the report, in their order: a new section is one module, one template and one entry here."""

from __future__ import annotations

from ..cable.section import DYNAMICS
from ..catenary.regimes import REGIMES
from ..catenary.work_precision import WORK_PRECISION
from ..conformance.section import CONFORMANCE
from ..evidence.claim_map import CLAIM_MAP
from ..evidence.claims import CLAIMS
from ..evidence.defects import DEFECTS
from ..evidence.machine import MACHINE
from ..evidence.other_codes import OTHER_CODES
from ..harmonic_balance.section import HARMONIC
from ..mooring.networks import MOORING_NETWORKS
from ..mooring.section import MOORING
from ..network.section import NETWORKS
from ..papers.errata import ERRATA, read_errata
from ..papers.published import PUBLISHED
from ..papers.section import ITEMS, entries
from ..response_curves.section import RESPONSE_CURVES
from ..response_curves.sweep import SWEEP
from ..scenes.load_cases.costs import LOAD_CASE_COSTS
from ..scenes.load_cases.section import LOAD_CASES
from ..scenes.networks.section import MOVING_NETWORKS
from ..scenes.section import SCENES
from ..stability.section import STABILITY

SECTIONS = (
    REGIMES, CLAIM_MAP, CLAIMS, DEFECTS,
    WORK_PRECISION, NETWORKS, MOORING, MOORING_NETWORKS, DYNAMICS, HARMONIC, SCENES, MOVING_NETWORKS, LOAD_CASE_COSTS,
    ITEMS, ERRATA, PUBLISHED,
    STABILITY, RESPONSE_CURVES,
    CONFORMANCE, OTHER_CODES,
    MACHINE,
)  # fmt: skip
"""Of the whole report; each names its page."""


def claimed_tests() -> set[str]:
    """Return the tests that the page names for what it says: of sections, of items of the papers and of misprints."""
    of_sections = (test for section in SECTIONS for tests in section.tests.values() for test in tests)
    of_items = (test for entry in entries() for test in entry.tests)
    of_errata = (row["test"].removeprefix("verification/") for row in read_errata()["erratum"])
    return {*of_sections, *of_items, *of_errata}


SCENE_SECTIONS = (SCENES, MOVING_NETWORKS, SWEEP, LOAD_CASES, MACHINE)
"""Of the page about somebody's own lines and networks."""
