"""What a whole run of pytest leaves for the report; the plugin of options, for a folder that was never installed."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest_plugins = ["verification.conformance.plugin"]

RESULTS = Path("mooring-report") / "results"
"""Where the report keeps its results, below the caller's folder."""
CHOICES = ("keyword", "markexpr", "deselect", "ignore", "ignore_glob", "lf", "maxfail", "collectonly", "xmlpath")
"""Options of pytest that leave tests out, or ask for a file of their own."""


@pytest.hookimpl(tryfirst=True)
def pytest_cmdline_main(config):
    """Have the workers of ``-n`` take a file's tests together, and steal from one another only at the end.

    A fixture of a module is then made once and a loop compiled once, where tests dealt out in turns make both on every
    worker.
    """
    if getattr(config.option, "numprocesses", None) and config.option.dist == "no":
        config.option.dist = "worksteal"


@pytest.hookimpl(tryfirst=True)
def pytest_configure(config):
    """Have the outcomes of a whole run written for the report, with a digest of the sources that they are of."""
    is_whole = config.args_source is pytest.Config.ArgsSource.TESTPATHS
    if is_whole and not any(getattr(config.option, name, None) for name in CHOICES) and not _is_worker(config):
        config.pluginmanager.register(_Recorder(config))


def _is_worker(config) -> bool:
    return hasattr(config, "workerinput")


class _Recorder:
    """Leaves the outcomes of a whole run where the report looks for them, so that it need not run the tests again."""

    def __init__(self, config):
        from reports.pipeline.running.pytest_results import digest_sources

        self.xml, self.sources = config.invocation_params.dir / RESULTS / "tests" / "pytest.xml", digest_sources()
        config.option.xmlpath = str(self.xml)

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self, session, exitstatus):
        if exitstatus not in (0, 1) or session.shouldfail or session.shouldstop:
            return
        try:
            from reports.page.registry import claimed_tests
            from reports.pipeline.running.pytest_results import record_outcomes
            from reports.pipeline.stages import stages_of_claims
        except ImportError:  # without matplotlib there is no report either
            return
        record_outcomes(self.xml, self.xml.parents[1], stages_of_claims(claimed_tests()), self.sources)
