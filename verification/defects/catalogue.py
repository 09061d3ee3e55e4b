"""All seeded defects, the checks they are shown to, and which of these compare with numbers kept on file."""

from __future__ import annotations

from .cables import DEFECTS as CABLES
from .defect import Defect
from .dynamics import DEFECTS as DYNAMICS
from .networks import DEFECTS as NETWORKS
from .spans import DEFECTS as SPANS

CATALOGUE: tuple[Defect, ...] = (*SPANS, *NETWORKS, *CABLES, *DYNAMICS)

# ---------------------------------------------------------------- kinds of checks
FROZEN = ("test_published.py", "test_references.py")
"""Checks that compare with published or stored numbers: files, or functions as file::function."""

PLANTING = ("test_checks.py", "test_network_checks.py")
"""Files and functions that plant mistakes of their own by text: with another mistake there they fail for that alone."""


def frozen(test: str) -> bool:
    """Whether a test compares with numbers kept on file."""
    return test.startswith(FROZEN)

WIDER: dict[str, tuple[str, ...]] = {d.module: () for d in CATALOGUE}
