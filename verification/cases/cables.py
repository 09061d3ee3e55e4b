"""Cases of the problem type "cable": one line with its water, its ends and its fairlead's motion. Inputs only."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class CableCase:
    """Inputs of solvers.CableProperties, Environment and Motion, SI; the defaults are HB Table 1, at rest.

    Motion: amplitude sin(2 pi f t) + quadrature cos(2 pi f t), (3,) in m, of the frequency f in Hz; None: none.
    """

    name: str
    EA: float = 3.84243e8
    diameter: float = 0.09
    mass_per_length: float = 77.7066
    submerged_weight: float = 698.094
    Cdn: float = 1.6
    Cdb: float | None = None
    Cdt: float = 0.0
    Ca: float = 1.0
    damping: float = 0.0
    length: float = 902.2
    anchor: tuple[float, float, float] = (0.0, 0.0, 0.0)
    fairlead: tuple[float, float, float] = (848.67, 0.0, 250.0)
    rho: float = 1025.0
    current: tuple[float, float, float] = (0.0, 0.0, 0.0)
    depth: float | None = None
    seabed_stiffness: float | None = None
    frequency: float = 0.05
    amplitude: tuple[float, float, float] | None = None
    quadrature: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def turned(self, angle: float) -> CableCase:
        """The case seen from a frame turned about z by -angle, rad: ends, current and motion turn by angle."""
        c, s = math.cos(angle), math.sin(angle)
        turn = lambda v: (c * v[0] - s * v[1], s * v[0] + c * v[1], v[2])
        return replace(
            self,
            name=f"{self.name}, turned",
            anchor=turn(self.anchor),
            fairlead=turn(self.fairlead),
            current=turn(self.current),
            amplitude=None if self.amplitude is None else turn(self.amplitude),
            quadrature=turn(self.quadrature),
        )

    def mirrored(self) -> CableCase:
        """The case seen in a mirror, y -> -y."""
        flip = lambda v: (v[0], -v[1], v[2])
        return replace(
            self,
            name=f"{self.name}, mirrored",
            anchor=flip(self.anchor),
            fairlead=flip(self.fairlead),
            current=flip(self.current),
            amplitude=None if self.amplitude is None else flip(self.amplitude),
            quadrature=flip(self.quadrature),
        )


OC3 = CableCase("OC3 line")
"""HB section 4.1: no seabed, still water."""

SURGE_5 = replace(OC3, name="5 m surge", amplitude=(5.0, 0.0, 0.0))
SURGE_9 = replace(OC3, name="9 m surge", amplitude=(9.0, 0.0, 0.0))
SWAY_5 = replace(OC3, name="5 m sway", amplitude=(0.0, 5.0, 0.0))
HEAVE_5 = replace(OC3, name="5 m heave", amplitude=(0.0, 0.0, 5.0))
TABLE_2 = (SURGE_5, HEAVE_5, SWAY_5)
"""Cases 1 to 3 of HB Table 2; the fourth has two frequencies."""

OC3_SEABED = replace(
    OC3,
    name="OC3 line on the seabed",
    anchor=(-853.87, 0.0, -320.0),
    fairlead=(-5.2, 0.0, -70.0),
    depth=320.0,
    seabed_stiffness=3000.0,
)
SLACK_CHAIN = CableCase(
    "slack chain on a seabed",
    EA=6e8,
    diameter=0.08,
    mass_per_length=110.0,
    submerged_weight=1028.2,
    Cdn=1.4,
    length=400.0,
    anchor=(0.0, 0.0, -80.0),
    fairlead=(370.0, 0.0, -5.0),
    depth=80.0,
    seabed_stiffness=8e3,
    current=(0.4, 0.1, 0.0),
    frequency=1 / 11,
    amplitude=(1.0, 0.0, 0.5),
)
"""Two thirds of it rest; a cell of 25 nodes at the touchdown turns by 0.18 rad."""

SHORT_CHAIN = CableCase(
    "chain of 60 m on a seabed",
    EA=6e8,
    diameter=0.08,
    mass_per_length=110.0,
    submerged_weight=1028.2,
    length=60.0,
    anchor=(-50.0, 0.0, -12.0),
    fairlead=(0.0, 0.0, 0.0),
    depth=12.0,
    seabed_stiffness=1e4,
)
"""On 25 nodes its pretension is off by 5 %, on 50 by 2 %, on 100 by 0.2 %."""

STUDLESS_CHAIN = CableCase(
    "studless chain of a 15 MW turbine",
    EA=3.27e9,
    diameter=0.333,
    mass_per_length=685.0,
    submerged_weight=5842.0,
    Cdn=1.1,
    length=850.0,
    anchor=(-837.6, 0.0, -200.0),
    fairlead=(-58.0, 0.0, -14.0),
    depth=200.0,
    seabed_stiffness=1.75e5,
    frequency=0.2,
    amplitude=(0.0, 0.0, 2.0),
)
"""A heave whose growth over half a period takes the tension away, and over a whole period does not."""

EVERYTHING = replace(
    OC3_SEABED,
    name="every term",
    Cdb=1.2,
    Cdt=0.05,
    damping=0.02,
    current=(0.7, 0.4, 0.1),
    amplitude=(2.0, 1.0, 1.5),
    quadrature=(0.0, 0.8, 1.0),
)
LEVEL = replace(
    EVERYTHING,
    name="every term in the plane",
    current=(0.7, 0.0, 0.1),
    amplitude=(2.0, 0.0, 1.5),
    quadrature=(0.0, 0.0, 1.0),
)
"""Every term of HB (1)-(12) on: nothing symmetric, and all that a plane has."""

PAPER_CASES = {
    "case_1": "Case 1: surge 5 m",
    "case_2": "Case 2: heave 5 m",
    "case_3": "Case 3: sway 5 m",
    "case_4": "Case 4: surge and sway",
    "case_1_large": "Surge 9 m",
}
"""Scene reference_data/scenes/dynamics/hb_<name>.toml -> title: the cases of HB Table 2 and the surge of HB Fig. 4."""
