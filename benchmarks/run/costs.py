"""What a solve of a moving line costs on any machine: time steps, Newton iterations, factorisations, cell evaluations.

A cell evaluation is the equations of one cell at one instant, once in each Newton iteration or explicit stage. It is
counted alike in time, where an iteration is of one instant, and in harmonic balance, where it is of all samples.
"""

from __future__ import annotations

from collections.abc import Iterable

COUNTS = ("steps", "iterations", "factorisations", "cell_evaluations")
"""Keys of a count; a value is None where a solver does not tell it."""
NOT_TOLD = dict.fromkeys(COUNTS)


def count_work(response) -> dict:
    """Return the COUNTS of a history or periodic response.

    Iterations on coarser meshes and with fewer harmonics count as if on the mesh of the result; trial steps of a line
    search are not told. Iterations of the start in time of a moving line are no Newton iterations of harmonic balance
    and count in the cell evaluations alone. Parts of a network that are solved by themselves are taken to share its
    cells equally. A response that is extrapolated from two meshes costs both.
    """
    system = response.system
    cells = _count_cells(system) / len(getattr(system, "components", ()) or (None,))
    if hasattr(response, "factorisations"):
        return {"steps": response.steps, "iterations": response.iterations, "factorisations": response.factorisations,
                "cell_evaluations": round(response.iterations * cells)}  # fmt: skip
    samples, coarse = response.basis.samples, response.coarse_iterations
    in_time = hasattr(system, "periodic_start")  # the start of a moving line: one instant an iteration
    instants = response.iterations * samples + coarse * (1 if in_time else samples)
    own = {"steps": None, "iterations": response.iterations + (0 if in_time else coarse), "factorisations": None,
           "cell_evaluations": round(instants * cells)}  # fmt: skip
    half = getattr(response, "coarse", None)
    return own if half is None else add_work([own, count_work(half)])


def _count_cells(system) -> int:
    layout = getattr(system, "layout", None)
    return system.nodes - 1 if layout is None else len(layout.first)


def add_work(counts: Iterable[dict]) -> dict:
    """Return the sum of some counts; None where one of them is not told."""
    counts = list(counts)
    return {key: None if any(one[key] is None for one in counts) else sum(one[key] for one in counts)
            for key in COUNTS}  # fmt: skip


def count_explicit(coupling_steps: int, inner_steps: int, stages: int, cells: int) -> dict:
    """Return the COUNTS of an explicit scheme with so many steps within each coupling step, and stages in each."""
    steps = coupling_steps * inner_steps
    return NOT_TOLD | {"steps": steps, "cell_evaluations": steps * stages * cells}
