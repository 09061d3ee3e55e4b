"""The lines of a file written for other programs, beside its results: MoorDyn and MAP++ input files."""

from __future__ import annotations

from pathlib import Path

from solvers import Element, InputError, Network, Node, Scene
from solvers.io import write_map_file, write_moordyn

WRITERS = {"MoorDyn": ("moordyn.txt", write_moordyn), "MAP++": ("map.map", write_map_file)}


def network_of(scene: Scene) -> Network:
    """Return the line of a scene as a network of one element, its fairlead coupled, with the first friction."""
    nodes = Node("fixed", scene.anchor), Node("coupled", scene.fairlead)
    cable = scene.cable if scene.cable.diameter and scene.cable.mass_per_length else None
    weight = scene.cable.weight_in(scene.environment)
    line = Element(weight, scene.cable.EA, scene.length, (0, 1), scene.friction[0], cable)
    return Network(nodes, (line,), scene.environment)


def write_exports(network, folder: Path, name: str) -> list[dict]:
    """Write the files; return the program, file and notes of each, or why there is none."""
    made = []
    for program, (suffix, write) in WRITERS.items():
        path = folder / f"{name}_{suffix}"
        try:
            made.append({"program": program, "file": path.name, "notes": list(write(path, network))})
        except InputError as error:
            made.append({"program": program, "file": None, "notes": [str(error)]})
    return made
