"""One load case: how the coupled points move, for how long, in which current and at which offset."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .motions.body_motion import BodyMotion
from .motions.sea_state import SeaState
from .outcome import InputError
from .types import Vector
from .validation import non_negative_number, positive_number, vector

RAMP = 120.0  # s; a line of a few hundred metres in drag has forgotten its start after some periods


@dataclass(frozen=True, eq=False)
class LoadCase:
    """A row of a table of load cases.

    motion: a SeaState, a BodyMotion, or any motion of all coupled points alike
    duration: s, over which statistics are taken, after ``ramp`` in s, over which the motion grows from rest
    current: (3,) m/s in place of that of the system, None: as there; offset: (3,) m, by which the coupled points are
    displaced at rest. Raises InputError naming the field, its value and its unit.
    """

    name: str
    motion: Any
    duration: float
    ramp: float = RAMP
    current: Vector | None = None
    offset: Vector = (0.0, 0.0, 0.0)

    def __post_init__(self):
        moves = isinstance(self.motion, (SeaState, BodyMotion)) or hasattr(self.motion, "velocity")
        if not moves:
            problem = f"{self.motion!r} is no SeaState, BodyMotion or Motion"
            raise InputError(problem, field="motion", value=self.motion)
        object.__setattr__(self, "duration", positive_number("duration", self.duration, "s"))
        object.__setattr__(self, "ramp", non_negative_number("ramp", self.ramp, "s"))
        if self.current is not None:
            object.__setattr__(self, "current", vector("current", self.current, "m/s"))
        object.__setattr__(self, "offset", vector("offset", self.offset, "m"))

    @property
    def whole_duration(self) -> float:
        """Ramp and duration, s."""
        return self.ramp + self.duration
