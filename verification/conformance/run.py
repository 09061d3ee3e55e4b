"""One run of the cases against one solver: which cases, their tests, and what comes out."""

from __future__ import annotations

import difflib
import platform
from dataclasses import asdict
from importlib import metadata
from pathlib import Path

import pytest

from .judge import NOT_MODELLED, REFUSED, Judgement, Match, QuantityVerdict
from .process.session import LoadingError, SolverProcess
from .results.summary import count_answered, count_unexplained, count_verdicts, name_mistakes, summarise_features
from .tables import LEVELS, PROBLEMS, available_levels, load_table

DISTRIBUTION = "mooring-verification"
SCHEMA_VERSION = 1


class UsageProblem(Exception):
    """The command line asks for what cannot be done; the text says what, and what there is."""


class Run:
    """Cases of some levels against the solver of a name. Raises UsageProblem.

    rows : id -> row of the report, of the cases judged in this process
    """

    def __init__(self, name: str, levels=(), xfails: str | None = None, strict: bool = False):
        words = [word.strip() for option in levels for word in option.split(",") if word.strip()]
        for word in words:
            if word not in LEVELS:
                raise UsageProblem(f"--level: {word!r} is none of {', '.join(LEVELS)}")
        try:
            self.solver = SolverProcess(name)
        except LoadingError as error:
            raise UsageProblem(f"--solver: {error}") from None
        try:
            self.levels = self._levels(words)
            self.xfails = read_xfails(xfails) if xfails else {}
        except UsageProblem:
            self.solver.close()
            raise
        self.strict, self.rows = strict, {}
        self.tables = {level: load_table(level) for level in self.levels}

    def _levels(self, words) -> tuple[str, ...]:
        """Return the levels in order: those asked for, else those that the solver has a method for."""
        able = [level for level in LEVELS if any(problem in self.solver.limits for problem in PROBLEMS[level])]
        for word in words:
            if word not in able:
                problems = " or ".join(PROBLEMS[word])
                raise UsageProblem(f"--level {word}: {self.solver.label} has no method {problems}")
            if word not in available_levels():
                raise UsageProblem(f"--level {word}: its cases are not installed")
        levels = words or (LEVELS[:1] if self.solver.is_command else able)
        return tuple(level for level in available_levels() if level in levels)

    # ------------------------------------------------------------ cases
    def cases(self, level: str) -> list:
        """Return the cases of a level, none where it is not asked for."""
        return list(self.tables[level].cases) if level in self.tables else []

    def check(self, case):
        """Judge a case; the test passes, fails, is skipped or fails as expected."""
        solved = self.solver.judge(case, self.tables[case.level].mistakes)
        judgement = solved.judgement
        fails, expected = judgement.fails(self.strict), self.xfails.get(case.id)
        self.rows[case.id] = make_row(judgement, solved.seconds, fails, expected is not None)
        if expected is not None and not fails:
            pytest.fail(f"{case.id}: is {judgement.verdict} and stands in {expected}: take it out", pytrace=False)
        if fails:
            if expected is not None:
                pytest.xfail(judgement.text())
            pytest.fail(judgement.text(), pytrace=False)
        if judgement.verdict in (REFUSED, NOT_MODELLED):
            pytest.skip(f"{judgement.verdict}: {judgement.words}")

    def close(self):
        """End the process of the solver."""
        self.solver.close()

    # ------------------------------------------------------------ what comes out
    @property
    def version(self) -> str:
        """Version of the set: year and month."""
        versions = {table.version for table in self.tables.values()}
        return max(versions, default="unknown")

    def header(self) -> str:
        """Return one line for the head of the run."""
        title = " ".join(filter(None, (self.solver.label, self.solver.version)))
        return f"mooring conformance {self.version}: {title} ({self.solver.name}), {', '.join(self.levels)}"

    def in_order(self, rows: dict) -> list[dict]:
        """Return rows by id in the order of the tables."""
        return [rows[case.id] for table in self.tables.values() for case in table.cases if case.id in rows]

    def judgements(self, rows) -> list[Judgement]:
        """Return the judgements that rows are made of."""
        cases = {case.id: case for table in self.tables.values() for case in table.cases}
        return [read_row(cases[row["id"]], row) for row in rows]

    def describe(self, rows) -> dict:
        """Return the report, as report.schema.json describes it."""
        judgements = self.judgements(rows)
        answered, asked = count_answered(judgements)
        return {
            "schema": SCHEMA_VERSION,
            "set": self.version,
            "suite": own_version(),
            "solver": {"label": self.solver.label, "version": self.solver.version, "name": self.solver.name},
            "python": platform.python_version(),
            "platform": platform.platform(),
            "levels": list(self.levels),
            "strict": self.strict,
            "passed": not any(row["failed"] for row in rows),
            "verdicts": count_verdicts(judgements),
            "answered": {"quantities": answered, "asked": asked},
            "features": summarise_features(judgements),
            "mistakes": [
                asdict(one) | {"cases": list(one.cases), "alike": list(one.alike)} for one in name_mistakes(judgements)
            ],
            "cases": rows,
        }

    def summary(self, rows) -> list[str]:
        """Return the title and the lines of the summary."""
        judgements = self.judgements(rows)
        lines = [f"mooring conformance {self.version}: {self.solver.label}"]
        for level in self.levels:
            mine = [one for one in judgements if one.case.level == level]
            count = ", ".join(f"{n} {verdict}" for verdict, n in count_verdicts(mine).items())
            answered, asked = count_answered(mine)
            if mine:
                lines.append(f"{level}: {count}, of {len(mine)}; {answered} of {asked} quantities answered")
        lines += [f"  {feature}: {text}" for feature, text in summarise_features(judgements).items()]
        mistakes = name_mistakes(judgements)
        lines += [f"mistake: {one.text()}" for one in mistakes]
        open_cases = count_unexplained(judgements, mistakes)
        return lines + ([f"no listed mistake: {open_cases} more cases are not right"] if open_cases else [])


def read_xfails(path: str) -> dict[str, str]:
    """Return id -> "FILE, line n". Raises UsageProblem for an id of no case, naming the nearest one."""
    try:
        lines = Path(path).read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise UsageProblem(f"--xfails {path}: cannot be read: {error}") from None
    known = [case.id for level in available_levels() for case in load_table(level).cases]
    places = {}
    for number, line in enumerate(lines, start=1):
        one = line.partition("#")[0].strip()
        if one and one not in known:
            near = difflib.get_close_matches(one, known, 1, cutoff=0.0)[0]
            raise UsageProblem(f"{path}, line {number}: there is no case {one}; the nearest is {near}")
        if one:
            places[one] = f"{path}, line {number}"
    return places


# ---------------------------------------------------------------- rows of the report
def make_row(judgement: Judgement, seconds: float | None, fails: bool, expected: bool) -> dict:
    """Return a judgement as the report has it; failed: that its test does."""
    case = judgement.case
    return {
        "id": case.id,
        "level": case.level,
        "group": case.group,
        "title": case.title,
        "features": list(case.features),
        "verdict": judgement.verdict,
        "failed": fails != expected,
        "expected_to_fail": expected,
        "message": judgement.words,
        "seconds": seconds,
        "quantities": [asdict(one) | {"digits": _finite(one.digits)} for one in judgement.quantities],
        "unanswered": list(judgement.unanswered) if judgement.quantities else [],
        "matches": [asdict(one) | {"quantities": list(one.quantities)} for one in judgement.matches],
    }


def _finite(digits: float) -> float | None:
    return digits if digits < float("inf") else None


def read_row(case, row: dict) -> Judgement:
    """Return the judgement that a row was made of."""
    quantities = tuple(
        QuantityVerdict(**{name: one[name] for name in QuantityVerdict.__dataclass_fields__})
        for one in row["quantities"]
    )
    matches = tuple(Match(**one | {"quantities": tuple(one["quantities"])}) for one in row["matches"])
    return Judgement(case, row["verdict"], quantities, matches, row["message"])


def own_version() -> str:
    """Return the version of this distribution, "unknown" in a folder that was never installed."""
    try:
        return metadata.version(DISTRIBUTION)
    except metadata.PackageNotFoundError:
        return "unknown"
