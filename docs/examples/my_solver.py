"""A solver as many write it: an integrator, and the sign of the friction by the velocity."""

from math import copysign, cos

import numpy as np
from scipy.integrate import solve_ivp

m, c, k, A0, B0, Omega, v1, v2, mu1, mu2, FN = 0.1, 0.2, 3, -2, 9, 4, 1, 25, 0.3, 0.2, 10


def motion(t, state):
    x, v = state
    friction = FN * (mu1 * copysign(1, v - v1) + mu2 * copysign(1, v - v2))
    return v, (A0 + B0 * cos(Omega * t) - k * x - c * v - friction) / m


t = np.linspace(0.1324, 6, 400)
found = solve_ivp(motion, (t[0], t[-1]), (4.5447, 1), t_eval=t)
np.savetxt("run.csv", np.column_stack([t, *found.y]), delimiter=",", header="t,x,v", comments="")
