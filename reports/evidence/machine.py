"""The section on the machine: where and when everything was measured, and the commands that repeat it."""

from __future__ import annotations

from ..page.numbers.formatting import across
from ..page.section import Content, Inputs, Section


def build(inputs: Inputs) -> Content:
    """Return machine, versions and stages, and what a reader should know of the times."""
    machine = inputs.results["machine"]
    return Content({"machine": machine, "stages": inputs.stages}, sentences=_sentences(machine, inputs))


def _sentences(machine: dict | None, inputs: Inputs) -> list[str]:
    sentences = []
    if machine:
        threads = across(library["threads"] for library in machine["blas"]) if machine["blas"] else "unknown"
        sentences.append(
            f"Measured at commit {machine['commit'] or 'unknown'} on {machine['cpu']}, {machine['cores']} cores, BLAS "
            f"on {threads} thread{'' if threads == '1' else 's'}."
        )
    loads = [stage["load"][0] for stage in inputs.stages if stage["load"]]
    if loads:
        sentences.append(f"Load before the stages {across(loads)}: times are the least or the median of turns in one "
                         "process, and comparisons are ratios, so that load falls on all alike.")  # fmt: skip
    troubles = sorted({note.split(":")[0] for notes in inputs.notes.values() for note in notes})
    sentences += [f"{trouble}, of some stages: a note stands where it matters." for trouble in troubles]
    sentences.append("Errors and counts do not depend on the machine; times do, and one command repeats them on yours.")
    return sentences


MACHINE = Section(
    id="machine",
    title="Machine, how to repeat",
    part="trust",
    page="machine",
    needs=("machine",),
    template="evidence/machine.html.j2",
    build=build,
)
