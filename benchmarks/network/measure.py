"""Networks: pictures, the paper's Table 2 remade, error against time, speed, growth, MoorPy beside: networks.json."""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator

from ..run import console, results
from . import accuracy as network_accuracy
from . import growth as network_growth
from . import paired_timing as network_turns
from . import pictures as network_pictures
from . import table2 as network_table2

PARTS: dict[str, Callable[[bool], list]] = {
    "pictures": network_pictures.tasks,
    "table2": network_table2.tasks,
    "example": network_table2.example_tasks,
    "work": network_accuracy.tasks,
    "speed": network_turns.speed,
    "growth": network_growth.tasks,
    "peers": network_turns.peers,
}
"""Name in the file -> quick -> calls, each giving rows (list of dict)."""

WHOLE = {"growth": network_growth.whole}
"""What is made of all rows of a part, where it is more than their list."""


def measured(parts, quick: bool = False) -> dict:
    """The file, or the named parts of it."""
    tasks = {name: PARTS[name](quick) for name in parts}
    file = {"quick": quick}

    def steps() -> Iterator[None]:
        for name, calls in tasks.items():
            rows = []
            for call in calls:
                rows += call()
                yield
            file[name] = WHOLE.get(name, list)(rows)

    gc.disable()  # as timeit does: a collection in one solver's turn is not its doing
    try:
        for _ in console.progress(steps(), sum(map(len, tasks.values())), "networks"):
            pass
    finally:
        gc.enable()
    return file


def main(argv=None) -> int:
    """Command line."""
    parser = console.parser("networks", __doc__)
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=list(PARTS), help="measure only these")
    parser.add_argument("--quick", action="store_true", help="smaller networks, fewer tolerances and turns")
    arguments = parser.parse_args(argv)
    file = measured(arguments.parts, arguments.quick)
    results.write(arguments.out / "networks.json", file)
    for name in ("speed", "peers"):
        for row in file.get(name, ()):
            print(f"{row['system']}{' ' + row['setting'] if 'setting' in row else ''}: ratio {row['ratio']:.4g}")
    for family, p in file.get("growth", {"exponents": {}})["exponents"].items():
        if p is not None:
            print(f"growth of {family}: elements^{p:.3g}")
    return 0


if __name__ == "__main__":
    console.run(main)
