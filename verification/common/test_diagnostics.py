"""Do the warnings of a result say what is wrong with it, by the right number? Results written down by formula."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from solvers import Motion
from solvers.common import diagnostics

PERIOD, NODES = 8.0, 4


class Line:
    """A system of four nodes whose tension is a function of time at each, and whose fairlead is ``away`` m off."""

    def __init__(self, tensions, amplitude=1.0, away=0.0):
        self.tensions, self.away, self.period = tensions, away, PERIOD
        self.motion = Motion.harmonic(1 / PERIOD, (0.0, 0.0, amplitude))

    def tension(self, y, ydot):
        return np.array([tension(y[0]) for tension in self.tensions])  # the state is the time itself

    s = np.linspace(0.0, 100.0, NODES)

    needs_mesh_check = False

    def rest_warnings(self):
        return ()

    def drift(self, y, t):
        return np.array([0.6, 0.0, 0.8])[:, None] * self.away * np.ones_like(t)


def history(line, count=160, periods=2, steps=None):
    """A history of the line at equal times, as ``check_history`` reads it."""
    time = np.linspace(0.0, periods * PERIOD, count + 1)
    at = lambda t: np.array([t])
    return SimpleNamespace(
        ramped_system=line, system=line, failed_ramp=None, time=time, steps=count if steps is None else steps,
        hold="position",
        tension=line.tension(at(time), None), drift=lambda: np.abs(line.away) * np.ones_like(time),
        at=at, rate_at=at, fairlead_tension=lambda t: line.tension(at(t), None)[-1],
    )  # fmt: skip


def response(line, harmonics=8, mean=True):
    """A periodic response of the line, as ``check_response`` reads it."""
    at = lambda t: np.array([t])
    basis = SimpleNamespace(harmonics=harmonics)
    return SimpleNamespace(system=line, basis=basis, at=at, rate_at=at, last_period=(0.0, PERIOD), mean=mean)


def wave(mean=10.0, **amplitudes):
    """mean + sum of amplitudes cos(k omega t), as c1=..., c7=..."""
    harmonics = {int(name[1:]): value for name, value in amplitudes.items()}
    return lambda t: mean + sum(a * np.cos(2 * np.pi * k * t / PERIOD) for k, a in harmonics.items()) + 0 * t


def inner_nodes_with(tension):
    """Four nodes: the tension at all but the fairlead, where a smooth wave of range 2 is."""
    return Line([tension] * (NODES - 1) + [wave(c1=1.0)])


CALM, SHARP = wave(c1=1.0), wave(c1=1.0, c40=0.5)


def test_a_smooth_history_and_response_warn_of_nothing():
    line = Line([CALM] * NODES)
    assert list(diagnostics.check_history(history(line))) == [] == list(diagnostics.check_response(response(line)))


def test_resolution_is_judged_at_the_fairlead():
    """Waves at other nodes do not count for the fairlead's tension; one there is reported with its share."""
    assert list(diagnostics.check_history(history(inner_nodes_with(SHARP)))) == []
    assert list(diagnostics.check_response(response(inner_nodes_with(wave(c1=1.0, c8=0.1))))) == []
    line = Line([CALM] * (NODES - 1) + [SHARP])
    bends = diagnostics.largest_slope_change(SHARP(history(line).time), history(line).time) / np.ptp(
        SHARP(history(line).time)
    )
    (warnings,) = diagnostics.check_history(history(line))
    assert warnings == f"dt: the slope of the tension changes by {bends:.2g} of its range in a step: use a shorter dt"


@pytest.mark.parametrize("last", [7, 8])
def test_the_warning_of_the_last_two_harmonics_gives_their_amplitude(last):
    """A tenth of the range is reported as such; the same amplitude in the harmonic before them is not."""
    line = Line([CALM] * (NODES - 1) + [wave(c1=1.0, **{f"c{last}": 0.2})])
    spread = np.ptp(line.tensions[-1](PERIOD * np.arange(128) / 128))
    (warnings,) = diagnostics.check_response(response(line))
    assert warnings == f"harmonics: the last of 8 carry {0.2 / spread:.2g} of the tension's range: use more"
    assert list(diagnostics.check_response(response(Line([CALM] * 3 + [wave(c1=1.0, c6=0.2)])))) == []


def test_amplitudes_are_compared_with_the_range():
    """Just below and just above the bound, whatever the size of the tension."""
    for size in (1e-3, 1.0, 1e6):
        for share, warnings in ((0.8, False), (1.25, True)):
            tail = share * diagnostics.TAIL * 2 * size
            line = Line([CALM] * 3 + [wave(mean=10 * size, c1=size, c8=tail)])
            assert bool(list(diagnostics.check_response(response(line)))) is warnings, (size, share)


@pytest.mark.parametrize("harmonics", [3, 4])
def test_fewer_than_four_harmonics_are_too_few(harmonics):
    """Four show how the response falls off; three do not, however smooth it is."""
    warnings = list(diagnostics.check_response(response(Line([CALM] * NODES), harmonics=harmonics)))
    too_few = ["harmonics: 3 are too few to show how the response falls off: use 4 or more"]
    assert warnings == (too_few if harmonics == 3 else [])


def test_two_periods_are_compared_from_the_second_on():
    """Of a wave that grows, the difference of two periods over the range of the last; nothing before there are two."""
    growing = Line([CALM] * (NODES - 1) + [lambda t: 10.0 + (1.0 + 0.5 * t / PERIOD) * np.cos(2 * np.pi * t / PERIOD)])
    (warning,) = diagnostics.check_history(history(growing, periods=2))
    last = growing.tensions[-1](np.linspace(PERIOD, 2 * PERIOD, 81))
    share = 0.5 / np.ptp(last)  # the amplitude grows by 0.5 in a period
    assert warning == f"periods: the last two differ by {share:.2g} of the range of the tension: not periodic yet"
    assert list(diagnostics.check_history(history(growing, periods=1.99))) == []


def test_periods_are_compared_by_the_range_of_the_last():
    """Whatever the range is, 1 N too; where the tension has come to rest there is none to compare with."""
    amplitude = lambda t, last: np.where(t < PERIOD, 0.25, last)
    for last, warned in ((0.5, True), (0.0, False)):
        line = Line(
            [CALM] * (NODES - 1) + [lambda t, last=last: 2 + amplitude(t, last) * np.cos(2 * np.pi * t / PERIOD)]
        )
        warnings = list(diagnostics.check_history(history(line, count=16)))
        assert any(text.startswith("periods: the last two differ by") for text in warnings) is warned
        assert np.ptp(line.tensions[-1](np.linspace(0.0, 2 * PERIOD, 17))) == (1.0 if warned else 0.5)


def test_a_range_of_rounding_is_no_motion():
    """A billionth of the tension is where rounding ends: above it the share of the last harmonics is judged."""
    for share, judged in ((0.8, False), (1.25, True)):
        amplitude = share * 1e-9 / 2
        line = Line([CALM] * (NODES - 1) + [wave(mean=1.0, c1=0.9 * amplitude, c8=0.1 * amplitude)])
        assert bool(list(diagnostics.check_response(response(line)))) is judged, share


def test_changes_of_slope_are_judged_only_where_every_step_is_stored():
    """Of a history that keeps every second step the stored times give no warning of dt; nor does a constant tension."""
    line = Line([CALM] * 3 + [SHARP])
    assert list(diagnostics.check_history(history(line, steps=320))) == []
    assert list(diagnostics.check_history(history(Line([wave()] * NODES)))) == []


def test_a_tension_of_zero_is_no_compression():
    """A line may hang slack; a tension below zero at one node is reported with node, time and number."""
    zero = wave(mean=1.0, c1=1.0)  # least at half a period, between two of the stored times and at an instant
    assert zero(np.array([4.0])) == 0.0
    line = Line([CALM, zero, CALM, CALM])
    for result in (history(line, count=161 * 2), history(line, count=2), response(line)):
        of = diagnostics.check_history if hasattr(result, "time") else diagnostics.check_response
        assert [warnings for warnings in of(result) if warnings.startswith("tension")] == []
    below = Line([CALM, wave(mean=1.0, c1=1.5), CALM, CALM])
    (warnings,) = diagnostics.check_response(response(below))
    assert warnings == "tension: -0.5 N between instants, at t = 4 s, node 2: use more nodes, or more harmonics"


def test_the_warning_of_a_displaced_fairlead_gives_distance_and_share():
    """The distance, over half the excursion; none where the fairlead stands still where it should."""
    for amplitude, away, warnings in ((2.0, 0.2, True), (2.0, 0.09, False), (0.0, 0.0, False)):
        line = Line([CALM] * NODES, amplitude, away)
        for result in (
            list(diagnostics.check_history(history(line))),
            list(diagnostics.check_response(response(line))),
        ):
            assert bool(result) is warnings, (amplitude, away)
            if warnings:
                assert result[0].startswith("drift: the fairlead is up to 0.2 m from its place, 0.1 of its excursion")
    (warnings,) = diagnostics.check_response(response(Line([CALM] * NODES, 0.0, 0.5)))
    assert warnings.startswith("drift: the fairlead is up to 0.5 m from its place: use more nodes")


class Waves:
    """A result with a fairlead tension, a last period and whether it succeeded."""

    def __init__(self, tension, success=True):
        self.fairlead_tension, self.success, self.last_period = tension, success, (2.0, 4.0)


def test_the_change_that_a_mesh_makes_is_an_rms_over_the_range():
    """Sines of amplitudes 10 and 8 differ by 2 sqrt(1/2) of a range of 20; a coarse mesh that failed tells nothing."""
    fine = Waves(lambda t: 50.0 + 10.0 * np.sin(np.pi * t / 2))
    coarse = lambda t: 50.0 + 8.0 * np.sin(np.pi * t / 2)
    assert np.isclose(diagnostics.relative_change(fine, Waves(coarse)), np.sqrt(0.5) / 10, rtol=1e-4)
    assert diagnostics.relative_change(fine, Waves(coarse, success=False)) is None


def test_a_mesh_is_judged_by_the_change_that_half_of_it_makes():
    """No word below the bound, one with the number above it, and one where the error is not known."""
    bound = diagnostics.MAX_MESH_ERROR
    assert list(diagnostics.check_mesh(bound, "nodes")) == []
    (above,) = diagnostics.check_mesh(0.21, "nodes")
    assert "0.21 of its range: use more nodes" in above
    (unknown,) = diagnostics.check_mesh(None, "cells")
    assert "not known" in unknown


def test_the_excursion_is_that_to_the_end_of_the_history():
    """Of a motion without a period, 1 m/s for 16 s in two steps: half of 16 m, of which 5 % may be missed."""
    for away, warned in ((0.39, False), (0.41, True)):
        line = Line([CALM] * NODES, away=away)
        line.period, line.motion = None, SimpleNamespace(displacement=lambda t: np.outer([0.6, 0.0, 0.8], t))
        warnings = list(diagnostics.check_history(history(line, count=2)))
        assert any(warning.startswith("drift") for warning in warnings) is warned, away
