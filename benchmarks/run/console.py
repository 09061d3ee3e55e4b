"""What every program shares on the command line: the output folder, the progress bar, one BLAS thread, bad endings."""

from __future__ import annotations

import argparse
import os
import sys
from concurrent.futures.process import BrokenProcessPool
from importlib.resources import files
from pathlib import Path

from threadpoolctl import threadpool_limits
from tqdm import tqdm

PROGRESS = "MOORING_PROGRESS"
"""Environment variable; "lines" asks for `progress <done> <total>` on stdout, from which a parent draws its own bar."""

ROOT = Path(str(files("benchmarks"))).parent
"""Folder of the packages: the root of the repository, or site-packages where they are installed from a wheel."""

MODULE = (sys.executable, "-P", "-m")
"""Runs a module; -P keeps the caller's folder, whose files could hide one of the packages, off the search path."""

DEFAULT_OUT = Path("mooring-report") / "results"


def child_environment() -> dict[str, str]:
    """Return the environment of a child process that finds these packages whatever the working folder is."""
    result = dict(os.environ)
    if (ROOT / "pyproject.toml").is_file():  # a checkout: an installed wheel is found anyway
        result["PYTHONPATH"] = os.pathsep.join(filter(None, [str(ROOT), result.get("PYTHONPATH", "")]))
    return result


def parser(program: str, doc: str) -> argparse.ArgumentParser:
    """Parser with ``--out``; the first line of the module's docstring is its description."""
    made = argparse.ArgumentParser(prog=f"python -m benchmarks.{program}", description=doc.splitlines()[0])
    made.add_argument("--out", type=Path, default=DEFAULT_OUT, metavar="DIR",
                      help=f"folder of the result files (default: {DEFAULT_OUT})")  # fmt: skip
    return made


def whole_number(least: int, what: str):
    """argparse type: an integer >= least."""

    def parse(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            value = least - 1
        if value < least:
            raise argparse.ArgumentTypeError(f"{text!r} is not {what} (an integer >= {least})")
        return value

    return parse


def add_jobs(parser):
    """``--jobs``: all cores by default."""
    number = whole_number(1, "a number of processes")
    parser.add_argument("--jobs", type=number, default=os.cpu_count() or 1, metavar="J", help="processes")


def asks_for_lines() -> bool:
    """Return whether a parent draws the bar, from lines `progress <done> <total>` on stdout."""
    return os.environ.get(PROGRESS) == "lines"


def progress(items, total: int, label: str):
    """Yield from ``items`` under a bar on stderr, or with one line on stdout a step where a parent asks for lines."""
    if not asks_for_lines():
        yield from tqdm(items, total=total, desc=label, file=sys.stderr)
        return
    for done, item in enumerate(items, start=1):
        yield item
        print(f"progress {done} {total}", flush=True)


def run(main) -> None:
    """``main()`` with the BLAS pinned to one thread; interruptions, files and broken peers end without a traceback."""
    try:
        with threadpool_limits(1):
            sys.exit(main())
    except KeyboardInterrupt:
        sys.exit("interrupted; exact results that were finished are kept for the next run")
    except (OSError, ImportError, BrokenProcessPool) as error:
        sys.exit(f"{type(error).__name__}: {error}")
