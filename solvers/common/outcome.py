"""Statuses that every solver returns, and the errors that it raises."""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum
from functools import cached_property
from typing import Self


class Status(Enum):
    """How a solve ended; the value says what happened and what to try."""

    SUCCESS = "solved to the requested tolerance"
    INVALID_INPUT = (
        "an input is not finite, has the wrong sign, or puts an end below the seabed: "
        "build solvers.Span from this row to read which one"
    )
    NOT_CONVERGED = "the iteration stopped above the requested tolerance: relax it, or report these inputs"
    FRICTION_UNDETERMINED = (
        "the line rests on the seabed between two ends above it, where friction acts as the line was laid "
        "and statics alone cannot tell: set friction = 0 or clearance = 0"
    )
    NO_EQUILIBRIUM_FOUND = (
        "no equilibrium of the cable was found, even with the current raised in small steps: "
        "see whether the line can hold (length against chord, tension above zero), or use more nodes"
    )
    STEP_FAILED = (
        "a time step did not converge: take a shorter dt, or step_tolerance for a step that adapts; near rho_inf = 1, "
        "where nothing damps the shortest waves and short steps may feed them, a smaller rho_inf"
    )
    COMPRESSION = (
        "the tension vanished at a node, and a perfectly flexible cable in compression is ill-posed: "
        "reduce the motion, or let it grow from rest over a longer time"
    )
    OVERSTRETCHED = (
        "the line is stretched beyond 30 %, where no mooring line holds and EA has no meaning: "
        "use a longer line or a smaller motion"
    )
    NO_PERIODIC_RESPONSE = (
        "no periodic response was found at the full motion, even with its amplitude raised in small steps: "
        "use more nodes (over a seabed, where the line touches down) or fewer harmonics, start from a neighbouring "
        "response, or reduce the motion"
    )
    CURVE_STEP_TOO_SHORT = (
        "the response curve was not followed further, even in the shortest steps: the last good point is the last one "
        "of the curve; use more harmonics or samples, a smaller min_step, or over a damped seabed a contact_depth, for "
        "its force jumps where a node touches down"
    )
    CURVE_LEFT_RANGE = (
        "the system refuses the parameter beyond the last good point, which is the last one of the curve: "
        "end the range before it"
    )
    CURVE_FOLD_AT_STOP = (
        "the response curve has a fold at the stop of its range, where it turns back: "
        "the last good point is the last one of the curve; move the stop"
    )
    CURVE_SINGULAR_START = (
        "the response curve starts at a fold or a branch point, where its direction is not determined: move the start"
    )
    CURVE_INTERRUPTED = (
        "the response curve was interrupted: its points are kept, and response_curve(..., resume=curve) goes on"
    )
    CURVE_RETURNED = "the response curve turned back and left its range at its start: start from another response"
    CURVE_TOO_LONG = (
        "the response curve has as many points as allowed: raise max_points and go on with resume=curve, "
        "or allow a longer max_step"
    )
    NOT_CORRECTED = (
        "the periodic response was found, but its mesh is too coarse or too uneven for a deferred correction: "
        "use more nodes, even out the mesh, or set deferred_correction=False"
    )
    NOT_FINITE = (
        "forces or ratios of the inputs (to L, to w L) leave the range of double precision: change the extreme input"
    )


class InputError(ValueError):
    """An input is refused before any work; the message names the field, its value and its unit.

    Attributes, each None where it has no meaning: ``field``, the name of the argument or key; its ``value``; its
    ``unit``; ``item``, (kind, index) of the node or element that it belongs to. The message is a label (by default the
    item or the field, "" for none) and the ``problem``, which states value, unit and what they should be.
    """

    def __init__(self, problem: str, *, field=None, value=None, unit=None, item=None, label=None):
        if label is None:
            label = f"{item[0]} {item[1]}" if item else field
        super().__init__(f"{label}: {problem}" if label else problem)
        self.problem, self.field, self.value, self.item = problem, field, value, item
        self.unit = unit and unit.strip("()")

    def labelled(self, label: str) -> InputError:
        """Return the error with another label in its message, in place of its field or item."""
        return InputError(self.problem, field=self.field, value=self.value, unit=self.unit, item=self.item, label=label)

    def located(self, place: str) -> InputError:
        """Return the error with the place of the input, a file, line or table, in front of its message."""
        return InputError(str(self), field=self.field, value=self.value, unit=self.unit, item=self.item, label=place)


class ConvergenceError(RuntimeError):
    """A solve failed; the message says what was given, what is wrong and what to try.

    Attributes: ``outcome``, the result object that ``throw=False`` would have returned.
    """

    def __init__(self, message: str, outcome=None):
        super().__init__(message)
        self.outcome = outcome


def describe_vector(vector) -> str:
    """Return words for three components."""
    return f"({', '.join(f'{part:.6g}' for part in vector)})"


class Outcome:
    """Mixin of every result: expects the fields ``status``, ``iterations`` and ``residual_norm``."""

    status: Status
    iterations: int
    residual_norm: float

    @property
    def success(self) -> bool:
        """True when the result can be used."""
        return self.status is Status.SUCCESS

    def describe(self) -> Iterator[str]:
        """Yield the main numbers with their units, a line of text each; a failed result yields none."""
        yield from ()

    def __repr__(self) -> str:
        """Status, main numbers and warnings, in one to five lines; nothing is solved for."""
        lines = [f"{type(self).__name__}: {self.status.name}, {self.iterations} iterations, "
                 f"residual {self.residual_norm:.2g}"]  # fmt: skip
        lines += self.describe() if self.success else [self.status.value]
        return "\n  ".join([*lines, *self._describe_warnings()])

    def _describe_warnings(self) -> Iterator[str]:
        """Yield a line on the warnings; those that are kept once asked for may take a solve, which this starts not."""
        if not hasattr(type(self), "warnings"):
            return
        if isinstance(type(self).warnings, cached_property) and "warnings" not in vars(self):  # type: ignore[attr-defined]
            yield "warnings: ask .warnings"
            return
        warnings = self.warnings  # type: ignore[attr-defined]
        more = f" (and {len(warnings) - 1} more: .warnings)" if len(warnings) > 1 else ""
        yield f"warning: {warnings[0]}{more}" if warnings else "no warnings"

    def or_raise(self, given) -> Self:
        """Return this result if it is a success; raises ConvergenceError naming what was ``given`` otherwise."""
        if self.status is not Status.SUCCESS:
            raise ConvergenceError(
                f"{self.status.value} (given {given}; {self.iterations} iterations, residual {self.residual_norm:.3g})",
                self,
            )
        return self
