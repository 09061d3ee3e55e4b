"""The summary of the page: the questions in order, each answered by what its sections say and measured."""

from __future__ import annotations

from dataclasses import dataclass, replace

from .figures import Figure, Group
from .section import PARTS, Content, Section
from .verdicts import Verdict


@dataclass(frozen=True)
class Answer:
    """A part of the page with its question, and what its sections give to the summary."""

    part: str
    question: str
    sentences: list[str]
    verdicts: list[Verdict]
    figures: Group | None


def answer_questions(contents: list[tuple[Section, Content]]) -> list[Answer]:
    """Return one answer a part, in the order of the page."""
    return [_answer(part, question, contents) for part, question in PARTS.items()]


def _answer(part: str, question: str, contents: list[tuple[Section, Content]]) -> Answer:
    own = [content for section, content in contents if section.part == part]
    sentences = [sentence for content in own for sentence in content.sentences] or ["Not measured yet."]
    verdicts = [v for section, content in contents for v in content.verdicts if (v.part or section.part) == part]
    return Answer(part, question, sentences, verdicts, _group([pair for content in own for pair in content.figures]))


def _group(figures: list[tuple[str, Figure]]) -> Group | None:
    if not figures:
        return None
    captions = "; ".join(caption for caption, _ in figures)
    text = f"Error against run time of {captions}. Rings: the Pareto front."
    return Group(text, [_with_own_ids(figure) for _, figure in figures])


def _with_own_ids(figure: Figure) -> Figure:
    """Return the same figure under other ids, for it stands in its section as well."""
    svg = figure.svg.replace(f'"{figure.name}-', f'"again-{figure.name}-')
    return replace(figure, svg=svg.replace(f"#{figure.name}-", f"#again-{figure.name}-"))
