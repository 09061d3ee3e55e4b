"""What has become slower, less accurate or failed between two runs of the report.

A and B are commits whose runs were saved (of an installed wheel: version-X), files that were saved, or "latest";
without them, what is saved is listed.
Exit status 0: nothing past the threshold; 1: something is; 2: bad arguments.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path
from statistics import median, quantiles

from .dependencies.sources import OUT
from .history import OTHERS, Measures, load, of_others, saved

THRESHOLD = 1.3
"""Default ratio B over A beyond which a time or an error counts. Two runs of one commit on a virtual machine with two
cores differed by 0.98 to 1.04 in timings with quartiles and by 0.92 to 1.02 in groups (one pair: benchmarks, speed and
networks). In a run on a busier machine, of an earlier commit, single timings were up to 2.3 times as long: what is
compared wants a quiet machine."""

GOOD = ("right", "passed", "solved", "SUCCESS", "caught")
SHOWN = 40  # rows of each kind


@dataclass(frozen=True)
class Change:
    """One row of the table: values before and after, their ratio with its spread, and whether it alarms.

    kind : "slower", "faster", "less accurate", "more accurate", "failed", "mended"
    """

    kind: str
    name: str
    before: str
    after: str
    ratio: float | None = None
    spread: tuple[float, float] | None = None

    @property
    def alarms(self) -> bool:
        """It is for the worse."""
        return self.kind in ("slower", "less accurate", "failed")


def compare(a: Measures, b: Measures, threshold: float) -> list[Change]:
    """Return all that changed past the threshold; times only between runs on one machine."""
    times = [*_single_times(a, b, threshold), *_group_times(a, b, threshold)] if a.machine == b.machine else []
    return [*_failures(a, b), *_errors(a, b, threshold), *times]


def _ours(names) -> list[str]:
    return [name for name in names if not of_others(name)]


def _common(a: dict, b: dict) -> list[str]:
    return [name for name in a if name in b]


def _past(ratio: float, low: float, high: float, threshold: float) -> str:
    """Return "slower" or "faster" where even the near end of the spread is on that side, else ""."""
    if ratio > threshold and low > 1:
        return "slower"
    return "faster" if ratio < 1 / threshold and high < 1 else ""


def _single_times(a, b, threshold):
    """Yield changes of timings with quartiles; the spread of a ratio is that of the quartiles against one another."""
    for name in _ours(_common(a.times, b.times)):
        if len(a.times[name]) == len(b.times[name]) == 3 and min(a.times[name]) > 0:
            (x, x_low, x_high), (y, y_low, y_high) = a.times[name], b.times[name]
            ratio, spread = y / x, (y_low / x_high, y_high / x_low)
            if kind := _past(ratio, *spread, threshold):
                yield Change(kind, name, _seconds(x), _seconds(y), ratio, spread)


def _group_times(a, b, threshold):
    """Yield changes of groups of timings of one number each: median ratio and its quartiles."""
    for group, ratios in _ratios(a, b, _ours(_common(a.times, b.times))).items():
        ratio, spread = median(ratios), _quartiles(ratios)
        if kind := _past(ratio, *spread, threshold):
            yield Change(kind, f"{group}, {len(ratios)} timings", "1", f"{ratio:.3g}", ratio, spread)


def _ratios(a, b, names) -> dict[str, list[float]]:
    ratios = {}
    for name in names:
        if 1 in (len(a.times[name]), len(b.times[name])) and a.times[name][0] > 0:
            ratios.setdefault(name.partition(" | ")[0], []).append(b.times[name][0] / a.times[name][0])
    return ratios


def _quartiles(ratios) -> tuple[float, float]:
    if len(ratios) < 2:
        return ratios[0], ratios[0]
    low, _, high = quantiles(ratios, n=4, method="inclusive")
    return low, high


def _errors(a, b, threshold):
    for name in _ours(_common(a.errors, b.errors)):
        (x, rounding), (y, _) = a.errors[name], b.errors[name]
        worse, better = max(y, rounding) / max(x, rounding), max(x, rounding) / max(y, rounding)
        if max(worse, better) > threshold:
            kind = "less accurate" if worse > threshold else "more accurate"
            yield Change(kind, name, f"{x:.3g}", f"{y:.3g}", worse)


def _failures(a, b):
    for name in _ours(_common(a.states, b.states)):
        x, y = a.states[name], b.states[name]
        if (x in GOOD) != (y in GOOD) and "skipped" not in (x, y):
            yield Change("failed" if x in GOOD else "mended", name, x, y)
    yield from (Change("failed", f"stage {title}", "ran", "failed") for title in b.failed if title not in a.failed)
    yield from (Change("failed", name, "not there", "failed") for name, y in b.states.items()
                if y == "failed" and name not in a.states)  # fmt: skip


def others(a: Measures, b: Measures) -> list[float]:
    """Return ratios of the times of other codes, the same versions in both runs: how the machine has changed."""
    same = [other for other in OTHERS if a.packages.get(other) == b.packages.get(other)]
    names = (name for name in _common(a.times, b.times) if any(other in name.lower() for other in same))
    return [b.times[name][0] / a.times[name][0] for name in names if a.times[name][0] > 0]


# ---------------------------------------------------------------- the table
def table(a: Measures, b: Measures, changes: list[Change], threshold: float) -> str:
    """Return the comparison in words and rows, what is for the worse first."""
    lines = [f"A: {a.commit}, {a.date}, {a.machine}", f"B: {b.commit}, {b.date}, {b.machine}", ""]
    if a.machine != b.machine:
        lines.append("times are not compared: A and B are of different machines")
    elif ratios := others(a, b):
        low, high = _quartiles(ratios)
        lines.append(f"the machine: other codes take {median(ratios):.2f} times as long in B ({low:.2f} to {high:.2f})")
    counts = {kind: sum(change.kind == kind for change in changes) for kind in KINDS}
    for kind, count in counts.items():
        rows = sorted((change for change in changes if change.kind == kind), key=lambda c: -_far(c))
        lines += [f"\n{kind}: {count}"] if rows else []
        lines += [f"  {_ratio(row):>24}  {row.before} -> {row.after}  {row.name}" for row in rows[:SHOWN]]
        lines += [f"  and {count - SHOWN} more"] if count > SHOWN else []
    pairs = [(a.times, b.times), (a.errors, b.errors), (a.states, b.states)]
    both = ", ".join(f"{len(_common(*pair))} {word}" for pair, word in zip(pairs, ("times", "errors", "outcomes"),
                                                                            strict=True))  # fmt: skip
    gone = sum(len(x.keys() - y.keys()) for x, y in pairs)
    lines.append(f"\ncompared: {both}; {gone} of A are not in B")
    worse = sum(change.alarms for change in changes)
    return "\n".join([*lines, f"{worse} for the worse by more than {threshold:g} times" if worse else
                      f"nothing is worse by more than {threshold:g} times"])  # fmt: skip


KINDS = ("failed", "less accurate", "slower", "mended", "more accurate", "faster")


def _far(change: Change) -> float:
    return max(change.ratio or 1, 1 / (change.ratio or 1))


def _ratio(change: Change) -> str:
    if change.ratio is None:
        return ""
    spread = f" ({change.spread[0]:.3g} to {change.spread[1]:.3g})" if change.spread else ""
    return f"{change.ratio:.3g} times{spread}"


def _seconds(value: float) -> str:
    scale, unit = next((s, u) for s, u in ((1, "s"), (1e3, "ms"), (1e6, "us")) if value * s >= 1 or u == "us")
    return f"{value * scale:.3g} {unit}"


# ---------------------------------------------------------------- command line
def find(name: str, out: Path) -> Path:
    """Return the file of a commit (or its beginning), of a path or of the word latest. Raises ValueError."""
    if Path(name).is_file():
        return Path(name)
    runs = saved(out)
    if name == "latest" and runs:
        return runs[-1]
    matches = [path for path in runs if path.stem.startswith(name)]
    exact = [path for path in matches if path.stem == name] or matches
    if len(exact) == 1:
        return exact[0]
    if exact:
        raise ValueError(f"{name!r} fits several saved runs, give the path of one: {', '.join(map(str, exact))}")
    raise ValueError(f"{name!r} is no file and no saved commit; `python -m reports compare` lists what is saved")


def _parser(default_out: Path) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m reports compare", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)  # fmt: skip
    parser.add_argument("runs", nargs="*", metavar="A B", help="commits, files or latest; B is latest if left out")
    parser.add_argument("--threshold", type=float, default=THRESHOLD, metavar="R",
                        help=f"ratio beyond which a time or an error counts (default {THRESHOLD:g})")  # fmt: skip
    parser.add_argument("--out", type=Path, default=default_out, metavar="DIR", help="folder of the report")
    return parser


def main(argv, default_out: Path = OUT) -> int:
    """Command line."""
    parser = _parser(default_out)
    arguments = parser.parse_args(argv)
    if not arguments.threshold > 1:
        parser.error(f"--threshold {arguments.threshold:g}: a ratio greater than 1 is wanted, such as {THRESHOLD:g}")
    if len(arguments.runs) > 2:
        parser.error(f"two runs are compared, and {len(arguments.runs)} are given")
    try:
        if not arguments.runs:
            return _list(arguments.out)
        a, b = (load(find(name, arguments.out)) for name in [*arguments.runs, "latest"][:2])
    except (ValueError, OSError) as error:
        parser.error(str(error))
    changes = compare(a, b, arguments.threshold)
    print(table(a, b, changes, arguments.threshold))
    return 1 if any(change.alarms for change in changes) else 0


def _list(out: Path) -> int:
    runs = [(path, load(path)) for path in saved(out)]
    for path, run in runs:
        words = f"{len(run.times)} times, {len(run.errors)} errors, {len(run.states)} outcomes"
        print(f"{run.commit:24} {run.date}  {words}  {path}")
    if not runs:
        print(f"nothing is saved in {out / 'history'} yet: `python -m reports` saves what it measures")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
