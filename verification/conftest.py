"""Settings of the whole verification run: seeds, one BLAS thread, floating-point errors raise, the long version."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from threadpoolctl import threadpool_limits

from . import IN_REPOSITORY

EXAMPLES = {"default": 500, "deep": 5000}  # as scipy.special against mpmath: 500 points by default, 5000 on request

for _name, _examples in EXAMPLES.items():
    settings.register_profile(
        _name,
        max_examples=_examples,
        derandomize=True,  # the same examples in every run; a failure prints the blob that repeats it
        deadline=None,
        print_blob=True,
        suppress_health_check=[HealthCheck.too_slow],  # an example against 50 digits takes some 40 ms
    )


if not IN_REPOSITORY:

    def pytest_addoption(parser):
        """The option that conftest.py of the repository adds, which no wheel has."""
        parser.addoption("--deep", action="store_true", default=False, help="the long version, as in the repository")


def pytest_configure(config):
    config._one_blas_thread = threadpool_limits(1)  # held for the whole run
    settings.load_profile("deep" if config.getoption("--deep") else "default")


def pytest_report_header(config):
    deep = config.getoption("--deep")
    examples = EXAMPLES["deep" if deep else "default"]
    return f"verification: {'deep' if deep else 'default'} run, Hypothesis derandomized, {examples} examples, seed 2026"


@pytest.fixture(scope="session")
def deep(request) -> bool:
    """True in the long version of the run."""
    return request.config.getoption("--deep")


@pytest.fixture(autouse=True)
def floating_point_errors_raise():
    """Solvers silence them only locally, where a comment says why."""
    with np.errstate(divide="raise", over="raise", invalid="raise"):
        yield
