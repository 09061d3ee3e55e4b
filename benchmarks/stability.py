"""Where the solvers break, and whether they say so: stability maps of every solver, stability.json."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

from . import (
    console,
    results,
    stability_cables,
    stability_harmonic,
    stability_networks,
    stability_peers,
    stability_spans,
    stability_stiff,
    stability_time,
    truth,
)
from .stability_maps import VERDICTS, Map, sources


class Piece(NamedTuple):
    """A part of the file that is kept when it is done: ``made()`` yields steps and returns the entry."""

    name: str
    steps: int
    made: Callable


def maps(known) -> list[Map]:
    """Every map, in the order of the page; ``known`` is a truth.TruthCache."""
    modules = stability_networks, stability_cables, stability_time, stability_harmonic
    return [*stability_spans.maps(known), *(one for module in modules for one in module.maps())]


def pieces(known, quick: bool) -> list[Piece]:
    """The maps, the figures on stiffness, and the other codes."""
    found = [one.quick() if quick else one for one in maps(known)]
    return [
        *(Piece(one.name, one.size, partial(_map, one)) for one in found),
        Piece("explicit", 1, partial(_listed, stability_stiff.explicit)),
        Piece("axial", 1, partial(_listed, stability_stiff.axial)),
        Piece("peers_spans", 1, partial(_listed, stability_peers.spans, known, quick)),
        Piece("peers_dynamics", 1, partial(_listed, stability_peers.dynamics, quick)),
    ]


def _map(one: Map):
    points = []
    for point in one.points():
        points.append(point)
        yield
    return one.entry(points)


def _listed(rows, *arguments):
    found = list(rows(*arguments))
    yield
    return found


def measured(folder: Path, chosen, quick: bool) -> dict:
    """The file; each piece is kept in folder/cache when it is finished, by the content of what it is made with."""
    work = [piece for piece in pieces(truth.TruthCache(folder), quick) if not chosen or piece.name in chosen]
    found = {}

    def steps():
        for piece in work:
            path = folder / "cache" / f"stability-{piece.name}{'-quick' if quick else ''}-{sources()}.json"
            if path.exists():
                found[piece.name] = json.loads(path.read_text(encoding="utf-8"))
                yield from range(piece.steps)
                continue
            found[piece.name] = results.plain((yield from piece.made()))
            results.write(path, found[piece.name])

    for _ in console.progress(steps(), sum(piece.steps for piece in work), "stability"):
        pass
    entries = [entry for entry in found.values() if isinstance(entry, dict)]
    others = {name: entry for name, entry in found.items() if not isinstance(entry, dict)}
    return {"quick": quick, "verdicts": VERDICTS, "maps": entries} | others


def main(argv=None) -> int:
    """Command line."""
    parser = console.parser("stability", __doc__)
    parser.add_argument("--quick", action="store_true", help="fewer points")
    parser.add_argument("--parts", nargs="+", metavar="NAME", help="only these maps or parts")
    arguments = parser.parse_args(argv)
    file = measured(arguments.out, arguments.parts, arguments.quick)
    results.write(arguments.out / "stability.json", file)
    for entry in file["maps"]:
        seconds = sum(point["seconds"] for point in entry["points"])
        counts = ", ".join(f"{count} {verdict}" for verdict, count in entry["counts"].items() if count)
        print(f"{entry['name']:20} {counts} ({seconds:.1f} s)")
    return 0


if __name__ == "__main__":
    console.run(main)
