"""The moving line of a scene: error and run time of a ladder of settings, and the cheapest that meets its tolerance.

Errors are the greatest difference of the fairlead tension over a period from a converged one, over its greatest value.
"""

from __future__ import annotations

import time

import numpy as np

from solvers import ConvergenceError, Scene, Status, cable_system, solve_periodic, solve_static, solve_time_domain
from solvers.common.motions.motion import Ramped
from solvers.numerics.modes import natural_modes
from verification.registry import INSTANTS, instants, last_period_tension

from ..cable import work_precision as dynamic_work
from ..cable.cases import on_mesh, warm_up
from .network_outputs import NEVER, POSES, grounded_length

STATIC_NODES = (25, 50, 100, 200)
HARMONIC = ((25, 4), (25, 6), (25, 9), (50, 9), (50, 15), (100, 15), (100, 25), (200, 25))
"""(nodes, harmonics): both grow together, for of two errors the larger hides the other."""
CORRECTED = ((13, 6), (17, 9), (25, 15), (41, 20))
"""The same with a deferred correction."""
STEPPED = ((25, 50), (50, 100), (50, 200), (100, 200), (100, 400))
"""(nodes, steps in a period)."""
PROBES = HARMONIC[0], HARMONIC[3]  # what harmonic balance must solve before more is tried
LEVELS, FINE, FINEST = (50, 100, 200), 25, 40
"""Of the reference: nodes, harmonics, and harmonics of a correction on the coarsest mesh."""
STEPPED_LEVELS = ((100, 400), (200, 800))
PERIODS = 6  # of a time history: the last one is compared
TOLERANCE = 1e-2  # of the greatest tension, where the file has none: well below what drag coefficients are known to
SERIES = 241  # instants of the waveforms that are shown
SHOWN_HARMONICS = 12
POSE_POINTS = 81  # of the line that is drawn at some instants

SLACK_SHARE = 0.1  # of the mean tension: a smaller one is called nearly slack
NEAR_RESONANCE = 0.1  # relative distance of a driving harmonic from a natural frequency
MODES = 8


class Study:
    """Solutions of one scene, each solved once."""

    def __init__(self, scene: Scene):
        self.scene, self.period = scene, scene.motion.period
        self.chains, self.solutions = {}, {}
        self.warnings = []

    def chain(self, nodes: int):
        """Return the cable on so many nodes, its equilibrium solved for."""
        if nodes not in self.chains:
            self.chains[nodes] = cable_system(self.scene, nodes)
            self.chains[nodes].rest_state()
        return self.chains[nodes]

    def solve(self, method: str, nodes: int, other: int) -> dict:
        """One setting from rest: seconds, status, wave (None where it failed), and the response itself."""
        key = method, nodes, other
        if key not in self.solutions:
            chain, began = self.chain(nodes), time.perf_counter()
            if harmonic := method.startswith("harmonic"):
                corrected = method.endswith("corrected")
                response = solve_periodic(chain, harmonics=other, deferred_correction=corrected, throw=False)
            else:
                response = solve_time_domain(chain, dt=self.period / other, periods=PERIODS, throw=False)
            seconds = time.perf_counter() - began
            good = response.status is Status.SUCCESS
            self.solutions[key] = {
                "method": method,
                "nodes": nodes,
                **({"harmonics": other} if harmonic else {"dt": self.period / other}),
                "seconds": seconds,
                "status": response.status.name,
                "sentence": response.status.value,
                "wave": last_period_tension(response) if good else None,
                "response": response,
            }
        return self.solutions[key]

    def reference(self) -> dict:
        """The converged tension: harmonic balance extrapolated in the mesh, or the finest time histories."""
        if all(self.solve("harmonic balance", *probe)["wave"] is not None for probe in PROBES):
            try:
                return self._harmonic_reference()
            except ConvergenceError as error:
                self.warnings.append(f"Harmonic balance did not converge on the finer meshes: {error}")
        coarse, fine = (self.solve("time domain", *level) for level in STEPPED_LEVELS)
        if coarse["wave"] is None or fine["wave"] is None:
            return {"wave": None, "uncertainty": None, "method": None, "status": fine["sentence"]}
        spread = _error(coarse["wave"], fine["wave"])
        about = {"nodes": fine["nodes"], "dt": fine["dt"], "response": fine["response"]}
        return {"wave": fine["wave"], "uncertainty": spread, "method": "time domain"} | about

    def _harmonic_reference(self):
        responses = [None]
        for nodes in LEVELS:
            chain = self.chain(nodes)
            start = on_mesh(responses[-1], chain)
            responses.append(solve_periodic(chain, harmonics=FINE, start=start))
        rough, middle, fine = (last_period_tension(response) for response in responses[1:])
        coarsest = responses[1]
        more = last_period_tension(solve_periodic(coarsest.system, harmonics=FINEST, start=coarsest)) - rough
        before = middle + (middle - rough) / _gain(LEVELS[:2])
        last = fine + (fine - middle) / _gain(LEVELS[1:])
        tension = last + more
        uncertainty = (abs(last - before).max() + abs(more).max()) / abs(tension).max()
        size = [float(abs(a - b).max()) for a, b in ((rough, middle), (middle, fine))]
        order = float(np.log(size[0] / size[1]) / np.log((LEVELS[2] - 1) / (LEVELS[1] - 1))) if size[1] else None
        about = {"nodes": LEVELS[-1], "harmonics": FINEST, "order": order, "response": responses[-1]}
        return {"wave": tension, "uncertainty": float(uncertainty), "method": "harmonic balance"} | about


def _gain(nodes) -> float:
    """Of two meshes, by how much more than its change the error of second order of the coarser is."""
    coarse, fine = nodes
    return ((fine - 1) / (coarse - 1)) ** 2 - 1


def _error(tension, reference) -> float:
    return float(abs(tension - reference).max() / abs(reference).max())


def steps(scene: Scene) -> int:
    """How many times ``study`` yields."""
    return 2 + len(HARMONIC) + len(CORRECTED) + len(STEPPED)


def study(scene: Scene):
    """Generator: yields None after each step of the work, at the end the part of the scene's file."""
    made = Study(scene)
    warm_up()
    try:
        statics = static_ladder(made)
    except ConvergenceError as error:
        for _ in range(steps(scene) - 1):
            yield None
        yield {"failed": f"The line has no equilibrium to move from: {error}"}
        return
    yield None
    reference = made.reference()
    yield None
    ladder, balanced = [], reference["method"] == "harmonic balance"
    rungs = {"harmonic balance": HARMONIC, "harmonic balance, corrected": CORRECTED, "time domain": STEPPED}
    tried = rungs if balanced else rungs | {"harmonic balance": PROBES, "harmonic balance, corrected": ()}
    for method, settings in rungs.items():
        for nodes, other in settings:
            if (nodes, other) in tried[method]:
                ladder.append(made.solve(method, nodes, other))
            if (method, nodes, other) != ("time domain", *STEPPED[-1]):
                yield None
    yield _report(made, statics, reference, ladder)


def peer_rows(study: Study, known) -> list[dict]:
    """Rows of other codes at two of their settings, against the converged tension."""
    ramped, rows = Ramped(study.scene.motion, study.period / 2), []
    for label, adapter in dynamic_work.peer_adapters().items():
        for cells, steps in adapter.settings[dynamic_work.QUICK_PEER]:
            began = time.perf_counter()
            answer = dynamic_work.ask(adapter, study.scene, ramped, study.period, (cells, steps), PERIODS)
            row = {"method": label, "nodes": cells + 1, "dt": study.period / steps, "warnings": [], "error": None}
            row |= {"seconds": time.perf_counter() - began, "status": answer.kind.upper() or "SUCCESS"}
            if known is not None and not answer.kind:
                row["error"] = _error(answer.tension[:: max(1, steps // INSTANTS)], known[:: max(1, INSTANTS // steps)])
            rows.append(row | {"sentence": answer.message[:200]})
            if answer.kind:
                break
    return rows


def static_ladder(study: Study) -> dict:
    """Fairlead tension at rest on finer and finer meshes, against shooting."""
    exact = float(solve_static(study.chain(STATIC_NODES[-1]), method="shooting").tension[-1])
    rows = []
    for nodes in STATIC_NODES:
        began = time.perf_counter()
        tension = float(solve_static(cable_system(study.scene, nodes)).tension[-1])
        seconds = time.perf_counter() - began
        rows.append({"nodes": nodes, "tension": tension, "error": abs(tension - exact) / exact, "seconds": seconds})
    return {"exact": exact, "rows": rows}


def _report(study: Study, statics: dict, reference: dict, ladder: list[dict]) -> dict:
    scene, known = study.scene, reference["wave"]
    rows = []
    for point in ladder:
        row = {key: value for key, value in point.items() if key not in ("wave", "response")}
        row["warnings"] = list(point["response"].warnings) if point["wave"] is not None else []
        right = point["wave"] is not None and known is not None
        rows.append(row | {"error": _error(point["wave"], known) if right else None})
    tolerance = motion_tolerance(scene)
    best = _recommended(rows, reference, tolerance)
    rows += peer_rows(study, known)
    about = {key: value for key, value in reference.items() if key not in ("wave", "response")}
    report = {"period": study.period, "fields": study.chain(STATIC_NODES[0]).fields, "statics": statics, "ladder": rows}
    report |= {"reference": about, "recommended": best, "tolerance": tolerance, "python": _python(best)}
    report |= {"modes": _modes(study), "driving": _driving(scene), "in_current": any(scene.environment.current)}
    if known is not None:
        report |= _pictured(study, reference)
    return report | {"warnings": study.warnings + list(_warnings(study, report))}


def motion_tolerance(scene: Scene) -> float:
    """Return the tolerance of a scene for its motion: its own, unless that is the default, made for lines at rest."""
    return TOLERANCE if scene.tolerance == Scene.tolerance else scene.tolerance


def _recommended(rows, reference, tolerance) -> dict | None:
    """The cheapest setting whose error, with that of the reference, meets the tolerance; else the most accurate one.

    One that warns, of drift or of long steps, is taken only where all that meet the tolerance do.
    """
    solved = [row | {"promised": row["error"] + reference["uncertainty"]} for row in rows if row["error"] is not None]
    within = [row for row in solved if row["promised"] <= tolerance]
    if within:
        return min(within, key=lambda row: (bool(row["warnings"]), row["seconds"])) | {"meets": True}
    return min(solved, key=lambda row: row["promised"]) | {"meets": False} if solved else None


def _pictured(study: Study, reference: dict) -> dict:
    """Waveform, spectrum, envelope along the line and where the tension is smallest."""
    response = reference["response"]
    first, period = response.last_period
    at = first + instants(period)
    state, rate = response.at(at), response.rate_at(at)
    tension = response.system.tension(state, rate)
    node, instant = np.unravel_index(tension.argmin(), tension.shape)
    positions = response.system.positions(state)
    shown = np.linspace(0, at.size - 1, SERIES).astype(int)
    spectrum = np.fft.rfft(reference["wave"]) / at.size
    every = max(1, len(response.system.s) // 100)
    return {
        "motion": [_row(study, reference, at - first, state, tension, positions)],
        "poses": _poses(study, positions),
        "waveform": {"time": at[shown] - first, "tension": reference["wave"][shown]},
        "harmonics": [spectrum[0].real, *(2 * abs(spectrum[1 : SHOWN_HARMONICS + 1]))],
        "envelope": {
            "s": response.system.s[::every],
            "low": tension.min(axis=1)[::every],
            "mean": tension.mean(axis=1)[::every],
            "high": tension.max(axis=1)[::every],
        },
        "extremes": {"max": reference["wave"].max(), "min": reference["wave"].min(), "mean": spectrum[0].real},
        "smallest": {
            "tension": tension[node, instant],
            "s": response.system.s[node],
            "time": at[instant] - first,
        },
    }


def _row(study: Study, reference: dict, instants, state, tension, positions) -> dict:
    """Return the line as a row of the table of lines has it: see ``network_outputs.lines``."""
    system, wave, scene = reference["response"].system, reference["wave"], study.scene
    row = {"line": scene.name, "pretension": float(solve_static(study.chain(LEVELS[-1])).tension[-1]),
           "min": wave.min(), "mean": wave.mean(), "max": wave.max(), "std": wave.std(),
           "time_of_max": instants[wave.argmax()]}  # fmt: skip
    for name, index in (("greatest", tension.argmax()), ("least", tension.argmin())):
        node, instant = np.unravel_index(index, tension.shape)
        row[name] = {"tension": tension[node, instant], "s": system.s[node], "time": instants[instant]}
    force = tension[0] * system.direction(state[:, :1])[:, 0]
    up = int(force[2].argmax())
    row |= {"anchor_max": tension[0].max(), "uplift": max(force[2, up], 0.0), "grounded": None, "slack": NEVER}
    row["uplift_angle"] = np.degrees(np.arctan2(row["uplift"], np.hypot(*force[:2, up])))
    if scene.environment.depth is not None:
        length = grounded_length(positions[2], system.s, -scene.environment.depth)
        row["grounded"] = [length.min(), length.max()]
    return row


def _poses(study: Study, positions) -> dict:
    """Return the line at some instants of the period and at rest, as ``network_outputs.envelope`` has lines, m."""
    at_rest = solve_static(study.chain(LEVELS[-1])).r
    points = np.unique(np.linspace(0, positions.shape[1] - 1, POSE_POINTS).astype(int))
    at_rest = at_rest[:, np.unique(np.linspace(0, at_rest.shape[1] - 1, POSE_POINTS).astype(int))]
    chosen = np.linspace(0, positions.shape[2], POSES + 1)[:-1].astype(int)
    return {"rest": [at_rest], "poses": [[positions[:, points, k]] for k in chosen]}


def _modes(study: Study) -> list[float]:
    """Lowest natural frequencies at rest, Hz."""
    return natural_modes(study.chain(LEVELS[1]), MODES).frequencies.tolist()


def _driving(scene: Scene) -> list[float]:
    """Frequencies of the motion, Hz."""
    motion = scene.motion
    moves = motion.sine.any(axis=1) | motion.cosine.any(axis=1)
    return [float(k * motion.frequency) for k in 1 + np.flatnonzero(moves)]


def _warnings(study: Study, report: dict):
    """Sentences on what the owner of this moving line should know."""
    if any(study.scene.environment.current):
        yield "The current acts on the moving line; forces, profile and stiffness above are those of still water."
    top = max(study.scene.anchor[2], study.scene.fairlead[2])
    if top > 0:
        yield f"An end is {top:.4g} m above still water (z = 0), and the line is taken to be in the water all along."
    mine = [row for row in report["ladder"] if row["method"] in ("harmonic balance", "time domain")]
    failed = {row["sentence"] for row in mine if row["status"] not in ("SUCCESS", "NO_PERIODIC_RESPONSE")}
    yield from (f"Some settings failed: {sentence}." for sentence in sorted(failed))
    if any(row["status"] == "NO_PERIODIC_RESPONSE" for row in mine):
        yield "Harmonic balance did not find the periodic response of this line: the settings are of time stepping."
    for driven in report["driving"]:
        nearest = min(report["modes"], key=lambda mode: abs(mode - driven))
        if abs(nearest - driven) < NEAR_RESONANCE * driven:
            yield f"The motion at {driven:.4g} Hz is near a natural frequency of the line at rest, {nearest:.4g} Hz."
    if report["recommended"] is not None:
        best = report["recommended"]
        which = "recommended" if best["meets"] else "most accurate"
        yield from (f"The {which} setting warns: {text}." for text in best.get("warnings", ()))
    smallest = report.get("smallest")
    if smallest is None:
        yield "No setting gave a converged tension to compare with: " + report["reference"]["status"] + "."
    elif smallest["tension"] < SLACK_SHARE * report["extremes"]["mean"]:
        yield (
            f"The tension falls to {smallest['tension']:.4g} N at s = {smallest['s']:.4g} m: where it vanishes, a "
            "perfectly flexible cable is no longer a model of a mooring line, and snap loads follow."
        )


def _python(best) -> str | None:
    """The recommended setting as lines to paste."""
    if best is None:
        return None
    if best["method"] == "time domain":
        name, how = "solve_time_domain", f"dt={best['dt']:.6g}, periods={PERIODS}"
    else:
        name, how = "solve_periodic", f"harmonics={best['harmonics']}"
        how += ", deferred_correction=True" if best["method"].endswith("corrected") else ""
    return (
        f"from solvers import Scene, cable_system, {name}\n\n"
        f'system = cable_system(Scene.load("FILE"), nodes={best["nodes"]})\nresponse = {name}(system, {how})\n'
        "response.tension_harmonics(5)  # N: mean and amplitudes of the fairlead tension"
    )
