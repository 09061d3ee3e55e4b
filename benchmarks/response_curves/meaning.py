"""What the curve of a sweep means for the design, in sentences: largest tension, jumps, instability, gaps, doubts."""

from __future__ import annotations

import numpy as np

LARGE_ERROR = 0.05  # of a point by its harmonics: what it says is then a guide


def write_sentences(file: dict) -> list[str]:
    """Return what the curves mean for the design, in sentences."""
    curves, gap = file["curves"], file["gap"]
    if not curves:
        return _gaps(file)
    return [_largest(file), _jumps(curves, gap), _instability(curves, gap), *_gaps(file), *_doubts(file)]


def find_largest_tension(curves):
    """Return the largest tension of the curves, N, the number of its element and its frequency, Hz."""
    greatest = [np.asarray(curve["greatest"], dtype=float) for curve in curves]
    number = int(np.argmax([each.max() for each in greatest]))
    e, i = np.unravel_index(greatest[number].argmax(), greatest[number].shape)
    return float(greatest[number][e, i]), int(e), float(curves[number]["frequency"][i])


def _largest(file) -> str:
    tension, e, frequency = find_largest_tension(file["curves"])
    band = "over the band" if file["gap"] is None else "where the curve was followed"
    text = (
        f"With {file['amplitude']:.3g} m of motion the largest tension {band} is {tension / 1e3:.4g} kN"
        f"{_in_line(file, e)}, at {frequency:.4g} Hz ({1 / frequency:.3g} s), "
        f"{tension / float(file['rest'][e]):.3g} times that at rest"
    )
    breaking = file["breaking"][e]
    text += f" and {100 * tension / breaking:.3g} % of the breaking load" if breaking else ""
    for row in file["integrated_at_largest"]:
        text += f"; time integration gives {float(row['greatest'][e]) / 1e3:.4g} kN there"
    return f"{text}."


def _in_line(file, e) -> str:
    return "" if len(file["lines"]) == 1 else f" in {file['lines'][e]}"


def _jumps(curves, gap) -> str:
    folds = sorted(each["value"] for curve in curves for each in curve["special"] if each["kind"] == "fold")
    if not folds:
        where = "" if gap is None else " where the curve was followed"
        return f"No jumps{where}: no frequency of the curve has a second response beside it."
    places = ", ".join(f"{value:.4g}" for value in folds)
    return (
        f"Jumps at {places} Hz: between two of them more than one response exists, and which one the line is in "
        "depends on how it came there; a simulation from rest shows one of them only."
    )


def _instability(curves, gap) -> str:
    ranges = [part for curve in curves for part in _unstable_ranges(curve)]
    if not ranges:
        where = "each frequency" if gap is None else "each frequency of the curve"
        return f"No instability: small disturbances, sideways too, decay at {where}."
    kinds = sorted({each["kind"] for curve in curves for each in curve["special"] if each["kind"] != "fold"})
    sideways = any(across is not None and across >= 1 for curve in curves for across in curve["sideways"])
    named = [*kinds, *(["growth across the plane of the line"] if sideways else [])]
    why = f" ({', '.join(named)})" if named else ""
    places = ", ".join(f"{low:.4g}" if low == high else f"{low:.4g} to {high:.4g}" for low, high in ranges)
    return (
        f"Unstable at {places} Hz{why}: there the line leaves this motion for another one, and its tensions come from "
        f"time integration{' in three dimensions' if sideways else ''}."
    )


def _unstable_ranges(curve):
    """Return (lowest, highest) frequency of each run of unstable points along a curve."""
    runs: list[list[float]] = []
    was_stable = True
    for frequency, is_stable in zip(curve["frequency"], curve["stable"], strict=True):
        if not is_stable:
            if was_stable:
                runs.append([])
            runs[-1].append(float(frequency))
        was_stable = is_stable
    return [(min(run), max(run)) for run in runs]


def _gaps(file) -> list[str]:
    """Return a sentence on the part of the band without a curve and the tensions of time integration there."""
    if file["gap"] is None:
        return []
    low, high = file["gap"]
    reasons = {curve["end"] or curve["status"] for curve in file["curves"]} or {"no periodic response was found"}
    text = f"From {low:.4g} to {high:.4g} Hz the curve was not followed ({'; '.join(sorted(reasons))})"
    if not file["integrated"]:
        return [f"{text}, and time integration from rest failed as well."]
    tension, e, frequency = find_largest_tension([_as_curve(file["integrated"])])
    return [f"{text}: time integration at {len(file['integrated'])} frequencies there gives up to "
            f"{tension / 1e3:.4g} kN{_in_line(file, e)}, at {frequency:.4g} Hz."]  # fmt: skip


def _as_curve(integrated) -> dict:
    """Return rows of time integrations as a curve has them: frequency (P,), greatest (E, P)."""
    return {"frequency": [row["frequency"] for row in integrated],
            "greatest": np.transpose([row["greatest"] for row in integrated])}  # fmt: skip


def _doubts(file):
    """Yield sentences on special points of the series alone, on slack and on harmonics that are too few."""
    curves, series = file["curves"], f"{file['harmonics']} harmonics"
    turns = [each["value"] for curve in curves for each in curve["unresolved"]]
    if turns:
        places = f"{min(turns):.4g}" if min(turns) == max(turns) else f"{min(turns):.4g} to {max(turns):.4g}"
        yield (
            f"At {places} Hz the series of {series} turns back where the motion does not: no jump of the line, but the "
            "end of what this curve resolves."
        )
    doubtful = [frequency for curve in curves for frequency, error in
                zip(curve["frequency"], curve["errors"], strict=True) if error > LARGE_ERROR]  # fmt: skip
    if doubtful:
        yield (
            f"Between {min(doubtful):.4g} and {max(doubtful):.4g} Hz points have errors above "
            f"{100 * LARGE_ERROR:.0f} % by their {series}: a line nearly slack, or a seabed that it meets."
        )
