"""Does an installed wheel work? Builds one, installs it in a fresh environment, runs its commands in an empty folder.

`python .ci/wheel.py [--keep FOLDER]`. Every file that a command writes must be in `mooring-report/` below that folder.
"""

from __future__ import annotations

import argparse
import re
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

SOLVER = """from benchmarks.peers import Adapter, SpanAnswer  # as older adapters do
from solvers import Span, solve_span

class Mine(Adapter):
    label = "mine"

    def span(self, case, tolerance=None):
        state = solve_span(Span(**case.inputs()))
        return SpanAnswer(state.H, state.V)
"""

WRONG = """import os
import signal
import time
from my_code import MyCode
from verification.conformance import SpanAnswer

class KiloNewton(MyCode):
    def span(self, case, tolerance=None):
        answer = super().span(case)
        return SpanAnswer(answer.H / 1000, answer.V / 1000)

class Swapped(MyCode):
    def span(self, case, tolerance=None):
        answer = super().span(case)
        return SpanAnswer(answer.H, answer.V - case.w * case.L)  # at the anchor

class InAir(MyCode):
    def span(self, case, tolerance=None):
        case.w = case.mass_per_length * case.g
        return super().span(case)

class Hangs(MyCode):
    time_limits = {"span": 0.5}
    def span(self, case, tolerance=None):
        time.sleep(1000 if case.z == 481.1 or case.L == 600.0 else 0)
        return super().span(case)

class Crashes(MyCode):
    def span(self, case, tolerance=None):
        if case.L == 600.0:
            os.kill(os.getpid(), signal.SIGSEGV)
        return super().span(case)

class Nonsense(MyCode):
    def span(self, case, tolerance=None):
        return SpanAnswer("5 kN", [1.0])
"""

VERDICTS = {
    "KiloNewton": (1, "mistake: kN_for_N"),
    "Swapped": (1, "mistake: ends_swapped or anchor_force_for_fairlead"),
    "InAir": (1, "mistake: weight_in_air"),
    "Hangs": (1, "no answer within 0.5 s"),
    "Crashes": (1, "ended by SIGSEGV"),
    "Nonsense": (1, "H = '5 kN', and a number is wanted"),
}
"""Class of WRONG -> exit status of the conformance command, and words that it says."""

LONGEST_STATICS = 60  # s

HINT = 'python -m pip install "mooring-verification[report]"'
SOME_TESTS = ("common/test_motion.py", "catenary/test_references.py::test_table_is_complete")

SAMPLES = {"spans": "10", "conformance_statics": "3", "conformance_networks": "1"}
"""Generated set -> rows that are computed anew: of networks, whose stiffness takes longest, one."""

PAGE = ("mooring-report/scene-my_line.html", "mooring-report/results/scene_my_line.json",
        "mooring-report/results/machine.json")  # fmt: skip


class Failure(Exception):
    """What is wrong with the wheel, in words."""


def run(words: list, folder: Path, code: int = 0, says: str = "", traceback: bool = False) -> str:
    """Run a command in the folder; return what it printed. Raises Failure where it ends or speaks otherwise.

    traceback: whether one is expected of a command that fails
    """
    began = time.perf_counter()
    done = subprocess.run([str(word) for word in words], cwd=folder, capture_output=True, text=True)
    text = done.stdout + done.stderr
    shown = " ".join(str(word) for word in words)
    if done.returncode != code or says not in text or (code and not traceback and "Traceback" in text):
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


def environment(folder: Path) -> Path:
    """Return the Python of a new environment."""
    venv.create(folder, with_pip=True)
    return folder.resolve() / ("Scripts" if sys.platform == "win32" else "bin") / "python"


def files(folder: Path) -> dict[Path, tuple[int, int]]:
    """Return every file below the folder with its size and its time of change; no bytecode, no compiled cache."""
    paths = (path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    return {path: (path.stat().st_size, path.stat().st_mtime_ns) for path in paths}


def check_without_extras(python: Path, folder: Path):
    """The solvers work, and each program that needs an extra names it with the command that installs it."""
    run([python, "-c", "import solvers; print(solvers.Span(w=1.0, EA=1e3, L=10.0, x=8.0, z=1.0), solvers.__version__)"],
        folder)  # fmt: skip
    for module in ("reports", "benchmarks.peers", "benchmarks.run.machine", "reference_data", "verification.defects"):
        run([python, "-m", module], folder, code=1, says=HINT)


def check_conformance(python: Path, wheel: Path, folder: Path):
    """The README's adapter and wrong ones are judged where nothing but numpy, scipy and pytest is installed."""
    install = [python, "-m", "pip", "install", "-q", "--no-compile", "--disable-pip-version-check"]
    run([*install, "--no-deps", wheel], folder)
    run([*install, "numpy", "scipy", "pytest"], folder)
    run([python, "-c", "import numba"], folder, code=1, says="No module named 'numba'", traceback=True)
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    example = re.search(r"<!-- file: my_code.py -->\n```python\n(.*?)```", text, re.DOTALL)[1]
    (folder / "my_code.py").write_text(example, encoding="utf-8")
    (folder / "wrong.py").write_text(WRONG, encoding="utf-8")
    judge = [python.parent / "pytest", "--pyargs", "verification.conformance", "-p", "no:cacheprovider"]
    began = time.perf_counter()
    run([*judge, "--solver", "my_code.py", "--conformance-report", "report.json", "--badge", "badge.svg"], folder,
        says="right")  # fmt: skip
    if (seconds := time.perf_counter() - began) > LONGEST_STATICS:
        raise Failure(f"the statics level takes {seconds:.0f} s with a solver of a few ms a line")
    for name, (code, words) in VERDICTS.items():
        run([*judge, "--solver", f"wrong.py:{name}", "--level", "statics"], folder, code=code, says=words)


def check_commands(python: Path, folder: Path):
    """The commands of the README, from a folder that holds one line and one solver, and nothing else."""
    (folder / "my_line.toml").write_text(LINE, encoding="utf-8")
    (folder / "my_code.py").write_text(SOLVER, encoding="utf-8")
    package = Path(run([python, "-c", "import reports; print(reports.__path__[0])"], folder).strip()).parent
    before = files(package) | files(folder)
    run([python, "-m", "reports", "my_line.toml", "--solver", "my_code.py"], folder, says="scene-my_line.html")
    run([python, "-m", "reports", "compare"], folder, says="nothing is saved in mooring-report/history yet")
    for name, rows in SAMPLES.items():
        words = ("reference_data", "check", "--only", name, "--sample", rows)
        run([python, "-m", *words], folder, says="0 differences")
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
        judged, empty = folder.resolve() / "judged", folder.resolve() / "empty"
        for path in (judged, empty):
            path.mkdir()
        check_conformance(environment(folder / "bare"), wheel, judged)
        python = environment(folder / "venv")
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
