"""The moving cables that are measured: the four cases of the HB paper and its large surge; their converged tension.

Errors are those of the fairlead tension over one period, relative to its range (greatest less least): the root of the
mean square (``rms``) and the greatest (``error``).
"""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import asdict, dataclass, field
from functools import cache
from importlib.resources import files
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from solvers import Scene
from solvers.cable.system import cable_system
from solvers.harmonic_balance.solve import solve_periodic
from verification.cases import cables
from verification.registry import INSTANTS, last_period_tension

from ..run import refinement, results
from ..run.refinement import estimate_uncertainty

SCENES = files("reference_data") / "scenes" / "dynamics"
CASES = cables.PAPER_CASES
PAPER_CASES = tuple(CASES)[:4]
"""The cases of HB Table 2."""

NODES, HARMONICS, SAMPLES, DT, PERIODS = 50, 9, 32, 0.1, 3
"""The settings of HB section 4.3."""


def scene(name: str) -> Scene:
    """One of CASES."""
    return Scene.load(SCENES / f"hb_{name}.toml")


@cache
def system(name: str, nodes: int = NODES, fields: str = "auto"):
    """Return the cable of a case, its equilibrium solved: its cost is in no timing but where a benchmark says so."""
    cable = cable_system(scene(name), nodes, fields=fields)
    cable.rest_state()
    return cable


def warm_up():
    """Load or compile what is compiled, in both precisions: it would be in the first timings of a process."""
    solve_periodic(system("case_1", 25), harmonics=HARMONICS)


def axial_ratio(name: str) -> float:
    """First axial frequency of the stretched line as a straight bar between held ends, over that of the motion."""
    case = scene(name)
    wave_speed = math.sqrt(case.cable.EA / case.cable.mass_per_length)
    return wave_speed / (2 * case.length) / case.motion.frequency


@dataclass(frozen=True)
class Reference:
    """Converged fairlead tension (INSTANTS,) in N at ``instants`` of the period in s; uncertainty: its rms,
    estimated; levels: nodes of the meshes that it is extrapolated from; refinements: "mesh", "steps"
    or "harmonics" -> the fields of a Refinement of its finest run, which extrapolation may still improve."""

    period: float
    tension: np.ndarray
    uncertainty: float
    levels: tuple[int, ...] = ()
    refinements: dict = field(default_factory=dict)

    @property
    def range(self) -> float:
        """Greatest less least tension, N."""
        return float(np.ptp(self.tension))

    def harmonics(self, k: int) -> np.ndarray:
        """Mean and amplitudes of harmonics 1..k, (k + 1,), N."""
        spectrum = np.fft.rfft(self.tension) / self.tension.size
        return np.concatenate([[spectrum[0].real], 2 * abs(spectrum[1 : k + 1])])

    def errors(self, tension) -> dict:
        """rms and error of a waveform at equal times of the period: a multiple of INSTANTS, or a divisor."""
        given = np.asarray(tension)[:: max(1, len(tension) // INSTANTS)]
        difference = (given - self.tension[:: INSTANTS // len(given)]) / self.range
        return {"rms": rms(difference), "error": float(abs(difference).max())}

    def errors_of_response(self, response) -> dict:
        """Return rms and error of the last period of a TimeHistory or PeriodicResponse."""
        return self.errors(last_period_tension(response))


LEVELS, FINE, FINEST = (50, 100, 200, 400), 30, 60
QUICK_LEVELS, QUICK_FINE = (25, 50, 100), 20


def converged(name: str, levels=LEVELS, harmonics=FINE, finest=FINEST) -> Reference:
    """HB extrapolated to infinitely many nodes, and corrected at the coarsest mesh to ``finest`` harmonics.

    The error is of second order in the cell. Uncertainty: what the finest mesh moves the extrapolated value by, and
    what the additional harmonics do; relative to the range.
    """
    responses = [None]
    for nodes in levels:
        chain = system(name, nodes)
        responses.append(solve_periodic(chain, harmonics=harmonics, start=on_mesh(responses[-1], chain)))
    coarsest, waves = responses[1], [last_period_tension(response) for response in responses[1:]]
    fewest = solve_periodic(coarsest.system, harmonics=harmonics // 2)
    more = solve_periodic(coarsest.system, harmonics=finest, start=coarsest)
    by_harmonics = [last_period_tension(fewest), waves[0], last_period_tension(more)]
    meshes = list(zip(levels, waves, strict=True))
    limits = [fine + (fine - rough) / (((m - 1) / (n - 1)) ** 2 - 1) for (n, rough), (m, fine) in pairwise(meshes)]
    tension = limits[-1] + by_harmonics[2] - waves[0]
    spread = float(np.ptp(tension))
    uncertainty = (rms(limits[-1] - limits[-2]) + rms(by_harmonics[2] - waves[0])) / spread
    cells = [n - 1 for n in levels[-3:]]
    refinements = {
        "mesh": estimate_uncertainty(cells, waves[-3:], spread),
        "harmonics": estimate_uncertainty(
            (harmonics // 2, harmonics, finest), by_harmonics, spread, is_truncation=True
        ),
    }
    kept = {name: asdict(one) for name, one in refinements.items()}
    return Reference(chain.period, tension, uncertainty, levels, kept)


def rms(values) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def on_mesh(response, chain):
    """Coefficients of a response on another mesh of the same cable, as a start; None for none."""
    return None if response is None else CubicSpline(response.system.s, response.z, axis=1)(chain.s)


class References:
    """Converged tensions, kept in ``folder``/cache by the content of what they are made with."""

    def __init__(self, folder: Path, quick: bool):
        self.settings = (QUICK_LEVELS, QUICK_FINE, FINE) if quick else (LEVELS, FINE, FINEST)
        self.folder = folder / "cache"
        self.folder.mkdir(parents=True, exist_ok=True)

    def get_or_compute(self, name: str) -> Reference:
        """Return the Reference of a case: kept, or computed; a finer one that is kept serves too."""
        for settings in ((LEVELS, FINE, FINEST), self.settings):
            path = self._path(name, settings)
            if path.exists():
                kept = json.loads(path.read_text(encoding="utf-8"))
                return Reference(**kept | {"tension": np.array(kept["tension"])})
        reference = converged(name, *self.settings)
        results.write(path, vars(reference))
        return reference

    def _path(self, name, settings) -> Path:
        made = hashlib.sha256(json.dumps([sources(), settings]).encode())
        made.update((SCENES / f"hb_{name}.toml").read_bytes())
        return self.folder / f"tension-{name}-{made.hexdigest()[:16]}.json"


_SOLVERS = (
    "cable/system",
    "cable/planar",
    "cable/spatial",
    "numerics/chain",
    "cable/loads",
    "numerics/fourier",
    "harmonic_balance/solve",
    "harmonic_balance/residual",
    "harmonic_balance/blocks",
    "numerics/compiled",
    "numerics/lu/bordered",
    "numerics/lu/blas_by_address",
    "numerics/newton",
    "cable/statics",
    "common/motions/motion",
    "common/motions/motion_arrays",
    "common/properties",
    "io/scene",
    "harmonic_balance/response",
    "cable/midpoint_stencils",
)


@cache
def sources() -> str:
    """Digest of the solver modules that a reference depends on, and of this one."""
    total = hashlib.sha256(Path(__file__).read_bytes() + Path(refinement.__file__).read_bytes())
    for name in _SOLVERS:
        total.update((files("solvers") / f"{name}.py").read_bytes())
    return total.hexdigest()
