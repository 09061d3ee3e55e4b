"""Moving networks: MoorDyn beside them, error against run time, growth with lines, damping: mooring_networks.json."""

from __future__ import annotations

from pathlib import Path

from ...cable.measure import add_parts, chosen, measured
from ...run import console, results
from . import agreement, scaling, work_precision


def references(quick: bool, folder: Path):
    """How far apart the fine runs of the nine lines are; the timings find MoorDyn's made."""
    fine = work_precision.references(quick, folder)
    yield {"methods": list(fine)}


def systems_beside_moordyn(quick: bool, folder: Path):
    """Four systems by MoorDyn and here, with what explains the differences."""
    rows = []
    for row in agreement.rows(quick):
        rows.append(row)
        yield None
    yield {"rows": rows}


def work(quick: bool, folder: Path):
    """Error against run time of the nine lines."""
    yield from work_precision.work(quick, folder)


def balance(quick: bool, folder: Path):
    """Where harmonic balance has a response of the nine lines."""
    yield {"rows": work_precision.balance(quick)}


def growth(quick: bool, folder: Path):
    """Time and memory by lines."""
    yield from scaling.growth(quick)


def damping(quick: bool, folder: Path):
    """In time and by harmonic balance, by drag."""
    yield from scaling.damping(quick)


PARTS = {
    "references": references,
    "agreement": systems_beside_moordyn,
    "balance": balance,
    "work": work,
    "growth": growth,
    "damping": damping,
}
TIMED = ("work", "growth", "damping")


def main(argv=None) -> int:
    """Command line."""
    parser = console.parser("mooring_networks", __doc__)
    add_parts(parser, PARTS)
    arguments = parser.parse_args(argv)
    names, output = chosen(arguments, TIMED, "mooring_networks")
    file = measured(PARTS, names, "mooring_networks", arguments.quick, arguments.out)
    results.write(arguments.out / output, file | {"quick": arguments.quick})
    for row in file.get("work", {}).get("ratios", ()):
        print(f"MoorDyn {row['size']}, {row['other']} steps: {row['ratio']:.3g} times as long at {row['rms']:.2g}")
    return 0


if __name__ == "__main__":
    console.run(main)
