"""Andrews' squeezing mechanism as the IVP test set states it: seven angles, six constraints, integrated here.

M(q) q̈ = f(q, q̇) − Gᵀλ with g(q) = 0; λ from G q̈ = −Ġ q̇. An oracle that shares nothing with kinform. The
published end values satisfy G q̇ = 0 to 1e-9 only; those found here are converged to 1e-12.
"""

from __future__ import annotations

import numpy as np
from numpy import cos, sin
from scipy.integrate import solve_ivp

XC, YC, XB, YB = 0.014, 0.072, -0.03635, 0.03273
D, DA, E, EA, RR, SS = 0.028, 0.0115, 0.02, 0.01421, 0.007, 0.035
SA, SB, SC, SD, U, ZF, ZT, FA = 0.01874, 0.01043, 0.018, 0.02, 0.04, 0.02, 0.04, 0.01421
M2, M4, M6 = 0.00365, 0.00706, 0.00706


def constraints(q):
    """G = ∂g/∂q (6, 7); complex q gives derivatives."""
    b, t, g, p, d, o, e = q
    out = np.zeros((6, 7), dtype=q.dtype)
    for row in (0, 2, 4):
        out[row, :2] = -RR * sin(b) + D * sin(b + t), D * sin(b + t)
        out[row + 1, :2] = RR * cos(b) - D * cos(b + t), -D * cos(b + t)
    out[0, 2], out[1, 2] = -SS * cos(g), -SS * sin(g)
    out[2, 3:5] = -E * cos(p + d), -E * cos(p + d) + ZT * sin(d)
    out[3, 3:5] = -E * sin(p + d), -E * sin(p + d) - ZT * cos(d)
    out[4, 5:] = ZF * sin(o + e), ZF * sin(o + e) - U * cos(e)
    out[5, 5:] = -ZF * cos(o + e), -ZF * cos(o + e) - U * sin(e)
    return out


def inertia_and_forces(q, v):
    """M (7, 7) and f (7,)."""
    _, t, g, p, _, o, _ = q
    bp, tp, _, pp, dp, op, ep = v
    m, arm4, arm6 = np.zeros((7, 7)), E - EA, ZF - FA
    m[0, 0] = 0.04325 * 0.00092**2 + M2 * (RR**2 - 2 * DA * RR * cos(t) + DA**2) + 2.194e-6 + 4.410e-7
    m[1, 0] = m[0, 1] = M2 * (DA**2 - DA * RR * cos(t)) + 4.410e-7
    m[1, 1] = M2 * DA**2 + 4.410e-7
    m[2, 2] = 0.02373 * (SA**2 + SB**2) + 5.255e-6
    m[3, 3] = M4 * arm4**2 + 5.667e-7
    m[4, 3] = m[3, 4] = M4 * (arm4**2 + ZT * arm4 * sin(p)) + 5.667e-7
    m[4, 4] = M4 * (ZT**2 + 2 * ZT * arm4 * sin(p) + arm4**2) + 0.0705 * (0.02308**2 + 0.00916**2)
    m[4, 4] += 5.667e-7 + 1.169e-5
    m[5, 5] = M6 * arm6**2 + 5.667e-7
    m[6, 5] = m[5, 6] = M6 * (arm6**2 - U * arm6 * sin(o)) + 5.667e-7
    m[6, 6] = M6 * (arm6**2 - 2 * U * arm6 * sin(o) + U**2) + 0.05498 * (0.01228**2 + 0.00449**2)
    m[6, 6] += 5.667e-7 + 1.912e-5
    x, y = SD * cos(g) + SC * sin(g) + XB - XC, SD * sin(g) - SC * cos(g) + YB - YC
    pull = -4530.0 * (np.hypot(x, y) - 0.07785) / np.hypot(x, y)
    f = [
        0.033 - M2 * DA * RR * tp * (tp + 2 * bp) * sin(t), M2 * DA * RR * bp**2 * sin(t),
        pull * (x * (SC * cos(g) - SD * sin(g)) + y * (SD * cos(g) + SC * sin(g))),
        M4 * ZT * arm4 * dp**2 * cos(p), -M4 * ZT * arm4 * pp * (pp + 2 * dp) * cos(p),
        -M6 * U * arm6 * ep**2 * cos(o), M6 * U * arm6 * op * (op + 2 * ep) * cos(o),
    ]  # fmt: skip
    return m, np.array(f)


def solve(q, v):
    """Accelerations (7,) and multipliers (6,)."""
    m, f = inertia_and_forces(q, v)
    G = constraints(q)
    turn = np.imag(constraints(q + 1e-30j * v) @ v) / 1e-30
    both = np.linalg.solve(np.block([[m, G.T], [G, np.zeros((6, 6))]]), np.concatenate([f, -turn]))
    return both[:7], both[7:]


def end(start, t=0.03):
    """q, q̇ and λ at time t, from rest at q = start."""
    run = solve_ivp(
        lambda _, y: np.concatenate([y[7:], solve(y[:7], y[7:])[0]]), (0, t), np.concatenate([start, np.zeros(7)]),
        method="DOP853", rtol=1e-13, atol=1e-15,
    )  # fmt: skip
    q, v = run.y[:7, -1], run.y[7:, -1]
    return q, v, solve(q, v)[1]
