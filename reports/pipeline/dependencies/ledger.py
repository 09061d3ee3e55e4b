"""Which results are still valid: a key per stage, from the contents of everything its result depends on."""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
import os
import platform
import re
import subprocess
import sys
import tomllib
from functools import cache
from itertools import chain
from pathlib import Path

from ..stages import Stage
from .installation import DISTRIBUTION, has_git, installed_requirements, installed_version, is_repository
from .sources import ROOT, depends_on, files_of

DRAWING = ("matplotlib", "jinja2", "tqdm", "ruff")
"""Packages that no result depends on, only the page or the progress bar."""


def write_atomically(path: Path, text: str):
    """Readers see the old file or the new one, never half of it."""
    temporary = path.with_name(f"{path.name}.{os.getpid()}.tmp")
    temporary.write_text(text, encoding="utf-8", newline="")
    os.replace(temporary, path)


@cache
def digest(path: str) -> str:
    """Digest of a file by content; ``path`` from the repository's root."""
    return hashlib.sha256((ROOT / path).read_bytes()).hexdigest()


def digests(files) -> list[tuple[str, str]]:
    """(path, digest) of every file; where it lies outside the repository, its name only."""
    return [(Path(file).name if Path(file).is_absolute() else file, digest(file)) for file in files]


@cache
def packages() -> dict:
    """Installed versions of what the project names and results may depend on, None where it is not installed."""
    names = sorted({re.match(r"[\w.-]+", item)[0] for item in _requirements()} - {DISTRIBUTION, *DRAWING})
    return {name: _version(name) for name in names}


def _requirements() -> list[str]:
    """All dependencies, optional ones too: of pyproject.toml in a checkout, else of the installed distribution."""
    if not is_repository():
        return installed_requirements()
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return [*project["dependencies"], *chain.from_iterable(project["optional-dependencies"].values())]


def _version(name: str) -> str | None:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return None


@cache
def commit() -> str:
    """Commit and whether the tree is modified; the version where the packages are installed; empty outside git."""
    if not is_repository():
        return f"version-{installed_version()}"
    if not has_git():
        return ""
    try:
        command = ("git", "describe", "--always", "--dirty", "--abbrev=12", "--exclude=*")
        return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=20).stdout.strip()
    except (OSError, subprocess.TimeoutExpired):
        return ""


def machine() -> str:
    """Return the machine that a timing belongs to."""
    return " ".join([platform.node(), platform.machine(), platform.processor(), str(os.cpu_count())])


@cache
def key(stage: Stage, arguments: tuple[str, ...]) -> str:
    """Return a digest of imports, sources, arguments and versions; for a timing, of the machine too."""
    files = {*depends_on(stage.programs), *(file for source in stage.sources for file in files_of(source))}
    parts = [digests(sorted(files)), arguments, packages(), sys.version]
    if stage.timed or stage.name == "machine":
        parts.append(machine())
    if stage.name == "machine":
        parts.append(commit())
    return hashlib.sha256(json.dumps(parts).encode()).hexdigest()


class Ledger:
    """Record of the finished stages beside their results: key, digest, seconds, date, load. Written after a stage."""

    def __init__(self, results: Path):
        self.results, self.path = results, results / "stages.json"
        try:
            self.entries = json.loads(self.path.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            self.entries = {}

    def current(self, stage: Stage) -> bool:
        """Return whether the result is as it was written, no failure, and nothing that it depends on has changed."""
        entry = self.entries.get(stage.name, {})
        if not entry.get("good") or entry.get("result") != self._result(stage):
            return False  # before all sources are read
        return entry.get("key") in [key(stage, arguments) for arguments in (stage.arguments, *stage.better)]

    def _result(self, stage: Stage) -> str | None:
        path = self.results / stage.output
        return hashlib.sha256(path.read_bytes()).hexdigest() if path.exists() else None

    def valid(self, stage: Stage) -> bool:
        """Return whether the recorded result belongs to the present sources, whatever its arguments were."""
        entry = self.entries.get(stage.name, {})
        return bool(entry.get("key")) and entry["key"] == key(stage, tuple(entry["arguments"]))

    def expected(self, stage: Stage) -> float:
        """Return seconds the stage took last time with these arguments, or a guess."""
        entry = self.entries.get(stage.name, {})
        return entry["seconds"] if entry.get("arguments") == list(stage.arguments) else stage.seconds

    def forget(self, stage: Stage):
        """Delete the record of a stage before it runs: its output is no result until it is recorded."""
        if self.entries.get(stage.name, {}).pop("key", None):
            self._write()

    def record(self, stage: Stage, **facts):
        """Record a stage that succeeded."""
        result = self._result(stage)
        self.entries[stage.name] = {"arguments": list(stage.arguments), "result": result, **facts}
        self._write()

    def _write(self):
        write_atomically(self.path, json.dumps(self.entries, indent=1))
