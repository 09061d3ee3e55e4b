"""Tables of load cases on Dask: the same rows bit for bit, and a killed worker loses none of them."""

from __future__ import annotations

import os
import signal

import pytest

from solvers.load_cases import solve_load_cases

from .systems import CATENARY, sea_case

distributed = pytest.importorskip("distributed", reason="the optional extra dask is not installed")
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning")  # of sockets to the worker that is killed
SETTING = {"dt": 0.2, "cells": 8}
SEAS = [sea_case(f"sea {seed}", 0.4 + 0.02 * seed, seed, duration=200.0) for seed in range(24)]


def test_two_workers_give_the_same_rows_though_one_is_killed():
    """A local cluster of two processes, one killed once some rows are done: all rows, as this process has them."""
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        workers = client.run(os.getpid)
        done = []

        def kill_one(count, total):
            done.append(count)
            if count == 3:
                os.kill(min(workers.values()), signal.SIGKILL)

        table = solve_load_cases(CATENARY, SEAS, **SETTING, executor=client.get_executor(), progress=kill_one)
    assert len(workers) == 2 and done == list(range(len(SEAS) + 1))
    assert table.cases == solve_load_cases(CATENARY, SEAS, **SETTING).cases and not table.failed
