"""Is what README and theory pages say there: links, tests, misprints, and the values of the examples?"""

from __future__ import annotations

import ast
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "solvers" / "theory").glob("*.md"))]
SOLVERS = ("catenary", "networks", "cable", "time_domain", "harmonic_balance")
TESTS = ("verification", "benchmarks", "reports/browser")
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e-?\d+)?")


def broken_links(text: str, folder: Path) -> list[str]:
    """Relative targets of Markdown links and pictures that are not there."""
    targets = re.findall(r"\]\(([^)#\s]+)[^)]*\)", text)
    return [target for target in targets if "://" not in target and not (folder / target).exists()]


def missing_tests(text: str) -> list[str]:
    """Quoted ``test_file.py`` and ``test_file.py::test_name`` that are not there."""
    missing = []
    for file, _, name in re.findall(r"\b(test_\w+\.py)(::(test_\w+))?", text):
        found = [path for folder in TESTS for path in (ROOT / folder).glob(file)]
        if not found or (name and f"def {name}(" not in found[0].read_text(encoding="utf-8")):
            missing.append(f"{file}::{name}")
    return missing


def missing_errata(text: str) -> list[str]:
    """Places that the pages call "Erratum `where`" and that are in no row of reference_data/errata.toml."""
    rows = tomllib.loads((ROOT / "reference_data" / "errata.toml").read_text(encoding="utf-8"))["erratum"]
    places = {row["where"] for row in rows}
    return [where for where in re.findall(r"[Ee]rratum `([^`]+)`", text) if where not in places]


def blocks(text: str) -> list[str]:
    """Python examples that solve something, but for the files that the page prints."""
    found = re.findall(r"(<!-- file: \S+ -->\n)?```python\n(.*?)```", text, re.DOTALL)
    return [code for file, code in found if not file and "benchmarks.peers" not in code]


def wrong_values(code: str) -> list[str]:
    """Expressions of an example whose comment, up to a semicolon, has a number that is none of their values."""
    space, wrong = {}, []
    for statement in ast.parse(code).body:
        source = ast.unparse(statement)
        if not isinstance(statement, ast.Expr):
            exec(source, space)
            continue
        values = eval(source, space)
        values = np.concatenate([np.ravel(v) for v in (values if isinstance(values, tuple) else (values,))])
        comment = code.splitlines()[statement.end_lineno - 1].partition("  # ")[2].partition(";")[0]
        for number in NUMBER.findall(comment):
            last = 10.0 ** -len(number.partition(".")[2])  # the last digit that is printed may be rounded
            if not np.any(abs(values - float(number)) <= last):
                wrong.append(f"{source}: {number} is none of {values}")
    return wrong


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.name)
def test_what_a_page_names_is_there(page):
    """Links, tests and misprints."""
    text = page.read_text(encoding="utf-8")
    assert not broken_links(text, page.parent)
    assert not missing_tests(text)
    assert not missing_errata(text)


def test_every_solver_has_its_theory_and_the_readme_leads_there():
    """One page for each, linked, with a section on where it is verified."""
    readme = PAGES[0].read_text(encoding="utf-8")
    for name in SOLVERS:
        text = (ROOT / "solvers" / "theory" / f"{name}.md").read_text(encoding="utf-8")
        assert f"(solvers/theory/{name}.md)" in readme and "## Where it is verified" in text
        assert re.search(r"test_\w+\.py::test_\w+", text)


def test_examples_of_the_readme_give_the_values_beside_them(monkeypatch):
    """To the digits printed."""
    monkeypatch.chdir(ROOT)
    examples = blocks(PAGES[0].read_text(encoding="utf-8"))
    assert len(examples) >= 3
    for code in examples:
        assert not wrong_values(code)


def test_each_check_turns_red():
    """A broken link, a renamed test, a lost erratum, another digit."""
    assert broken_links("[a](no/such.md), [b](README.md)", ROOT) == ["no/such.md"]
    assert missing_tests("test_exact.py::test_no_such and test_none.py and test_exact.py") == [
        "test_exact.py::test_no_such",
        "test_none.py::",
    ]
    assert missing_errata("Erratum `(99)`") == ["(99)"]
    assert wrong_values("x = 2.0\nx, x + 1  # 2.0, 3.2 N; 99\n")
    assert not wrong_values("x = 2.0\nx, x + 1  # 2.00, 3 N; 99\n")
