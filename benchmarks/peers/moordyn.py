"""MoorDyn 2 on a cable with a moving fairlead, through its own Python bindings.

Not one of the solvers of spans in ``peers.available``; benchmarks.dynamic_work imports it where MoorDyn is installed.
What to mind: the tension output of a line is that of its last segment, half a segment from the end (first order), so
the force on the point is taken; in a coupling step the fairlead moves with one velocity, so the mean one is given, and
a long coupling step still shifts the response. Its RK2 is unstable for a line without internal damping: DAMPING is a
share of the critical damping of a segment, so it vanishes with refinement.
"""

from __future__ import annotations

import os
import tempfile
from contextlib import contextmanager
from importlib import metadata
from pathlib import Path

import moordyn
import numpy as np

LABEL = "MoorDyn"

DAMPING = -0.1
STEP = 0.2  # s over the number of segments: 4 ms for 49 of them; twice that is beyond the limit of stability
DEPTH = 5000.0  # m: of a seabed that is not there

_INPUT = """MoorDyn
--- LINE TYPES ---
Name Diam MassDen EA BA/-zeta EI Cd Ca CdAx CaAx
(-) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
cable {d!r} {m!r} {EA!r} {damping} 0 {Cd!r} {Ca!r} {Cdt!r} 0
--- POINTS ---
ID Attachment X Y Z M V CdA CA
(#) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Fixed {anchor} 0 0 0 0
2 Coupled {fairlead} 0 0 0 0
--- LINES ---
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
1 cable 1 2 {L!r} {segments} -
--- OPTIONS ---
0 writeLog
1 disableOutput
1 disableOutTime
RK2 tScheme
{step!r} dtM
{g!r} g
{rho!r} rho
{depth!r} WtrDpth
0 TmaxIC
--- OUTPUT ---
--- need this line ---
"""


def version() -> str:
    return metadata.version("moordyn")


def unsupported(scene) -> str:
    environment, cable = scene.environment, scene.cable
    if environment.depth is not None or any(environment.current):
        return "this adapter describes still water without a seabed"
    if cable.Cdb != cable.Cdn or cable.damping:
        return "this adapter gives one transverse drag coefficient and no damping in s"
    return ""


def describe(scene, segments: int) -> str:
    """Its input file; the submerged weight follows from diameter and mass."""
    cable, environment = scene.cable, scene.environment
    points = {name: " ".join(map(repr, getattr(scene, name))) for name in ("anchor", "fairlead")}
    return _INPUT.format(
        d=cable.diameter, m=cable.mass_per_length, EA=cable.EA, damping=DAMPING, Cd=cable.Cdn, Ca=cable.Ca,
        Cdt=cable.Cdt, L=scene.length, segments=segments, step=STEP / segments, g=environment.g, rho=environment.rho,
        depth=DEPTH, **points,
    )  # fmt: skip


def simulate(scene, displacement, duration: float, *, segments=49, coupling=0.02) -> tuple[np.ndarray, np.ndarray]:
    """(time (K,) s, fairlead tension (K,) N) at the ends of the coupling steps (s), from rest.

    displacement: t (K,) in s -> (3, K) in m, of the fairlead about its place in the scene.
    """
    count = round(duration / coupling)
    time = coupling * np.arange(count + 1)
    place = np.array(scene.fairlead) + displacement(time).T
    velocity = np.diff(place, axis=0) / coupling
    force = np.empty((count, 3))
    with tempfile.TemporaryDirectory() as folder, _silence():
        file = Path(folder) / "lines.txt"
        file.write_text(describe(scene, segments), encoding="utf-8")
        system = moordyn.Create(str(file))
        try:
            moordyn.Init(system, list(place[0]), [0.0, 0.0, 0.0])
            point = moordyn.GetPoint(system, 2)
            for k in range(count):
                moordyn.Step(system, list(place[k]), list(velocity[k]), time[k], coupling)
                force[k] = moordyn.GetPointForce(point)
        finally:
            moordyn.Close(system)
    return time[1:], np.linalg.norm(force, axis=1)


@contextmanager
def _silence():
    """It prints from C++, past sys.stdout and sys.stderr."""
    kept = [os.dup(stream) for stream in (1, 2)]
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for stream in (1, 2):
            os.dup2(nowhere, stream)
        yield
    finally:
        for stream, old in zip((1, 2), kept, strict=True):
            os.dup2(old, stream)
            os.close(old)
        os.close(nowhere)
