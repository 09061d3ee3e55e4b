"""Is what README and theory pages say there: links, tests, misprints, and the values of the examples?"""

from __future__ import annotations

import ast
import importlib
import inspect
import pkgutil
import re
import tomllib
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

import solvers
from verification import IN_REPOSITORY, ROOT

pytestmark = pytest.mark.skipif(not IN_REPOSITORY, reason="an installed wheel has no README")

PAGES = [ROOT / "README.md", *sorted((ROOT / "solvers").glob("*/theory.md"))]
ROOMS = ("catenary", "network", "cable", "time_domain", "harmonic_balance", "stability")
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
ROUNDING = 1 + 1e-6  # of half a digit: a value in the middle is a double, and may lie on either side of it


def broken_links(text: str, folder: Path) -> list[str]:
    """Relative targets of Markdown links and pictures that are not there."""
    targets = re.findall(r"\]\(([^)#\s]+)[^)]*\)", text)
    return [target for target in targets if "://" not in target and not (folder / target).exists()]


def missing_tests(text: str) -> list[str]:
    """Quoted ``folder/test_file.py`` and ``folder/test_file.py::test_name`` that are not there, seen from the root."""
    missing = []
    for file, name in re.findall(r"((?:[\w.-]+/)*\btest_\w+\.py)(?:::(\w+))?", text):
        source = (ROOT / file).read_text(encoding="utf-8") if (ROOT / file).is_file() else None
        if source is None or (name and not re.search(rf"^def {name}\(", source, re.MULTILINE)):
            missing.append(f"{file}::{name}")
    return missing


def values_in_solvers(name: str) -> set[float]:
    """Return the numbers that a name stands for: of module constants, and of default arguments of public calls."""
    modules = [importlib.import_module(m.name) for m in pkgutil.walk_packages(solvers.__path__, "solvers.")]
    calls = [getattr(solvers, public) for public in solvers.__all__ if inspect.isfunction(getattr(solvers, public))]
    values = [getattr(module, name) for module in modules if hasattr(module, name)]
    values += [inspect.signature(call).parameters[name].default for call in calls
               if name in inspect.signature(call).parameters]  # fmt: skip
    return {float(value) for value in values if isinstance(value, int | float) and not isinstance(value, bool)}


def wrong_constants(text: str) -> list[str]:
    """Constants quoted as `name` = number, or `module.name` = number, whose value in the solvers is another or none."""
    quoted = re.findall(r"`(?:[\w.]+\.)?(\w+)` = (\d+(?:\.\d+)?(?:e[-+]?\d+)?)( eps)?", text)
    return [
        f"{name} = {value}{eps}"
        for name, value, eps in quoted
        if float(value) * (2.0**-52 if eps else 1.0) not in values_in_solvers(name)
    ]


def missing_errata(text: str) -> list[str]:
    """Places that the pages call "Erratum `where`" and that are in no row of reference_data/errata.toml."""
    rows = tomllib.loads((ROOT / "reference_data" / "errata.toml").read_text(encoding="utf-8"))["erratum"]
    places = {row["where"] for row in rows}
    return [where for where in re.findall(r"[Ee]rratum `([^`]+)`", text) if where not in places]


def blocks(text: str) -> list[str]:
    """Python examples that solve something, but for the files that the page prints."""
    result = re.findall(r"(<!-- file: \S+ -->\n)?```python\n(.*?)```", text, re.DOTALL)
    return [code for file, code in result if not file and "verification.conformance" not in code]


def half_digit(number: str) -> float:
    """Half a unit of the last digit that is printed."""
    return 0.5 * 10.0 ** Decimal(number).as_tuple().exponent


def wrong_values(code: str) -> list[str]:
    """Expressions of an example whose comment, up to a semicolon, has a number that is none of their values.

    Numbers stand in the order of the values; of equal values one may stand for all, so values may be left out.
    """
    space, wrong = {}, []
    for statement in ast.parse(code).body:
        source = ast.unparse(statement)
        if not isinstance(statement, ast.Expr):
            exec(source, space)
            continue
        values = eval(source, space)
        values = np.concatenate([np.ravel(v) for v in (values if isinstance(values, tuple) else (values,))])
        comment = code.splitlines()[statement.end_lineno - 1].partition("  # ")[2].partition(";")[0]
        after = 0
        for number in NUMBER.findall(comment):
            fits = np.flatnonzero(abs(values[after:] - float(number)) <= ROUNDING * half_digit(number))
            if fits.size:
                after += int(fits[0]) + 1
            else:
                wrong.append(f"{source}: {number} is none of {values[after:]}")
    return wrong


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_what_a_page_names_is_there(page):
    """Links, tests and misprints."""
    text = page.read_text(encoding="utf-8")
    assert not broken_links(text, page.parent)
    assert not missing_tests(text)
    assert not missing_errata(text)


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_constants_that_a_page_quotes_are_those_of_the_code(page):
    """Each `name` = number is the value of that constant or default argument."""
    assert not wrong_constants(page.read_text(encoding="utf-8"))


def test_every_solver_has_its_theory_and_the_readme_leads_there():
    """One page for each, linked, with a section on where it is verified."""
    readme = PAGES[0].read_text(encoding="utf-8")
    for name in ROOMS:
        text = (ROOT / "solvers" / name / "theory.md").read_text(encoding="utf-8")
        assert f"(solvers/{name}/theory.md)" in readme and "## Where it is verified" in text
        assert re.search(r"test_\w+\.py::test_\w+", text)


def test_examples_of_the_readme_give_the_values_beside_them(monkeypatch):
    """To the digits printed."""
    monkeypatch.chdir(ROOT)
    examples = blocks(PAGES[0].read_text(encoding="utf-8"))
    assert len(examples) >= 3
    for code in examples:
        assert not wrong_values(code)


def test_each_check_turns_red():
    """A broken link, a renamed test or another folder, a lost erratum, another digit, another order."""
    assert broken_links("[a](no/such.md), [b](README.md)", ROOT) == ["no/such.md"]
    lost = [
        "verification/catenary/test_exact.py::test_no_such",
        "verification/test_none.py::",
        "catenary/test_exact.py::",
        "benchmarks/test_exact.py::test_random_lines",
        "verification/catenary/test_exact.py::test_random",
    ]
    assert missing_tests(" and ".join(name.removesuffix("::") for name in lost)) == lost
    assert not missing_tests(
        "`verification/catenary/test_exact.py`, `verification/catenary/test_exact.py::test_random_lines`."
    )
    assert missing_errata("Erratum `(99)`") == ["(99)"]
    assert wrong_constants("`newton.MAX_ITERATIONS` = 201, `tolerance` = 1e-3, `NOT_THERE` = 1") == [
        "MAX_ITERATIONS = 201", "tolerance = 1e-3", "NOT_THERE = 1"
    ]  # fmt: skip
    assert not wrong_constants("`newton.MAX_ITERATIONS` = 200 and `tolerance` = 1e-10")
    wrong = lambda comment: wrong_values(f"x = 2.0\nx, x + 1, x, 1.26e-3  # {comment}\n")
    for comment in ("2.0, 3.2 N; 99", "3, 2, 2", "2, 2, 3", "2, 3, 2, 2", "2.1", "1.2e-3", "1.3e-03, 2"):
        assert wrong(comment), comment
    assert not any(map(wrong, ("2.00, 3 N; 99", "2.0 N, 1.3e-3", "3, 1.26e-3", "no number")))
    assert half_digit("-72.125") == 0.0005 and half_digit("137766") == 0.5 and half_digit("2.5e-3") == 0.5e-4
