"""Settings of the whole verification run: seeds, one BLAS thread, floating-point errors raise, the long version."""

from __future__ import annotations

import gc

import numpy as np
import pytest

try:
    from hypothesis import HealthCheck, settings
    from threadpoolctl import threadpool_limits
except ModuleNotFoundError:  # verification.conformance, which outside solvers run, needs neither
    settings = threadpool_limits = None

EXAMPLES = {"default": 500, "deep": 5000}  # as scipy.special against mpmath: 500 points by default, 5000 on request

for _name, _examples in EXAMPLES.items() if settings else ():
    settings.register_profile(
        _name,
        max_examples=_examples,
        derandomize=True,  # the same examples in every run; a failure prints the blob that repeats it
        deadline=None,
        print_blob=True,
        suppress_health_check=[HealthCheck.too_slow],  # an example against 50 digits takes some 40 ms
    )


def pytest_configure(config):
    if settings:
        config._one_blas_thread = threadpool_limits(1)  # held for the whole run
        settings.load_profile("deep" if _is_deep(config) else "default")


def pytest_collection():
    """Collect tests without garbage collections: each would look through all that was collected so far."""
    gc.disable()


def pytest_collection_finish():
    """Leave what was collected, thousands of tests that live to the end, out of every later garbage collection."""
    gc.enable()
    gc.collect()
    gc.freeze()


def pytest_report_header(config):
    if config.getoption("conformance_solver", default=None):
        return None  # it is about a solver of another
    examples = EXAMPLES["deep" if _is_deep(config) else "default"]
    kind = "deep" if _is_deep(config) else "default"
    return f"verification: {kind} run, Hypothesis derandomized, {examples} examples, seed 2026"


def _is_deep(config) -> bool:
    return bool(config.getoption("--deep", default=False))


@pytest.fixture(scope="session")
def deep(request) -> bool:
    """True in the long version of the run."""
    return _is_deep(request.config)


@pytest.fixture(autouse=True)
def floating_point_errors_raise():
    """Solvers silence them only locally, where a comment says why."""
    with np.errstate(divide="raise", over="raise", invalid="raise"):
        yield
