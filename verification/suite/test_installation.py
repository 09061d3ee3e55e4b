"""Does the project work from any folder, and say what it needs? (`.ci/wheel.py` tries a wheel.)"""

from __future__ import annotations

import configparser
import os
import re
import subprocess
import sys
import tomllib

import pytest

from verification import IN_REPOSITORY, ROOT

SCENE = ROOT / "reference_data" / "scenes" / "shallow_chain.toml"
LONGEST = 60  # s that any command here may take

PROGRAMS = {
    "reports": ("jinja2", "matplotlib", "pytest", "hypothesis", "mpmath"),
    "benchmarks": ("mpmath", "tqdm"),
    "reference_data": ("mpmath", "tqdm"),
    "verification.defects": ("mpmath", "pytest", "hypothesis"),
}
"""Package with programs -> extras without which none of them runs."""


def python(*words, folder=ROOT, **environment) -> subprocess.CompletedProcess:
    """Run Python in the folder, with these packages on its path."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)} | environment
    command = [sys.executable, *map(str, words)]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=LONGEST)


def test_a_report_is_written_where_the_caller_stands(tmp_path):
    """Into mooring-report below that folder and nowhere else, also where files there have the names of packages."""
    (tmp_path / "benchmarks").mkdir()
    for decoy in ("benchmarks/__init__.py", "solvers.py", "tqdm.py"):
        (tmp_path / decoy).write_text("raise RuntimeError('a file of the caller is imported')\n", encoding="utf-8")
    (tmp_path / "line.toml").write_text(SCENE.read_text(encoding="utf-8"), encoding="utf-8")
    before = set(tmp_path.rglob("*"))
    run = python("-P", "-m", "reports", "line.toml", "--only", "machine", folder=tmp_path)
    assert run.returncode == 0, run.stderr
    out = tmp_path / "mooring-report"
    assert all(path.is_relative_to(out) for path in set(tmp_path.rglob("*")) - before)
    page = (out / "scene-line.html").read_text(encoding="utf-8")
    assert "python -m benchmarks.run.machine --out mooring-report/results" in page
    assert "python -m benchmarks.scenes.measure line.toml --out mooring-report/results" in page


def test_programs_write_into_one_folder():
    """The report reads what benchmarks and seeded defects write by default."""
    code = ("from benchmarks.run.console import DEFAULT_OUT as a; "
            "from verification.defects.__main__ import DEFAULT_OUT as b; "
            "from reports.pipeline.dependencies.sources import OUT; print(a, b, OUT / 'results')")  # fmt: skip
    assert set(python("-c", code).stdout.split()) == {os.path.join("mooring-report", "results")}


@pytest.mark.parametrize(("package", "module"), [(p, m) for p, modules in PROGRAMS.items() for m in modules])
def test_a_missing_extra_is_named_with_its_command(package, module):
    """One line instead of a traceback, before anything else is imported."""
    code = f"import sys; sys.argv[0] = '-m'; sys.modules[{module!r}] = None; import {package}"
    run = python("-c", code)
    assert run.returncode == 1 and len(run.stderr.splitlines()) == 1, run.stderr
    assert f"python -m {package} needs {module}, not installed here" in run.stderr
    assert 'python -m pip install "mooring-verification[report]"' in run.stderr


def test_only_a_checkout_is_taken_for_the_repository(tmp_path):
    """Neither a folder without a project file nor one with that of another project, in a git repository or not."""
    code = ("import sys, pathlib; from reports.pipeline.dependencies.installation import has_git, is_repository; "
            "print(*(f(pathlib.Path(sys.argv[1])) for f in (is_repository, has_git)))")  # fmt: skip
    answers = lambda: python("-c", code, tmp_path).stdout.split()
    (tmp_path / ".git").mkdir()
    assert answers() == ["False", "False"]
    (tmp_path / "pyproject.toml").write_text('[project]\nname = "another"\n', encoding="utf-8")
    assert answers() == ["False", "False"]
    (tmp_path / "pyproject.toml").write_text('[project]\nname = "mooring-verification"\n', encoding="utf-8")
    assert answers() == ["True", "True"]


@pytest.mark.skipif(not IN_REPOSITORY, reason="compares with pyproject.toml, which only the repository has")
def test_installed_tests_run_under_the_same_settings():
    """pytest's settings of the wheel are those of pyproject.toml, but for the folders."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["pytest"]["ini_options"]
    parser = configparser.ConfigParser()
    parser.read(ROOT / "verification" / "installed_pytest.ini", encoding="utf-8")
    installed = {key: value.split() for key, value in parser["pytest"].items()}
    words = lambda value: value if isinstance(value, list) else re.split(r"\s+", str(value))
    wanted = {key: words(value) for key, value in project.items() if key != "testpaths"}
    assert {key: [word.lower() for word in value] for key, value in installed.items()} == {
        key: [word.lower() for word in value] for key, value in wanted.items()
    }
