"""Harmonic balance: the HB paper's figures and table remade, error against time, limits: harmonic_balance.json."""

from __future__ import annotations

import time

import numpy as np

from solvers.harmonic_balance.solve import solve_periodic
from solvers.time_domain.solve import solve_time_domain
from verification.registry import instants, last_period_tension

from ..cable import work_precision as dynamic_work
from ..cable.cases import (
    CASES,
    DT,
    HARMONICS,
    NODES,
    PAPER_CASES,
    PERIODS,
    SAMPLES,
    References,
    axial_ratio,
    rms,
    system,
)
from ..cable.measure import add_parts, chosen, measured
from ..run import console, results
from ..run.harness import clock
from . import limits as harmonic_limits

CHOICES = ((1, 8), (3, 16), (9, 32), (15, 64))  # (Nh, Nt) of Figs. 3 and 4
VARIANTS = {
    "paper": {"mean": False, "globalisation": "relaxation", "multilevel": False},
    "paper, constant kept": {"mean": True, "globalisation": "relaxation", "multilevel": False},
    "default": {},
}
SHOWN = 200  # instants of a period that are drawn
NODE = 25  # whose state the paper shows
TURNS = 3
LADDER, QUICK_LADDER, MOST, QUICK_MOST = (3, 5, 7, 9, 12, 15, 20, 25, 30), (3, 5, 9, 12), 45, 24
LEVELS = (1e-2, 1e-3, 1e-4)  # of the range of the tension
FINE = 30  # harmonics of the spectra
CONSTANT = {
    ("case_1", 9, 32, True): "hb_mean_9",
    ("case_1", 9, 32, False): "hb_paper_9",
    ("case_1", 30, 96, True): "hb_mean_30",
    ("case_1_large", 3, 16, True): None,
    ("case_1_large", 3, 16, False): "hb_paper_9m",
    ("case_1_large", 9, 32, True): "hb_mean_9m",
    ("case_1_large", 9, 32, False): None,
    ("case_3", 9, 32, True): None,
    ("case_3", 9, 32, False): None,
}
"""(case, harmonics, samples, whether the constant term is kept) -> the set of reference_data/oc3_dynamics, of two
independent programs, that has these settings; None where none has."""
QUICK_CONSTANT = [key for key in CONSTANT if key[1] == (3 if key[0] == "case_1_large" else HARMONICS)]
EXTREMES = 4000  # instants for greatest and least values


def converged(quick: bool, references):
    """The references, which later parts (and a later run of the timed ones) find made."""
    uncertainties = {}
    for case in CASES:
        reference = references.get_or_compute(case)
        uncertainties[case] = {"uncertainty": reference.uncertainty, "levels": reference.levels,
                               "refinements": reference.refinements}  # fmt: skip
        yield None
    yield uncertainties


def newton(quick: bool, references):
    """Fig. 3 and Fig. 4: error of every Newton step and the tension, by (Nh, Nt), for 5 m and 9 m."""
    rows = []
    for case in ("case_1", "case_1_large"):
        for variant, options in VARIANTS.items():
            few = case == "case_1_large" and variant == "paper"  # with more harmonics it takes minutes, or fails
            most = 2 if quick and few else 3 if quick or few else len(CHOICES)
            for Nh, Nt in CHOICES[:most]:
                response = solve_periodic(system(case), harmonics=Nh, samples=Nt, throw=False, **options)
                rows.append(
                    {
                        "case": case,
                        "variant": variant,
                        "harmonics": Nh,
                        "samples": Nt,
                        "errors": [step.error for step in response.steps],
                        "iterations": response.iterations,
                        "coarse_iterations": response.coarse_iterations,
                        "status": response.status.name,
                        "reached": response.amplitude,
                        "tension": last_period_tension(response)[:: len(last_period_tension(response)) // SHOWN],
                    }
                )
            yield None
    yield rows


def cases(quick: bool, references):
    """Table 2 and Figs. 6-9: both methods with the paper's settings, and other codes, turn and turn about."""
    rows = []
    for case in PAPER_CASES:
        calls = _calls(case)
        responses, seconds = {}, {}
        for name, call in calls.items():  # also the warm-up, but in the quick run
            start = time.perf_counter()
            responses[name] = call()
            seconds[name] = [time.perf_counter() - start] if quick else []
            if getattr(responses[name], "kind", ""):
                del responses[name]
        calls = {name: call for name, call in calls.items() if name in responses}
        rng = np.random.default_rng(2026)
        for _ in range(0 if quick else TURNS):
            for name in rng.permutation(list(calls)).tolist():
                seconds[name].append(clock(calls[name], 1))
        reference = references.get_or_compute(case)
        for name, result in responses.items():
            rows.append({"case": case, "method": name, "seconds": seconds[name], "uncertainty": reference.uncertainty,
                         "range": reference.range, "iterations": getattr(result, "iterations", None)}
                        | dynamic_work.errors(reference, result) | _shape(result, reference.period))  # fmt: skip
        rows.append(
            {"case": case, "method": "reference", "tension": reference.tension[:: reference.tension.size // SHOWN]}
        )
        yield None
    reference = references.get_or_compute("case_1")
    converged_values = {"max": reference.tension.max() / 1e3, "min": reference.tension.min() / 1e3,
                        "harmonics": reference.harmonics(5) / 1e3}  # fmt: skip
    yield {"node": NODE, "s": system("case_1").s[NODE - 1], "rows": rows, "converged": converged_values,
           "levels": reference.levels}  # fmt: skip


def _calls(case: str) -> dict:
    """The methods of Table 2, and other codes, as functions of no argument."""
    chain = system(case)
    calls = {
        "time domain": lambda: solve_time_domain(chain, dt=DT, periods=PERIODS),
        "harmonic balance": lambda: solve_periodic(chain, harmonics=HARMONICS, samples=SAMPLES),
    }
    return calls | dynamic_work.peer_calls(case)


def _shape(response, period) -> dict:
    """Fairlead tension and the state at NODE over the last period; of a peer the tension alone."""
    if isinstance(response, dynamic_work.PeerTension):
        return {"tension": response.tension[:: max(1, response.tension.size // SHOWN)]}
    first, _ = response.last_period
    state = response.at(first + instants(period, SHOWN))[:, NODE - 1]
    fields = dict(zip(response.system.fields, state, strict=True))
    return {"tension": last_period_tension(response)[:: len(last_period_tension(response)) // SHOWN], "fields": fields}


def constant(quick: bool, references):
    """With and without the constant term: extremes, mean, harmonics, error, and the tension of the period."""
    rows = []
    for key in QUICK_CONSTANT if quick else CONSTANT:
        case, Nh, Nt, mean = key
        response = solve_periodic(system(case), harmonics=Nh, samples=Nt, mean=mean, throw=False)
        tension = response.fairlead_tension(instants(system(case).period, EXTREMES))
        harmonics = response.tension_harmonics(5)
        rows.append(
            {
                "case": case,
                "harmonics": Nh,
                "samples": Nt,
                "mean": mean,
                "independent": CONSTANT[key],
                "iterations": response.iterations,
                "max": tension.max(),
                "min": tension.min(),
                "average": harmonics[0],
                "amplitudes": harmonics[1:],
                "least": response.tension.min(),
                "status": response.status.name,
                "tension": tension[:: EXTREMES // SHOWN],
            }
            | references.get_or_compute(case).errors_of_response(response)
        )
        yield None
    yield rows


def work(quick: bool, references):
    """Error against run time: points of all methods, a case each; the uncertainty of the references."""
    points, uncertainty = [], {}
    for case in PAPER_CASES[:1] if quick else PAPER_CASES:
        reference = references.get_or_compute(case)
        uncertainty[case] = reference.uncertainty
        for point in dynamic_work.points(case, reference, quick):
            points.append(point)
            yield None
    yield {"points": points, "uncertainty": uncertainty, "at_errors": dynamic_work.at_errors(points)}


def needed(quick: bool, references):
    """Error in Nh alone, at N = 50 against many harmonics; the Nh that each level takes, and the rate of decay."""
    rows, summary = [], []
    most = QUICK_MOST if quick else MOST
    for case in ("case_1", "case_4") if quick else PAPER_CASES:
        waves, response = {}, None
        for Nh in (*(QUICK_LADDER if quick else LADDER), most):
            response = solve_periodic(system(case), harmonics=Nh, start=response)
            waves[Nh] = last_period_tension(response)
        best = waves.pop(most)
        errors = {Nh: rms(values - best) / np.ptp(best) for Nh, values in waves.items()}
        rows += [{"case": case, "harmonics": Nh, "rms": error} for Nh, error in errors.items()]
        late = [(Nh, error) for Nh, error in errors.items() if HARMONICS <= Nh <= most / 2]
        rate = -np.polyfit(*np.log(np.array(late, dtype=float).T), 1)[0]
        summary.append({"case": case, "rate": float(rate)} | {
            f"{level:g}": next((Nh for Nh, error in errors.items() if error <= level), None) for level in LEVELS
        })  # fmt: skip
        yield None
    yield {"rows": rows, "summary": summary, "most": most, "nodes": NODES, "axial": axial_ratio("case_1")}


def spectra(quick: bool, references):
    """Harmonics of the fairlead tension, extremes of the tension along the line, and where it is least."""
    rows = []
    for case in CASES:
        response = solve_periodic(system(case), harmonics=15 if quick else FINE)
        t = instants(system(case).period)
        tension = system(case).tension(response.at(t), response.rate_at(t))
        node, k = np.unravel_index(tension.argmin(), tension.shape)
        rows.append(
            {
                "case": case,
                "amplitudes": response.tension_harmonics(response.basis.harmonics),
                "s": system(case).s,
                "rest": system(case).tension(system(case).rest_state()),
                "min": tension.min(axis=1),
                "mean": tension.mean(axis=1),
                "max": tension.max(axis=1),
                "least": tension[node, k],
                "node": int(node) + 1,
                "at": t[k],
                "axial": axial_ratio(case),
            }
        )
        yield None
    yield rows


PARTS = {
    "references": converged,
    "newton": newton,
    "cases": cases,
    "constant": constant,
    "work": work,
    "needed": needed,
    "spectra": spectra,
    "limit": harmonic_limits.limit,
    "growth": harmonic_limits.growth,
    "fields": harmonic_limits.fields,
    "oscillators": harmonic_limits.oscillators,
}
TIMED = ("cases", "work", "growth", "fields", "oscillators")


def main(argv=None) -> int:
    """Command line."""
    parser = console.parser("harmonic_balance", __doc__)
    add_parts(parser, PARTS)
    arguments = parser.parse_args(argv)
    names, output = chosen(arguments, TIMED, "harmonic_balance")
    references = References(arguments.out, arguments.quick)
    file = measured(PARTS, names, "harmonic balance", arguments.quick, references)
    results.write(arguments.out / output, file | {"quick": arguments.quick})
    for row in file.get("cases", {"rows": []})["rows"]:
        if "seconds" in row:
            print(f"{row['case']}, {row['method']}: {min(row['seconds']):.3g} s, rms {row['rms']:.2g} of the range")
    return 0


if __name__ == "__main__":
    console.run(main)
