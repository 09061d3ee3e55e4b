"""The machine, the versions and the load under which results were measured: machine.json."""

from __future__ import annotations

import os
import platform
import subprocess
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path

import numpy as np  # noqa: F401 (loads its BLAS, which is reported)
import scipy.linalg  # noqa: F401 (loads its own)
from threadpoolctl import threadpool_info

from . import console, results

PACKAGES = {
    "numpy": "numpy",
    "scipy": "scipy",
    "mpmath": "mpmath",
    "gmpy2": "gmpy2",
    "pytest": "pytest",
    "pytest-benchmark": "pytest-benchmark",
    "hypothesis": "hypothesis",
    "MoorPy": "moorpy",
    "pycatenary": "pycatenary",
    "MoorDyn": "moordyn",
}
"""Name on the page -> distribution."""


def describe() -> dict:
    """Everything but results."""
    return {
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "commit": _git("rev-parse", "--short", "HEAD") or _installed(),
        "modified": bool(_git("status", "--porcelain")),
        "python": platform.python_version(),
        "platform": platform.platform(),
        "cpu": _cpu(),
        "cores": os.cpu_count(),
        "load_before": list(os.getloadavg()) if hasattr(os, "getloadavg") else None,
        "blas": [_library(entry) for entry in threadpool_info()],
        "versions": {name: _version(package) for name, package in PACKAGES.items()},
    }


def _git(*arguments) -> str:
    """Output of git, empty where there is no git or no repository of this project's own."""
    if not (console.ROOT / ".git").exists():  # of a folder above site-packages git would tell another project's state
        return ""
    try:
        done = subprocess.run(["git", *arguments], cwd=console.ROOT, capture_output=True, text=True, timeout=10)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""


def _installed() -> str | None:
    """Return the version of an installed wheel, in place of a commit; None for a checkout without git."""
    return None if (console.ROOT / "pyproject.toml").exists() else f"version-{_version('mooring-verification')}"


def _cpu() -> str:
    """Model name of the processor: Linux tells it in a file, other systems through platform."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def _library(entry) -> dict:
    return {
        "library": entry["internal_api"],
        "version": entry["version"],
        "threads": entry["num_threads"],
        "architecture": entry.get("architecture"),
    }


def _version(package: str) -> str | None:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def main(argv=None) -> int:
    """Command line."""
    arguments = console.parser("machine", __doc__).parse_args(argv)
    for result in console.progress([describe()], 1, "machine"):
        results.write(arguments.out / "machine.json", result)
    return 0


if __name__ == "__main__":
    console.run(main)
