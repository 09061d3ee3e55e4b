"""Can every check of the networks turn red? Planted mistakes, each with the checks that must find it."""

from __future__ import annotations

import inspect
import textwrap
from dataclasses import dataclass

import pytest

from solvers.catenary import excursion as catenary_excursion
from solvers.network import equations as network_balance
from solvers.network import jacobian as network_jacobian
from solvers.network import monolithic as network_monolithic
from solvers.network import nested as network_nested
from solvers.network import scalar as network_few
from solvers.network import solve as network

from ..cases.networks import bridle, bridle_system, chain_wire_chain, hanging_mass, spring_net, two_line
from .test_jacobian import CHECKS as DERIVATIVES
from .test_solve import (
    closed_form_misses,
    energy_misses,
    equilibrium_misses,
    exact,
    exact_misses,
    invariance_misses,
    iteration_misses,
    network_of,
    printed_misses,
    reaction_misses,
    solve_network,
    status_misses,
)

EXACT = (two_line(226.61, 1.0), hanging_mass(), bridle(), bridle_system(1.0, (20.0, -7.0, 1.0)))
JOINT = (chain_wire_chain(0.6),)
STIFF_DIGITS = 2e-11  # as in test_network

CHECKS = {
    **DERIVATIVES,
    "printed digits": printed_misses,
    "printed digits, nested": lambda: printed_misses(method="nested", fallback=False),
    "40 digits": lambda: exact_misses(EXACT),
    "40 digits, grounded joint": lambda: exact_misses(JOINT, STIFF_DIGITS),
    "reactions": lambda: reaction_misses(EXACT),
    "closed forms": closed_form_misses,
    "equilibrium": equilibrium_misses,
    "iterations": iteration_misses,
    "invariances": lambda: invariance_misses((bridle(), two_line())),
    "energy": lambda: energy_misses((bridle(), spring_net())),
}


@dataclass(frozen=True)
class Slip:
    """A mistake: in ``function``, ``right`` becomes ``wrong``; ``checks`` must all turn red."""

    function: object
    right: str
    wrong: str
    checks: tuple[str, ...]


SLIPS = {
    "buoy and mass exchanged": Slip(
        network_balance.Balance.__init__,
        "environment.rho * node.volume - node.mass",
        "node.mass - environment.rho * node.volume",
        ("closed forms", "40 digits", "equilibrium"),
    ),
    "friction forgotten at the anchor": Slip(
        network_balance.Balance.unbalanced,
        "= H_anchor * direction, V_anchor",
        "= H * direction, V_anchor",
        ("reactions", "40 digits, grounded joint"),
    ),
    "azimuth does not turn": Slip(
        network_balance.Elements.tangents,
        "= self.H / g.reach, self.H_anchor / g.reach",
        "= 0 * g.reach, 0 * g.reach",
        ("tangent", "assembled by hand"),
    ),
    "raised end hangs from a fixed height": Slip(
        network_balance._sagging,
        "softness + a * a * K11",
        "softness",
        ("tangent", "stiffness of coupled nodes"),
    ),
    "friction left out of the anchor's stiffness (4.11)": Slip(
        network_balance.exact_derivatives,
        "friction[resting, None] * D[resting, 1]",
        "0 * friction[resting, None] * D[resting, 1]",
        ("tangent", "stiffness of coupled nodes"),
    ),
    "(4.15) with the sign of the sine": Slip(
        catenary_excursion.suspended,
        "(both / 2), b, spread - sine,",
        "(both / 2), b, spread + sine,",
        ("blocks", "assembled by hand", "assembled against differences"),
    ),
    "(4.16a) as printed": Slip(
        catenary_excursion._touching,
        "lost / (w * EA)",
        "friction * np.maximum(grounded, 0.0) / EA",
        ("blocks",),
    ),
    "B block of the paper, no friction at the anchor (4.11)": Slip(
        catenary_excursion._touching,
        "pulled * friction",
        "0 * pulled",
        ("blocks",),
    ),
    "part on the seabed left out (2.23a)": Slip(
        catenary_excursion.suspended,
        "H * spread + lying",
        "H * spread",
        ("blocks",),
    ),
    "anchor on the seabed that follows V": Slip(
        catenary_excursion._free,
        "anchor[smooth, 1, 1], raised[smooth, 1] = 0.0, -1.0",
        "raised[smooth, 1] = -1.0",
        ("blocks",),
    ),
    "V of the anchor end upwards": Slip(
        catenary_excursion._free,
        "H.copy(), b, _block",
        "H.copy(), -b, _block",
        ("40 digits",),
    ),
    "gap of the wrong sign in the Schur complement": Slip(
        network_monolithic.Iterate.newton_step,
        "closing = K @ -other.gap",
        "closing = K @ other.gap",
        ("Schur step against dense step",),
    ),
    "forces do not follow the gap": Slip(
        network_monolithic.Iterate.newton_step,
        "@ motion + closing)",
        "@ motion)",
        ("Schur step against dense step",),
    ),
    "rows of the anchor missing": Slip(
        network_jacobian.analytic_jacobian,
        "x.anchor], axis=1)",
        "0 * x.anchor], axis=1)",
        ("assembled against differences",),
    ),
    "half the differences": Slip(
        network_jacobian.difference_jacobian,
        "difference / step * units[i]",
        "difference / (2 * step) * units[i]",
        ("assembled against differences",),
    ),
    "free nodes do not follow": Slip(
        network_nested.coupled_stiffness,
        "- dense(K[held][:, follow]) @ inner",
        "",
        ("stiffness of coupled nodes", "stiffness of a body"),
    ),
    "moment of the turned body": Slip(
        network.NetworkState.body_stiffness,
        "K[3:, 3:] -=",
        "K[3:, 3:] +=",
        ("stiffness of a body",),
    ),
    "reaction of the opposite sign": Slip(
        network._left,
        "return force - unbalanced",
        "return unbalanced - force",
        ("reactions", "equilibrium", "closed forms"),
    ),
    "satisfied with a percent": Slip(
        network_monolithic._converged,
        "bound = now.monolith.balance, tolerance *",
        "bound = now.monolith.balance, 1e-2 *",
        ("40 digits",),
    ),
    "satisfied with a percent, in floats": Slip(
        network_few._balanced,
        "<= tolerance *",
        "<= 1e-2 *",
        ("printed digits",),
    ),
    "stiffness across left out, in floats": Slip(
        network_few.Few.jacobian,
        "T = turn * sign * other",
        "T = 0.0",
        ("floats",),
    ),
    "a line that lies otherwise taken for a smooth one": Slip(
        network_few._law,
        "touching and (clearance > 0 or friction > 0)",
        "touching and clearance > 0",
        ("floats",),
    ),
    "one end numbered wrongly": Slip(
        network_balance.Balance.pattern,
        "self.dof.ravel()[self.coordinates]",
        "self.dof.ravel()[self.coordinates[:, ::-1]]",
        ("tangent",),
    ),
}


def plant(monkeypatch, slip: Slip):
    """Give the function the code of its text with the fragment replaced, wherever it was imported."""
    text = textwrap.dedent(inspect.getsource(slip.function))
    assert text.count(slip.right) == 1, f"{slip.right!r} stands {text.count(slip.right)} times in {slip.function}"
    space: dict = {}
    module = inspect.getmodule(slip.function)
    exec(compile("from __future__ import annotations\n" + text.replace(slip.right, slip.wrong), "planted", "exec"),
         vars(module), space)  # fmt: skip
    monkeypatch.setattr(slip.function, "__code__", space[slip.function.__name__].__code__)


def turns_red(check) -> bool:
    """A check is red when it names a miss, or when the broken solver does not get through it."""
    try:
        return bool(CHECKS[check]())
    except Exception:
        return True


@pytest.fixture(scope="module", autouse=True)
def references():
    """40 digits by the solver's start before anything is planted."""
    for case in (*EXACT, *JOINT):
        exact(case)


@pytest.mark.parametrize("slip", SLIPS.values(), ids=SLIPS)
def test_planted_mistakes_turn_checks_red(slip, monkeypatch):
    plant(monkeypatch, slip)
    assert [check for check in slip.checks if not turns_red(check)] == []


def test_every_check_turns_red_somewhere():
    """Beside the mistakes of the solver: budgets and statuses, which no formula moves."""
    found = {check for slip in SLIPS.values() for check in slip.checks}
    assert set(CHECKS) - found == {"pattern", "invariances", "energy", "iterations", "printed digits, nested"}


def test_an_iteration_without_its_jacobian_is_too_slow(monkeypatch):
    plant(monkeypatch, SLIPS["(4.15) with the sign of the sine"])
    assert turns_red("iterations")


def test_a_direction_that_prefers_an_axis_is_seen(monkeypatch):
    slip = Slip(
        network_balance.Balance.unbalanced,
        "= -H * direction, -V",
        "= -H * direction, -V - 1e-3 * H * direction[0] ** 2",
        (),
    )
    plant(monkeypatch, slip)
    assert turns_red("invariances") and turns_red("equilibrium") and turns_red("40 digits")


def test_a_start_taken_for_the_solution_is_seen(monkeypatch):
    """Success is declared wherever the iteration stands."""
    plant(monkeypatch, Slip(network._state, "if residual <= tolerance", "if residual <= 1e9 * tolerance", ()))
    assert status_misses(monkeypatch)
    lenient = Slip(network_nested.newton, "if worst <= bound(elements)", "if worst <= 1e9 * bound(elements)", ())
    plant(monkeypatch, lenient)
    assert turns_red("printed digits, nested")


def test_an_element_without_an_entry_is_seen(monkeypatch):
    plant(monkeypatch, Slip(network_balance.Balance.pattern, "(rows >= 0) &", "(rows >= 3) &", ()))
    assert turns_red("pattern")


def test_a_node_far_from_equilibrium_gives_work(monkeypatch):
    """Energy is not least where the load is forgotten."""
    case = bridle()
    state = solve_network(network_of(case))
    plant(monkeypatch, SLIPS["buoy and mass exchanged"])
    assert turns_red("energy") and state.success
