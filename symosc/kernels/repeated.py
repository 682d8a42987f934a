"""Entire functions for derivatives by parameters: divided differences of exp over repeated nodes.

With the characteristic roots l1, l2 and e[...] the divided differences of z -> exp(z tau)

    U1 = e[l1, l1, l2, l2],   U0 = dU1/dtau,   U2 = e[0, l1, l1, l2, l2]
    V + i W = e[i Omega, l1, l1, l2, l2],      P + i Q = e[i Omega, i Omega, l1, l2]

(`symosc.symbolic.maps` derives what they are good for). One rule is good in every regime, at resonance and for short
times. If the pair of nodes that are farthest apart are at least FAR_NODES / tau apart, it is the difference over that
pair, otherwise the Taylor series about the nodes' centre. A difference over a far pair loses at most a few bits, and a
series over near nodes none.

The functions run on floats, and with other globals (`symosc.mappings.equations`) on mpmath numbers.
"""

from __future__ import annotations

from cmath import exp

from symosc.kernels.entire import EPS

# Nodes farther apart than this, times tau, are told apart by a difference.
FAR_NODES = 3.0
# All nodes nearer to 0 than this, times tau: a series about 0 keeps small imaginary parts to their own size.
NEAR_ZERO = 0.5


def repeated(tau, K):
    """Return U0, U1, U2, V, W, P, Q at `tau` >= 0 for the constants `K` (`symosc.engine.flow.Constants`)."""
    if K.under:
        l1, l2 = complex(-K.h, K.omega_d), complex(-K.h, -K.omega_d)
    else:
        l1, l2 = complex(K.l1), complex(K.l2)
    drive = complex(0.0 * K.Om, K.Om)
    known: dict[tuple[complex, ...], complex] = {}
    U1 = divided_difference((l1, l1, l2, l2), tau, known)
    U0 = l1 * U1 + divided_difference((l1, l2, l2), tau, known)  # Leibniz' rule for z exp(z tau)
    U2 = divided_difference((0.0 * l1, l1, l1, l2, l2), tau, known)
    Z = divided_difference((drive, l1, l1, l2, l2), tau, known)
    Y = divided_difference((drive, drive, l1, l2), tau, known)
    return U0.real, U1.real, U2.real, Z.real, Z.imag, Y.real, Y.imag


def divided_difference(nodes, tau, known):
    """Return the divided difference of z -> exp(z tau) over the complex `nodes`, some of which may be equal.

    `known` keeps the differences that have been computed at this `tau`.
    """
    if nodes in known:
        return known[nodes]
    far, first, last = -1.0, 0, 0
    for i in range(len(nodes)):
        for j in range(i):
            gap = abs(nodes[i] - nodes[j])
            if gap > far:
                far, first, last = gap, j, i
    if far * tau < FAR_NODES:
        known[nodes] = series(nodes, tau)
    else:
        without_last = divided_difference(nodes[:last] + nodes[last + 1 :], tau, known)
        without_first = divided_difference(nodes[:first] + nodes[first + 1 :], tau, known)
        known[nodes] = (without_last - without_first) / (nodes[first] - nodes[last])
    return known[nodes]


def series(nodes, tau):
    """Return the divided difference over nodes near each other: sum of h_j / (n + j)! about their centre.

    h_j is the complete homogeneous symmetric polynomial of degree j of the nodes, which are n + 1.
    """
    n = len(nodes) - 1
    centre = 0.0 * nodes[0]
    if max([abs(z) for z in nodes]) * tau > NEAR_ZERO:
        for z in nodes:
            centre = centre + z
        centre = centre / (n + 1)
    offsets = [(z - centre) * tau for z in nodes]
    radius = max([abs(z) for z in offsets])
    scale = exp(centre * tau)
    for i in range(1, n + 1):
        scale = scale * tau / i
    # h_j(z_0 .. z_k) = h_j(z_0 .. z_(k-1)) + z_k h_(j-1)(z_0 .. z_k); `partial` holds h_j n! / (n + j)! by k.
    partial = [1.0 + 0.0 * centre] * (n + 1)
    total = partial[n]
    bound, j = 1.0 + 0.0 * radius, 0
    while bound > EPS:
        j = j + 1
        bound = bound * radius / j  # radius^j / j! bounds the term
        below = 0.0 * centre
        for i in range(n + 1):
            below = below + offsets[i] * partial[i] / (n + j)
            partial[i] = below
        total = total + below
    return scale * total
