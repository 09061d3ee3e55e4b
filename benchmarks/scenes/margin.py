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
