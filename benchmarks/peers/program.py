"""A code that is called as a program: one JSON object on its standard input, one on its standard output.

in   {"problem": "span", "tolerance": null, "w", "EA", "L", "x", "z", "seabed", "friction", "clearance"}
     {"problem": "network", "tolerance": null, "rho", "g", "depth" (null: no seabed),
      "nodes": [{"kind", "r", "mass", "volume", "force"}], "elements": [{"w", "EA", "L", "ends", "friction"}]}
     {"problem": "cable", "cells", "time": [K], "fairlead": [K x 3], "anchor": [3], "length", "w", "EA", "diameter",
      "mass_per_length", "Cdn", "Cdb", "Cdt", "Ca", "damping", "rho", "g", "current": [3], "depth", "seabed_stiffness"}
out  {"H", "V"}, {"tension": [e x 2]} or {"tension": [K]}, N; and if it likes "iterations" and "seconds" of the solve by
     its own clock (else the whole call is timed, its start included); or {"refused": "why"}, {"unsupported": "why"}
Lines before that object are passed over. An exit status other than 0 is a refusal, with the last line that it printed.
"""

from __future__ import annotations

import contextlib
import ctypes
import json
import os
import shutil
import signal
import subprocess
import sys
import threading
from dataclasses import asdict

import numpy as np

from .adapter import Adapter, Refused, SpanAnswer

MOST = 64_000_000  # bytes of output: the tension of a million steps in full digits is a third of that
SHOWN = 120  # characters of what it printed, in a refusal


class Program(Adapter):
    """Another code behind a command line; see the module for what it reads and prints.

    command : words of the command line; a relative path is looked up beside the file that brings the class
    problems : those that it solves, of "span", "network", "cable"
    """

    command: tuple[str, ...] = ()
    problems: tuple[str, ...] = ("span",)
    tolerances = False
    folder: str = ""

    def solves(self, problem: str) -> bool:
        """Whether it says so."""
        return problem in self.problems

    def span(self, case, tolerance=None) -> SpanAnswer:
        """As Adapter.span."""
        answer = self._ask("span", case.inputs() | {"tolerance": tolerance})
        return SpanAnswer(answer.get("H"), answer.get("V"), answer.get("iterations"), seconds=answer.get("seconds"))

    def network(self, network, tolerance=None):
        """As Adapter.network."""
        keys = {"nodes": ("kind", "r", "mass", "volume", "force"), "elements": ("w", "EA", "L", "ends", "friction")}
        asked = {
            part: [{key: getattr(one, key) for key in names} for one in getattr(network, part)]
            for part, names in keys.items()
        }
        environment = {key: getattr(network.environment, key) for key in ("rho", "g", "depth")}
        return self._ask("network", asked | environment | {"tolerance": tolerance}).get("tension")

    def cable(self, scene, time, fairlead, cells):
        """As Adapter.cable."""
        asked = asdict(scene.cable) | asdict(scene.environment) | {"w": scene.cable.weight_in(scene.environment)}
        del asked["submerged_weight"]
        asked |= {"anchor": scene.anchor, "length": scene.length, "cells": cells}
        asked |= {"time": np.asarray(time).tolist(), "fairlead": np.asarray(fairlead).tolist()}
        return self._ask("cable", asked).get("tension")

    def words(self) -> list[str]:
        """The command line. Raises FileNotFoundError where there is no such program."""
        if not self.command:
            raise FileNotFoundError(f"{type(self).__name__}: command is empty; give the words of a command line")
        first, *others = map(str, self.command)
        own_path = os.path.join(self.folder, first)
        path = own_path if os.path.isfile(own_path) else shutil.which(first)
        if path is None:
            raise FileNotFoundError(f"{type(self).__name__}: there is no program {first!r} in {self.folder} or on PATH")
        return [path, *others]

    def _ask(self, problem: str, asked: dict) -> dict:
        code, out, err = _run(self.words(), json.dumps({"problem": problem} | asked), self.limit(problem), self.folder)
        if code:
            ended = f"ended by {signal.Signals(-code).name}" if code < 0 else f"exit status {code}"
            words = (err.strip() or out.strip()).splitlines()
            raise Refused(f"{ended}: {words[-1][:SHOWN]}" if words else ended)
        answer = _parsed(out)
        if answer.get("unsupported"):
            raise NotImplementedError(str(answer["unsupported"]))
        if answer.get("refused"):
            raise Refused(str(answer["refused"]))
        return answer


def _parsed(out: str) -> dict:
    """The JSON object that was printed: all of it, or its last line."""
    for text in (out, (out.strip().splitlines() or [""])[-1]):
        with contextlib.suppress(ValueError):
            answer = json.loads(text)
            if isinstance(answer, dict):
                return answer
    raise Refused(f"printed no JSON object: {out[:SHOWN]!r}" if out.strip() else "printed nothing")


def _run(words, text: str, limit: float, folder: str) -> tuple[int, str, str]:
    """(exit status, standard output, standard error); what it started ends with it."""
    try:
        process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   cwd=folder or None, start_new_session=True,
                                   preexec_fn=_end_with_parent if sys.platform == "linux" else None)  # fmt: skip
    except OSError as error:
        raise Refused(f"cannot be started: {error.strerror}: {words[0]}") from None
    heard = {}
    pipes = [threading.Thread(target=_send, args=(process.stdin, text), daemon=True)]
    pipes += [threading.Thread(target=_hear, args=(process, name, heard), daemon=True) for name in ("stdout", "stderr")]
    try:
        for pipe in pipes:
            pipe.start()
        code = process.wait(limit)
        for pipe in pipes[1:]:
            pipe.join(limit)
    except subprocess.TimeoutExpired:
        raise Refused(f"no answer within {limit:g} s") from None
    finally:
        _end(process)
    if any(len(part) > MOST for part in heard.values()):
        raise Refused(f"printed more than {MOST // 1_000_000} MB")
    return code, *(heard.get(name, b"").decode(errors="replace") for name in ("stdout", "stderr"))


def _end_with_parent():
    """A report that is interrupted, or killed, leaves no program behind that hangs (Linux: PR_SET_PDEATHSIG = 1)."""
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)


def _send(pipe, text: str):
    with contextlib.suppress(OSError), pipe:  # a program need not read what it is given
        pipe.write(text.encode())


def _hear(process, name: str, heard: dict):
    with getattr(process, name) as pipe:
        heard[name] = pipe.read(MOST + 1)
    if len(heard[name]) > MOST:
        _end(process)


def _end(process):
    """Ends the program and all that it started in its session, whether or not it is still there itself."""
    with contextlib.suppress(OSError):
        os.killpg(process.pid, signal.SIGKILL) if hasattr(os, "killpg") else process.kill()
    process.wait()
