"""A solver as many write it: the sign of each friction force by the velocity."""

from math import copysign, cos

import numpy as np
from scipy.integrate import solve_ivp

m = 1
c = 1
k = 1
A0 = -15
B0 = 10
Omega = 1
v1 = 1
v2 = 5
mu1 = 0.8
mu2 = 0.6
FN = 9.81


def motion(t, state):
    x, v = state
    friction = FN * (mu1 * copysign(1, v - v1) + mu2 * copysign(1, v - v2))
    return v, (A0 + B0 * cos(Omega * t) - k * x - c * v - friction) / m


t = np.linspace(0, 40, 2000)
found = solve_ivp(motion, (0, 40), (0, 0), t_eval=t)
table = np.column_stack([t, *found.y])
np.savetxt("run.csv", table, delimiter=",", header="t,x,v", comments="")
