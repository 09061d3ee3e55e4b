"""Plant every defect of the catalogue in a copy of the project, one at a time, and see which checks find it."""

from __future__ import annotations

import argparse
import json
import os
import signal
import sys
import time
from pathlib import Path

from . import campaign
from .catalogue import CATALOGUE, WIDER, draw, frozen
from .defect import Defect
from .mutants import module_names, sample
from .runner import ROOT, CheckError, Log, digest, run
from .verdict import Verdict, as_json, kept, summary, verdicts

DEFAULT_OUT = Path("mooring-report") / "results"
PROGRESS = "MOORING_PROGRESS"
"""Environment variable; "lines" asks for `progress <done> <total>` on stdout, from which a parent draws its own bar."""


def pairs(catalogue, wider: bool) -> list[tuple[Defect | None, str]]:
    """(defect, check) to run: the checks on the project as it is, each defect with its own, with all if ``wider``."""
    chosen = [(d, c) for d in catalogue for c in dict.fromkeys((d.check, *(WIDER[d.module] if wider else ())))]
    return [(None, check) for check in dict.fromkeys(check for _, check in chosen)] + chosen


def _arguments(argv) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m verification.defects", description=__doc__)
    parser.add_argument("--all", action="store_true", help="show each defect to every check of its module, too (long)")
    parser.add_argument("--sample", type=int, metavar="N", help="misprints, blind spots and N others, drawn by the "
                        "sources: another draw where these have changed")  # fmt: skip
    parser.add_argument("--only", nargs="+", metavar="TEXT", help="defects whose name or module contains one of these")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="checks run at a time")
    parser.add_argument("--timeout", type=float, default=120.0, metavar="S", help="after so long a check has seen it")
    parser.add_argument("--out", type=Path, default=DEFAULT_OUT, metavar="DIR", help="folder of the results")
    parser.add_argument("--fresh", action="store_true", help="run again what has not changed since the last run")
    parser.add_argument("--mutants", type=int, metavar="N", help="plant N random changes of each module instead")
    parser.add_argument("--module", action="append", metavar="NAME", help="plant in this module only (may be repeated)")
    parser.add_argument("--list", action="store_true", help="list the defects and their checks, and run nothing")
    arguments = parser.parse_args(argv)
    if arguments.jobs < 1 or not arguments.timeout > 0 or min(arguments.mutants or 1, arguments.sample or 1) < 1:
        parser.error("--jobs, --timeout, --sample and --mutants must be > 0")
    words, modules = arguments.only or [""], arguments.module or module_names(ROOT / "solvers")
    if unknown := set(modules) - set(module_names(ROOT / "solvers")):
        parser.error(f"no module of solvers is named {', '.join(sorted(unknown))}")
    catalogue = CATALOGUE if arguments.sample is None else draw(arguments.sample, digest(ROOT))
    arguments.catalogue = [d for d in catalogue if d.module in modules]
    if arguments.mutants is not None:
        arguments.catalogue = sample(ROOT / "solvers", arguments.mutants, modules)
    arguments.catalogue = [d for d in arguments.catalogue if any(w in d.name or w == d.module for w in words)]
    if not arguments.catalogue:
        parser.error(f"no defect has {' or '.join(map(repr, words))} in its name or as its module")
    return arguments


def main(argv=None) -> int:
    """Exit status 0: all as it should be; 1: the output says what is not; 2: bad arguments, checks or patches."""
    arguments = _arguments(argv)
    if arguments.list:
        print(*(f"{d.module}: {d.name}: {d.check}" for d in arguments.catalogue), sep="\n")
        return 0
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    options = {"jobs": arguments.jobs, "timeout": arguments.timeout, "fresh": arguments.fresh}
    if arguments.mutants is not None:
        return main_of_mutants(arguments, options)
    log, results = Log(arguments.out / "defects.jsonl"), []
    wanted = pairs(arguments.catalogue, arguments.all)
    try:
        for _, _, result in progress(run(wanted, log, **options)):
            results = result
    except KeyboardInterrupt:
        print("\ninterrupted; finished results are kept and the next run goes on from there", file=sys.stderr)
        return 130
    except CheckError as error:
        print(f"\n{error}", file=sys.stderr)
        return 2
    made = verdicts(arguments.catalogue, results)
    tell(made)
    if arguments.only is None and arguments.module is None:
        write_atomically(arguments.out / "defects.json", json.dumps(as_json(made), indent=1))
    counts = summary(made)
    part = arguments.only or arguments.module
    return 0 if kept(counts) or (part and not (counts["survivors"] or counts["seen_blind"])) else 1


def progress(steps):
    """Pass on (done, total, results) under a bar with the time left, or with lines where a parent asks for them."""
    began, first = time.perf_counter(), None
    for done, total, results in steps:
        first = done if first is None else first
        if os.environ.get(PROGRESS) == "lines":
            print(f"progress {done} {total}", flush=True)
        elif sys.stderr.isatty():
            gone = time.perf_counter() - began
            left = f"{gone * (total - done) / (done - first):.0f} s left" if done > first else "..."
            filled = 30 * done // max(total, 1)
            bar = "#" * filled + "-" * (30 - filled)
            print(f"\rdefects {done}/{total} |{bar}| {gone:.0f} s gone, {left}   ", end="", file=sys.stderr, flush=True)
        yield done, total, results
    if sys.stderr.isatty():
        print(file=sys.stderr)


def tell(result: list[Verdict]):
    """The matrix defect x check, then the counts."""
    columns = sorted({r.check.split("::")[0].split()[0] for v in result for r in v.results})
    print("\n".join(f"{chr(97 + i % 26) * (1 + i // 26):>3} {name}" for i, name in enumerate(columns)))
    print("X: its own check saw it, x: another one did, s: one with stored numbers, .: not seen, !: red by itself\n")
    for v in sorted(result, key=lambda v: v.defect.module):
        marks = " ".join(_mark(v, [r for r in v.results if r.check.startswith(column)]) for column in columns)
        state = "blind" if v.defect.blind and not v.seen else "" if v.good else "SURVIVES" if not v.seen else "SEEN"
        print(f"{v.defect.module:>20}  {v.defect.name:<52.52} {marks}  {state}")
    counts = summary(result)
    print(f"\n{counts['caught']} of {counts['defects']} defects found, {counts['caught_by_named']} by the check named "
          f"for them, {counts['caught_otherwise']} ({counts['rate']:.1%}) without stored numbers; {counts['blind']} "
          f"blind spots; misprints planted: {len(counts['misprints'])}")  # fmt: skip
    for name, what in (
        ("survivors", "not found without stored numbers"),
        ("unexplained", "survive without an explanation"),
        ("seen_blind", "declared blind, and seen"),
        ("missed_misprints", "misprints not found"),
        ("void", "checks that are red without any defect"),
    ):
        if counts[name]:
            print(f"{what}:", *counts[name], sep="\n  ")


def main_of_mutants(arguments, options) -> int:
    """Exit status 0: enough of every module's mutants are killed; 1: the output says where not; 2: a red test."""
    try:
        log = Log(arguments.out / "mutants.jsonl")
        *_, (_, _, results) = progress(campaign.run(arguments.catalogue, log, **options))
    except KeyboardInterrupt:
        print("\ninterrupted; finished results are kept and the next run goes on from there", file=sys.stderr)
        return 130
    except CheckError as error:
        print(f"\n{error}", file=sys.stderr)
        return 2
    rows = campaign.scores(arguments.catalogue, results, campaign.judgements())
    tell_scores(rows)
    return 0 if all(row.rate >= campaign.LEAST for row in rows) else 1


def tell_scores(rows: list[campaign.Score]):
    """Print the mutants of each module, and then those that survived without a judgement."""
    print(f"{'module':>32}  planted  killed  equivalent  open   rate")
    for row in rows:
        counts = f"{row.planted:7d} {row.killed:7d} {len(row.equivalent):11d} {len(row.open):5d}"
        print(f"{row.module:>32}  {counts} {row.rate:6.1%}{'' if row.rate >= campaign.LEAST else '  too few'}")
    planted, killed = sum(row.planted for row in rows), sum(row.killed for row in rows)
    equivalent, left = (sum(len(getattr(row, name)) for row in rows) for name in ("equivalent", "open"))
    print(f"\n{planted} mutants: {killed} killed, {equivalent} judged equivalent, {left} open")
    print(*(f"  {mutant.name}" for row in rows for mutant in row.open), sep="\n")


def _mark(verdict: Verdict, results) -> str:
    marks = [_letter(verdict, r) for r in results]
    return next((letter for letter in "!Xxs." if letter in marks), " ")


def _letter(verdict, result) -> str:
    if result.check in verdict.void:
        return "!"
    if result not in verdict.seen:
        return "."
    if result.check == verdict.defect.check:
        return "X"
    return "s" if frozen(result.test or result.check) else "x"


def write_atomically(path: Path, text: str):
    """Readers see the old file or the new one, never half of it."""
    temporary = path.with_name(f"{path.name}.{os.getpid()}.tmp")
    temporary.write_text(text, encoding="utf-8")
    os.replace(temporary, path)


if __name__ == "__main__":
    sys.exit(main())
