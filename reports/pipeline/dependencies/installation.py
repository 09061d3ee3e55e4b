"""Where the packages are, a checkout of the repository or an installed wheel, and what follows for child processes."""

from __future__ import annotations

import os
import sys
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path

from .sources import ROOT

DISTRIBUTION = "mooring-verification"
MODULE = (sys.executable, "-P", "-m")
"""Runs a module. -P keeps the caller's folder off the module search path, so that no folder or file of the caller's
hides one of the packages."""

INSTALLED_PYTEST = ("-c", "{root}/verification/installed_pytest.ini", "--rootdir={root}", "-p", "no:cacheprovider")
"""Options of pytest for installed tests: the settings that a checkout has in pyproject.toml, and no cache."""


def is_repository(root: Path = ROOT) -> bool:
    """Return whether the folder is a checkout or an unpacked source archive; other projects' files do not count."""
    project = root / "pyproject.toml"
    return project.is_file() and f'name = "{DISTRIBUTION}"' in project.read_text(encoding="utf-8")


def has_git(root: Path = ROOT) -> bool:
    """Return whether git can be asked there: of a wheel below another project, it would tell that project's state."""
    return is_repository(root) and (root / ".git").exists()


def installed_version() -> str:
    """Return the version of the installed distribution, or "unknown"."""
    try:
        return version(DISTRIBUTION)
    except PackageNotFoundError:
        return "unknown"


def installed_requirements() -> list[str]:
    """Return the requirements of the installed distribution, optional ones too; none where it is not installed."""
    try:
        return requires(DISTRIBUTION) or []
    except PackageNotFoundError:
        return []


def child_environment() -> dict[str, str]:
    """Return the environment of a child process that finds these packages whatever the working folder is.

    An installed wheel is found anyway; its folder, first on the path, would put other packages before the standard
    library.
    """
    result = dict(os.environ)
    if is_repository():
        result["PYTHONPATH"] = os.pathsep.join(filter(None, [str(ROOT), result.get("PYTHONPATH", "")]))
    return result
