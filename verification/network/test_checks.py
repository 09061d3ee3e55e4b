"""Can every check of the networks turn red? Planted mistakes, each with the checks that must turn red on it."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from ..cases.networks import bridle, bridle_system, chain_wire_chain, hanging_mass, spring_net, two_line
from ..tools.planting import Fault, plant_in_place
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
    """A fault, and the ``checks`` that must all turn red on it."""

    fault: Fault
    checks: tuple[str, ...]


SLIPS = {
    "buoy and mass exchanged": Slip(
        Fault(
            "network.equations",
            "NetworkEquations.__init__",
            "environment.rho * node.volume - node.mass",
            "node.mass - environment.rho * node.volume",
        ),
        (
            "closed forms",
            "40 digits",
            "equilibrium",
        ),
    ),
    "friction forgotten at the anchor": Slip(
        Fault(
            "network.equations",
            "NetworkEquations.unbalanced_force",
            "H_anchor * direction",
            "H * direction",
            where="H.size",
        ),
        (
            "reactions",
            "40 digits, grounded joint",
        ),
    ),
    "azimuth does not turn": Slip(
        Fault(
            "network.equations",
            "Elements.tangents",
            "self.H / g.divisor, self.H_anchor / g.divisor",
            "0 * g.divisor, 0 * g.divisor",
        ),
        (
            "tangent",
            "assembled by hand",
        ),
    ),
    "raised end hangs from a fixed height": Slip(
        Fault("network.equations", "_sagging_derivatives", "end_stiffness + a * a * K11", "end_stiffness"),
        (
            "tangent",
            "stiffness of coupled nodes",
        ),
    ),
    "friction left out of the anchor's stiffness (4.11)": Slip(
        Fault(
            "network.equations",
            "exact_derivatives",
            "friction[resting, None] * D[resting, 1]",
            "0 * friction[resting, None] * D[resting, 1]",
        ),
        (
            "tangent",
            "stiffness of coupled nodes",
        ),
    ),
    "(4.15) with the sign of the sine": Slip(
        Fault("catenary.excursion", "suspended", "spread - sine", "spread + sine"),
        (
            "blocks",
            "assembled by hand",
            "assembled against differences",
        ),
    ),
    "(4.16a) as printed": Slip(
        Fault(
            "catenary.excursion",
            "_touching",
            "lost / (w * EA)",
            "friction * np.maximum(grounded, 0.0) / EA",
            where="friction * w * grounded",
        ),
        ("blocks",),
    ),
    "B block of the paper, no friction at the anchor (4.11)": Slip(
        Fault(
            "catenary.excursion",
            "_touching",
            "_block(pulled, pulled * friction, lift_H, zero)",
            "_block(pulled, 0 * pulled, lift_H, zero)",
        ),
        ("blocks",),
    ),
    "part on the seabed left out (2.23a)": Slip(
        Fault("catenary.excursion", "suspended", "H * spread + lying", "H * spread"), ("blocks",)
    ),
    "anchor on the seabed that follows V": Slip(
        Fault(
            "catenary.excursion",
            "_free",
            "anchor[smooth, 1, 1], by_clearance[smooth, 1] = 0.0, -1.0",
            "by_clearance[smooth, 1] = -1.0",
        ),
        ("blocks",),
    ),
    "V of the anchor end upwards": Slip(
        Fault(
            "catenary.excursion",
            "_free",
            "Excursion(l, h, H.copy(), b, _block(C11, C12, C12, C22), anchor, by_clearance)",
            "Excursion(l, h, H.copy(), -b, _block(C11, C12, C12, C22), anchor, by_clearance)",
        ),
        ("40 digits",),
    ),
    "gap of the wrong sign in the Schur complement": Slip(
        Fault("network.monolithic", "Iterate.newton_step", "-other.gap[:, :, None]", "other.gap[:, :, None]"),
        ("Schur step against dense step",),
    ),
    "forces do not follow the gap": Slip(
        Fault("network.monolithic", "Iterate.newton_step", "D[:, :2] @ motion + closing", "D[:, :2] @ motion"),
        ("Schur step against dense step",),
    ),
    "rows of the anchor missing": Slip(
        Fault("network.jacobian", "analytic_jacobian", "x.anchor", "0 * x.anchor"), ("assembled against differences",)
    ),
    "half the differences": Slip(
        Fault("network.jacobian", "difference_jacobian", "difference / step", "difference / (2 * step)"),
        ("assembled against differences",),
    ),
    "free nodes do not follow": Slip(
        Fault(
            "network.nested",
            "coupled_stiffness",
            "to_dense(K[coupled][:, coupled]) - to_dense(K[coupled][:, free]) @ motion",
            "to_dense(K[coupled][:, coupled])",
        ),
        (
            "stiffness of coupled nodes",
            "stiffness of a body",
        ),
    ),
    "moment of the turned body": Slip(
        Fault(
            "network.solve",
            "NetworkState.body_stiffness",
            "K[3:, 3:] -= _cross(force) @ _cross(arm)",
            "K[3:, 3:] += _cross(force) @ _cross(arm)",
        ),
        ("stiffness of a body",),
    ),
    "reaction of the opposite sign": Slip(
        Fault("network.solve", "_reactions_and_residual", "force - unbalanced", "unbalanced - force"),
        (
            "reactions",
            "equilibrium",
            "closed forms",
        ),
    ),
    "satisfied with a percent": Slip(
        Fault(
            "network.monolithic",
            "is_balanced",
            "tolerance * largest_force(now.elements)",
            "1e-2 * largest_force(now.elements)",
        ),
        ("40 digits",),
    ),
    "satisfied with a percent, in floats": Slip(
        Fault("network.scalar", "is_balanced", "tolerance * point.largest", "1e-2 * point.largest"), ("printed digits",)
    ),
    "stiffness across left out, in floats": Slip(
        Fault("network.scalar", "ScalarEquations.jacobian", "T = across * sign * other", "T = 0.0"), ("floats",)
    ),
    "a line that lies otherwise taken for a smooth one": Slip(
        Fault(
            "network.scalar", "_excursion", "touching and (clearance > 0 or friction > 0)", "touching and clearance > 0"
        ),
        ("floats",),
    ),
    "one end numbered wrongly": Slip(
        Fault(
            "network.equations",
            "NetworkEquations.build_sparsity",
            "self.dof.ravel()[self.coordinates]",
            "self.dof.ravel()[self.coordinates[:, ::-1]]",
        ),
        ("tangent",),
    ),
}


def turns_red(check) -> bool:
    """Return whether a check reports an error, or the broken solver raises one."""
    try:
        return bool(CHECKS[check]())
    except Exception:
        return True


@pytest.fixture(scope="module", autouse=True)
def references():
    """Solve the references to 40 digits, from the solver's result before anything is planted."""
    for case in (*EXACT, *JOINT):
        exact(case)


@pytest.mark.parametrize("slip", SLIPS.values(), ids=SLIPS)
def test_planted_mistakes_turn_checks_red(slip, monkeypatch):
    plant_in_place(slip.fault, monkeypatch)
    assert [check for check in slip.checks if not turns_red(check)] == []


def test_every_check_turns_red_somewhere():
    """All but those that no fault of a formula turns red: each of these has a test of its own below."""
    shown = {check for slip in SLIPS.values() for check in slip.checks}
    assert set(CHECKS) - shown == {"pattern", "invariances", "energy", "iterations", "printed digits, nested"}


def test_an_iteration_without_its_jacobian_is_too_slow(monkeypatch):
    plant_in_place(SLIPS["(4.15) with the sign of the sine"].fault, monkeypatch)
    assert turns_red("iterations")


def test_a_direction_that_prefers_an_axis_is_seen(monkeypatch):
    plant_in_place(
        Fault(
            "network.equations",
            "NetworkEquations.unbalanced_force",
            "-H * direction, -V",
            "-H * direction, -V - 1e-3 * H * direction[0] ** 2",
        ),
        monkeypatch,
    )
    assert turns_red("invariances") and turns_red("equilibrium") and turns_red("40 digits")


def test_a_start_taken_for_the_solution_is_seen(monkeypatch):
    """Success is declared wherever the iteration stands."""
    plant_in_place(
        Fault(
            "network.solve",
            "_state",
            "Status.SUCCESS if residual <= tolerance else Status.NOT_CONVERGED",
            "Status.SUCCESS if residual <= 1e9 * tolerance else Status.NOT_CONVERGED",
        ),
        monkeypatch,
    )
    assert status_misses(monkeypatch)
    plant_in_place(
        Fault(
            "network.nested",
            "_RegularisedNewton.is_solved",
            "self.bound(now.elements)",
            "1e9 * self.bound(now.elements)",
        ),
        monkeypatch,
    )
    assert turns_red("printed digits, nested")


def test_an_element_without_an_entry_is_seen(monkeypatch):
    plant_in_place(
        Fault(
            "network.equations",
            "NetworkEquations.build_sparsity",
            "(rows >= 0) & (columns >= 0)",
            "(rows >= 3) & (columns >= 0)",
        ),
        monkeypatch,
    )
    assert turns_red("pattern")


def test_a_node_far_from_equilibrium_gives_work(monkeypatch):
    """Energy is not least where the load is forgotten."""
    case = bridle()
    state = solve_network(network_of(case))
    plant_in_place(SLIPS["buoy and mass exchanged"].fault, monkeypatch)
    assert turns_red("energy") and state.success
