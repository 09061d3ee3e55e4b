"""Does an installed wheel work? Builds one, installs it in a fresh environment, runs its commands in an empty folder.

`python .ci/wheel.py [--keep FOLDER]`. Every file that a command writes must be in `mooring-report/` below that folder.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
import time
import venv
from pathlib import Path

ROOT = Path(__file__).parents[1]
SOURCES = ("solvers", "verification", "benchmarks", "reference_data", "reports", "pyproject.toml", "README.md")

LINE = """name = "My line"
tolerance = 1e-6
[environment]
depth = 320.0
[line]
length = 902.2
EA = 384.243e6
diameter = 0.09
mass_per_length = 77.7066
[ends]
anchor = [-853.87, 0.0, -320.0]
fairlead = [-5.2, 0.0, -70.0]
"""

SOLVER = """from benchmarks.peers import Adapter, SpanAnswer
from solvers import Span, solve_span

class Mine(Adapter):
    label = "mine"

    def span(self, case, tolerance=None):
        state = solve_span(Span(**case.inputs()))
        return SpanAnswer(state.H, state.V)
"""

HINT = 'python -m pip install "mooring-verification[report]"'
SOME_TESTS = ("common/test_motion.py", "catenary/test_references.py::test_table_is_complete")

PAGE = ("mooring-report/scene-my_line.html", "mooring-report/results/scene_my_line.json",
        "mooring-report/results/machine.json")  # fmt: skip


class Failure(Exception):
    """What is wrong with the wheel, in words."""


def run(words: list, folder: Path, code: int = 0, says: str = "") -> str:
    """Run a command in the folder; return what it printed. Raises Failure where it ends or speaks otherwise."""
    began = time.perf_counter()
    done = subprocess.run([str(word) for word in words], cwd=folder, capture_output=True, text=True)
    text = done.stdout + done.stderr
    shown = " ".join(str(word) for word in words)
    if done.returncode != code or says not in text or (code and "Traceback" in text):
        raise Failure(f"{shown}: exit status {done.returncode} for {code}, wanted words {says!r}:\n{text[-3000:]}")
    print(f"{time.perf_counter() - began:5.1f} s  {shown}", flush=True)
    return text


def build(folder: Path) -> Path:
    """Return the wheel, built from a copy: what earlier builds left in the checkout is not taken into it."""
    source = folder / "source"
    source.mkdir()
    skipped = shutil.ignore_patterns("__pycache__", "*.tmp")
    for name in SOURCES:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, source / name, ignore=skipped)
        else:
            shutil.copy2(ROOT / name, source / name)
    run([sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "-w", folder, source], folder)
    (wheel,) = folder.glob("*.whl")
    return wheel


def files(folder: Path) -> dict[Path, tuple[int, int]]:
    """Return every file below the folder with its size and its time of change; no bytecode, no compiled cache."""
    paths = (path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    return {path: (path.stat().st_size, path.stat().st_mtime_ns) for path in paths}


def check_without_extras(python: Path, folder: Path):
    """The solvers work, and each program that needs an extra names it with the command that installs it."""
    run([python, "-c", "import solvers; print(solvers.Span(w=1.0, EA=1e3, L=10.0, x=8.0, z=1.0), solvers.__version__)"],
        folder)  # fmt: skip
    for module in ("reports", "benchmarks.smoke", "benchmarks.run.machine", "reference_data", "verification.defects"):
        run([python, "-m", module], folder, code=1, says=HINT)


def check_commands(python: Path, folder: Path):
    """The commands of the README, from a folder that holds one line and one solver, and nothing else."""
    (folder / "my_line.toml").write_text(LINE, encoding="utf-8")
    (folder / "my_code.py").write_text(SOLVER, encoding="utf-8")
    package = Path(run([python, "-c", "import reports; print(reports.__path__[0])"], folder).strip()).parent
    before = files(package) | files(folder)
    run([python, "-m", "benchmarks.smoke", "my_code.py"], folder, says="line oc3-floating: right")
    run([python, "-m", "reports", "my_line.toml", "--solver", "my_code.py"], folder, says="scene-my_line.html")
    run([python, "-m", "reports", "compare"], folder, says="nothing is saved in mooring-report/history yet")
    run([python, "-m", "reference_data", "check", "--sample", "10"], folder, says="0 differences")
    run([python, "-m", "reference_data", "regenerate"], folder, code=2, says="run it in a checkout")
    tests = [package / "verification" / name for name in SOME_TESTS]
    settings = ["-c", package / "verification" / "installed_pytest.ini", "--rootdir", package]
    run([python, "-m", "pytest", *settings, "-p", "no:cacheprovider", *tests], folder, says="passed")
    for name in PAGE:
        if not (folder / name).is_file():
            raise Failure(f"{name} is not there")
    after = files(package) | files(folder)
    out = folder / "mooring-report"
    strange = [path for path in after if after[path] != before.get(path) and out not in path.parents]
    strange += [path for path in before if path not in after]
    if strange:
        raise Failure(f"written outside of mooring-report: {', '.join(map(str, strange))}")


def main(argv=None) -> int:
    """Exit status 0: the wheel works; 1: it does not, and the output says why."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="work in this new folder, and leave it there")
    arguments = parser.parse_args(argv)
    folder = arguments.keep or Path(tempfile.mkdtemp(prefix="mooring-wheel-"))
    folder.mkdir(parents=True, exist_ok=True)
    try:
        wheel = build(folder.resolve())
        venv.create(folder / "venv", with_pip=True)
        python = folder.resolve() / "venv" / ("Scripts" if sys.platform == "win32" else "bin") / "python"
        empty = folder.resolve() / "empty"
        empty.mkdir()
        install = [python, "-m", "pip", "install", "-q", "--no-compile", "--disable-pip-version-check"]
        run([*install, wheel], folder)
        check_without_extras(python, empty)
        run([*install, f"{wheel}[report]"], folder)
        check_commands(python, empty)
    except Failure as failure:
        print(failure, file=sys.stderr)
        return 1
    finally:
        if not arguments.keep:
            shutil.rmtree(folder, ignore_errors=True)
    print("the wheel works")
    return 0


if __name__ == "__main__":
    sys.exit(main())
