"""The cases, methods and lines of the section on moving lines, as the page names and draws them."""

from __future__ import annotations

from pathlib import Path

from ..cable import cases as cable_cases
from ..drawing import style
from ..page.figures import Figure
from ..page.formatting import slug

CASES = cable_cases.CASES | {
    "shallow_chain": "Shallow chain, 60 m: circle",
    "oc3_seabed": "OC3 over a seabed: surge 5 m",
    "semi_15MW": "15 MW semisubmersible: circle 3 m",
}
METHODS = {
    "in time": {"color": style.PALETTE[1], "marker": "s"},
    "in time, extrapolated": {"color": style.PALETTE[4], "marker": "X"},
    "harmonic balance": {"color": style.PALETTE[0], "marker": "o"},
    "harmonic balance, extrapolated": {"color": style.PALETTE[3], "marker": "P"},
    "box scheme, in time": {"color": style.PALE, "marker": "v"},
    "box scheme, harmonic balance, corrected": {"color": style.PALETTE[5], "marker": "^"},
    "MoorDyn": {"color": style.PALETTE[2], "marker": "D"},
}
OWN = tuple(METHODS)[:4]
"""Methods of nodes and elements."""
LINES = {
    "oc3": "OC3 chain, 320 m",
    "oc4": "OC4 chain, 200 m",
    "semi_15MW": "15 MW semisubmersible, 200 m",
    "soft_clay": "studless chain, 50 m, soft clay",
    "rock": "FPSO chain, 100 m, rock",
    "wire": "steel wire, 1000 m",
    "wave_energy": "wave-energy chain, 25 m",
    "nylon": "nylon rope, 30 m",
    "buoy": "buoy chain, 12 m",
    "shallow": "chain of 60 m, 5 m deep",
}


def save(figure, folder: Path, name: str, title: str, alt: str) -> Figure:
    """Write a figure as style.save does, under the names that all figures of this section have."""
    return style.save(figure, folder, f"mooring_{slug(name)}", title, alt)
