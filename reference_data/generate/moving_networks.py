"""End tensions of the random moving networks: `python -m reference_data.generate.moving_networks` writes the table.

Doubles of an integration, so that another machine gives the same to some eleven digits and not the same text;
verification/mooring/test_exact_networks.py recomputes a part of it within its stated uncertainty.
"""

import csv
from importlib.resources import files
from pathlib import Path

from verification.exact.mooring.random_networks import SEEDS, random_history

COLUMNS = ("seed", "t", "line", "T_a", "T_b")
DIGITS = 12
TOLERANCE = 1e-12


def rows(seed):
    """Return the rows of a seed, dicts of text."""
    history = random_history(seed, rtol=TOLERANCE, atol=TOLERANCE)
    return [
        {"seed": str(seed), "t": repr(float(t)), "line": str(line)}
        | {name: f"{value:.{DIGITS - 1}e}" for name, value in zip(("T_a", "T_b"), ends, strict=True)}
        for t, lines in zip(history.t, history.end_tension, strict=True)
        for line, ends in enumerate(lines)
    ]


def main():
    """Write the table."""
    path = Path(str(files("reference_data"))) / "moving_networks" / "data.csv"
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for seed in SEEDS:
            writer.writerows(rows(seed))


if __name__ == "__main__":
    main()
