"""An interpreter for pytest on one copy of the project; where it can fork, the libraries are imported once.

As a programme (without the packages around it) it is the side that forks: it reads lines {"arguments", "timeout",
"interpreted"}, runs pytest on each in a child of its own, which imports the project anew, and answers {"code",
"output"}. When its input ends, because the other side has finished or was killed, it ends with the child that runs.
"""

from __future__ import annotations

import contextlib
import gc
import importlib
import json
import os
import select
import signal
import subprocess
import sys
import time
from pathlib import Path

LIBRARIES = ("pytest", "hypothesis", "mpmath", "numba", "numpy.polynomial", "scipy.integrate", "scipy.interpolate",
             "scipy.linalg", "scipy.optimize", "scipy.sparse.linalg", "threadpoolctl")  # fmt: skip
"""What most checks import; nothing of the project."""

DISABLE_JIT = {"NUMBA_DISABLE_JIT": "1"}
"""Environment in which numba leaves loops to Python."""


class Stopped(RuntimeError):
    """The interpreter was ended while a check ran."""


def environment(root: Path) -> dict[str, str]:
    """Return the environment of checks on the copy at ``root``: one BLAS thread, no settings of the run around it.

    Bytecode is written, whatever the caller does: the copy is deleted, and hundreds of checks import it.
    """
    others = ("PYTEST_", "MOORING_", "COV_", "PYTHONDONTWRITEBYTECODE")
    results = {k: v for k, v in os.environ.items() if not k.startswith(others)}
    results |= {"OPENBLAS_NUM_THREADS": "1", "COLUMNS": "240", "PYTHONPATH": str(root)}
    return results | {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}  # plugins: half of the start, for nothing the checks use


class Interpreter:
    """Runs pytest on the copy of the project at ``root``: forked from one that has the libraries, or each anew."""

    def __init__(self, root: Path, forks: bool = hasattr(os, "fork")):
        self.root, self.forks, self.process, self.closed = root, forks, None, False

    def run(self, arguments: list[str], timeout: float, interpreted: bool = False) -> tuple[int | None, str]:
        """Return (exit status, output) of pytest; the status is None after ``timeout`` s. Raises Stopped.

        interpreted : whether Python itself runs the loops that numba would compile
        """
        if self.closed:
            raise Stopped
        run = self._forked if self.forks else self._anew
        return run(arguments, timeout, interpreted)

    def close(self):
        """End it, and with it the check that runs."""
        self.closed, process = True, self.process
        if process is None:
            return
        if self.forks:
            with contextlib.suppress(OSError):  # closed already
                process.stdin.close()
            process.wait()
            process.stdout.close()
        else:
            process.kill()

    def _forked(self, arguments, timeout, interpreted):
        if self.process is None:
            self.process = subprocess.Popen(
                [sys.executable, "-P", __file__],
                cwd=self.root,
                env=environment(self.root),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
                encoding="utf-8",
                start_new_session=True,  # an interrupt from the keyboard is for the programme alone
            )
        try:
            order = {"arguments": arguments, "timeout": timeout, "interpreted": interpreted}
            print(json.dumps(order), file=self.process.stdin, flush=True)
            answer = json.loads(self.process.stdout.readline())
        except (OSError, ValueError) as error:
            raise Stopped from error
        return answer["code"], answer["output"]

    def _anew(self, arguments, timeout, interpreted):
        self.process = process = subprocess.Popen(
            [sys.executable, "-m", "pytest", *arguments],
            cwd=self.root,
            env=environment(self.root) | (DISABLE_JIT if interpreted else {}),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            encoding="utf-8",
            errors="replace",
        )
        try:
            output = process.communicate(timeout=timeout)[0]
        except subprocess.TimeoutExpired:
            process.kill()
            return None, process.communicate()[0]
        return process.returncode, output


# ---------------------------------------------------------------- the side that forks
def serve():
    """Answer line after line until the input ends."""
    for name in LIBRARIES:
        importlib.import_module(name)
    if projects := {"solvers", "verification", "benchmarks"} & set(sys.modules):
        raise RuntimeError(f"{sorted(projects)} of the project imported before a defect was planted")
    gc.freeze()
    while line := os_readline(0):
        order = json.loads(line)
        code, output = fork(order["arguments"], order["timeout"], order["interpreted"])
        print(json.dumps({"code": code, "output": output}), flush=True)


def os_readline(handle: int) -> bytes:
    """A line without a buffer behind which select() would not see the end of the input."""
    line = b""
    while byte := os.read(handle, 1):
        if byte == b"\n":
            return line
        line += byte
    return b""


def fork(arguments: list[str], timeout: float, interpreted: bool) -> tuple[int | None, str]:
    """(exit status, output) of pytest in a child; the status is None where it did not end."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        _child(arguments, writing, interpreted)
    os.close(writing)
    with contextlib.suppress(OSError):  # the child has done it, or has ended
        os.setpgid(child, child)
    output, until, late = b"", time.monotonic() + timeout, False
    while True:
        ready = select.select([0, reading], [], [], max(until - time.monotonic(), 0.0))[0]
        if 0 in ready:  # nothing is sent while a check runs: the other side is gone
            os.killpg(child, signal.SIGKILL)
            sys.exit(0)
        if not ready:
            late = True
            break
        piece = os.read(reading, 65536)
        output += piece
        if not piece:
            break
    if late:
        os.killpg(child, signal.SIGKILL)
    os.close(reading)
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    return None if late else status, output.decode("utf-8", "replace")


def disable_jit():
    """Let Python run compiled loops of this process, which has imported numba, and of those that it starts."""
    os.environ |= DISABLE_JIT
    sys.modules["numba"].config.reload_config()


def _child(arguments, writing, interpreted):
    """pytest on the project, which is imported only here; does not return."""
    code = 70
    try:
        os.setpgid(0, 0)
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        os.dup2(writing, 1)
        os.dup2(writing, 2)
        sys.path.insert(0, os.getcwd())
        importlib.invalidate_caches()
        if interpreted:
            disable_jit()
        import pytest

        code = int(pytest.main(arguments))
    except BaseException:
        import traceback

        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)


if __name__ == "__main__":
    serve()
