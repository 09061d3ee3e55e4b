"""Defects of motion in time and of periodic motion: generalized_alpha, time_domain, response, fourier, harmonic_*."""

from __future__ import annotations

from ...tools.planting import Fault
from ..defect import Defect
from .cables import reused

_SCHEME = "time_domain/test_solve.py::test_the_scheme_has_its_spectral_radius"
_IN_DT = "cable/test_order.py::test_order_in_dt -k 'bare and planar'"
_EXACT = "cable/test_order.py::test_fields_linear_in_s_and_t_are_reproduced -k 'bare and planar'"
_OUTPUTS = "time_domain/test_solve.py::test_outputs_belong_together"
_DRIFT = "time_domain/test_solve.py::test_the_fairlead_stays_where_it_is_prescribed -k 5"
_BASIS = "harmonic_balance/test_jacobian.py::test_fourier_basis"
_BLOCKS = "harmonic_balance/test_jacobian.py::test_jacobian_blocks_agree_with_complex_step -k 'mass or towed'"
_PREDICTED = "cable/test_predictor.py::test_the_predicted_velocities_grow_linearly_from_the_anchor"
_SUMS = "harmonic_balance/test_jacobian.py::test_blocks_are_the_sums_over_the_samples"
_TRIGONOMETRIC = "harmonic_balance/test_oscillators.py::test_trigonometric_solutions_come_out_exactly"
_MEAN = "harmonic_balance/test_oscillators.py::test_the_mean_is_closed_by_the_place"
_CHAIN = "numerics/test_bordered.py::test_the_solution_meets_every_row"
_BETWEEN_SAMPLES = "harmonic_balance/test_oscillators.py::test_a_state_that_is_invalid_between_the_samples_is_found"
_FORCES = "harmonic_balance/test_solve.py::test_forces_are_those_of_the_tension"


def _check(module: str, what: str) -> str:
    """The check for a fault of the time integration."""
    by_word = {"alpha_m": _SCHEME, "gamma": _SCHEME, "hold": _DRIFT, "Hermite": _OUTPUTS, "clock": _OUTPUTS,
               "carried": _EXACT}  # fmt: skip
    return next((check for word, check in by_word.items() if word in what), _IN_DT)


TIME_FAULTS = [
    (Fault("time_domain.generalized_alpha", "Scheme.from_spectral_radius", "3 - rho", "3 + rho"), "alpha_m"),
    (
        Fault(
            "time_domain.generalized_alpha",
            "Scheme.from_spectral_radius",
            "0.5 + alpha_m - alpha_f",
            "0.5 - alpha_m + alpha_f",
        ),
        "gamma",
    ),
    (
        Fault(
            "time_domain.generalized_alpha",
            "Stepper.step",
            "(y + f * (new - y), ydot + m * (new_dot - ydot), t + f * h)",
            "(y + m * (new - y), ydot + m * (new_dot - ydot), t + f * h)",
        ),
        "y at the level of ydot",
    ),
    (
        Fault(
            "time_domain.generalized_alpha",
            "Stepper.step",
            "(y + f * (new - y), ydot + m * (new_dot - ydot), t + f * h)",
            "(y + f * (new - y), ydot + f * (new_dot - ydot), t + f * h)",
        ),
        "ydot at the level of y",
    ),
    (Fault("time_domain.generalized_alpha", "Stepper.step", "t + f * h", "t + h"), "loads at the end of the step"),
    (Fault("time_domain.generalized_alpha", "Stepper.step", "t + h", "t"), "the end a step late"),
    (Fault("time_domain.generalized_alpha", "Stepper.step", "(1 - g) / g", "(1 + g) / g"), "the carried rate"),
    (
        Fault(
            "time_domain.drift_control",
            "PositionDriftControl.update",
            "-self.rate - self.gain * (offset / (_STEPS_TO_RETURN * self.interval))",
            "-self.rate + self.gain * (offset / (_STEPS_TO_RETURN * self.interval))",
        ),
        "the hold pushes away",
    ),
    (
        Fault("time_domain.history", "TimeHistory._cubic", "h * x * (1 - x) ** 2", "-h * x * (1 - x) ** 2"),
        "Hermite's cubic",
    ),
    (
        Fault(
            "time_domain.solve",
            "_Run.step",
            "self.end * self.steps / self.count",
            "self.end * self.steps / (self.count + 1)",
        ),
        "the clock",
    ),
]
"""The time integration: weights, levels of time, the hold, the interpolation."""


DEFECTS = (
    *reused(TIME_FAULTS, "term", _check),
    # ------------------------------------------------------------ newton (systems)
    Defect(
        "old correction again",
        Fault("numerics.newton", "_ErrorOriented._broyden_step", "x + self.taken[-1]", "x + self.taken[0]"),
        "stale",
        "a step with a kept Jacobian repeats the last correction",
        _TRIGONOMETRIC,
    ),
    Defect(
        "the Jacobian at the start kept in any case",
        Fault("numerics.newton", "full_newton", "newton[2] <= _KEEP_FIRST * steps[0].error", "True"),
        "regime",
        "the second of some full steps is taken with the Jacobian of the first, however long it is",
        "numerics/test_newton.py::test_full_steps_keep_a_jacobian_that_serves",
    ),
    Defect(
        "relaxation grows where it should shrink",
        Fault("numerics.newton", "adapted_relaxation", "error < last", "error > last"),
        "sign",
        "the relaxation factor of HB (75) falls while the error falls",
        "harmonic_balance/test_solve.py::test_the_papers_relaxation_converges_as_fast -k 1",
    ),
    Defect(
        "damping that accepts everything",
        Fault("numerics.newton", "is_contraction", "(1 - length / 4) * full", "np.inf"),
        "tolerance",
        "every step of the damped Newton method is taken in full",
        "numerics/test_newton.py::test_damping_converges_where_full_steps_diverge",
    ),
    Defect(
        "update with the wrong sign",
        Fault("numerics.newton", "_updated", "1 - share(taken[-1])", "1 + share(taken[-1])"),
        "sign",
        "Broyden's update of an old Jacobian goes the other way",
        "harmonic_balance/test_start.py::test_updates_of_an_old_jacobian_save_steps",
    ),
    # ------------------------------------------------------------ generalized_alpha
    Defect(
        "first order by gamma",
        Fault("time_domain.generalized_alpha", "Scheme.from_spectral_radius", "0.5 + alpha_m - alpha_f", "0.5"),
        "order",
        "gamma = 1/2 whatever the spectral radius: order one",
        _SCHEME,
    ),
    Defect(
        "weights of another scheme",
        Fault("time_domain.generalized_alpha", "Scheme.from_spectral_radius", "1 / (1 + rho)", "rho / (1 + rho)"),
        "symbol",
        "alpha_f of the scheme for structures (of Chung and Hulbert) in the one for first-order systems",
        _SCHEME,
    ),
    Defect(
        "tolerance of a step in per cent",
        Fault("time_domain.generalized_alpha", "Stepper.step", "self.tolerance", "1e-2"),
        "tolerance",
        "a step is done when its last correction is one per cent",
        _OUTPUTS,
    ),
    Defect(
        "Jacobian of the whole interval",
        Fault(
            "time_domain.generalized_alpha",
            "Stepper._factorise",
            "(f, m * rate)",
            "(1.0, rate)",
        ),
        "derivative",
        "the weights of the step are left out of its Jacobian: it converges, slowly",
        "time_domain/test_steps.py::test_a_new_jacobian_converges_quadratically",
    ),
    Defect(
        "Jacobian of the last step length",
        Fault(
            "time_domain.generalized_alpha", "Stepper.step", "self._factorised_for != h", "self._factorised_for is None"
        ),
        "stale",
        "after a change of the step the old factors are kept until they hardly converge",
        "time_domain/test_steps.py::test_a_new_step_length_takes_a_new_jacobian",
    ),
    Defect(
        "offset taken back at once",
        Fault(
            "time_domain.drift_control",
            "PositionDriftControl.update",
            "offset / (_STEPS_TO_RETURN * self.interval)",
            "_STEPS_TO_RETURN * offset / self.interval",
        ),
        "factor",
        "the hold divides by what it should multiply with: four times too strong",
        "time_domain/test_steps.py::test_drift_control_takes_an_offset_back",
    ),
    Defect(
        "mean over two periods",
        Fault("time_domain.drift_control", "MeanDriftControl.__call__", "self.sum / self.interval", "self.sum"),
        "unit",
        "the mean hold takes the integral of the drift for its mean",
        "harmonic_balance/test_oscillators.py "
        "time_domain/test_solve.py::test_the_fairlead_stays_where_it_is_prescribed -k 'stays and 5'",
    ),
    # ------------------------------------------------------------ time_domain
    Defect(
        "error of a step forgets the other method's",
        Fault(
            "time_domain.step_control",
            "StepControl.accept",
            "(2 + 3 * previous[0] / h) / 12 + self.constant",
            "(2 + 3 * previous[0] / h) / 12 - self.constant",
        ),
        "sign",
        "Milne's device subtracts the error constants that it should add",
        "time_domain/test_steps.py::test_the_next_step_size_follows_from_the_error",
    ),
    Defect(
        "step control of another order",
        Fault("time_domain.step_control", "StepControl.accept", "-1 / 3", "-1 / 2"),
        "order",
        "steps are changed as if the local error fell with the square of the step",
        "time_domain/test_steps.py::test_the_next_step_size_follows_from_the_error",
    ),
    Defect(
        "ramp over a whole period",
        Fault("time_domain.solve", "_first_ramp", "system.period / 2", "system.period"),
        "factor",
        "the default ramp of HB 4.3 is twice too long",
        "time_domain/test_solve.py::test_the_ramp_takes_half_a_period",
    ),
    Defect(
        "every n-th step, one late",
        Fault("time_domain.solve", "_Run.step", "self.steps % self.every == 0", "self.steps % self.every == 1"),
        "index",
        "a thinned history keeps the steps after those that it should",
        _OUTPUTS,
    ),
    Defect(
        "slope of Hermite's cubic",
        Fault("time_domain.history", "TimeHistory._cubic", "3 * x - 2", "2 - 3 * x"),
        "sign",
        "the rate between two stored times",
        _OUTPUTS,
    ),
    Defect(
        "invalid states pass",
        Fault(
            "time_domain.solve",
            "_Run.continues",
            "self.status is Status.STEP_FAILED or (self.event is not None and not allow_invalid)",
            "self.status is Status.STEP_FAILED",
        ),
        "regime",
        "a history goes on through a compression that was not allowed",
        "time_domain/test_solve.py::test_compression_is_reported_with_its_time_and_node",
    ),
    # ------------------------------------------------------------ response
    Defect(
        "vessel pushed",
        Fault("common.response", "Response.fairlead_force", "-self.tension[-1]", "self.tension[-1]"),
        "sign",
        "the force on the vessel points away from the line",
        _OUTPUTS,
    ),
    Defect(
        "amplitudes halved",
        Fault(
            "common.response", "Response.tension_harmonics", "2 * abs(spectrum[1 : k + 1])", "abs(spectrum[1 : k + 1])"
        ),
        "factor",
        "harmonics of the tension are those of a two-sided spectrum",
        "common/test_response.py::test_harmonics_of_the_tension_are_those_of_a_known_sum",
    ),
    Defect(
        "harmonics from the mean on",
        Fault("common.response", "Response.tension_harmonics", "spectrum[1 : k + 1]", "spectrum[0:k]"),
        "index",
        "the amplitude of the first harmonic is that of the mean",
        "common/test_response.py::test_harmonics_of_the_tension_are_those_of_a_known_sum",
    ),
    Defect(
        "mean force counted in",
        Fault("common.response", "Response.tension_harmonics", "spectrum[0].real", "2 * spectrum[0].real"),
        "factor",
        "the mean tension is twice itself",
        "common/test_response.py::test_harmonics_of_the_tension_are_those_of_a_known_sum",
    ),
    Defect(
        "tension without its rate",
        Fault(
            "common.response",
            "Response._tension_at",
            "self.system.tension(self.at(t), self.rate_at(t))",
            "self.system.tension(self.at(t))",
        ),
        "term",
        "the tension at any time leaves the material's damping out",
        "common/test_response.py::test_tension_includes_the_material_damping",
    ),
    # ------------------------------------------------------------ fourier
    Defect(
        "no block for the constant",
        Fault(
            "numerics.fourier",
            "Basis.functions",
            "q_t[:, first::2], q_t[:, first + 1 :: 2] = k * cos, -k * sin",
            "q_t[:, 0 : 2 * len(k) : 2], q_t[:, 1 : 2 * len(k) : 2] = k * cos, -k * sin",
        ),
        "misprint",
        "(57) as printed: the rates start in the column of the constant",
        _BASIS,
        misprint="HB (57)",
    ),
    Defect(
        "Gram matrix as printed",
        Fault(
            "numerics.fourier",
            "Basis.__init__",
            "2 / samples * self.Q",
            "np.linalg.lstsq(self.Q @ self.Q.T + 1e-9 * np.eye(samples), self.Q, rcond=None)[0] * 0.5",
        ),
        "misprint",
        "(71): (F- F-^T)^-1 of a singular matrix, here with what makes it invertible",
        _BASIS,
        misprint="HB (71)",
    ),
    Defect(
        "mean of the samples for the coefficient",
        Fault("numerics.fourier", "Basis.__init__", "2 / samples", "1 / samples"),
        "factor",
        "(61) without its 2",
        _BASIS,
    ),
    Defect(
        "constant not divided by the root of two",
        Fault("numerics.fourier", "Basis.functions", "math.sqrt(0.5)", "1.0"),
        "factor",
        "c_0 for c_0/sqrt(2) in (49)",
        _BASIS,
    ),
    Defect(
        "last sample twice",
        Fault(
            "numerics.fourier",
            "Basis.__init__",
            "2 * math.pi / omega * np.arange(samples) / samples",
            "2 * math.pi / omega * np.arange(samples) / (samples - 1)",
        ),
        "index",
        "the samples include both ends of the period",
        _BASIS,
    ),
    Defect(
        "sines and cosines exchanged",
        Fault(
            "numerics.fourier",
            "Basis.functions",
            "q[:, first::2], q[:, first + 1 :: 2] = sin, cos",
            "q[:, first::2], q[:, first + 1 :: 2] = cos, sin",
        ),
        "symbol",
        "values in one order of coefficients, rates in the other",
        _BASIS,
    ),
    # ------------------------------------------------------------ harmonic_balance
    Defect(
        "one period of a subharmonic response",
        Fault(
            "harmonic_balance.solve",
            "_basis",
            "2 * math.pi / (nu * system.period)",
            "2 * math.pi / system.period",
        ),
        "misprint",
        "(61): the integral over T_f and not over nu T_f",
        "harmonic_balance/test_oscillators.py::test_exact_subharmonics",
        misprint="HB (61)",
    ),
    Defect(
        "constant terms omitted",
        Fault("harmonic_balance.solve", "_basis", "bool(mean)", "False"),
        "misprint",
        "4.1: in still water the constant terms are left out",
        _TRIGONOMETRIC,
        misprint="HB section 4.1",
    ),
    Defect(
        "coefficients moved by one",
        Fault(
            "harmonic_balance.start",
            "truncate_or_pad",
            "padded[..., new.mean : new.mean + count] = z[..., old.mean : old.mean + count]",
            "padded[..., 1 : 1 + count] = z[..., 1 : 1 + count]",
        ),
        "index",
        "without a constant term a response in another basis starts with its second coefficient",
        "harmonic_balance/test_oscillators.py::test_a_response_without_the_constant_is_confirmed_by_one_step",
    ),
    Defect(
        "symmetry taken on trust",
        Fault(
            "harmonic_balance.solve",
            "solve_periodic",
            "not solution.residual.satisfies_omitted_rows(solution.z)",
            "False",
        ),
        "regime",
        "a mirror that passed by mistake is not looked at again",
        "harmonic_balance/test_oscillators.py::test_symmetry_is_looked_at_again_in_the_solution",
    ),
    Defect(
        "half the motion is the motion",
        Fault("harmonic_balance.solve", "_response", "reached < 1.0", "reached < 0.1"),
        "regime",
        "the response to a part of the motion is a success",
        "harmonic_balance/test_solve.py::test_a_motion_too_large_is_named",
    ),
    Defect(
        "error by the largest change",
        Fault("harmonic_balance.start", "mean_change", "abs(step).mean", "abs(step).min"),
        "tolerance",
        "(76) by the smallest change of a coefficient: done after one step",
        _TRIGONOMETRIC,
    ),
    Defect(
        "carried start turned the wrong way",
        Fault(
            "cable.system",
            "CableSystem.predict_motion",
            'np.einsum("dcn,n,dt->cnt", rotation, self.s / self.s[-1], rate)',
            'np.einsum("cdn,n,dt->cnt", rotation, self.s / self.s[-1], rate)',
        ),
        "symbol",
        "the rotation into the frame of the line is transposed: the start moves elsewhere than its fairlead",
        _PREDICTED,
    ),
    Defect(
        "the anchor moves",
        Fault("cable.system", "CableSystem.predict_motion", "self.s / self.s[-1]", "1 - self.s / self.s[-1]"),
        "boundary",
        "the predicted velocities are those of a line whose anchor is moved in place of the fairlead",
        _PREDICTED,
    ),
    Defect(
        "valid at the samples is valid",
        Fault("harmonic_balance.solve", "", "INSTANTS_PER_SAMPLE = 4", "INSTANTS_PER_SAMPLE = 1"),
        "regime",
        "states that leave what the equations hold for between two samples are accepted",
        _BETWEEN_SAMPLES,
    ),
    Defect(
        "event in the period of the driving",
        Fault(
            "harmonic_balance.solve",
            "_first_invalid",
            "2 * math.pi / basis.omega / count",
            "2 * math.pi / 2 / basis.omega / count",
        ),
        "factor",
        "a subharmonic response is looked at in one period of its driving alone",
        _BETWEEN_SAMPLES,
    ),
    # ------------------------------------------------------------ harmonic_rows
    Defect(
        "mean of the velocity kept",
        Fault(
            "harmonic_balance.residual",
            "HarmonicResidual.__init__",
            "self.end_rows[offset + d][1:]",
            "self.end_rows[offset + d][:-1]",
        ),
        "boundary",
        "in place of the mean of an end row its last coefficient is given up",
        _MEAN,
    ),
    Defect(
        "a mirror seen at three instants",
        Fault("harmonic_balance.residual", "find_mirror", "basis.times[: basis.samples // 2]", "basis.times[:3]"),
        "regime",
        "a push between the instants at which the mirror is tried is missed",
        "harmonic_balance/test_oscillators.py::test_a_short_push_is_no_symmetry",
    ),
    Defect(
        "odd where even",
        Fault("harmonic_balance.residual", "HarmonicResidual._active", "0 if sign > 0 else 1", "1 if sign > 0 else 0"),
        "sign",
        "under a mirror fields that it keeps have odd harmonics",
        "harmonic_balance/test_oscillators.py::test_symmetry_changes_nothing_but_the_work",
    ),
    Defect(
        "blocks of one cell missing",
        Fault("harmonic_balance.residual", "HarmonicResidual.jacobian", "nodes - 1", "nodes - 2"),
        "index",
        "made in parts, the blocks of a chain of 66 nodes lack the last cell",
        "harmonic_balance/test_jacobian.py::test_blocks_made_in_parts_are_those_made_at_once",
    ),
    Defect(
        "single precision taken on trust",
        Fault(
            "harmonic_balance.residual",
            "HarmonicResidual.linearise",
            "not factors.singular and abs(more).mean() <= MAX_REFINEMENT * abs(step).mean()",
            "not factors.singular",
        ),
        "tolerance",
        "factors in single precision serve where the matrix is nearly singular, too",
        "harmonic_balance/test_start.py::test_double_precision_where_single_does_not_do",
    ),
    Defect(
        "first solution taken away twice",
        Fault("harmonic_balance.residual", "HarmonicResidual.linearise", "step + more", "step - more"),
        "sign",
        "the refinement of a Newton step has the wrong sign",
        "harmonic_balance/test_jacobian.py::test_newton_steps_solve_the_complex_step_jacobian",
    ),
    # ------------------------------------------------------------ harmonic_blocks, compiled, heap
    Defect(
        "sum and difference of harmonics exchanged",
        Fault("harmonic_balance.blocks", "_add", "cos[less] - cos[more]", "cos[more] - cos[less]"),
        "sign",
        "products of two sines have the wrong sign",
        _BLOCKS,
    ),
    Defect(
        "second derivatives as first ones",
        Fault("harmonic_balance.blocks", "_add", "w * ss, w * sc, w * cs, w * cc", "w * sc, w * ss, w * cc, w * cs"),
        "index",
        "sine and cosine change places in the second derivative, too",
        "harmonic_balance/test_jacobian.py::test_blocks_are_the_sums_over_the_samples",
    ),
    Defect(
        "rates of the basis for its values",
        Fault("harmonic_balance.blocks", "_add", "w * sc, -w * ss, w * cc, -w * cs", "w * ss, w * sc, w * cs, w * cc"),
        "symbol",
        "Q for its rate in (72)-(74), where tangents change in time",
        _SUMS,
    ),
    Defect(
        "a still rate with the wrong sign",
        Fault(
            "harmonic_balance.blocks",
            "_add_still",
            "block[i, j + 1] -= np.float32(rows[i]) * rate * value",
            "block[i, j + 1] += np.float32(rows[i]) * rate * value",
        ),
        "sign",
        "of a constant tangent by the rates, -omega sin is taken as its opposite",
        _SUMS,
    ),
    Defect(
        "the constant as cosine of nothing",
        Fault("harmonic_balance.blocks", "_add", "np.sqrt(block.dtype.type(2.0))", "block.dtype.type(2.0)"),
        "factor",
        "the constant function is not divided by the root of two",
        _SUMS,
    ),
    Defect(
        "still at the first node",
        Fault(
            "harmonic_balance.blocks",
            "_still",
            (
                "for samples in tangent:\n"
                "    for value in samples:\n"
                "        if value != samples[0]:\n"
                "            return False"
            ),
            (
                "for samples in tangent[:1]:\n"
                "    for value in samples:\n"
                "        if value != samples[0]:\n"
                "            return False"
            ),
        ),
        "regime",
        "a tangent that changes in time at later nodes only is taken as constant",
        _SUMS,
    ),
    Defect(
        "tangents of any shape",
        Fault(
            "harmonic_balance.blocks",
            "Blocks.__call__",
            "any(other.shape != by_y.shape for other in (by_ydot, *by_yddot)) or shape != fits",
            "False and shape != fits",
        ),
        "regime",
        "compiled loops read beside tangents that do not fit",
        "harmonic_balance/test_jacobian.py::test_tangents_that_do_not_fit_are_refused",
    ),
    Defect(
        "no folder, no solver",
        Fault(
            "numerics.compiled",
            "compiled",
            "RuntimeError",
            "ZeroDivisionError",
        ),
        "regime",
        "where numba finds no folder to keep its code in, solvers cannot be imported",
        "numerics/test_compiled.py::test_compiled_loops_need_no_folder",
    ),
    Defect(
        "nothing learned",
        Fault("numerics.memory", "", "31 * 2**20", "2**10"),
        "factor",
        "the block that tells the C library to keep memory is a small one",
        "harmonic_balance/test_start.py::test_a_second_solve_touches_no_new_memory",
    ),
    Defect(
        "product without the drift",
        Fault(
            "harmonic_balance.residual",
            "HarmonicResidual.product",
            'np.einsum("djnt,jnt->dt", slope, moved[0][0])',
            '0 * np.einsum("djnt,jnt->dt", slope, moved[0][0])',
        ),
        "term",
        "J x, which refines a step, leaves the closing of the mean out",
        "harmonic_balance/test_jacobian.py::test_products_agree_with_complex_step -k 'mass or towed'",
    ),
    Defect(
        "loops of another text",
        Fault("numerics.compiled", "compiled", "text.encode()", "b''"),
        "stale",
        "loops on disk stay as they are where a function that they call from another file is changed",
        "numerics/test_compiled.py::test_a_changed_function_of_another_file_compiles_the_loop_anew",
    ),
    # ------------------------------------------------------------ numerics.lu
    Defect(
        "integers of any length",
        Fault("numerics.lu.blas_by_address", "external", '"int64"', '"int128"'),
        "regime",
        "BLAS with integers of 64 bits reads past those of 32 bits",
        "numerics/test_bordered.py::test_a_build_with_longer_integers_is_refused",
    ),
    Defect(
        "rows of a block as if it were whole",
        Fault("numerics.lu.blas_by_address", "_lda", "A.strides[0]", "A.shape[1] * A.itemsize"),
        "index",
        "a block of a larger array is read as if its rows followed each other",
        _CHAIN,
    ),
    Defect(
        "transposed elimination",
        Fault("numerics.lu.blas_by_address", "gemm", "_address(_MINUS64)", "_address(_ONE64)"),
        "sign",
        "the Schur complement is added",
        _CHAIN,
    ),
    Defect(
        "full rows not carried on",
        Fault(
            "numerics.lu.bordered",
            "_eliminate",
            "blas.trsm(UPPER, PLAIN, NON_UNIT, c[p:], c[p:, n:])",
            "pass",
        ),
        "term",
        "full rows are not updated by the elimination",
        _CHAIN,
    ),
    Defect(
        "rows not exchanged on the right",
        Fault("numerics.lu.bordered", "_solve", "cells[i, rows[i, r]]", "cells[i, r]"),
        "term",
        "row exchanges are forgotten for the right-hand side",
        _CHAIN,
    ),
    Defect(
        "blocks of any shape",
        Fault("numerics.lu.bordered", "_block", "part.shape != shape", "False"),
        "regime",
        "compiled loops read beside blocks that do not fit",
        "numerics/test_bordered.py::test_blocks_that_do_not_fit_are_refused",
    ),
    Defect(
        "first node not solved",
        Fault("numerics.lu.bordered", "_solve", "range(m - 1, -1, -1)", "range(m - 1, 0, -1)"),
        "index",
        "the way back ends one node early",
        _CHAIN,
    ),
    Defect(
        "singular is regular",
        Fault(
            "numerics.lu.bordered",
            "_eliminate",
            "singular += blas.getrf(c[p:, :n], second)",
            "blas.getrf(c[p:, :n], second)",
        ),
        "regime",
        "a zero pivot on the way is not told",
        "numerics/test_bordered.py::test_an_empty_column_is_singular_without_full_rows",
    ),
    # ------------------------------------------------------------ modes
    Defect(
        "shift with the wrong sign",
        Fault("numerics.modes", "_oscillations_near", "sigma - 1 / mu", "sigma + 1 / mu"),
        "sign",
        "eigenvalues mirrored at the shift",
        "time_domain/test_solve.py::test_frequencies_of_a_taut_string -k planar",
    ),
    Defect(
        "radians per second for hertz",
        Fault("numerics.modes", "natural_modes", "omega / (2 * math.pi)", "omega"),
        "unit",
        "natural frequencies are angular",
        "time_domain/test_solve.py::test_frequencies_of_an_axial_bar",
    ),
    Defect(
        "damping that excites",
        Fault("numerics.modes", "natural_modes", "-eigenvalues.real", "eigenvalues.real"),
        "sign",
        "damped modes have negative damping",
        "time_domain/test_solve.py::test_damping_of_modes_is_that_of_a_kelvin_voigt_bar",
    ),
    # ------------------------------------------------------------ invariants
    Defect(
        "the slope instead of its change",
        Fault("common.diagnostics", "largest_slope_change", "abs(np.diff(slope))", "abs(np.diff(slope, 2))"),
        "index",
        "a warning of long steps from the third difference: of two steps nothing is left",
        "suite/test_stability.py::test_steps_too_long_for_the_motion_are_warned_of",
    ),
    Defect(
        "drift over the diameter of the motion",
        Fault(
            "common.diagnostics",
            "_check_position",
            "np.linalg.norm(np.ptp(system.motion.displacement(t), axis=-1)) / 2",
            "np.linalg.norm(np.ptp(system.motion.displacement(t), axis=-1)) * 2",
        ),
        "factor",
        "the excursion four times too large: a drift of a tenth passes",
        "suite/test_stability.py::test_drift_is_warned_of",
    ),
    Defect(
        "a cure that is there",
        Fault("common.diagnostics", "check_history", 'history.hold == "position"', 'history.hold == "mean"'),
        "regime",
        "the end that is held is told to be held",
        "suite/test_stability.py::test_the_warning_of_a_drift_names_a_remedy_that_is_left",
    ),
    # ------------------------------------------------------------ deferred correction
    Defect(
        "stencils to one side",
        Fault("cable.midpoint_stencils", "midpoint_stencils", "cell - width // 2 + 1", "cell - width // 2 + 3"),
        "index",
        "the nodes of a cell lie to its right: cubics are exact still, a response of growing steps is not",
        "harmonic_balance/test_deferred_correction.py::test_cases_of_the_paper_gain",
    ),
    Defect(
        "moments of a whole cell",
        Fault("cable.midpoint_stencils", "midpoint_stencils", "power + 1", "power + 2"),
        "factor",
        "the integral of a cell with wrong moments",
        "harmonic_balance/test_deferred_correction.py::test_stencils_are_exact_for_cubics",
    ),
    Defect(
        "slope of a unit cell",
        Fault("cable.midpoint_stencils", "midpoint_stencils", "slope / h[:, None]", "slope"),
        "unit",
        "the slope of the middle per cell, not per metre",
        "harmonic_balance/test_deferred_correction.py::test_stencils_are_exact_for_cubics",
    ),
    Defect(
        "three nodes",
        Fault("cable.midpoint_stencils", "", "_WIDTH = 4", "_WIDTH = 3"),
        "order",
        "stencils of three nodes: exact for quadratic polynomials only",
        "harmonic_balance/test_deferred_correction.py::test_stencils_are_exact_for_cubics",
    ),
    Defect(
        "correction backwards",
        Fault("harmonic_balance.solve", "_corrected", "x - step", "x + step"),
        "sign",
        "the deferred correction doubles the error",
        "harmonic_balance/test_deferred_correction.py::test_repeated_corrections_make_up_for_an_old_jacobian",
    ),
    Defect(
        "one correction",
        Fault("harmonic_balance.solve", "", "MAX_CORRECTIONS = 3", "MAX_CORRECTIONS = 1"),
        "stale",
        "one step with a Jacobian that is old: a share of the second order stays",
        "harmonic_balance/test_deferred_correction.py::test_repeated_corrections_make_up_for_an_old_jacobian",
    ),
    Defect(
        "states given as rates",
        Fault(
            "harmonic_balance.response",
            "PeriodicResponse.rate_at",
            "self.basis.functions(np.asarray(t, dtype=float))[1]",
            "self.basis.functions(np.asarray(t, dtype=float))[0]",
        ),
        "symbol",
        "rates of a response by the Fourier functions of its states",
        "harmonic_balance/test_oscillators.py::test_trigonometric_solutions_come_out_exactly",
    ),
    Defect(
        "corrections that grow",
        Fault("harmonic_balance.solve", "_corrected", "k < 2", "k < 0"),
        "input",
        "a correction that leads away is taken for one",
        "harmonic_balance/test_deferred_correction.py::test_where_the_steps_grow_it_is_refused",
    ),
    Defect(
        "trapezoids beside cells of fourth order",
        Fault(
            "cable.equations",
            "CableEquations.__init__",
            "self.stencils.quadrature() if self.stencils else trapezoidal_weights(self.ds)",
            "trapezoidal_weights(self.ds)",
        ),
        "order",
        "the mean place of the fairlead by a rule of second order",
        "harmonic_balance/test_deferred_correction.py::test_corrected_responses_are_of_fourth_order",
    ),
    # ------------------------------------------------------------ declared blind spots
    # ------------------------------------------------------------ mends that real lines over a seabed asked for
    Defect(
        "a converged step is refused after a relaxed one",
        Fault(
            "time_domain.generalized_alpha",
            "Stepper.step",
            "error <= self.tolerance",
            "error <= self.tolerance and relaxation == 1.0",
            where="last_error, relaxation = math.inf, 1.0",
        ),
        "regime",
        "steps sit at rounding until the limit, for the relaxation factor never comes back to one",
        "time_domain/test_solve.py::test_a_converged_step_is_accepted_after_relaxed_ones",
    ),
    Defect(
        "residual of the step before a singular Jacobian",
        Fault("time_domain.generalized_alpha", "Stepper.step", "self.error = math.inf", "pass"),
        "stale",
        "a history that fails for a singular Jacobian reports the small residual of its last good step",
        "time_domain/test_solve.py::test_a_failed_step_has_an_infinite_error",
    ),
    Defect(
        "residual of a start that fails",
        Fault(
            "time_domain.generalized_alpha",
            "Stepper.initial_rate",
            "self.error, self.worst = euler.error, euler.worst",
            "pass",
        ),
        "stale",
        "a history without a first rate reports the residual 0",
        "time_domain/test_solve.py::test_a_history_whose_first_step_fails_has_an_infinite_residual",
    ),
    Defect(
        "no second ramp",
        Fault("time_domain.solve", "solve_time_domain", "longer.success", "False"),
        "regime",
        "a motion that the default ramp shakes into compression is called impossible",
        "time_domain/test_solve.py::test_a_failure_in_the_first_ramp_takes_a_longer_one",
    ),
    Defect(
        "a pretension that nobody compares",
        Fault("cable.statics", "StaticState.pretension_error", "abs(float(self.tension[-1]) / exact - 1)", "0.0"),
        "input",
        "the mesh spoils the pretension without a word",
        "cable/test_statics.py::test_a_pretension_that_the_mesh_spoils_is_warned_of",
    ),
    Defect(
        "pretension over the lower seabed alone",
        Fault("catenary.pretension", "mean_pretension", "sum(tensions) / len(tensions)", "tensions[-1]"),
        "regime",
        "a rigid seabed w/k lower for the mean of two, up to 1 % too much tension",
        "cable/test_statics.py::test_the_exact_pretension_over_a_yielding_seabed_is_that_of_shooting",
    ),
    Defect(
        "pretension over a rigid seabed",
        Fault("cable.statics", "exact_pretension", "system.w0 / system.seabed_stiffness", "0.0"),
        "term",
        "a seabed that yields is taken for one that does not",
        "cable/test_statics.py::test_the_exact_pretension_over_a_yielding_seabed_is_that_of_shooting",
    ),
    Defect(
        "exact pretension over a seabed of mud",
        Fault("catenary.pretension", "", "_MAX_SEABED_EFFECT = 0.02", "_MAX_SEABED_EFFECT = 0.2"),
        "tolerance",
        "a warning of the mesh where no catenary gives the tension",
        "cable/test_statics.py::test_a_seabed_too_soft_for_a_catenary_gives_no_pretension_error",
    ),
    Defect(
        "exact pretension in a current",
        Fault("cable.statics", "exact_pretension", "system.current is not None or system.w0 <= 0", "system.w0 <= 0"),
        "regime",
        "a line in a current is compared with one in still water",
        "cable/test_statics.py::test_the_pretension_error_is_that_of_the_catenary",
    ),
    # ------------------------------------------------------------ continuation
    Defect(
        "secant beyond the next load",
        Fault(
            "numerics.continuation",
            "continue_in_load",
            "(load_factor - reached) / (reached - before[0])",
            "(load_factor + reached) / (reached - before[0])",
        ),
        "sign",
        "the guess of the next load is taken far beyond it",
        "numerics/test_continuation.py",
    ),
    Defect(
        "no prediction of the rate",
        Fault("time_domain.solve", "_Run.step", "h / self.previous[0]", "0.9 * h / self.previous[0]"),
        "factor",
        "the start of Newton's method in a step",
        "time_domain/test_solve.py cable/test_order.py::test_order_in_dt -k 'not fault and not planted and (scheme or "
        "outputs or order_in_dt and bare)'",
        blind="a start: each step converges to the same state; a fixed step sees at most one iteration more",
    ),
    Defect(
        "Jacobian kept longer",
        Fault("numerics.newton", "", "_KEEP = 0.2", "_KEEP = 0.05"),
        "factor",
        "when a step with an old Jacobian is still worth taking",
        "harmonic_balance/test_oscillators.py::test_trigonometric_solutions_come_out_exactly "
        "harmonic_balance/test_oscillators.py::test_methods_find_the_same_response",
        blind="a choice between two ways to the same root: the numbers of steps and of factorisations change",
    ),
)
