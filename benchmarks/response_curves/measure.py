"""Response curves of cables, stability, basins, maps and what they cost: response_curves.json.

The parts one after the other; each is in the file with its CPU seconds.
"""

from __future__ import annotations

import time
from functools import partial

from ..run import console, results
from . import maps, two_methods
from .curves import measure_case
from .systems import CASES

PARTS = {f"curve_{case.name}": partial(measure_case, case) for case in CASES}
PARTS |= {"count": maps.count_responses, "basins": maps.basins, "parametric": maps.parametric,
          "methods": two_methods.compare_methods, "cost": two_methods.cost}  # fmt: skip
NOT_IN_QUICK = ("curve_shallow", "curve_bridle", "count", "basins")
DEEP = {"whole_curve": two_methods.whole_curve}


def main(argv=None) -> int:
    """Command line."""
    parser = console.parser("response_curves.measure", __doc__)
    parser.add_argument("--quick", action="store_true", help="fewer curves and points")
    parser.add_argument("--deep", action="store_true", help="a whole curve of 200 points on 50 cells, too")
    parser.add_argument("--parts", nargs="+", choices=[*PARTS, *DEEP], help="only these parts")
    arguments = parser.parse_args(argv)
    left_out = NOT_IN_QUICK if arguments.quick else ()
    whole = [name for name in PARTS if name not in left_out]
    chosen = arguments.parts or [*whole, *(DEEP if arguments.deep else ())]
    file: dict = {"quick": arguments.quick, "seconds": {}}

    def work():
        for name in chosen:
            begin = time.process_time()
            file[name] = (PARTS | DEEP)[name](arguments.quick)
            file["seconds"][name] = time.process_time() - begin
            yield name

    for _ in console.progress(work(), len(chosen), "response curves"):
        pass
    results.write(arguments.out / "response_curves.json", file)
    for name, seconds in file["seconds"].items():
        print(f"{name}: {seconds:.1f} s")
    return 0


if __name__ == "__main__":
    console.run(main)
