"""Are the natural modes of masses in a row those of the textbook, and is what they cannot be refused?"""

from __future__ import annotations

import math

import numpy as np
import pytest

from solvers import InputError
from solvers.numerics.modes import natural_modes

from ..cases.oscillators import MassChain, harmonic_force

EXACT = 2e-9  # of a frequency; measured up to 2e-10, where the first shift lies far below all frequencies


def masses(nodes, k=1.0, c=0.0, m=1.0) -> MassChain:
    """Return equal masses on equal springs, the first on a wall and the last free."""
    return MassChain("masses", 1.0, harmonic_force(0.0, 1.0, 0, nodes), nodes, m=m, c=c, k=k)


def exact_frequencies(nodes, k=1.0, m=1.0):
    """Return the frequencies in Hz of ``masses`` without damping, 2 sqrt(k/m) sin((2 j - 1) pi / (4 N + 2)) rad/s."""
    j = np.arange(1, nodes + 1)
    return 2 * math.sqrt(k / m) * np.sin((2 * j - 1) * math.pi / (4 * nodes + 2)) / (2 * math.pi)


@pytest.mark.parametrize("near", [0.0, 0.3])
def test_one_damped_mass(near):
    """The single mode of one mass: sqrt(k/m) / (2 pi) and c / (2 sqrt(k m)), from either kind of shift."""
    modes = natural_modes(masses(1, k=4.0, c=0.4), 1, near)
    assert modes.frequencies == pytest.approx([2.0 / (2 * math.pi)], rel=EXACT)
    assert modes.damping == pytest.approx([0.1], rel=EXACT)


@pytest.mark.parametrize("k", [1e-6, 1.0, 1e8])
@pytest.mark.parametrize("nodes", [2, 8, 20])
def test_equal_masses_on_equal_springs(nodes, k):
    """The lowest modes, whatever the size of the frequencies, without damping; all of them on a short chain."""
    count = min(nodes, 6)
    modes = natural_modes(masses(nodes, k), count)
    assert modes.frequencies == pytest.approx(exact_frequencies(nodes, k)[:count], rel=EXACT)
    assert abs(modes.damping).max() <= EXACT


def test_modes_near_a_frequency():
    """Those nearest to the one asked for, sorted; the lowest where it lies far below all."""
    exact = exact_frequencies(40)
    near = (exact[20] + 2 * exact[21]) / 3
    nearest = np.sort(exact[np.argsort(abs(exact - near))[:3]])
    assert natural_modes(masses(40), 3, near).frequencies == pytest.approx(nearest, rel=EXACT)
    assert natural_modes(masses(40), 3, 0.01 * exact[0]).frequencies == pytest.approx(exact[:3], rel=EXACT)


def test_shapes_are_those_of_the_textbook():
    """Places sin((2 j - 1) n pi / (2 N + 1)) of masses n = 1..N, velocities lambda times that; of norm 1."""
    nodes = 8
    modes = natural_modes(masses(nodes), 3)
    for j in range(3):
        shape = modes.shapes[:, :, j]
        place = np.sin((2 * j + 1) * np.arange(1, nodes + 1) * math.pi / (2 * nodes + 1))
        factor = shape[0, 0] / place[0]
        assert shape[0] == pytest.approx(factor * place, abs=EXACT)
        assert shape[1] == pytest.approx(2j * math.pi * modes.frequencies[j] * factor * place, abs=EXACT)
        assert np.linalg.norm(shape) == pytest.approx(1.0, abs=EXACT)


def test_what_a_chain_does_not_have_is_refused():
    """More modes than pairs of eigenvalues, or than oscillations."""
    with pytest.raises(InputError, match=r"^count: 5 modes asked, a chain of 3 nodes has at most 4"):
        natural_modes(masses(3), 5)
    with pytest.raises(InputError, match=r"^count: 4 modes asked, 3 found on 3 nodes$"):
        natural_modes(masses(3), 4)


def test_a_shift_far_above_the_lowest_frequency_is_refused():
    """Two masses on a soft spring and a stiff one between them: up to 1e8 times the lowest frequency is taken."""
    chain = masses(2, k=np.array([1.0, 1e16]))
    lowest, highest = math.sqrt(0.5) / (2 * math.pi), math.sqrt(2e16) / (2 * math.pi)
    assert natural_modes(chain, 1, near=0.99e8 * lowest).frequencies == pytest.approx([highest], rel=EXACT)
    with pytest.raises(InputError, match=r"^near: .* Hz must not exceed 1e\+08 of the lowest frequency, 0.113 Hz"):
        natural_modes(chain, 1, near=1.01e8 * lowest)
