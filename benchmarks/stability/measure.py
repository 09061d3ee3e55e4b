"""Where the solvers break, and whether they say so: stability maps of every solver, stability.json."""

from __future__ import annotations

import json
import signal
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import cache, partial
from pathlib import Path

from threadpoolctl import threadpool_limits

from ..run import console, results
from ..run import oracle_cache as truth
from . import cables as stability_cables
from . import harmonic as stability_harmonic
from . import networks as stability_networks
from . import peers as stability_peers
from . import spans as stability_spans
from . import stiff as stability_stiff
from . import time as stability_time
from .maps import VERDICTS, Map, sources

MODULES = stability_networks, stability_cables, stability_time, stability_harmonic


@cache
def work(folder: Path, quick: bool) -> dict[str, Map | Callable]:
    """What the file is made of: every map in the order of the page, and functions that yield rows, by name."""
    known = truth.TruthCache(folder)
    maps = [*stability_spans.maps(known), *(one for module in MODULES for one in module.maps())]
    return {one.name: one.quick() if quick else one for one in maps} | {
        "explicit": stability_stiff.explicit,
        "axial": stability_stiff.axial,
        "peers_spans": partial(stability_peers.spans, known, quick),
        "peers_dynamics": partial(stability_peers.dynamics, quick),
    }


def part(folder: Path, quick: bool, name: str, row: int | None):
    """A row of a map, or all rows of the other pieces; in a process of its own."""
    made = work(folder, quick)[name]
    return made.row(row) if isinstance(made, Map) else results.plain(list(made()))


def measured(folder: Path, chosen, quick: bool, jobs: int) -> dict:
    """The file; each piece is kept in folder/cache when it is finished, by the content of what it is made with."""
    pieces = {name: made for name, made in work(folder, quick).items() if not chosen or name in chosen}
    path = lambda name: folder / "cache" / f"stability-{name}{'-quick' if quick else ''}-{sources()}.json"
    new = [name for name in pieces if not path(name).exists()]
    rows = {name: _rows(pieces[name]) for name in new}
    with ProcessPoolExecutor(jobs, initializer=_start_process) as pool:
        heavy = sorted(new, key=lambda name: isinstance(pieces[name], Map))  # what cannot be cut comes first
        sent = {pool.submit(part, folder, quick, name, row): (name, row) for name in heavy for row in rows[name]}
        done = {name: {} for name in new}
        try:
            for future in console.progress(as_completed(sent), len(sent), "stability"):
                name, row = sent[future]
                done[name][row] = future.result()
                if len(done[name]) == len(rows[name]):
                    results.write(path(name), _entry(pieces[name], done[name]))
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    pieces_by_name = {name: json.loads(path(name).read_text(encoding="utf-8")) for name in pieces}
    entries = [entry for entry in pieces_by_name.values() if isinstance(entry, dict)]
    others = {name: entry for name, entry in pieces_by_name.items() if not isinstance(entry, dict)}
    return {"quick": quick, "verdicts": VERDICTS, "maps": entries} | others


def _start_process():
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends its processes
    threadpool_limits(1)


def _rows(made) -> list:
    return list(range(len(made.y.values))) if isinstance(made, Map) else [None]


def _entry(made, done: dict):
    return made.entry([point for row in sorted(done) for point in done[row]]) if isinstance(made, Map) else done[None]


def main(argv=None) -> int:
    """Command line."""
    parser = console.parser("stability", __doc__)
    parser.add_argument("--quick", action="store_true", help="fewer points")
    parser.add_argument("--parts", nargs="+", metavar="NAME", help="only these maps or parts")
    console.add_jobs(parser)
    arguments = parser.parse_args(argv)
    file = measured(arguments.out, arguments.parts, arguments.quick, arguments.jobs)
    results.write(arguments.out / "stability.json", file)
    for entry in file["maps"]:
        seconds = sum(point["seconds"] for point in entry["points"])
        counts = ", ".join(f"{count} {verdict}" for verdict, count in entry["counts"].items() if count)
        print(f"{entry['name']:20} {counts} ({seconds:.1f} s)")
    return 0


if __name__ == "__main__":
    console.run(main)
