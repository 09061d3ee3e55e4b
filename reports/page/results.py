"""What the folder of results holds, read by groups of stages, and what is not as it should be."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any

from ..pipeline.dependencies.ledger import Ledger
from ..pipeline.dependencies.sources import ROOT
from ..pipeline.running.runner import Ended
from ..pipeline.stages import GROUPS, Stage
from .navigation.claims import Question, read_questions

SCENE_GROUPS = ("scenes", "moving_scene", "published")
"""Groups with one file a scene."""
CODE_GROUPS = ("conformance",)
"""Groups with one file a code."""


class Results:
    """Parsed result files and, for every group of stages, notes on what is not as it should be."""

    def __init__(self, out: Path, stages: list[Stage], ended: list[Ended]):
        self.folder, self.stages = out / "results", stages
        self.ledger = Ledger(self.folder)
        self.ended = {end.stage.name: end for end in ended}
        self._loaded: dict[str, dict | None] = {}
        self.notes = {group: self._notes(group) for group in GROUPS}

    def load(self, group: str) -> Any:
        """Return what the files of a group hold together, None where nothing can be read.

        Of scenes, stem -> result; of conformance, code -> report; of tests, the test files with their claims and
        outcomes. Raises KeyError where there is no such group: a section that names a group wrongly would be empty
        without a word.
        """
        if group not in GROUPS:
            raise KeyError(f"no such group of stages: {group!r}; there are {', '.join(GROUPS)}")
        if group == "tests":
            return self.questions
        if group not in self._loaded:
            load = self._load_codes if group in CODE_GROUPS else self._load_merged
            self._loaded[group] = (self._load_scenes if group in SCENE_GROUPS else load)(group)
        return self._loaded[group]

    def digest(self, group: str) -> str:
        """Return the digest of the files of a group of stages."""
        result = hashlib.sha256()
        for stage in self.stages:
            file = self.folder / stage.output
            if stage.group == group:
                result.update(stage.output.encode() + (file.read_bytes() if file.exists() else b"none"))
        return result.hexdigest()

    def _load_merged(self, group: str) -> dict | None:
        contents = [self._read(stage.output) for stage in self.stages if stage.group == group]
        return {key: value for content in contents if content for key, value in content.items()} or None

    def _load_codes(self, group: str) -> dict[str, dict] | None:
        stages = [stage for stage in self.stages if stage.group == group]
        reports = {stage.name.removeprefix(f"{group}_"): self._read(stage.output) for stage in stages}
        return {name: report for name, report in reports.items() if report} or None

    def _load_scenes(self, group: str) -> dict[str, dict] | None:
        stages = [stage for stage in self.stages if stage.group == group]
        scenes = {stage.name.removeprefix("scene_"): (self._read(stage.output), stage.arguments[1]) for stage in stages}
        return {stem: scene | {"path": path} for stem, (scene, path) in scenes.items() if scene} or None

    def _read(self, output: str) -> dict | None:
        try:
            return json.loads((self.folder / output).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None

    @cached_property
    def questions(self) -> list[Question]:
        """The test files with their claims, and the outcomes that the stages of tests left."""
        stages = [stage for stage in self.stages if stage.group == "tests"]
        paths = (self.folder / stage.output for stage in stages if stage.runs or self.ledger.current(stage))
        return read_questions(ROOT / "verification", [path for path in paths if path.exists()])

    def _notes(self, group: str) -> list[str]:
        """Return what is not as it should be in a group of stages, each kind of trouble once."""
        troubles = {}
        for stage in self.stages:
            if stage.group == group and (trouble := self._trouble(stage)):
                troubles.setdefault(trouble, []).append(stage.title)
        return [f"{trouble}: {', '.join(titles)}." for trouble, titles in troubles.items()]

    def _trouble(self, stage: Stage) -> str:
        if not stage.runs:
            return ""
        end, exists = self.ended.get(stage.name), (self.folder / stage.output).exists()
        if end and end.state == "failed":
            return "Failed in this run; the page shows an earlier result" if exists else "Failed; nothing to show"
        if not exists:
            return "Not run yet; nothing to show"
        return "" if self.ledger.valid(stage) else "Last run on other sources or on another machine"

    def failures(self) -> list[dict]:
        """Return title, command and last lines of every stage that failed in this run."""
        return [
            {
                "title": end.stage.title,
                "command": end.stage.command_line(self.folder),
                "tail": end.tail,
                "is_refused": end.is_refused,
            }
            for end in self.ended.values()
            if end.state == "failed"
        ]

    @cached_property
    def stage_table(self) -> list[dict]:
        """Return the stages as they ran last, those of tests as one."""
        rows = [self._stage_row(stage) for stage in self.stages if stage.group != "tests"]
        tests = [self._stage_row(stage) for stage in self.stages if stage.group == "tests" and stage.runs]
        ran = [row for row in tests if row["finished"]]
        if not tests:
            return rows
        together = {"title": f"verification tests, {len(ran)} of {len(tests)} stages",
                    "command": "python -m pytest verification",
                    "seconds": sum(row["seconds"] for row in ran) if ran else None,
                    "finished": max((row["finished"] for row in ran), default=None),
                    "load": ran[0]["load"] if ran else None}  # fmt: skip
        return [together, *rows]

    def _stage_row(self, stage: Stage) -> dict:
        entry = self.ledger.entries.get(stage.name, {})
        command = replace(stage, arguments=tuple(entry.get("arguments", stage.arguments))).command_line(self.folder)
        facts = {key: entry.get(key) for key in ("seconds", "finished", "load")}
        return {"title": stage.title, "command": command} | facts
