"""Verification: cases, exact references, and tests named by the question they ask."""

from importlib.resources import files
from pathlib import Path

ROOT = Path(str(files("verification"))).parent
"""Folder of the packages: the root of the repository, or site-packages where they are installed from a wheel."""

_PROJECT = ROOT / "pyproject.toml"
IN_REPOSITORY = _PROJECT.is_file() and 'name = "mooring-verification"' in _PROJECT.read_text(encoding="utf-8")
"""False for an installed wheel, which has the five packages and no README, no project file and no history."""
