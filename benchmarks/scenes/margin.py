"""Design tension of a line against its strength: mean and dynamic parts combined as DNV-OS-E301 has them."""

from __future__ import annotations

STRENGTH_SHARE = 0.95  # of the minimum breaking load: the characteristic strength without tests, DNV-OS-E301
NO_FACTORS = 1.0, 1.0  # where the file gives none: a comparison of forces, and no design


def margin(mean: float, greatest: float, breaking_load: float | None, factors: tuple[float, float] | None):
    """Return the design tension, the strength (N) and the utilisation of a line; None without a breaking load.

    T_d = gamma_mean T_mean + gamma_dyn (T_max - T_mean), S_C = 0.95 S_mbs; mean and greatest tension in N.
    """
    if breaking_load is None:
        return None
    by_mean, by_dynamic = factors or NO_FACTORS
    design = by_mean * mean + by_dynamic * (greatest - mean)
    strength = STRENGTH_SHARE * breaking_load
    return {"mean": mean, "dynamic": greatest - mean, "design": design, "breaking_load": breaking_load,
            "strength": strength, "utilisation": design / strength, "gamma_mean": by_mean, "gamma_dyn": by_dynamic,
            "given": factors is not None}  # fmt: skip


def margins(rows: list[dict], breaking_loads, factors) -> list[dict]:
    """Return a margin for each row of lines ("line", "mean", "max" in N) whose breaking load is known."""
    made = []
    for row, breaking_load in zip(rows, breaking_loads, strict=True):
        part = margin(row["mean"], row["max"], breaking_load, factors)
        if part is not None:
            made.append({"line": row["line"]} | part)
    return made


def margins_of_cases(cases, breaking_loads, factors) -> list[dict]:
    """Return for each line whose breaking load is known the margin in the load case that leaves the least.

    cases: CaseResult, those without results left out. The characteristic tension is the extreme of the reference time
    where one could be fitted and is more than the greatest tension of the case (basis "extreme"), else that tension
    (basis "greatest").
    """
    made = []
    for k, breaking_load in enumerate(breaking_loads):
        rows = [_of_case(case, case.lines[k], breaking_load, factors) for case in cases if case.success]
        if breaking_load is not None and rows:
            made.append(max(rows, key=lambda row: row["utilisation"]))
    return made


def _of_case(case, line, breaking_load, factors) -> dict:
    greatest = max(line.maximum, line.extreme or 0.0)
    basis = "extreme" if greatest == line.extreme else "greatest"
    part = margin(line.mean, greatest, breaking_load, factors) or {"utilisation": 0.0}
    return {"line": line.line, "case": case.name, "basis": basis} | part
