"""A solver in a process of its own: asked case by case, ended where it takes too long, started again after a crash."""

from __future__ import annotations

import contextlib
import json
import queue
import signal
import subprocess
import sys
import tempfile
import threading
from dataclasses import dataclass

from ..judge import NOT_MODELLED, REFUSED, Judgement, judge
from ..tables import Case
from .program import end_process, end_with_parent

START_LIMIT = 300.0
"""s; a solver that compiles itself when imported takes its time."""
MARGIN = 2.0
"""s beyond the limit of a solve: a program is ended by its own adapter, which says so and ends all that it started."""
_BOOT = "import json, sys; sys.path[:] = json.loads(sys.argv[1]); from verification.conformance.process import child; "
_BOOT += "child.main(sys.argv[2])"


class LoadingError(Exception):
    """There is no solver of that name, or it cannot be imported; the text says why."""


@dataclass(frozen=True)
class Solved:
    """One judged case and the seconds that it took."""

    judgement: Judgement
    seconds: float | None


class SolverProcess:
    """The solver that a command line names. Raises LoadingError.

    label, version : its own; limits : problem -> s, of those that it solves; is_command : a program that is named by
    its command line alone, and so cannot say what it solves
    """

    def __init__(self, name: str):
        self.name = name
        self._process, self._lines, self._errors = None, None, None
        self._margin = 0.0
        hello = self._start()
        self._margin = MARGIN * hello["is_program"]
        self.label, self.version, self.limits = hello["label"], hello["version"], hello["limits"]
        self.is_command = hello["is_command"]

    def judge(self, case: Case, sentences=None) -> Solved:
        """Return the judgement of the solver's answer to a case."""
        if case.problem not in self.limits:
            words = f"it has no method {case.problem}"
            return Solved(Judgement(case, NOT_MODELLED, words=words), None)
        reply = self._ask(case)
        for key, verdict in (("not modelled", NOT_MODELLED), ("refused", REFUSED)):
            if key in reply:
                return Solved(Judgement(case, verdict, words=reply[key]), reply.get("seconds"))
        return Solved(judge(case, reply["answer"], sentences), reply["seconds"])

    def close(self):
        """End the process and all that it started."""
        if self._process is not None:
            with contextlib.suppress(OSError):
                self._process.stdin.close()
            end_process(self._process)
            self._process.stdout.close()
            self._errors.close()
            self._process = None

    def _start(self) -> dict:
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115 (closed with the process)
        paths = [path for path in sys.path if isinstance(path, str)]
        self._process = subprocess.Popen(
            [sys.executable, "-c", _BOOT, json.dumps(paths), self.name], stdin=subprocess.PIPE,
            stdout=subprocess.PIPE, stderr=self._errors, text=True, encoding="utf-8", start_new_session=True,
            preexec_fn=end_with_parent if sys.platform == "linux" else None)  # fmt: skip
        self._lines = queue.Queue()
        threading.Thread(target=_read, args=(self._process.stdout, self._lines), daemon=True).start()
        hello = self._receive(START_LIMIT, "is not imported within")
        for key in ("error", "refused"):
            if key in hello:
                self.close()
                raise LoadingError(hello[key] if key == "error" else f"{self.name}: {hello[key]}")
        return hello

    def _ask(self, case: Case) -> dict:
        if self._process is None:
            self._start()
        with contextlib.suppress(OSError):  # where it has ended, that is what is received
            self._process.stdin.write(json.dumps({"problem": case.problem, "inputs": case.inputs}) + "\n")
            self._process.stdin.flush()
        limit = self.limits[case.problem]
        return self._receive(limit, "no answer within")

    def _receive(self, limit: float, late: str) -> dict:
        """Return the next line of the process; where there is none it is ended, and the words say how."""
        try:
            line = self._lines.get(timeout=limit + self._margin)
        except queue.Empty:
            self.close()
            return {"refused": f"{late} {limit:g} s"}
        if line:
            return json.loads(line)
        code, words = self._process.wait(), self._last_error()
        self.close()
        ended = f"ended by {signal.Signals(-code).name}" if code < 0 else f"ended with exit status {code}"
        return {"refused": f"{ended}: {words}" if words else ended}

    def _last_error(self) -> str:
        """Return the last line of standard error."""
        self._errors.seek(0)
        lines = self._errors.read().decode(errors="replace").strip().splitlines()
        return lines[-1][:120] if lines else ""


def _read(pipe, lines: queue.Queue):
    """Put every line of a pipe into a queue, and at last an empty one."""
    with contextlib.suppress(ValueError, OSError):  # it is closed where the process is ended
        for line in pipe:
            lines.put(line)
    lines.put("")
