"""A network of lines in one TOML file.

name = "..."                 optional: description
[environment]                rho = 1025 kg/m^3, g = 9.80665 m/s^2; depth (m): a flat seabed at z = -depth
[[line_types]]               name, EA (N), then submerged_weight (N/m) or diameter (m) + mass_per_length (kg/m)
[[nodes]]                    name, kind = "fixed" | "free" | "coupled", r = [x, y, z] m (of a free node a guess);
                             mass (kg), volume (m^3), force = [x, y, z] N, zero if not given
[[elements]]                 line_type, length (m), anchor and fairlead: names of nodes; friction = 0 on the seabed

Keys are checked by the helpers of ``scene``, which are private to this package.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

from .network import Element, Network, Node
from .outcome import InputError
from .properties import CableProperties, Environment
from .scene import _KEYS, _REQUIRED, _check_keys, _point

_SECTION = ("diameter", "mass_per_length", "submerged_weight")
_KEYS |= {
    "network": {"name", "description", "environment", "line_types", "nodes", "elements"},
}
