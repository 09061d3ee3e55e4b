"""Does every public call show how it is used, and give what its example prints?"""

from __future__ import annotations

import doctest
import inspect

import pytest

import solvers
from solvers.io import load_body_motion, load_moordyn, load_network, read_map_file, write_moordyn
from solvers.numerics.modes import natural_modes

RETURNED = {"CableSystem", "CatenaryBatch", "CatenaryState", "ConvergenceError", "InputError", "NetworkState",
            "PeriodicResponse", "Regime", "ResponseCurve", "StaticState", "Status", "TimeHistory",
            "MooringSystem"}  # fmt: skip
"""Public classes that calls return or raise, and callers do not build."""

PUBLIC = {name: getattr(solvers, name) for name in solvers.__all__ if callable(getattr(solvers, name))}
CALLS = {name: call for name, call in PUBLIC.items() if name not in RETURNED}
CALLS |= {"Scene.load": solvers.Scene.load, "natural_modes": natural_modes, "read_map_file": read_map_file,
          "load_network": load_network, "load_body_motion": load_body_motion,
          "load_moordyn": load_moordyn, "write_moordyn": write_moordyn}  # fmt: skip


def examples(call, name: str) -> doctest.DocTest:
    """Return the examples of a call's own docstring; they see what ``from solvers import *`` brings."""
    space = {word: getattr(solvers, word) for word in solvers.__all__}
    return doctest.DocTestParser().get_doctest(inspect.getdoc(call) or "", space, name, None, 0)


def failures(call, name: str = "call") -> list[str]:
    """Return what is wrong with the examples of a call: none, one that only builds names, or another output."""
    test, output = examples(call, name), []
    if not any(example.want for example in test.examples):
        return [f"{name}: no example that shows a value"]
    doctest.DocTestRunner(verbose=False).run(test, out=output.append)
    return output


@pytest.mark.parametrize("name", CALLS)
def test_examples_give_what_they_print(name):
    """Each public call has an example in its docstring, which runs and prints the values beside it."""
    wrong = failures(CALLS[name], name)
    assert not wrong, "\n".join(wrong)


def test_what_needs_no_example_is_public():
    """The list of classes that callers do not build has no name that is gone."""
    assert set(PUBLIC) >= RETURNED


@pytest.mark.parametrize(
    "text",
    ["Return one.", "Return one.\n\n>>> x = Span\n", "Return one.\n\n>>> 1 + 1\n3\n", "Return one.\n\n>>> no\n1\n"],
)
def test_a_missing_or_wrong_example_is_found(text):
    """No example, one that shows nothing, another value and a name that is not there are all found."""

    def call():
        pass

    call.__doc__ = text
    assert failures(call)
