"""Where the solvers break, and whether they say so: stability maps of every solver, stability.json."""

from __future__ import annotations

import json
import time

from . import console, results, stability_cables, stability_networks, stability_spans, stability_time, truth
from .stability_maps import VERDICTS, Map, sources


def maps(folder) -> list[Map]:
    """Every map, in the order of the page."""
    known = truth.TruthCache(folder)
    return [*stability_spans.maps(known), *stability_networks.maps(), *stability_cables.maps(), *stability_time.maps()]


def measured(folder, chosen, quick: bool) -> dict:
    """The file; each map is kept in folder/cache when it is finished, by the content of what it is made with."""
    work = [one.quick() if quick else one for one in maps(folder) if not chosen or one.name in chosen]
    total, entries = sum(one.size for one in work), []

    def steps():
        for one in work:
            path = folder / "cache" / f"stability-{one.name}-{'quick-' if quick else ''}{sources()}.json"
            if path.exists():
                entries.append(json.loads(path.read_text(encoding="utf-8")))
                yield from entries[-1]["points"]
                continue
            points = []
            for point in one.points():
                points.append(point)
                yield point
            entries.append(results.plain(one.entry(points)))
            results.write(path, entries[-1])

    start = time.perf_counter()
    for _ in console.progress(steps(), total, "stability"):
        pass
    return {"quick": quick, "verdicts": VERDICTS, "maps": entries, "seconds": time.perf_counter() - start}


def main(argv=None) -> int:
    """Command line."""
    parser = console.parser("stability", __doc__)
    parser.add_argument("--quick", action="store_true", help="fewer points")
    parser.add_argument("--maps", nargs="+", metavar="NAME", help="only these")
    arguments = parser.parse_args(argv)
    file = measured(arguments.out, arguments.maps, arguments.quick)
    results.write(arguments.out / "stability.json", file)
    for entry in file["maps"]:
        seconds = sum(point["seconds"] for point in entry["points"])
        counts = ", ".join(f"{count} {verdict}" for verdict, count in entry["counts"].items() if count)
        print(f"{entry['name']:20} {counts} ({seconds:.1f} s)")
    return 0


if __name__ == "__main__":
    console.run(main)
