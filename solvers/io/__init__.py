"""Readers of input files: scenes and networks in TOML, motions in CSV, MAP++ and MoorDyn files; response curves."""

from .case_file import load_system, read_load_cases
from .curve_file import load_curve, save_curve
from .map_plus_plus.reader import read_map_file
from .map_plus_plus.writer import write_map_file
from .moordyn.reader import load_moordyn
from .moordyn.writer import write_moordyn
from .network_scene import load_network
from .scene import Scene
from .series.motion_file import load_body_motion
from .series.sea_file import load_response_operators, load_spectrum

__all__ = [
    "Scene",
    "load_body_motion",
    "load_curve",
    "load_moordyn",
    "load_network",
    "load_response_operators",
    "load_spectrum",
    "load_system",
    "read_load_cases",
    "read_map_file",
    "save_curve",
    "write_map_file",
    "write_moordyn",
]
