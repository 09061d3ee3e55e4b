"""What a converged history of a moving network says: of each line, of the body, along the lines and in space."""

from __future__ import annotations

import numpy as np
from scipy.signal import welch

from solvers import mooring_system
from solvers.mooring import mooring_impedance, mooring_stiffness

SERIES = 361  # instants of the tensions that are drawn
SHOWN_HARMONICS, BODY_HARMONICS = 12, 3
POSES, SERIES_POSES, POSE_POINTS = 24, 60, 31  # of the envelope: instants, and points of a line
IMPEDANCE_CELLS = 40
SEGMENTS = 8  # of a series, whose periodograms are averaged
ALONG = 60  # points along a line at most
NEVER = {"start": None, "share": 0.0}


class LastWindow:
    """The stored times of a history that count: those of its last period, or all of a series.

    first: index of the first; start: its time, s; step: a MooringHistory stores each step of the same length.
    """

    def __init__(self, history, period):
        count = history.time.size if period is None else round(period / (history.time[1] - history.time[0]))
        self.first = history.time.size - count
        self.start = float(history.time[self.first])
        self.time = history.time[self.first :] - self.start

    def select(self, values) -> np.ndarray:
        """Return the part of an array (..., K) that belongs to the window."""
        return values[..., self.first :]


def lines(study, names, reference: dict, statics: dict) -> list[dict]:
    """Return a row for each line: tensions at its ends and along it in N, uplift, touchdown and slack."""
    history, wave = reference["history"], reference["wave"]
    window = LastWindow(history, study.period)
    instants = study.instants(history)
    instants = instants - instants[0]
    rows = []
    for e, (name, pretension) in enumerate(zip(names, statics["exact"], strict=True)):
        tension = wave[e]
        row = {"line": name, "pretension": pretension, "min": tension.min(), "mean": tension.mean(),
               "max": tension.max(), "std": tension.std(), "time_of_max": instants[tension.argmax()]}  # fmt: skip
        rows.append(row | _along(history, window, e) | _anchor(study, history, window, e))
    return rows


def _along(history, window, e) -> dict:
    """Return where and when the tension of the cells of a line is greatest and least, and when some are slack."""
    tension, s = window.select(history.elements[e].tension), history.system.layout.s[e]
    middles = (s[:-1] + s[1:]) / 2
    extremes = {}
    for name, index in (("greatest", tension.argmax()), ("least", tension.argmin())):
        cell, instant = np.unravel_index(index, tension.shape)
        extremes[name] = {"tension": tension[cell, instant], "s": middles[cell], "time": window.time[instant]}
    loose = (tension <= 0).any(axis=0)
    slack = {"start": window.time[loose.argmax()], "share": loose.mean()} if loose.any() else NEVER
    return extremes | {"slack": slack}


def _anchor(study, history, window, e) -> dict:
    """Return the tension at the anchor end, its uplift where the node there is fixed, and the length on the seabed."""
    element, node = history.elements[e], study.network.nodes[study.network.elements[e].ends[0]]
    force = window.select(element.anchor_force)
    row = {"anchor_max": np.linalg.norm(force, axis=0).max(), "uplift": None, "uplift_angle": None, "grounded": None}
    if node.kind == "fixed":
        up = int(force[2].argmax())
        row |= {"uplift": max(force[2, up], 0.0)}
        row["uplift_angle"] = np.degrees(np.arctan2(row["uplift"], np.hypot(*force[:2, up])))
    depth = study.network.environment.depth
    if depth is not None:
        length = grounded_length(window.select(element.r[2]), history.system.layout.s[e], -depth)
        row["grounded"] = [length.min(), length.max()]
    return row


def grounded_length(z, s, seabed: float) -> np.ndarray:
    """Return the unstretched length of line below the seabed's height, (K,), m; z (nodes, K) m, s (nodes,) m.

    A line at rest sinks into an elastic seabed by its weight over the stiffness, so what lies on it is below it.
    """
    depth = seabed - z
    upper, lower = np.minimum(depth[:-1], depth[1:]), np.maximum(depth[:-1], depth[1:])
    crossing = (upper < 0) & (lower > 0)
    share = np.where(upper >= 0, (lower > 0).astype(float), 0.0)
    share[crossing] = lower[crossing] / (lower - upper)[crossing]
    return np.diff(s) @ share


def waveforms(study, reference: dict) -> dict:
    """Return times (s), tension of each line (N) at them, and harmonics of a periodic motion (N): mean, amplitudes."""
    wave, t = reference["wave"], study.instants(reference["history"])
    shown = np.unique(np.linspace(0, t.size - 1, min(t.size, SERIES if study.period else 4 * SERIES)).astype(int))
    part = {"time": t[shown] - t[0], "tension": wave[:, shown], "harmonics": None, "spectrum": None}
    if study.period is not None:
        spectrum = np.fft.rfft(wave) / wave.shape[1]
        part["harmonics"] = np.column_stack([spectrum[:, 0].real, 2 * abs(spectrum[:, 1 : SHOWN_HARMONICS + 1])])
    else:
        part["spectrum"] = spectral_density(wave, t[1] - t[0])
    return part


def spectral_density(wave, dt: float) -> dict:
    """Return frequencies in Hz and densities (lines, F), N^2/Hz, of tensions (lines, K) in N, sampled each dt in s."""
    count = wave.shape[1]
    frequency, density = welch(wave, 1 / dt, nperseg=min(count, max(256, count // SEGMENTS)))
    return {"frequency": frequency[1:], "density": density[:, 1:]}


def along_lines(study, history) -> list[dict]:
    """Return least, mean and greatest tension (N) over the window along each line, s in m from its anchor end."""
    window, rows = LastWindow(history, study.period), []
    for s, element in zip(history.system.layout.s, history.elements, strict=True):
        tension = window.select(element.tension)
        every = max(1, tension.shape[0] // ALONG)
        rows.append({"s": ((s[1:] + s[:-1]) / 2)[::every], "low": tension.min(axis=1)[::every],
                     "mean": tension.mean(axis=1)[::every], "high": tension.max(axis=1)[::every]})  # fmt: skip
    return rows


def body(study, reference: dict) -> list[dict]:
    """Return statistics, and of a periodic motion harmonics, of force (N) and moment (N m) of the lines on the body."""
    history = reference["history"]
    window = LastWindow(history, study.period)
    both = window.select(np.concatenate([history.body_force, history.body_moment]))
    rows = []
    for name, unit, values in zip(("surge", "sway", "heave", "roll", "pitch", "yaw"), "NNNMMM", both, strict=True):
        row = {"component": name, "unit": {"N": "N", "M": "N m"}[unit], "mean": values.mean(), "min": values.min(),
               "max": values.max(), "std": values.std()}  # fmt: skip
        if study.period is not None:
            row["harmonics"] = 2 * abs(np.fft.rfft(values) / values.size)[1 : BODY_HARMONICS + 1]
        rows.append(row)
    return rows


def impedance(study) -> dict:
    """Return stiffness and impedance (6, 6) of the lines about rest, the latter at the frequency of the motion."""
    system = mooring_system(study.network, IMPEDANCE_CELLS, fields="spatial")
    reference = study.motion.reference
    matrices = {"reference": reference, "stiffness": mooring_stiffness(system, reference), "frequency": None}
    if study.period is not None:
        Z = mooring_impedance(system, 1 / study.period, reference)
        matrices |= {"frequency": 1 / study.period, "real": Z.real, "imaginary": Z.imag}
    return matrices


def envelope(study, history) -> dict:
    """Return positions of the lines at some instants of the motion, (poses, lines, 3, points) m, and those at rest."""
    window = LastWindow(history, study.period)
    count = POSES if study.period else SERIES_POSES
    chosen = window.first + np.linspace(0, window.time.size - 1, count + 1)[:-1].astype(int)
    layout = history.system.layout
    at_rest = history.system.rest.r
    moving, resting = [], []
    for s, nodes, element in zip(layout.s, layout.nodes, history.elements, strict=True):
        kept = np.unique(np.linspace(0, s.size - 1, POSE_POINTS).astype(int))
        moving.append(np.moveaxis(element.r[:, kept][..., chosen], -1, 0))
        resting.append(at_rest[:, nodes[kept]])
    travel = [float(np.linalg.norm(m - r, axis=1).max()) for m, r in zip(moving, resting, strict=True)]
    return {"rest": resting, "poses": [[line[k] for line in moving] for k in range(count)], "travel": travel}
