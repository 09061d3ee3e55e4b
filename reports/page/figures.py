"""Figures as the page shows them: drawings under one caption, each with the table of what it draws."""

from __future__ import annotations

from dataclasses import dataclass, field

from .numbers.tables import Table


@dataclass
class Figure:
    """One drawing. svg : element to embed; alt : description for those who cannot see it; wide : over both columns.

    chart : JSON of the chart that stands in its place where scripts run, or "" (reports/drawing/interactive.py)
    """

    name: str
    title: str
    alt: str
    svg: str
    wide: bool = False
    chart: str = ""


@dataclass
class Group:
    """Figures under one caption; anchor : id on the page, where something links to it."""

    caption: str
    figures: list[Figure] = field(default_factory=list)
    anchor: str = ""


@dataclass
class FigureWithTable:
    """Figures with the table of what they draw."""

    group: Group
    table: Table
