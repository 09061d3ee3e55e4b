"""Solvers that a reader brings: files with adapters, checked before anything runs, and part of what results depend on.

The programs under benchmarks read the files from the environment variable MOORING_SOLVERS.
"""

from __future__ import annotations

import ast
import os
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

from .dependencies.installation import MODULE, child_environment
from .dependencies.sources import SUFFIXES
from .stages import Stage

VARIABLE = "MOORING_SOLVERS"
LONGEST_NAME = 255  # characters of a text that may be the name of a file


def set_files(files: list[Path]) -> str:
    """Set the files for the programs that measure; return what is wrong with them, empty where nothing is."""
    if files:
        os.environ[VARIABLE] = os.pathsep.join(str(path.resolve()) for path in files)
    if not os.environ.get(VARIABLE):
        return ""
    program = "benchmarks.peers"
    done = subprocess.run([*MODULE, program], env=child_environment(), capture_output=True, text=True)
    return "" if done.returncode == 0 else (done.stderr.strip() or f"{program}: exit status {done.returncode}")


def add_sources(stages: list[Stage]) -> list[Stage]:
    """Return the stages; of those that run the solvers, the external files are sources."""
    files = [Path(name) for name in os.environ.get(VARIABLE, "").split(os.pathsep) if name]
    more = tuple(dict.fromkeys(source for path in files for source in sources(path)))
    return [replace(stage, sources=(*stage.sources, *more)) if _asks(stage) else stage for stage in stages]


def _asks(stage: Stage) -> bool:
    measured = any(word.startswith("benchmarks") for word in stage.arguments)
    return measured and stage.group not in ("machine", "published")


def sources(path: Path) -> list[str]:
    """Return the file, the modules beside it that it imports, and every file that a text in it names: its programs."""
    path = path.resolve()
    tree, files = ast.parse(path.read_text(encoding="utf-8")), [path]
    for node in ast.walk(tree):
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        names += [node.module] if isinstance(node, ast.ImportFrom) and node.module else []
        for name in (name.partition(".")[0] for name in names):
            files += [path.parent / f"{name}.py", *(p for p in (path.parent / name).rglob("*") if p.suffix in SUFFIXES)]
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and _may_name_a_file(node.value):
            files += [path.parent / node.value, Path(shutil.which(node.value) or path)]
    return [str(one.resolve()) for one in files if one.is_file()]


def _may_name_a_file(text: str) -> bool:
    return 0 < len(text) < LONGEST_NAME and text.isprintable()
