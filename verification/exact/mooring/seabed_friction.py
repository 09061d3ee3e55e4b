"""Work of smoothed Coulomb friction on a body that is dragged to and fro, in complete elliptic integrals. SI units."""

from __future__ import annotations

from mpmath import mp, mpf


def work_per_cycle(friction, normal_force, speed, friction_speed, omega):
    """Return the work that friction takes in a period 2 pi / omega, J, as mpf.

    The force is -mu N v / sqrt(v^2 + v_0^2) with v = speed cos(omega t) along a straight line; speed > 0 and v_0 =
    friction_speed >= 0 in m/s, mu = friction, N = normal_force in N constant, omega in rad/s. With
    R = sqrt(speed^2 + v_0^2) the power is mu N (sqrt(v^2 + v_0^2) - v_0^2 / sqrt(v^2 + v_0^2)), whose integral is

        4 mu N / omega (R E(k^2) - v_0^2 / R K(k^2)),   k = speed / R,

    and 4 mu N speed / omega without smoothing.
    """
    V, v0 = mpf(speed), mpf(friction_speed)
    size = 4 * mpf(friction) * mpf(normal_force) / mpf(omega)
    if v0 == 0:
        return size * V
    lost = 2 * max(0, int(mp.log10(v0 / V)) + 1)  # digits by which the two terms cancel where speed is small
    with mp.workdps(mp.dps + lost + 5):
        R2 = V * V + v0 * v0
        k2 = V * V / R2
        integral = mp.sqrt(R2) * mp.ellipe(k2) - v0 * v0 / mp.sqrt(R2) * mp.ellipk(k2)
    return size * integral
