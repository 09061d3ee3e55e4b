"""Tables of load cases: sea states and regular motions by the thousand, with statistics of every line."""

from ..common.load_case import LoadCase
from .results import Accuracy, CaseResult, LineResult, LoadCaseTable
from .solve import solve_load_cases

__all__ = ["Accuracy", "CaseResult", "LineResult", "LoadCase", "LoadCaseTable", "solve_load_cases"]
