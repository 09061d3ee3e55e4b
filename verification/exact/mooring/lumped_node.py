"""The forces on a node between two cells of a lumped line, written down in mpmath as they are stated.

A cell of unstretched length l between nodes a and b is straight: with chord r_b - r_a, 1 + e = |chord| / l,
tau = chord / |chord| and e' = tau . (v_b - v_a) / l it pulls its ends together with max(EA (e + beta e'), 0). Half of
it belongs to either node, and gives it, with the node's own velocity v and acceleration a,

    inertia   -(l/2) m a                       added mass       -(l/2) ma (a - (a . tau) tau)
    weight    -(l/2) w e_z                     normal drag      -(l/2) rho d Cdn / 2 sqrt(1 + e) |u_n| u_n
    seabed     (l/2) N e_z                     tangential drag  -(l/2) rho pi d Cdt / 2 sqrt(1 + e) |u_t| u_t tau
    friction  -(l/2) mu N v_h / sqrt(v_h . v_h + v_0^2)

with u = v - current, u_t = u . tau, u_n = u - u_t tau, v_h the horizontal part of v, and N = max(k p - c v_z, 0) per
unit length where p = -depth - z > 0. Components are x, y, z with z up, or x, z. SI units.
"""

from __future__ import annotations

from dataclasses import dataclass

from mpmath import mp, mpf


@dataclass(frozen=True)
class Cell:
    """length m, unstretched; EA N; beta s; mass, added_mass kg/m; weight N/m; rho kg/m^3; d m; Cdn, Cdt."""

    length: float
    EA: float
    beta: float = 0.0
    mass: float = 0.0
    added_mass: float = 0.0
    weight: float = 0.0
    rho: float = 0.0
    d: float = 0.0
    Cdn: float = 0.0
    Cdt: float = 0.0


@dataclass(frozen=True)
class Seabed:
    """depth m; stiffness k N/m^2; damping c N s/m^2; friction mu; friction_speed v_0 m/s; contact_depth p_0 m.

    The damping is c min(p / p_0, 1) at penetration p, c with p_0 = 0.
    """

    depth: float
    stiffness: float
    damping: float = 0.0
    friction: float = 0.0
    friction_speed: float = 1.0
    contact_depth: float = 0.0


def force_terms(cells, positions, velocities, acceleration, *, current=(0.0, 0.0, 0.0), seabed=None):
    """Return the forces on the middle one of three nodes in N, by name, each a list of mpf with the components.

    cells : the `Cell` before and the one behind the node;  positions, velocities : of the three nodes, m and m/s
    acceleration : of the middle node, m/s^2;  current : (x, y, z) m/s, without y where there are x, z only
    seabed : `Seabed` or None
    """
    planar = len(acceleration) == 2
    (xa, ya, za), (x, y, z), (xb, yb, zb) = (_spatial(r) for r in positions)
    (ua, va, wa), (u, v, w), (ub, vb, wb) = (_spatial(r) for r in velocities)
    ax, ay, az = _spatial(acceleration)
    cx, cy, cz = (mpf(c) for c in current)
    cy = mpf(0) if planar else cy
    before, behind = cells

    terms = _loads_of_half(before, (x - xa, y - ya, z - za), (u - cx, v - cy, w - cz), (ax, ay, az))
    other = _loads_of_half(behind, (xb - x, yb - y, zb - z), (u - cx, v - cy, w - cz), (ax, ay, az))
    terms = {name: [a + b for a, b in zip(terms[name], other[name], strict=True)] for name in terms}
    pull_a = _pull(before, (x - xa, y - ya, z - za), (u - ua, v - va, w - wa))
    pull_b = _pull(behind, (xb - x, yb - y, zb - z), (ub - u, vb - v, wb - w))
    terms["tension"] = [b - a for a, b in zip(pull_a, pull_b, strict=True)]
    share = mpf(before.length) / 2 + mpf(behind.length) / 2
    terms |= _seabed_forces(seabed, share, z, (u, v, w))
    return {name: [force[0], force[2]] if planar else force for name, force in terms.items()}


def force_residual(cells, positions, velocities, acceleration, **options):
    """Return the sum of `force_terms`, a list of mpf in N: zero where the node's motion is a solution."""
    terms = force_terms(cells, positions, velocities, acceleration, **options).values()
    return [mp.fsum(parts) for parts in zip(*terms, strict=True)]


def _spatial(vector):
    """Return x, y, z as mpf of a vector with components x, y, z or x, z."""
    x, *y, z = (mpf(component) for component in vector)
    return (x, *(y or [mpf(0)]), z)


def _pull(cell, chord, opening):
    """Return the tension times the tangent."""
    x, y, z = chord
    size = mp.sqrt(x * x + y * y + z * z)
    rate = (x * opening[0] + y * opening[1] + z * opening[2]) / size / mpf(cell.length)
    tension = mpf(cell.EA) * (size / mpf(cell.length) - 1 + mpf(cell.beta) * rate)
    if tension <= 0:
        return [mpf(0), mpf(0), mpf(0)]
    return [tension * x / size, tension * y / size, tension * z / size]


def _loads_of_half(cell, chord, relative, acceleration):
    """Return what the half of a cell gives to its node, but the tension."""
    half = mpf(cell.length) / 2
    x, y, z = chord
    size = mp.sqrt(x * x + y * y + z * z)
    tx, ty, tz = x / size, y / size, z / size
    ax, ay, az = acceleration
    a_t = ax * tx + ay * ty + az * tz
    m, ma = half * mpf(cell.mass), half * mpf(cell.added_mass)
    u, v, w = relative
    u_t = u * tx + v * ty + w * tz
    un, vn, wn = u - u_t * tx, v - u_t * ty, w - u_t * tz
    wetted = half * mpf(cell.rho) * mpf(cell.d) / 2 * mp.sqrt(size / mpf(cell.length))
    normal = wetted * mpf(cell.Cdn) * mp.sqrt(un * un + vn * vn + wn * wn)
    along = wetted * mp.pi * mpf(cell.Cdt) * abs(u_t) * u_t
    return {
        "inertia": [-m * ax, -m * ay, -m * az],
        "added mass": [-ma * (ax - a_t * tx), -ma * (ay - a_t * ty), -ma * (az - a_t * tz)],
        "normal drag": [-normal * un, -normal * vn, -normal * wn],
        "tangential drag": [-along * tx, -along * ty, -along * tz],
        "weight": [mpf(0), mpf(0), -half * mpf(cell.weight)],
    }


def _seabed_forces(seabed, share, z, velocity):
    """Return the normal force and the friction on the node that bears `share` metres of line."""
    u, v, w = velocity
    nothing = {"seabed": [mpf(0), mpf(0), mpf(0)], "friction": [mpf(0), mpf(0), mpf(0)]}
    if seabed is None:
        return nothing
    penetration = -mpf(seabed.depth) - z
    if penetration <= 0:
        return nothing
    reached = min(penetration / mpf(seabed.contact_depth), mpf(1)) if seabed.contact_depth else mpf(1)
    normal = share * (mpf(seabed.stiffness) * penetration - mpf(seabed.damping) * reached * w)
    if normal <= 0:
        return nothing
    grip = mpf(seabed.friction) * normal / mp.sqrt(u * u + v * v + mpf(seabed.friction_speed) ** 2)
    return {"seabed": [mpf(0), mpf(0), normal], "friction": [-grip * u, -grip * v, mpf(0)]}
