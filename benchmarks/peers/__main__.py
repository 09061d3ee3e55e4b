"""List the other codes that the measurements run: the installed peers, and what MOORING_SOLVERS brings.

Exit status 2: a file brings no solver, or a peer that is installed cannot be imported; standard error says why.
"""

import sys

from . import LIMITS, adapters


def main() -> int:
    """Print one line a code."""
    try:
        by_name = adapters()
    except ImportError as error:
        print(error, file=sys.stderr)
        return 2
    for adapter in by_name.values():
        title = " ".join(filter(None, (adapter.label, adapter.version, f"({adapter.name})")))
        print(f"{title} solves {', '.join(problem for problem in LIMITS if adapter.solves(problem))}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
