"""What the report runs: one stage per result file, and the command that writes it."""

from __future__ import annotations

import importlib.util
import os
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
SCENES = ROOT / "reference_data" / "scenes"

RANDOM, QUICK_RANDOM = 1000, 150
"""Random lines judged against 50 digits: enough to see a wrong answer in a few thousand; a look in two minutes."""

CODE = ("solvers", "verification/cases", "verification/exact", "verification/reference.py", "verification/registry.py")
MEASURED = (*CODE, "benchmarks", "reference_data")
EVERYTHING = ("solvers", "verification", "benchmarks", "reference_data", "reports", "pyproject.toml")


@dataclass(frozen=True)
class Stage:
    """One child process and the file it writes.

    name : unique; group : what --only takes; title : for the progress bar and the page
    arguments : after ``python -m``; {results} is the folder of the results, {part} a file that becomes ``output`` when
        the child succeeds (for programs that do not write atomically themselves)
    output : file in the folder of the results; sources : folders and files the result depends on
    timed : a timing, which belongs to one machine; seconds : expected time before the first run
    codes : exit statuses with a result (pytest: 1 = some tests fail)
    better : arguments of a longer run whose result serves as well
    """

    name: str
    group: str
    title: str
    arguments: tuple[str, ...]
    output: str
    sources: tuple[str, ...]
    timed: bool = False
    seconds: float = 5.0
    codes: tuple[int, ...] = (0,)
    better: tuple[str, ...] = ()

    @property
    def shown(self) -> str:
        """The command as a reader would type it."""
        words = [
            Path(word).relative_to(ROOT).as_posix() if word.startswith(str(ROOT)) else word for word in self.arguments
        ]
        return (
            " ".join(["python -m", *words]).replace("{results}", "reports/out/results").replace("{part}", self.output)
        )


LONG_TESTS = ("50_digits", "random_lines", "test_report", "test_network", "test_harmonic", "test_oscillators",
              "test_time_domain", "test_cable", "test_exact_dynamics", "test_fuzz", "test_stability", "test_defects",
              "test_found_by_defects")  # fmt: skip
QUICK_TESTS = " and ".join(f"not {name}" for name in LONG_TESTS)
"""Tests of the quick run: without those that take long, and without a report in a report."""

SLOW = ("work_precision", "defects")
"""Groups left out by --quick; results of an earlier whole run are still shown."""


def _tests(quick: bool) -> Stage:
    parallel = ("-n", "2") if importlib.util.find_spec("xdist") and (os.cpu_count() or 1) > 1 else ()
    arguments = ("pytest", "verification", "--junitxml={part}", *parallel)
    fewer, better = (("-k", QUICK_TESTS), arguments) if quick else ((), ())
    title, seconds = "verification tests", 20 if quick else 75
    arguments = (*arguments, *fewer)
    return Stage(
        "tests", "tests", title, arguments, "tests.xml", EVERYTHING, seconds=seconds, codes=(0, 1), better=better
    )


def _accuracy(random: int) -> tuple[str, ...]:
    return ("benchmarks.accuracy", "--out", "{results}", "--random", str(random), "--jobs", str(os.cpu_count() or 1))


def _machine() -> Stage:
    return Stage(
        "machine", "machine", "machine", ("benchmarks.machine", "--out", "{results}"), "machine.json", EVERYTHING
    )


DYNAMICS = {"dynamics": ("moving cable", "benchmarks.cable_dynamics", 32, 10),
            "harmonic_balance": ("harmonic balance", "benchmarks.harmonic_balance", 110, 30),
            "stability": ("stability maps", "benchmarks.stability", 65, 10)}  # fmt: skip
"""Stage -> title, program, expected seconds of the whole and of the quick run."""


def _dynamics(quick: bool) -> list[Stage]:
    """The moving cable; the quick run measures fewer sizes, and a whole one serves as well."""
    stages = []
    for name, (title, program, long, short) in DYNAMICS.items():
        whole = (program, "--out", "{results}")
        arguments, better = ((*whole, "--quick"), whole) if quick else (whole, ())
        expected = short if quick else long
        stages.append(Stage(name, name, title, arguments, f"{name}.json", MEASURED, True, expected, better=better))
    return stages


def _defects() -> Stage:
    """Every seeded defect and the check named for it, or all of its module; status 1: some promise is broken."""
    named = ("verification.defects", "--out", "{results}", "--jobs", str(os.cpu_count() or 1))
    sources = ("solvers", "verification", "reference_data", "pyproject.toml")
    return Stage("defects", "defects", "seeded defects", named, "defects.json", sources, seconds=400, codes=(0, 1),
                 better=(*named, "--all"))  # fmt: skip


def scene_stage(path: Path, group: str = "scenes") -> Stage:
    """The stage of one scene file; its result is named after the stem."""
    title = f"{'scene' if group == 'scenes' else 'published value'} {path.stem}"
    arguments = ("benchmarks.scene", str(path.resolve()), "--out", "{results}")
    sources = (*MEASURED, str(path.resolve()))
    return Stage(f"scene_{path.stem}", group, title, arguments, f"scene_{path.stem}.json", sources, True, 2)


def plan(quick: bool, published: list[Path]) -> list[Stage]:
    """The stages of the whole report, timings last; ``published`` are scene files made from published tables."""
    random = QUICK_RANDOM if quick else RANDOM
    better = _accuracy(RANDOM) if quick else ()
    chosen = ("-o", "python_files=bench_*.py", "--benchmark-enable", "--benchmark-only")
    timings = ("pytest", "benchmarks", *chosen, "--benchmark-json={part}")
    networks = ("benchmarks.networks", "--out", "{results}")
    return [
        _tests(quick),
        _machine(),
        Stage("accuracy", "accuracy", "error of every solver", _accuracy(random), "accuracy.json", MEASURED,
              seconds=60 * random / RANDOM, better=better),
        Stage("benchmarks", "benchmarks", "timings", timings, "benchmark.json", MEASURED, True, 15),
        Stage("work_precision", "work_precision", "error against time",
              ("benchmarks.work_precision", "--out", "{results}"), "work_precision.json", MEASURED, True, 60),
        Stage("speed", "speed", "speed side by side",
              ("benchmarks.speed", "--out", "{results}"), "speed.json", MEASURED, True, 15),
        Stage("networks", "networks", "networks of lines", (*networks, *(("--quick",) if quick else ())),
              "networks.json", MEASURED, True, 25 if quick else 75, better=networks if quick else ()),
        *_dynamics(quick),
        _defects(),
        *(scene_stage(path) for path in sorted(SCENES.glob("*.toml"))),
        *(scene_stage(path, "published") for path in published),
    ]  # fmt: skip


def scene_plan(paths: list[Path]) -> list[Stage]:
    """The stages of a page about somebody's own lines."""
    return [_machine(), *(scene_stage(path) for path in paths)]


GROUPS = ("tests", "machine", "accuracy", "benchmarks", "work_precision", "speed", "networks", *DYNAMICS, "defects",
          "scenes", "published")  # fmt: skip
