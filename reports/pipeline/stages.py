"""What the report runs: one stage per result file, and the command that writes it."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from .installation import INSTALLED_PYTEST, is_repository
from .sources import ROOT, program

SCENES = Path(str(files("reference_data") / "scenes"))
MOVING_SCENE = SCENES / "dynamics" / "taut_polyester_current.toml"
"""The example that moves: out of its plane, in a current, unlike the cases of the HB paper; it takes longest of all."""
NETWORKS = tuple(SCENES / "networks" / f"{name}_moving.toml" for name in ("oc3", "three_bridles", "chain_wire_chain"))
"""The networks that move: one line a node, joints in a body's yaw, a joint on the seabed."""
TESTS = Path(str(files("verification")))
PYTEST = ("pytest",) if is_repository() else ("pytest", *INSTALLED_PYTEST)
JUNIT = ("-p", "no:benchmark", "--junitxml={part}")
"""Without pytest-benchmark, which makes a folder of its own where the caller stands."""

RANDOM, QUICK_RANDOM = 400, 60
"""Random lines judged against 50 digits: enough to see one wrong answer in a hundred, the whole report within ten
minutes on two cores; a look in two minutes. `python -m benchmarks.catenary.accuracy --random N` judges more."""

CORES = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
JOBS = max(1, CORES // 2)
"""Processes of a stage that can use several: with half of the cores there is always another stage beside it, so that
no core waits for the end of the longest one."""


@dataclass(frozen=True)
class Stage:
    """One child process and the file it writes.

    name : unique; group : what --only takes; title : for the progress bar and the page
    arguments : after ``python -m``; {results} is the folder of the results, {part} a file that becomes ``output`` when
        the child succeeds (for programs that do not write atomically themselves), {jobs} the number of its processes,
        {root} the folder of the packages
    output : file in the folder of the results
    programs : files whose own text and imports the result depends on; sources : files and folders beside those
    timed : a timing, which belongs to one machine and runs alone, pinned to a core
    seconds : expected time before the first run; jobs : cores that it keeps busy
    codes : exit statuses with a result (pytest: 1 = some tests fail)
    better : arguments of a longer run whose result serves as well
    """

    name: str
    group: str
    title: str
    arguments: tuple[str, ...]
    output: str
    programs: tuple[str, ...] = ()
    sources: tuple[str, ...] = ()
    timed: bool = False
    seconds: float = 3.0
    jobs: int = 1
    codes: tuple[int, ...] = (0,)
    better: tuple[str, ...] = ()

    def command_line(self, results: Path) -> str:
        """Return the command as a reader would type it, its results in that folder."""
        words = (_typed(word.replace("{root}", str(ROOT))) for word in self.arguments)
        return self.filled(" ".join(["python -m", *words]), _typed(results), self.output)

    def filled(self, text: str, results, part) -> str:
        """``text`` with the places of folder, file and number of processes filled in."""
        filling = {"{results}": results, "{part}": part, "{jobs}": self.jobs, "{root}": ROOT}
        for place, value in filling.items():
            text = text.replace(place, str(value))
        return text


def _typed(word: str | Path) -> str:
    """Return a path below the working folder as seen from there; anything else as it is."""
    path, here = Path(word), Path.cwd()
    return path.relative_to(here).as_posix() if path.is_relative_to(here) else str(word)


# ---------------------------------------------------------------- tests
LONG_TESTS = {
    "catenary/test_exact": 50,
    "network/test_solve": 20,
    "harmonic_balance/test_solve": 15,
    "suite/test_stability": 13,
    "common/test_failures": 14,
    "catenary/test_invariants": 13,
    "time_domain/test_solve": 12,
    "cable/test_exact": 12,
    "network/test_properties": 12,
    "cable/test_order": 11,
    "network/test_checks": 11,
    "catenary/test_checks": 9,
    "cable/test_invariants": 8,
    "harmonic_balance/test_oscillators": 8,
    "catenary/test_references": 7,
    "cable/test_failures": 6,
    "harmonic_balance/test_start": 6,
    "cable/test_statics": 5,
    "suite/test_fuzz": 5,
}
"""Test files that take long -> expected seconds."""
IN_QUICK = {"catenary/test_exact": "not 50_digits and not random_lines"}
"""Files among them that the quick run takes in part: what pytest -k chooses."""
WHOLE_TREE = {"suite/test_architecture": ("solvers", "verification", "benchmarks", "reference_data", "reports")}
"""Tests that read sources which they do not name one by one."""

ELSEWHERE = (
    "suite/test_report",
    "suite/test_report_runs",
    "suite/test_dynamics_report",
    "suite/test_network_report",
    "suite/test_page",
    "suite/test_defects",
    "suite/test_planting",
)
"""Tests of what makes a report, which show nothing in one that it does not show itself; `pytest` runs them."""


def _tests(quick: bool) -> list[Stage]:
    """Return a stage for each long file; the others together, since starting pytest costs more than most of them."""
    files = (path.relative_to(TESTS).with_suffix("").as_posix() for path in sorted(TESTS.rglob("test_*.py")))
    stems = [stem for stem in files if stem not in ELSEWHERE]
    alone = [stem for stem in stems if stem in WHOLE_TREE or (stem in LONG_TESTS and (not quick or stem in IN_QUICK))]
    short = tuple(f"verification/{stem}.py" for stem in stems if stem not in LONG_TESTS and stem not in WHOLE_TREE)
    typed = (f"{{root}}/{file}" for file in short)
    together = Stage(
        "test_short",
        "tests",
        "tests: short files",
        (*PYTEST, *typed, *JUNIT),
        "tests/test_short.xml",
        (*short, "verification/conftest.py"),
        ("pyproject.toml", "conftest.py"),
        seconds=75,
        codes=(0, 1),
    )
    return [*(_test(stem, quick) for stem in alone), together]


def _test(stem: str, quick: bool) -> Stage:
    file = f"verification/{stem}.py"
    whole = (*PYTEST, f"{{root}}/{file}", *JUNIT)
    fewer = ("-k", IN_QUICK[stem]) if quick and stem in IN_QUICK else ()
    name = stem.replace("/test_", "_")
    title = f"tests: {stem.replace('/test_', ', ').replace('_', ' ')}"
    return Stage(
        f"test_{name}",
        "tests",
        title,
        (*whole, *fewer),
        f"tests/test_{name}.xml",
        (file, "verification/conftest.py"),
        ("pyproject.toml", "conftest.py", *WHOLE_TREE.get(stem, ())),
        seconds=8 if fewer else LONG_TESTS.get(stem, 3),
        codes=(0, 1),
        better=whole if fewer else (),
    )


# ---------------------------------------------------------------- measurements
def _measured(name: str, title: str, arguments: tuple[str, ...], seconds: float, group: str = "", **more) -> Stage:
    """Return the stage of a program of this project whose file is named as the stage."""
    arguments = (arguments[0], "--out", "{results}", *arguments[1:])
    file = f"{name}.json"
    return Stage(name, group or name, title, arguments, file, (program(arguments[0]),), seconds=seconds, **more)


def _machine() -> Stage:
    everything = ("solvers", "verification", "benchmarks", "reference_data", "reports", "pyproject.toml")
    return _measured("machine", "machine", ("benchmarks.run.machine",), 1, sources=everything)


def _sized(name: str, title: str, words: tuple[str, ...], seconds: tuple[float, float], quick: bool, **more) -> Stage:
    """Return the stage of a program with --quick, whose whole run serves the quick report as well."""
    if not quick:
        return _measured(name, title, words, seconds[0], **more)
    whole = (words[0], "--out", "{results}", *words[1:])
    return _measured(name, title, (*words, "--quick"), seconds[1], better=whole, **more)


def _accuracy(quick: bool) -> Stage:
    words = ("benchmarks.catenary.accuracy", "--jobs", "{jobs}", "--random")
    better = (words[0], "--out", "{results}", *words[1:], str(RANDOM)) if quick else ()
    words += (str(QUICK_RANDOM), "--coarse") if quick else (str(RANDOM),)
    return _measured("accuracy", "error of every solver", words, 25 if quick else 50, jobs=JOBS, better=better)


def _benchmarks() -> Stage:
    result = sorted((ROOT / "benchmarks").rglob("bench_*.py"))
    programs = tuple(path.relative_to(ROOT).as_posix() for path in result)
    typed = (f"{{root}}/{program}" for program in programs)
    options = (
        "--benchmark-enable",
        "--benchmark-only",
        "--benchmark-json={part}",
        "--benchmark-max-time=0.5",
        "--benchmark-storage=file://{results}/benchmarks",
    )
    return Stage(
        "benchmarks",
        "benchmarks",
        "timings",
        (*PYTEST, *typed, *options),
        "benchmark.json",
        programs,
        ("pyproject.toml",),
        timed=True,
        seconds=16,
    )


MOVING = {
    "dynamics": ("moving cable", "benchmarks.cable.measure", (21, 6), (10, 4)),
    "harmonic_balance": ("harmonic balance", "benchmarks.harmonic_balance.measure", (24, 10), (60, 10)),
    "mooring": ("moving line", "benchmarks.mooring.measure", (90, 12), (25, 8)),
    "mooring_networks": ("moving networks", "benchmarks.mooring.networks.measure", (26, 11), (18, 5)),
}
"""Group -> title, program, expected seconds of the whole and of the quick run: of what is not timed, and what is."""

DYNAMICS = (*MOVING, "stability")
"""Groups whose results the page shows in its sections on moving cables and on limits."""


def _dynamics(quick: bool) -> Iterator[Stage]:
    """Yield two stages for each program: what is no timing runs beside other work, references first; then timings."""
    for group, (title, module, untimed, timed) in MOVING.items():
        yield _sized(f"{group}_untimed", title, (module, "--kind", "untimed"), untimed, quick, group=group)
        yield _sized(group, f"{title}, timings", (module, "--kind", "timed"), timed, quick, group=group, timed=True)


def _stability(quick: bool) -> Stage:
    words = ("benchmarks.stability.measure", "--jobs", "{jobs}")
    return _sized("stability", "stability maps", words, (125, 12), quick, jobs=JOBS)


def _defects() -> Stage:
    """Return the stage of seeded defects, each with the check named for it; status 1: some promise is broken."""
    named = ("verification.defects", "--out", "{results}", "--jobs", "{jobs}")
    sources = ("solvers", "verification", "reference_data", "pyproject.toml")
    return Stage(
        "defects",
        "defects",
        "seeded defects",
        named,
        "defects.json",
        (),
        sources,
        seconds=190,
        jobs=JOBS,
        codes=(0, 1),
        better=(*named, "--all"),
    )


SCENE_SECONDS = {"published": 1, "scenes": 2, "moving_scene": 9, "moving_network": 12, "load_cases": 60}


def scene_stage(path: Path, group: str = "scenes") -> Stage:
    """Return the stage of one scene file, named after its stem; of a published line the forces only, no times."""
    published = group == "published"
    title = f"{'published value' if published else 'scene'} {path.stem}"
    arguments = (
        "benchmarks.scenes.measure",
        str(path.resolve()),
        "--out",
        "{results}",
        *(("--forces",) if published else ()),
    )
    return Stage(
        f"scene_{path.stem}",
        group,
        title,
        arguments,
        f"scene_{path.stem}.json",
        (program("benchmarks.scenes.measure"),),
        (str(path.resolve()),),
        timed=not published,
        seconds=SCENE_SECONDS[group],
    )


def _moving_networks() -> Iterator[Stage]:
    """Yield two stages: what is no timing beside other work, then the timings."""
    module = "benchmarks.scenes.networks"
    names = tuple(str(path.resolve()) for path in NETWORKS)
    for kind, name, title, seconds in (("untimed", "moving_networks_untimed", "networks in motion", 15),
                                       ("timed", "moving_networks", "networks in motion, timings", 8)):  # fmt: skip
        arguments = (module, *names, "--out", "{results}", "--compact", "--kind", kind)
        yield Stage(name, "moving_networks", title, arguments, f"{name}.json", (program(module),), names,
                    timed=kind == "timed", seconds=seconds)  # fmt: skip


def is_network(path: Path) -> bool:
    """Return whether a file describes a network: one of MAP++ or MoorDyn, or a TOML file with elements."""
    return path.suffix.lower() != ".toml" or "[[elements]]" in path.read_text(encoding="utf-8", errors="replace")


def _series_of(path: Path) -> tuple[str, ...]:
    """Return the CSV file that a network file takes its motion from, if it is there."""
    named = re.search(r'^file\s*=\s*"([^"]+)"', path.read_text(encoding="utf-8", errors="replace"), re.MULTILINE)
    return (str((path.parent / named[1]).resolve()),) if named and (path.parent / named[1]).is_file() else ()


def network_stage(path: Path, depth: float | None = None, series: Path | None = None) -> Stage:
    """Return the stage of one network file, named after its stem; depth in m, where a MAP++ file asks for it.

    series: a CSV file with the motion of the body, in place of the file's own.
    """
    module, where = "benchmarks.scenes.networks", str(path.resolve())
    moved = () if series is None else (str(series.resolve()),)
    arguments = (module, where, "--out", "{results}", *(("--motion", *moved) if moved else ()))
    arguments += () if depth is None else ("--depth", f"{depth:g}")
    name, sources = f"network_{path.stem}", (where, *_series_of(path), *moved)
    return Stage(
        name,
        "moving_networks",
        f"network {path.stem}",
        arguments,
        f"{name}.json",
        (program(module),),
        sources,
        timed=True,
        seconds=SCENE_SECONDS["moving_network"],
    )


def load_case_stages(cases: list[Path], system: Path, options: tuple[str, ...] = (), jobs: int = CORES) -> list[Stage]:
    """Return a stage for each table of load cases on a system; options: those of benchmarks.load_cases.table."""
    module = "benchmarks.load_cases.table"
    return [
        Stage(
            f"load_cases_{path.stem}_{system.stem}",
            "load_cases",
            f"load cases {path.stem}",
            (module, str(path.resolve()), str(system.resolve()), "--out", "{results}", "--jobs", "{jobs}", *options),
            f"load_cases_{path.stem}_{system.stem}.json",
            (program(module),),
            (str(path.resolve()), str(system.resolve()), *_files_beside(path), *_files_beside(system)),
            seconds=SCENE_SECONDS["load_cases"],
            jobs=jobs,
        )
        for path in cases
    ]


def _files_beside(path: Path) -> tuple[str, ...]:
    """Return the CSV files that a file names: operators, spectra, series."""
    named = dict.fromkeys(re.findall(r"[^\s,\"'=]+\.csv", path.read_text(encoding="utf-8", errors="replace")))
    return tuple(str((path.parent / name).resolve()) for name in named if (path.parent / name).is_file())


# ---------------------------------------------------------------- the whole
SLOW = ("work_precision", "defects", "benchmarks", "speed", "moving_scene", "moving_networks")
"""Groups left out by --quick; results of an earlier whole run are still shown."""

GROUPS = (
    "tests",
    "machine",
    "accuracy",
    "benchmarks",
    "work_precision",
    "speed",
    "networks",
    *DYNAMICS,
    "defects",
    "scenes",
    "moving_scene",
    "moving_networks",
    "published",
    "load_cases",
)


def plan(quick: bool, published: list[Path]) -> list[Stage]:
    """Return the stages of the whole report; ``published`` are scene files made from published tables."""
    return [
        *_tests(quick),
        _machine(),
        _accuracy(quick),
        _benchmarks(),
        _measured("work_precision", "error against time", ("benchmarks.catenary.work_precision",), 33, timed=True),
        _measured("speed", "speed side by side", ("benchmarks.catenary.speed",), 14, timed=True),
        _sized("networks", "networks of lines", ("benchmarks.network.measure",), (40, 20), quick, timed=True),
        *_dynamics(quick),
        _stability(quick),
        _defects(),
        *(scene_stage(path) for path in sorted(SCENES.glob("*.toml"))),
        scene_stage(MOVING_SCENE, "moving_scene"),
        *_moving_networks(),
        *(scene_stage(path, "published") for path in published),
    ]  # fmt: skip


def scene_plan(paths: list[Path], depth: float | None = None, series: Path | None = None) -> list[Stage]:
    """Return the stages of a page about somebody's own lines and networks."""
    return [
        _machine(),
        *(network_stage(path, depth, series) if is_network(path) else scene_stage(path) for path in paths),
    ]


def load_case_plan(cases: list[Path], system: Path, options: tuple[str, ...] = (), jobs: int = CORES) -> list[Stage]:
    """Return the stages of a page about tables of load cases on one system."""
    return [_machine(), *load_case_stages(cases, system, options, jobs)]
