"""A code that is called as a program: one JSON object on its standard input, one on its standard output.

in   {"problem": "span", "tolerance": null, "w", "EA", "L", "x", "z", "seabed", "friction", "clearance"}, and of
      conformance cases "s": [n], "mass_per_length", "diameter", "rho", "g"
     {"problem": "network", "tolerance": null, "rho", "g", "depth" (null: no seabed),
      "nodes": [{"kind", "r", "mass", "volume", "force"}], "elements": [{"w", "EA", "L", "ends", "friction"}]}, and of
      conformance cases "mass_per_length", "diameter" of elements and "body": null or {"nodes", "reference": [3]}
     {"problem": "cable", "cells", "time": [K], "fairlead": [K x 3], "anchor": [3], "length", "w", "EA", "diameter",
      "mass_per_length", "Cdn", "Cdb", "Cdt", "Ca", "damping", "rho", "g", "current": [3], "depth",
      "seabed_stiffness", "seabed_damping"}, and of conformance cases "friction", "slip_speed", "s": [n], "window": [2]
     {"problem": "moving_network", "cells", "time": [K], "coupled": [K x P x 3], and what cable and network have}
out  {"H", "V"}, {"tension": [e x 2]}, {"tension": [K]} or {"force": [P x 3 x K]}, N; and if it likes the other fields
     of SpanAnswer, NetworkAnswer, CableAnswer and MovingNetworkAnswer (adapter.py), "iterations", and "seconds" of the
     solve by its own clock (else the whole call is timed, its start included); or {"refused": "why"},
     {"unsupported": "why"}
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
from dataclasses import fields

from ..adapter import Adapter, CableAnswer, MovingNetworkAnswer, NetworkAnswer, Refused, SpanAnswer

MOST = 64_000_000  # bytes of output: the tension of a million steps in full digits is a third of that
SHOWN = 120  # characters of what it printed, in a refusal


_SPAN = ("s", "mass_per_length", "diameter", "rho", "g")
_NODE = ("kind", "r", "mass", "volume", "force")
_ELEMENT = ("w", "EA", "L", "ends", "friction", "mass_per_length", "diameter")
_SECTION = ("EA", "diameter", "mass_per_length", "Cdn", "Cdb", "Cdt", "Ca", "damping")
_WATER = ("rho", "g", "depth", "current", "seabed_stiffness", "seabed_damping")
_SCENE = ("friction", "slip_speed", "s", "window")


class Program(Adapter):
    """Another code behind a command line; see the module for what it reads and prints.

    command : words of the command line; a relative path is looked up beside the file that brings the class
    problems : those that it solves, of "span", "network", "cable", "moving_network"
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
        asked = case.inputs() | _given(case, _SPAN)
        return _as(SpanAnswer, self._ask("span", asked | {"tolerance": tolerance}))

    def network(self, network, tolerance=None):
        """As Adapter.network."""
        environment = {key: getattr(network.environment, key) for key in ("rho", "g", "depth")}
        asked = _parts(network, _NODE, _ELEMENT) | environment | {"tolerance": tolerance}
        if hasattr(network, "body"):
            body = network.body
            asked["body"] = body and {"nodes": list(body.nodes), "reference": list(body.reference)}
        answer = self._ask("network", asked)
        return _as(NetworkAnswer, answer) if hasattr(network, "body") else answer.get("tension")

    def cable(self, scene, time, fairlead, cells):
        """As Adapter.cable."""
        asked = _given(scene.cable, _SECTION) | _given(scene.environment, _WATER) | _given(scene, _SCENE)
        asked |= {"w": scene.cable.weight_in(scene.environment), "anchor": list(scene.anchor), "length": scene.length}
        asked |= {"time": _listed(time), "fairlead": _listed(fairlead), "cells": cells}
        answer = self._ask("cable", asked)
        return _as(CableAnswer, answer) if hasattr(scene, "window") else answer.get("tension")

    def moving_network(self, network, motion, time, cells):
        """As Adapter.moving_network; the program is given the places of the coupled nodes."""
        mean = [node.r for node in network.nodes if node.kind == "coupled"]
        moves = motion.displacement(mean, time)  # (3, P, K)
        coupled = [
            [[r[i] + float(moves[i][p][k]) for i in range(3)] for p, r in enumerate(mean)] for k in range(len(time))
        ]
        asked = _parts(network, (*_NODE, "CdA", "Ca"), _ELEMENT) | _given(network.environment, _WATER)
        for part, element in zip(asked["elements"], network.elements, strict=True):
            part |= _given(element.cable, _SECTION)
        asked |= _given(network, ("slip_speed",)) | {"time": _listed(time), "coupled": coupled, "cells": cells}
        return _as(MovingNetworkAnswer, self._ask("moving_network", asked))

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


def _listed(array) -> list:
    """Return an array of numpy, or nested tuples, as lists for JSON."""
    return array.tolist() if hasattr(array, "tolist") else list(array)


def _given(part, names) -> dict:
    """Return those attributes that the part has, for JSON."""
    present = {name: getattr(part, name) for name in names if hasattr(part, name)}
    return {name: _listed(one) if hasattr(one, "__len__") and name != "kind" else one for name, one in present.items()}


def _parts(network, node, element) -> dict:
    """Return nodes and elements for JSON."""
    return {
        "nodes": [_given(one, node) for one in network.nodes],
        "elements": [_given(one, element) for one in network.elements],
    }


def _as(kind, answer: dict):
    """Return what was printed as an answer; keys that it does not have are passed over."""
    wanted = {"H": None, "V": None} if kind is SpanAnswer else {}
    return kind(**wanted | {one.name: answer[one.name] for one in fields(kind) if answer.get(one.name) is not None})


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
                                   preexec_fn=end_with_parent if sys.platform == "linux" else None)  # fmt: skip
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
        end_process(process)
    if any(len(part) > MOST for part in heard.values()):
        raise Refused(f"printed more than {MOST // 1_000_000} MB")
    return code, *(heard.get(name, b"").decode(errors="replace") for name in ("stdout", "stderr"))


def end_with_parent():
    """End with the parent, so that one that is killed leaves nothing behind that hangs (Linux: PR_SET_PDEATHSIG)."""
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)


def _send(pipe, text: str):
    with contextlib.suppress(OSError), pipe:  # a program need not read what it is given
        pipe.write(text.encode())


def _hear(process, name: str, heard: dict):
    with getattr(process, name) as pipe:
        heard[name] = pipe.read(MOST + 1)
    if len(heard[name]) > MOST:
        end_process(process)


def end_process(process):
    """Ends the program and all that it started in its session, whether or not it is still there itself."""
    with contextlib.suppress(OSError):
        os.killpg(process.pid, signal.SIGKILL) if hasattr(os, "killpg") else process.kill()
    process.wait()
