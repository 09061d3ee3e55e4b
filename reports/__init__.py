"""The page: runs tests and benchmarks as child processes and shows what they wrote. It computes no physics."""

import sys
from importlib.util import find_spec

_NEEDED = ("hypothesis", "jinja2", "matplotlib", "mpmath", "pytest", "pytest_benchmark", "tqdm")
"""Modules of the extra [report] that every program here imports, or starts."""


def _require_extras():
    """End `python -m` with one line where an extra is missing: before Python has found the program, argv[0] is -m."""
    missing = [name for name in _NEEDED if find_spec(name) is None] if sys.argv[0] == "-m" else []
    if missing:
        sys.exit(
            f"python -m reports needs {', '.join(missing)}, not installed here: "
            'python -m pip install "mooring-verification[report]"'
        )


_require_extras()
