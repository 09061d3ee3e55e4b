"""`python -m reports`: runs what is needed and writes the report, a site; with scene files: one page about these."""

from __future__ import annotations

import argparse
import hashlib
import json
import signal
import sys
from pathlib import Path

from .pipeline import compare, external_solvers, history, published
from .pipeline.dependencies.ledger import digests, write_atomically
from .pipeline.dependencies.sources import OUT, files_of
from .pipeline.naming import name_files
from .pipeline.pack import pack
from .pipeline.running.runner import BusyError, Ended, run_all
from .pipeline.stages import CORES, GROUPS, SLOW, Stage, load_case_plan, plan, scene_plan, sweep_stage


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m reports",
        description=__doc__,
        epilog="python -m reports compare [A B]: what became slower, less accurate or failed between two runs; see its "
        "own --help. Exit status 0: all is there and all tests passed; 1: something failed, and the page says what; 2: "
        "what was asked for cannot be done.",
    )
    parser.add_argument("scenes", nargs="*", type=Path, metavar="FILE", help="a page about these only: "
                        "scenes and networks (.toml), MAP++ (.map, .dat) and MoorDyn files (.txt, .dat); or tables of "
                        "load cases (.csv; their columns: python -m benchmarks.load_cases.table --help) and the "
                        "system that they are for")  # fmt: skip
    parser.add_argument(
        "--depth", type=float, metavar="M", help="depth of the water, m, where a MAP++ file asks for it"
    )
    parser.add_argument(
        "--motion", type=Path, metavar="FILE.csv", help="motion of the body of the network files: a series"
    )
    parser.add_argument("--sweep", type=_band, metavar="A:B", help="the response curve of each file over frequencies "
                        "from A to B in Hz, with its stability")  # fmt: skip
    parser.add_argument("--amplitude", type=float, metavar="M", help="of the motion of a --sweep, m")
    parser.add_argument(
        "--quick",
        action="store_true",
        help="less than two minutes: fewer random lines and tests, without the sweep of the tolerance, "
        "the timings of lines at rest, the example that moves and the seeded defects",
    )
    parser.add_argument(
        "--solver",
        action="append",
        default=[],
        type=Path,
        metavar="FILE.py",
        help="a solver of your own, in the same tables and figures (README, Bring your own solver); may be repeated",
    )
    parser.add_argument(
        "--only", nargs="+", metavar="STAGE", help=f"run these only (after the scene files), of: {', '.join(GROUPS)}"
    )
    cases = parser.add_argument_group("load cases, and scenes and networks in waves")
    cases.add_argument("--dask", metavar="ADDRESS", help="solve them on the workers of a Dask scheduler")
    cases.add_argument("--jobs", type=int, default=CORES, metavar="J", help=f"threads (default: {CORES})")
    cases.add_argument("--tolerance", type=float, metavar="E", help="relative error of what is asked (default: 0.02)")
    cases.add_argument("--dt", type=float, metavar="S", help="step in s, with --cells in place of --tolerance")
    cases.add_argument("--cells", type=int, metavar="N", help="cells of a line")
    cases.add_argument("--wohler", type=float, metavar="M", help="exponent of the Woehler curve (default: 3)")
    parser.add_argument("--out", type=Path, default=OUT, metavar="DIR",
                        help=f"folder of page and results (default: {OUT} below this one)")  # fmt: skip
    parser.add_argument(
        "--zip", action="store_true", help="also pack pages, figures and tables into DIR.zip, to be sent"
    )
    parser.add_argument("--fresh", action="store_true", help="measure again what has not changed since the last run")
    return parser


def _band(text: str) -> str:
    """Return a band of frequencies such as 0.02:0.3. Raises argparse.ArgumentTypeError for anything else."""
    try:
        low, high = (float(part) for part in text.split(":"))
    except ValueError:
        low = high = 0.0
    if not 0 < low < high < float("inf"):
        raise argparse.ArgumentTypeError(f"{text!r} is no band of frequencies in Hz, such as 0.02:0.3")
    return text


def _check_arguments(parser: argparse.ArgumentParser, argv) -> argparse.Namespace:
    """Return the arguments, or end with a clear message and exit status 2."""
    arguments = parser.parse_args(argv)
    for name in arguments.only or ():
        if name not in GROUPS and name.endswith(".toml"):
            parser.error(f"{name} stands among the stages: put scene files before --only")
        if name not in GROUPS:
            parser.error(f"unknown stage {name!r}; the stages are {', '.join(GROUPS)}")
    for path in filter(None, (*arguments.scenes, arguments.motion)):
        if not path.is_file():
            parser.error(f"{path}: there is no such scene file")
    if trouble := external_solvers.set_files(arguments.solver):
        parser.error(trouble)
    if _tables(arguments) and len(arguments.scenes) != len(_tables(arguments)) + 1:
        parser.error("tables of load cases (.csv) take one system beside them: cases.csv my_system.toml")
    if arguments.sweep and (_tables(arguments) or not arguments.scenes):
        parser.error("--sweep takes scene or network files: my_line.toml --sweep 0.02:0.3")
    if arguments.amplitude is not None and not (arguments.sweep and arguments.amplitude > 0):
        parser.error("--amplitude is the largest displacement of a --sweep in m, above zero")
    if len({path.resolve() for path in arguments.scenes}) < len(arguments.scenes):
        parser.error("a scene file is given twice")
    if arguments.out.exists() and not arguments.out.is_dir():
        parser.error(f"{arguments.out}: is a file, and --out wants a folder")
    return arguments


def _tables(arguments) -> list[Path]:
    """Return the tables of load cases among the files."""
    return [path for path in arguments.scenes if path.suffix.lower() == ".csv"]


def main(argv=None) -> int:
    """Run the report; return 0: all there and passed; 1: something failed, the page says what; 2: bad input."""
    argv = sys.argv[1:] if argv is None else argv
    if argv[:1] == ["compare"]:
        return compare.main(argv[1:])
    arguments = _check_arguments(_parser(), argv)
    out = arguments.out.resolve()
    try:
        (out / "results").mkdir(parents=True, exist_ok=True)
    except OSError as error:
        print(f"{out}: no results can be written there ({error.strerror}): give another --out", file=sys.stderr)
        return 2
    stages, name = _plan(arguments, out)
    stages = external_solvers.add_sources(stages)
    wanted = arguments.only or [group for group in GROUPS if not (arguments.quick and group in SLOW)]
    chosen = [stage for stage in stages if stage.group in wanted and stage.runs]
    if not chosen:
        there = ", ".join(dict.fromkeys(stage.group for stage in stages))
        print(f"nothing to run: of the stages {there} of this page, --only names none", file=sys.stderr)
        return 2
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        ended = run_all(chosen, out / "results", arguments.fresh)
        if not arguments.scenes:
            history.save(out, stages, [end.stage.title for end in ended if end.state == "failed"])
        path = _page(out, name, stages, ended, not arguments.scenes)
        if arguments.zip:
            print(pack(out))
    except KeyboardInterrupt:
        print("\ninterrupted; finished results are kept and the next run goes on from there", file=sys.stderr)
        return 130
    except BusyError as error:
        print(error, file=sys.stderr)
        return 2
    if arguments.scenes:
        failed = {end.stage.name for end in ended if end.state == "failed"}
        _print_lines([stage for stage in stages if stage.name not in failed], out / "results")
    return _print_outcome(path, ended)


def _plan(arguments, out: Path) -> tuple[list[Stage], str]:
    """Return the stages, and the file name of the page."""
    named = {name: getattr(arguments, name) for name in ("dask", "tolerance", "dt", "cells", "wohler")}
    options = [word for name, value in named.items() if value is not None for word in (f"--{name}", str(value))]
    options += ["--fresh"] if arguments.fresh else []
    if tables := _tables(arguments):
        (system,) = (path for path in arguments.scenes if path not in tables)
        name = f"cases-{'-'.join(path.stem for path in tables)}-{system.stem}.html"
        return load_case_plan(tables, system, tuple(options), arguments.jobs), name
    if arguments.scenes:
        names = name_files(arguments.scenes, out / "results" / "names.json")
        stages = scene_plan(names, arguments.depth, arguments.motion, tuple(options), arguments.jobs)
        if arguments.sweep:
            stages += [sweep_stage(path, arguments.sweep, arguments.amplitude, arguments.depth, name)
                       for path, name in names.items()]  # fmt: skip
        return stages, f"scene-{'-'.join(names.values())}.html"
    from .page.registry import claimed_tests  # and matplotlib, which a page about somebody's lines may not need

    return plan(arguments.quick, published.write_scenes(out / "published"), claimed_tests()), "index.html"


def _page(out: Path, name: str, stages: list[Stage], ended: list[Ended], whole: bool) -> Path:
    """Build the pages, unless everything they are made of is as it was; return the first one."""
    record = out / "results" / f"{name}.key"
    made_of = [digests(file for folder in ("reports", "verification", "reference_data") for file in files_of(folder))]
    made_of += [[end.stage.name, end.tail] for end in ended if end.state == "failed"]
    made_of += [str(Path.cwd())]  # commands are shown as they are typed here
    results = [out / "results" / output for output in ("stages.json", *(stage.output for stage in stages))]
    made_of += [hashlib.sha256(file.read_bytes()).hexdigest() if file.exists() else None for file in results]
    now = hashlib.sha256(json.dumps(made_of).encode()).hexdigest()
    if not ((out / name).exists() and record.exists() and record.read_text(encoding="utf-8") == now):
        from .page import site  # matplotlib only where something is drawn

        record.unlink(missing_ok=True)  # from here on until the end the page is between two states
        site.build(out, name, stages, ended, whole)
        write_atomically(record, now)
    return out / name


def _print_lines(stages: list[Stage], results: Path):
    """Print the lines of every file and the setting to use, and tables of load cases."""
    from .response_curves.sweep import summarise as summarise_sweep
    from .scenes.load_cases import section as load_cases
    from .scenes.networks.settings import merge_timings
    from .scenes.networks.tables import summarise
    from .scenes.terminal import summarise_scene

    for stage in stages:
        path = results / stage.output
        if stage.group == "scenes" and path.exists():
            print(summarise_scene(json.loads(path.read_text(encoding="utf-8"))), end="\n\n")
        if stage.group == "sweep" and path.exists():
            for report in json.loads(path.read_text(encoding="utf-8")).values():
                print(summarise_sweep(report), end="\n\n")
        if stage.group == "load_cases" and path.exists():
            for summary in json.loads(path.read_text(encoding="utf-8")).values():
                print(load_cases.summarise(summary, results.parent), end="\n\n")
        if stage.group == "moving_networks" and path.exists():
            for stem, report in merge_timings(json.loads(path.read_text(encoding="utf-8"))).items():
                print(summarise(report, stem), end="\n\n")


def _print_outcome(path: Path, ended: list[Ended]) -> int:
    """Print what failed and where the page is; return the exit status."""
    failed = [end for end in ended if end.state == "failed"]
    said: set[tuple[str, ...]] = set()
    for end in failed:
        if end.is_refused and end.tail in said:
            continue  # two stages refused one file for one reason
        said.add(end.tail)
        print(
            f"\nthe stage {end.stage.name} failed ({end.stage.command_line(path.parent / 'results')}):", file=sys.stderr
        )
        print(*(f"  {line}" for line in end.tail), sep="\n", file=sys.stderr)
    red = [end.stage.title.removeprefix("tests: ") for end in ended if end.stage.group == "tests" and end.code == 1]
    if red:
        print(f"\nverification tests fail in {', '.join(red)}: the page names them", file=sys.stderr)
    print(path)
    return 1 if failed or red else 0


if __name__ == "__main__":
    sys.exit(main())
