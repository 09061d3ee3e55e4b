"""What the report runs: one stage per result file, and the command that writes it."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path

from .dependencies.installation import INSTALLED_PYTEST, is_repository
from .dependencies.sources import ROOT, program

SCENES = Path(str(files("reference_data") / "scenes"))
MOVING_SCENE = SCENES / "dynamics" / "taut_polyester_current.toml"
"""The example that moves: out of its plane, in a current, unlike the cases of the HB paper; it takes longest of all."""
NETWORKS = tuple(SCENES / "networks" / f"{name}_moving.toml" for name in ("oc3", "three_bridles", "chain_wire_chain"))
"""The networks that move: one line a node, joints in a body's yaw, a joint on the seabed."""
TESTS = Path(str(files("verification")))
PYTEST = ("pytest",) if is_repository() else ("pytest", *INSTALLED_PYTEST)
PLUGINS = ("verification/conftest.py", "verification/conformance/plugin.py")  # pytest loads them by itself
JUNIT = ("-p", "no:benchmark", "--junitxml={part}")
"""Without pytest-benchmark, which makes a folder of its own where the caller stands."""

RANDOM, QUICK_RANDOM = 300, 60
"""Random lines judged against 50 digits: of 300 one is wrong in 19 of 20 draws where one in a hundred is; a look in two
minutes. `python -m benchmarks.catenary.accuracy --random N` judges more."""

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
    better : arguments of longer runs whose results serve as well
    runs : whether the report runs it; else its result is shown where another command has left it
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
    better: tuple[tuple[str, ...], ...] = ()
    runs: bool = True

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
ALONE = {"catenary/test_exact": 20, "suite/test_stability": 10, "time_domain/test_solve": 12}
"""Files whose claims take longest, each a stage of its own -> expected seconds."""
NOT_IN_QUICK = (
    "catenary/test_exact.py::test_any_line_over_a_seabed_agrees_with_50_digits",
    "catenary/test_exact.py::test_random_lines",
    "mooring/test_random_networks.py::test_random_networks_move_as_they_must",
    "stability/test_basins.py::test_starts_land_where_another_integrator_has_them",
    "stability/test_curve.py::test_folds_are_those_of_shooting",
    "stability/test_special_points.py::test_special_points_are_those_of_shooting",
    "suite/test_stability.py::test_harmonic_balance_at_the_limits",
    "suite/test_stability.py::test_spans_at_the_limits_against_50_digits",
    "time_domain/test_solve.py::test_the_converged_line_meets_the_reference",
    "time_domain/test_solve.py::test_the_fairlead_stays_where_it_is_prescribed",
)
"""Claims that take longest."""

ELSEWHERE = (
    "suite/report/test_report",
    "suite/report/test_report_runs",
    "suite/report/test_dynamics_report",
    "suite/report/test_network_report",
    "suite/report/test_page",
    "suite/test_defects",
    "suite/test_planting",
)
"""Tests of what makes a report, which show nothing in one that it does not show itself; `pytest` runs them."""


def stages_of_claims(claimed: Iterable[str], quick: bool = False) -> list[Stage]:
    """Return the stages of the tests that the page names, as "room/test_x.py" or "room/test_x.py::test_y".

    Whole files, as `pytest` runs them, serve as well. The last stage is of the files that the page does not name: their
    outcomes are shown where `pytest` has left them.
    """
    files = (path.relative_to(TESTS).with_suffix("").as_posix() for path in sorted(TESTS.rglob("test_*.py")))
    stems = [stem for stem in files if stem not in ELSEWHERE]
    named: dict[str, list[str]] = {stem: [] for stem in stems}
    for test in sorted(set(claimed)):
        if (stem := test.partition(".py")[0]) in named:
            named[stem].append(test)
    together = [stem for stem in stems if named[stem] and stem not in ALONE]
    groups = [([stem], stem.replace("/test_", ", ").replace("_", " ")) for stem in ALONE if named.get(stem)]
    groups += [(together, "other claims")] if together else []
    stages = [_claims(group, [test for stem in group for test in named[stem]], title, quick) for group, title in groups]
    others = [stem for stem in stems if not named[stem]]
    return [*stages, replace(_claims(others, [], "files without a claim of the page", False), runs=False)]


def _claims(stems: list[str], tests: list[str], title: str, quick: bool) -> Stage:
    """Return the stage of some tests of these files; one without tests is of the whole files."""
    files = tuple(f"verification/{stem}.py" for stem in stems)
    whole = (*PYTEST, *(f"{{root}}/{file}" for file in files), *JUNIT)
    tests = [test for test in tests if not ("::" in test and test.partition("::")[0] in tests)]
    fewer = [test for test in tests if test not in NOT_IN_QUICK] if quick else []
    typed = [(*PYTEST, *(f"{{root}}/verification/{test}" for test in some), *JUNIT) for some in (fewer, tests) if some]
    commands = tuple(dict.fromkeys([*typed, whole]))
    name = stems[0].replace("/test_", "_") if len(stems) == 1 else title.replace(" ", "_")
    return Stage(
        f"test_{name}",
        "tests",
        f"tests: {title}",
        commands[0],
        f"tests/test_{name}.xml",
        (*files, *PLUGINS),
        ("pyproject.toml", "conftest.py"),
        seconds=4 if quick else ALONE.get(stems[0], 40),
        codes=(0, 1),
        better=commands[1:],
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
    return _measured(name, title, (*words, "--quick"), seconds[1], better=(whole,), **more)


def _accuracy(quick: bool) -> Stage:
    words = ("benchmarks.catenary.accuracy", "--jobs", "{jobs}", "--random")
    better = ((words[0], "--out", "{results}", *words[1:], str(RANDOM)),) if quick else ()
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
        "--benchmark-max-time=0.25",
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
    "harmonic_balance": ("harmonic balance", "benchmarks.harmonic_balance.measure", (10, 10), (30, 10)),
    "mooring": ("moving line", "benchmarks.mooring.measure", (100, 12), (25, 8)),
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
    return _sized("stability", "stability maps", words, (95, 12), quick, jobs=JOBS)


@dataclass(frozen=True)
class JudgedCode:
    """A code of the conformance matrix: its adapter, the package that it needs, and the cases that take too long.

    seconds : expected, of the whole run and of the quick one; left_out, quick : expressions of pytest's -k
    """

    name: str
    solver: str
    package: str
    seconds: tuple[float, float]
    left_out: tuple[str, ...] = ()
    quick: str = ""

    def cases(self, quick: bool) -> tuple[str, ...]:
        """Return the options that choose its cases, none for all of them."""
        if quick and self.quick:
            return ("-k", self.quick)
        return ("-k", " and ".join(f"not {name}" for name in self.left_out)) if self.left_out else ()


LONG_IN_MOORDYN = tuple(
    f"motion/{name}"
    for name in ("damping-steep", "damping-two", "bridle", "clump", "lazy-wave", "current-along", "seabed-soft-circle")
)
"""Where its explicit steps are shortest: 3 to 15 s of a processor each, as much together as all others."""
SHORT_IN_MOTION = "added-mass or normal-drag-surge or normal-drag-heave or tangential"
JUDGED = (
    JudgedCode("this_project", "benchmarks.conformance.this_project:ThisProject", "solvers", (12, 6),
               quick=f"statics or network or {SHORT_IN_MOTION}"),
    JudgedCode("moorpy", "benchmarks.peers.moorpy:MoorPy", "moorpy", (3, 3)),
    JudgedCode("pycatenary", "benchmarks.peers.pycatenary:PyCatenary", "pycatenary", (2, 2)),
    JudgedCode("moordyn", "benchmarks.peers.moordyn:MoorDyn", "moordyn", (40, 4), LONG_IN_MOORDYN,
               SHORT_IN_MOTION),
)  # fmt: skip


def _conformance(quick: bool) -> Iterator[Stage]:
    """Yield a stage for each code that is installed: the conformance command; status 1: some case fails."""
    tables = tuple(f"reference_data/conformance/{level}.json" for level in ("statics", "network", "motion"))
    command = (*PYTEST, "-p", "verification.conformance.plugin", "--pyargs", "verification.conformance",
               "--conformance-report={part}")  # fmt: skip
    for code in JUDGED:
        if find_spec(code.package):
            whole, fewer = ((*command, "--solver", code.solver, *code.cases(short)) for short in (False, True))
            yield Stage(
                f"conformance_{code.name}", "conformance", f"conformance of {code.name.replace('_', ' ')}",
                fewer if quick else whole, f"conformance_{code.name}.json", (program(code.solver.partition(":")[0]),),
                ("verification/conformance", *tables), seconds=code.seconds[quick], codes=(0, 1),
                better=(whole,) if quick and fewer != whole else ())  # fmt: skip


def _response_curves(quick: bool) -> Stage:
    words = ("benchmarks.response_curves.measure",)
    return _sized("response_curves", "response curves", words, (80, 12), quick)


def sweep_stage(path: Path, band: str, amplitude: float | None = None, depth: float | None = None,
                name: str = "") -> Stage:  # fmt: skip
    """Return the stage of the response curve of one line or network over a band such as 0.02:0.3, in Hz."""
    module, stem = "benchmarks.response_curves.sweep", name or path.stem
    arguments = (module, str(path.resolve()), "--band", band, "--out", "{results}", "--name", stem)
    arguments += () if amplitude is None else ("--amplitude", f"{amplitude:g}")
    arguments += () if depth is None else ("--depth", f"{depth:g}")
    sources = (str(path.resolve()), *_series_of(path))
    return Stage(f"sweep_{stem}", "sweep", f"sweep of {path.stem}", arguments, f"sweep_{stem}.json",
                 (program(module),), sources, seconds=20)  # fmt: skip


SAMPLE = 124
"""Seeded defects that are planted beside misprints and blind spots, one from every module: a quarter of all."""


def _defects() -> Stage:
    """Return the stage of seeded defects, each with the check named for it; status 1: some promise is broken."""
    named = ("verification.defects", "--out", "{results}", "--jobs", "{jobs}")
    drawn = (*named, "--sample", str(SAMPLE))
    sources = ("solvers", "verification", "reference_data", "pyproject.toml")
    return Stage(
        "defects",
        "defects",
        "seeded defects",
        drawn,
        "defects.json",
        (),
        sources,
        seconds=90,
        jobs=JOBS,
        codes=(0, 1),
        better=(named, (*named, "--all")),
    )


SCENE_SECONDS = {"published": 1, "scenes": 2, "moving_scene": 9, "moving_network": 12, "load_cases": 60, "own_sea": 15}


def scene_stage(path: Path, group: str = "scenes", name: str = "") -> Stage:
    """Return the stage of one scene file by its name, else its stem; of a published line the forces only, no times."""
    name = name or path.stem
    published = group == "published"
    title = f"{'published value' if published else 'scene'} {path.stem}"
    arguments = (
        "benchmarks.scenes.measure",
        str(path.resolve()),
        "--out",
        "{results}",
        *(("--forces",) if published else ()),
        *(("--name", name) if name != path.stem else ()),
    )
    return Stage(
        f"scene_{name}",
        group,
        title,
        arguments,
        f"scene_{name}.json",
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


def _load_case_costs() -> Iterator[Stage]:
    """Yield two stages: the errors of load cases beside other work, then what they cost, with these errors."""
    group, words = "load_case_costs", ("benchmarks.load_cases.measure", "--kind")
    yield _measured(f"{group}_untimed", "load cases", (*words, "untimed"), 25, group)
    yield _measured(group, "load cases, timings", (*words, "timed"), 17, timed=True)


def is_network(path: Path) -> bool:
    """Return whether a file describes a network: one of MAP++ or MoorDyn, or a TOML file with elements."""
    return path.suffix.lower() != ".toml" or "[[elements]]" in path.read_text(encoding="utf-8", errors="replace")


def _series_of(path: Path) -> tuple[str, ...]:
    """Return the CSV file that a network file takes its motion from, if it is there."""
    named = re.search(r'^file\s*=\s*"([^"]+)"', path.read_text(encoding="utf-8", errors="replace"), re.MULTILINE)
    return (str((path.parent / named[1]).resolve()),) if named and (path.parent / named[1]).is_file() else ()


def network_stage(path: Path, depth: float | None = None, series: Path | None = None, name: str = "") -> Stage:
    """Return the stage of one network file by its name, or else its stem; depth in m, where a MAP++ file asks for it.

    series: a CSV file with the motion of the body, in place of the file's own.
    """
    module, where = "benchmarks.scenes.networks", str(path.resolve())
    moved = () if series is None else (str(series.resolve()),)
    arguments = (module, where, "--out", "{results}", *(("--motion", *moved) if moved else ()))
    arguments += () if depth is None else ("--depth", f"{depth:g}")
    arguments += ("--name", name) if name and name != path.stem else ()
    name, sources = f"network_{name or path.stem}", (where, *_series_of(path), *moved)
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


def is_in_waves(path: Path) -> bool:
    """Return whether the [motion] of a scene or network file is a sea, which is a load case of its own."""
    if path.suffix.lower() != ".toml":
        return False
    return bool(re.search(r"^\s*spectrum\s*=", path.read_text(encoding="utf-8", errors="replace"), re.MULTILINE))


def sea_stage(path: Path, options: tuple[str, ...] = (), jobs: int = CORES, name: str = "") -> Stage:
    """Return the stage of a system in the sea of its own [motion]; options: those of benchmarks.load_cases.table."""
    module, name = "benchmarks.load_cases.table", name or path.stem
    named = ("--name", name) if name != path.stem else ()
    return Stage(
        f"load_cases_{name}",
        "load_cases",
        f"{path.stem} in waves",
        (module, str(path.resolve()), "--out", "{results}", "--jobs", "{jobs}", *named, *options),
        f"load_cases_{name}.json",
        (program(module),),
        (str(path.resolve()), *_files_beside(path)),
        seconds=SCENE_SECONDS["own_sea"],
        jobs=jobs,
    )


def _files_beside(path: Path) -> tuple[str, ...]:
    """Return the CSV files that a file names: operators, spectra, series."""
    named = dict.fromkeys(re.findall(r"[^\s,\"'=]+\.csv", path.read_text(encoding="utf-8", errors="replace")))
    return tuple(str((path.parent / name).resolve()) for name in named if (path.parent / name).is_file())


# ---------------------------------------------------------------- the whole
SLOW = ("work_precision", "defects", "benchmarks", "speed", "moving_scene", "moving_networks", "load_case_costs")
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
    "conformance",
    "response_curves",
    "defects",
    "scenes",
    "moving_scene",
    "moving_networks",
    "published",
    "load_cases",
    "sweep",
    "load_case_costs",
)


def plan(quick: bool, published: list[Path], claimed: Iterable[str] = ()) -> list[Stage]:
    """Return the stages of the whole report.

    published : scene files made from published tables; claimed : tests that the page names
    """
    return [
        *stages_of_claims(claimed, quick),
        _machine(),
        _accuracy(quick),
        _benchmarks(),
        _measured("work_precision", "error against time", ("benchmarks.catenary.work_precision",), 33, timed=True),
        _measured("speed", "speed side by side", ("benchmarks.catenary.speed",), 14, timed=True),
        _sized("networks", "networks of lines", ("benchmarks.network.measure",), (40, 20), quick, timed=True),
        *_dynamics(quick),
        _stability(quick),
        *_conformance(quick),
        _response_curves(quick),
        _defects(),
        *(scene_stage(path) for path in sorted(SCENES.glob("*.toml"))),
        scene_stage(MOVING_SCENE, "moving_scene"),
        *_moving_networks(),
        *_load_case_costs(),
        *(scene_stage(path, "published") for path in published),
    ]  # fmt: skip


def scene_plan(
    names: dict[Path, str],
    depth: float | None = None,
    series: Path | None = None,
    options: tuple[str, ...] = (),
    jobs: int = CORES,
) -> list[Stage]:
    """Return the stages of a page about somebody's own lines and networks, files with their names.

    options: those of benchmarks.load_cases.table, for what moves in waves; series: a motion in place of the files' own.
    """
    at_rest = (network_stage(path, depth, series, name) if is_network(path) else scene_stage(path, name=name)
               for path, name in names.items())  # fmt: skip
    in_waves = (sea_stage(path, options, jobs, name) for path, name in names.items()
                if is_in_waves(path) and not (series and is_network(path)))  # fmt: skip
    return [_machine(), *at_rest, *in_waves]


def load_case_plan(cases: list[Path], system: Path, options: tuple[str, ...] = (), jobs: int = CORES) -> list[Stage]:
    """Return the stages of a page about tables of load cases on one system."""
    return [_machine(), *load_case_stages(cases, system, options, jobs)]
