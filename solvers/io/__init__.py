"""Readers of input files: scenes and networks in TOML, MAP++ files."""

from .map_file import read_map_file
from .network_scene import load_network
from .scene import Scene

__all__ = [
    "Scene",
    "load_network",
    "read_map_file",
]
