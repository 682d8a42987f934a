"""A solver as many write it: the sign of each friction force by the velocity."""

from math import copysign, cos

import numpy as np
from scipy.integrate import solve_ivp

m, c, k, A0, B0, Omega = 1, 1, 1, -15, 10, 1
v1, v2, mu1, mu2, FN = 1, 5, 0.8, 0.6, 9.81


def motion(t, state):
    x, v = state
    friction = FN * (mu1 * copysign(1, v - v1) + mu2 * copysign(1, v - v2))
    return v, (A0 + B0 * cos(Omega * t) - k * x - c * v - friction) / m


t = np.linspace(0, 40, 2000)
found = solve_ivp(motion, (0, 40), (0, 0), t_eval=t)
table = np.column_stack([t, *found.y])
np.savetxt("run.csv", table, delimiter=",", header="t,x,v", comments="")
