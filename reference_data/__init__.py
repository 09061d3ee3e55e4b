"""Reference values with their provenance: one folder a set, data.csv beside source.toml."""

import sys
from importlib.util import find_spec

_NEEDED = ("mpmath", "tqdm")
"""Modules of the extra [report] that every program here imports, or starts."""


def _require_extras():
    """End `python -m` with one line where an extra is missing: before Python has found the program, argv[0] is -m."""
    missing = [name for name in _NEEDED if find_spec(name) is None] if sys.argv[0] == "-m" else []
    if missing:
        sys.exit(
            f"python -m reference_data needs {', '.join(missing)}, not installed here: "
            'python -m pip install "mooring-verification[report]"'
        )


_require_extras()
