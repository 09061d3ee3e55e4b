"""The pytest plugin: options, one test a case, a summary by feature, a report in JSON and a badge.

It is an entry point of pytest, so it is loaded wherever the package is installed. It adds its options, and takes part,
only where a command line names this package: a project of its own may have a ``--solver`` or ``--level``, too.
"""

from __future__ import annotations

import argparse
import contextlib
from pathlib import Path

import pytest

from verification import IN_REPOSITORY

from .tables import LEVELS

HERE = Path(__file__).parent
PACKAGE = "verification"


# ---------------------------------------------------------------- options
def pytest_addoption(parser, pluginmanager):
    """Add the options where the command line names this package, and everywhere in its repository."""
    config = pluginmanager.get_plugin("pytestconfig")
    if IN_REPOSITORY or any(_names_package(str(word)) for word in config.invocation_params.args):
        _add_options(parser)


def _names_package(word: str) -> bool:
    """Return whether a word of the command line is this package, a module of it, or a path in it."""
    name = word.partition("::")[0]
    return name.partition(".")[0] == PACKAGE or str(HERE.parent) in str(Path(name).absolute())


def _add_options(parser):
    group = parser.getgroup("mooring", "verification of mooring codes")
    group.addoption("--deep", action="store_true", default=False, dest="mooring_deep",
                    help="the long version of the suite's own tests: 5000 random lines and examples")  # fmt: skip
    group.addoption("--solver", metavar="SOLVER", dest="conformance_solver",
                    help="the code to judge: my_code.py, my_code.py:MyClass, package.module:MyClass, or a program with "
                    'its arguments, "./my_program --json"')  # fmt: skip
    group.addoption("--level", action="append", default=[], metavar="LEVEL", dest="conformance_levels",
                    help="statics, network or motion; may be repeated, or a list with commas (default: all that the "
                    "code has methods for; of a program statics)")  # fmt: skip
    group.addoption("--xfails", metavar="FILE", dest="conformance_xfails",
                    help="ids of cases known to fail, one a line, # comments; one that does not is red")  # fmt: skip
    group.addoption("--conformance-report", metavar="FILE.json", dest="conformance_report",
                    help="write all verdicts, errors and bounds (report.schema.json)")  # fmt: skip
    group.addoption("--badge", metavar="FILE.svg", dest="conformance_badge", help="write the result as a picture")
    # where --strict is an option of pytest itself, for strictness of its own, both are meant
    with contextlib.suppress(ValueError, argparse.ArgumentError):
        group.addoption("--strict", action="store_true", dest="strict", help="inaccurate answers fail, too")


def is_strict(config) -> bool:
    """Return whether --strict is given: pytest 8 keeps a flag, pytest 9 a setting that it overrides."""
    overridden = config.getoption("override_ini", default=None) or ()
    return bool(config.getoption("strict", default=False)) or "strict=true" in overridden


# ---------------------------------------------------------------- configuration
def pytest_configure(config):
    """Load the solver and check levels and xfails before anything is collected."""
    name = config.getoption("conformance_solver", default=None)
    if name is None:
        _refuse_alone(config)
    elif not config.getoption("help", default=False):
        from .run import Run, UsageProblem

        try:
            run = Run(name, config.getoption("conformance_levels"), config.getoption("conformance_xfails"),
                      is_strict(config))  # fmt: skip
        except UsageProblem as problem:
            raise pytest.UsageError(str(problem)) from None
        config.pluginmanager.register(Session(config, run), "mooring-conformance-session")


def _refuse_alone(config):
    """Raise UsageError for options without a solver, and where nothing but these cases is asked for."""
    given = [word for word in ("xfails", "report", "badge", "levels") if config.getoption(f"conformance_{word}", None)]
    only = config.args and all(_is_here(word) for word in config.args)
    if (given or only) and not hasattr(config, "workerinput"):
        raise pytest.UsageError(
            "--solver: say which code is to be judged: my_code.py, package.module:MyClass, or a program"
        )


def _is_here(word: str) -> bool:
    path = Path(word.partition("::")[0])
    if word.startswith(f"{PACKAGE}.conformance"):
        return True
    return path.exists() and path.resolve() in (HERE, *HERE.glob("test_*.py"))
    return word.startswith(f"{PACKAGE}.conformance") or (
        path.exists() and path.resolve() in (HERE, *HERE.glob("test_*.py"))
    )


def pytest_ignore_collect(collection_path, config):
    """Leave the cases out of a run of other tests, which names no solver."""
    if collection_path.parent == HERE and not config.getoption("conformance_solver", default=None):
        return True
    return None


class Session:
    """A run with a solver: its tests, and what is said at the end."""

    def __init__(self, config, run):
        self.config, self.run, self.rows = config, run, {}

    def pytest_report_header(self):
        """Return the set, the solver and the levels."""
        return self.run.header()

    def pytest_ignore_collect(self, collection_path):
        """Leave out the modules of levels that are not asked for."""
        modules = {HERE / f"test_{level}.py" for level in LEVELS if level not in self.run.levels}
        return True if collection_path in modules else None

    def pytest_generate_tests(self, metafunc):
        """Make a test of every case of the level that a module asks for."""
        if "conformance_case" in metafunc.fixturenames:
            cases = self.run.cases(metafunc.module.LEVEL)
            metafunc.parametrize("conformance_case", cases, ids=[case.id for case in cases])

    @pytest.fixture
    def conformance(self):
        """The run, which judges a case."""
        return self.run

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self, item, call):
        """Put the row of the case into the report of its test, which also comes from another process."""
        report = yield
        case = getattr(item, "callspec", None) and item.callspec.params.get("conformance_case")
        if case and call.when == "call":
            report.mooring_conformance = self.run.rows.get(case.id)
        return report

    def pytest_runtest_logreport(self, report):
        """Collect the rows."""
        row = getattr(report, "mooring_conformance", None)
        if row:
            self.rows[row["id"]] = row

    def pytest_sessionfinish(self, session):
        """Write report and badge, in the one process that has all rows; a run that judged nothing did not pass."""
        self.run.close()
        if hasattr(self.config, "workerinput"):
            return
        from .judge import NOT_MODELLED  # here, for it takes numpy, and a plugin is imported in every run of pytest

        if self.rows and all(row["verdict"] == NOT_MODELLED for row in self.rows.values()):
            session.exitstatus = session.exitstatus or pytest.ExitCode.NO_TESTS_COLLECTED
        from .results.report import write_badge, write_report

        rows = self.run.in_order(self.rows)
        for option, write in (("conformance_report", write_report), ("conformance_badge", write_badge)):
            path = self.config.getoption(option)
            if path:
                write(Path(path), self.run.describe(rows))

    def pytest_terminal_summary(self, terminalreporter):
        """Print the verdicts by level and by feature, and the mistakes."""
        lines = self.run.summary(self.run.in_order(self.rows))
        terminalreporter.section(lines[0])
        for line in lines[1:]:
            terminalreporter.write_line(line)
