"""How many motions begin: rows of the compiled loop from columns of starts, and the rest of a table of constants.

The rule is that of `symosc.engine.start.first_state`; a start that takes more than doubles to decide is left to it.
"""

from __future__ import annotations

from math import cos, sin

from symosc.engine.flow import constant_force, march_constants, march_steps
from symosc.engine.state import ON_BELT
from symosc.kernels._generated import acceleration
from symosc.kernels.entire import EPS, basis

# A force on a belt at the start that is smaller than this part of its terms is looked at with more digits.
CLEAR_FORCE = 1e-9


def march_rows(table, out):
    """Write the constants for marching of each row of a table into `out`, (rows, 2, fields): steps and strides."""
    for i in range(out.shape[0]):
        K = table[i]
        for which in range(2):
            step = march_steps(K)[which]
            entries = march_constants(step, basis(step, K), K)
            for n in range(7):
                out[i, which, n] = entries[n]


def first_rows(table, sets, states):
    """Complete rows of states that have at, theta, x, v and the times; mode 0 is left where doubles do not decide.

    Parameters
    ----------
    table : constants of the parameter sets.
    sets : (n,) the set of each motion.
    states : (n, STATE_WIDTH), updated; `at` is -1 where the belt on which a motion starts is not known.
    """
    for i in range(states.shape[0]):
        at, theta, x, v = int(states[i, 1]), float(states[i, 3]), float(states[i, 4]), float(states[i, 5])
        if at < 0:
            continue
        K = table[sets[i]]
        c = cos(theta)
        if at == 0:
            mode = 1 if v < K.belt1.v else 2 if v < K.belt2.v else 3
            below = acceleration(x, v, c, constant_force(mode, K), K.cm, K.w0sq, K.f0)
            above = below
        else:
            below = acceleration(x, v, c, constant_force(at, K), K.cm, K.w0sq, K.f0)
            above = acceleration(x, v, c, constant_force(at + 1, K), K.cm, K.w0sq, K.f0)
            if min(abs(below), abs(above)) <= CLEAR_FORCE * terms_of_forces(at, x, v, K):
                continue
            mode = at + 1 if above > 0.0 else at if below < 0.0 else ON_BELT + at
            if mode == at + 1:
                below = above
            elif mode == at:
                above = below
        states[i, 0], states[i, 6], states[i, 7] = mode, below, above
        states[i, 16], states[i, 17] = sin(theta), c
        states[i, 8] = (EPS * x) * (EPS * x)
        states[i, 10] = 0.0 if at > 0 else (EPS * v) * (EPS * v)


def terms_of_forces(boundary, x, v, K):
    """Return the size of the terms of the forces on a belt: what their rounding errors are measured by."""
    A = max(abs(constant_force(boundary, K)), abs(constant_force(boundary + 1, K)))
    return A + abs(K.f0) + abs(K.w0sq * x) + abs(K.cm * v)
