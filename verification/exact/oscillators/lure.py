"""Period doubling of Lur'e's system to any number of digits, by Taylor series and shooting.

    x' = y,  y' = z,  z' = -alpha z - y - x + x^2

An example of MatCont and of BifurcationKit. The system has no driving, so the orbit starts where x is largest, y = 0,
and its period T is unknown: with the start x, z and alpha four unknowns, for x, y, z that close and det(M + 1) = 0 of
the monodromy matrix M. No harmonic balance enters.
"""

from __future__ import annotations

from mpmath import eye, matrix, mp, mpf

GUARD_DIGITS = 10
STEPS = 40  # of a period, each a series
MOST_NEWTON = 12


def doubling(x, z, period, alpha, digits=15):
    """Return (alpha, omega) at the period doubling near an orbit from (x, 0, z), as mpf.

    Raises ValueError where Newton's method does not converge.
    """
    with mp.workdps(digits + GUARD_DIGITS):
        unknowns, h = matrix([x, z, period, alpha]), mpf(10) ** (-(digits + GUARD_DIGITS) // 2)
        for _ in range(MOST_NEWTON):
            value = _conditions(unknowns, digits + GUARD_DIGITS)
            slope = matrix(4, 4)
            for j in range(4):
                moved = unknowns.copy()
                moved[j] += h
                slope[:, j] = (_conditions(moved, digits + GUARD_DIGITS) - value) / h
            step = mp.lu_solve(slope, value)
            unknowns -= step
            if mp.norm(step) < mpf(10) ** (-digits):
                return unknowns[3], 2 * mp.pi / unknowns[2]
        raise ValueError(f"no period doubling near alpha = {alpha}")


def _conditions(unknowns, order):
    """Return what must vanish: the orbit's ends less its start, and det(M + 1)."""
    x0, z0, period, alpha = unknowns
    state, M = (x0, mpf(0), z0), eye(3)
    for _ in range(STEPS):
        state, flow = _series_step(state, alpha, period / STEPS, order)
        M = flow * M
    return matrix([state[0] - x0, state[1], state[2] - z0, mp.det(M + eye(3))])


def _series_step(state, alpha, h, order):
    """Return the state after a step, and the matrix of its derivatives by the state before it."""
    x, y, z = ([value] for value in state)
    columns = [[[mpf(int(i == j))] for i in range(3)] for j in range(3)]
    product = lambda p, q, n: mp.fdot(p[: n + 1], q[n::-1])
    for n in range(order):
        square, twice = product(x, x, n), [2 * product(x, dx, n) for dx, _, _ in columns]
        rates = [(y[n], z[n], -alpha * z[n] - y[n] - x[n] + square)]
        rates += [
            (dy[n], dz[n], -alpha * dz[n] - dy[n] - dx[n] + s) for (dx, dy, dz), s in zip(columns, twice, strict=True)
        ]
        for series, rate in zip([(x, y, z), *columns], rates, strict=True):
            for part, value in zip(series, rate, strict=True):
                part.append(value / (n + 1))
    at_end = lambda series: mp.fsum(a * h**n for n, a in enumerate(series))
    flow = matrix(3, 3)
    for j, column in enumerate(columns):
        for i in range(3):
            flow[i, j] = at_end(column[i])
    return tuple(at_end(series) for series in (x, y, z)), flow
