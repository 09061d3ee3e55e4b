"""Readers of input files: scenes and networks in TOML, motions in CSV, MAP++ files."""

from .map_file import read_map_file
from .motion_file import load_body_motion
from .network_scene import load_network
from .scene import Scene

__all__ = [
    "Scene",
    "load_body_motion",
    "load_network",
    "read_map_file",
]
