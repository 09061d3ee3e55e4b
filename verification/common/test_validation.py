"""Are numbers, arrays and vectors of any kind taken as they are meant, and what is none refused?"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from solvers import InputError
from solvers.common.validation import as_array, real_array, vector, whole_number

COMPLEX = [
    [1.0, 2j],
    np.array([1j, 2.0]),
    np.array([np.complex128(1 + 2j), 1.0], dtype=object),  # numpy would cut the imaginary part with a warning
    np.array([[1.0, 2.0], [3.0, np.complex64(0)]], dtype=object),
]


@pytest.mark.parametrize("value", COMPLEX, ids=repr)
def test_complex_numbers_are_no_real_array(value):
    with pytest.raises(TypeError):
        real_array(value)


@pytest.mark.parametrize(
    "value", [[1, 2.5], (1, Fraction(5, 2)), np.array([1, 2.5], dtype=object), np.array([1, Fraction(5, 2)])], ids=repr
)
def test_real_numbers_of_any_kind_are_an_array_of_floats(value):
    array = real_array(value)
    assert array.dtype == float and array.tolist() == [1.0, 2.5]


def test_an_array_is_copied():
    given = np.array([1.0, 2.0])
    assert not np.shares_memory(given, real_array(given))


@pytest.mark.parametrize("value", [np.ma.masked, [1.0, np.ma.masked], [[1.0], (np.ma.masked,)]], ids=repr)
def test_masked_elements_are_refused(value):
    with pytest.raises(ValueError, match="masked elements"):
        as_array(value)


@pytest.mark.parametrize("value", [[1, 2, 3], (1.0, 2.0, 3.0), np.array([1.0, 2.0, 3.0])], ids=repr)
def test_three_numbers_in_a_row_are_a_vector(value):
    assert vector("r", value, "m") == (1.0, 2.0, 3.0)


@pytest.mark.parametrize("value", [np.array([[1.0], [2.0], [3.0]]), np.array(1.0), [[1], [2], [3]], "123"], ids=repr)
def test_other_shapes_are_no_vector(value):
    with pytest.raises(InputError, match=r"(?s)r: .* must be three components"):
        vector("r", value, "m")


@pytest.mark.parametrize(("value", "most"), [(3, None), (10**30, None), (np.int8(5), 5), (3, 3)])
def test_whole_numbers_up_to_both_limits_are_taken(value, most):
    number = whole_number("n", value, 3, most)
    assert type(number) is int and number == value


@pytest.mark.parametrize(
    ("value", "most", "limits"),
    [(2, None, ">= 3"), (2, 5, "from 3 to 5"), (6, 5, "from 3 to 5"), (4.0, None, ">= 3"), (True, None, ">= 3")],
)
def test_other_numbers_are_no_whole_numbers(value, most, limits):
    with pytest.raises(InputError, match=f"^n: {value} must be a whole number {limits}$"):
        whole_number("n", value, 3, most)
