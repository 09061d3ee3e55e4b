"""Numbers and words as the page prints them."""

from __future__ import annotations

import math
import re

DASH, MINUS, TIMES = "\N{EN DASH}", "\N{MINUS SIGN}", "\N{MULTIPLICATION SIGN}"


def number(value, digits: int = 3) -> str:
    """Return significant digits; powers of ten for the very large and small; a dash for what is not there."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return DASH
    if isinstance(value, (bool, str)):
        return str(value)
    if isinstance(value, int) or value == 0:
        return f"{value:,}".replace(",", " ") if isinstance(value, int) and abs(value) >= 10_000 else f"{value:g}"
    if 1e-3 <= abs(value) < 10 ** max(digits, 5):
        return f"{value:.{max(digits - 1 - math.floor(math.log10(abs(value))), 0)}f}"
    return re.sub(r"e([+-])0*(\d)", lambda m: f"e{m[1].strip('+')}{m[2]}", f"{value:.{digits - 1}e}")


def two_digits(value) -> str:
    """Return a number with two significant digits."""
    return number(value, 2)


def ratio(value: float) -> str:
    """Return two or three digits: 3.4, 12, 178."""
    return f"{value:.2g}" if value < 100 else f"{value:.0f}"


def times(value: float) -> str:
    """Return such as "3.4 times"."""
    return f"{ratio(value)} times"


def across(values) -> str:
    """Return the range of values, such as "2.1 to 8.4"."""
    values = list(values)
    low, high = number(min(values), 2), number(max(values), 2)
    return low if low == high else f"{low} to {high}"


def slug(text: str) -> str:
    """Return letters, digits, dots and hyphens only: for file names and ids."""
    return re.sub(r"[^a-z0-9.-]+", "-", str(text).lower()).strip("-") or "unnamed"


def seconds(value: float | None) -> str:
    """Return a time with the unit that suits its size."""
    if value is None:
        return DASH
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if value >= size:
            return f"{number(value / size, 3)} {unit}"
    return f"{number(value * 1e9, 3)} ns"


def plural(count: int, noun: str) -> str:
    """Return such as "1 case", "2 cases"."""
    return f"{number(count)} {noun}{'' if count == 1 else 's'}"


def status_words(status: str) -> str:
    """Return the status of a solve in words: NO_PERIODIC_RESPONSE is "no periodic response"."""
    return {"SUCCESS": "solved"}.get(status, status.lower().replace("_", " "))


def python_call(solver: str, inputs: dict) -> str:
    """Return Python to paste: another code and this project on the same line at rest."""
    arguments = ", ".join(f"{key}={value!r}" for key, value in inputs.items())
    return (
        "from benchmarks.peers import adapters\nfrom solvers import Span, solve_span\nfrom verification.cases.spans "
        f"import SpanCase\ninputs = dict({arguments})\n"
        f'adapters()["{solver}"].span(SpanCase("example", "", **inputs)), solve_span(Span(**inputs))'
    )


def split_sentence(text: str) -> tuple[str, str]:
    """Return the first sentence of a text, and the others."""
    first, *others = re.split(r"(?<=[^A-Z.][.?!])\s+(?=[A-Z“])", str(text), maxsplit=1)
    return first, others[0] if others else ""
