"""The part of the chapter on certificates that is about motions of any number of periods."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from symosc.derive.blocks import block, proof
from symosc.derive.steps import Heading, Prose


def settled_motions() -> Iterator[Any]:
    """Yield why one period of a box of motions proves the events of all later ones."""
    yield Heading("Motions that settle: any number of periods")
    yield Prose(
        r"Carried from event to event, an enclosure says something of some thousand periods. One that settles on an "
        r"orbit is enclosed for ever. Let $P$ be the map from an arrival at a belt, with its time and position, to the "
        r"same arrival some periods later, less these periods. Let $B$ be the box of all $y$ with "
        r"$|y_i - c_i| \le e_i$, and let the entries of $D$ contain the derivatives of $P$ over $B$. All three are "
        r"balls: the events of all motions from $B$ are proven as those of one motion are "
        r"(Lemma~\ref{thm:certificates-steps}), and $D$ is the product of the Jacobians of their maps."
    )
    yield from block(
        "proposition",
        r"Let every motion from $B$ have the events of one word, and let $P(B) \subset B$. Then every motion that "
        r"comes into $B$ has the events of this word in every later period, at the phases and positions of the first "
        r"one's enclosures. If also $q = \max_i \sum_j |D_{ij}|\, e_j/e_i < 1$, there is one orbit that "
        r"passes $B$ once in every turn, and $n$ turns later a motion is within $2 q^n e_i$ of it.",
        title="a motion that settles",
        label="thm:certificates-settled",
    )
    yield from proof(
        r"The first part is induction: a motion in $B$ has these events and comes into $B$ again. For the second let "
        r"$\|y\| = \max_i |y_i|/e_i$. By the mean value theorem $|P(a) - P(b)|_i \le \sum_j |D_{ij}|\,|a_j - b_j| "
        r"\le q\, e_i\, \|a - b\|$ for all $a$, $b$ in $B$, which is convex. So $P$ is a contraction of the complete "
        r"set $B$ into itself, and Banach's theorem gives one fixed point $y^*$. Two points of $B$ have "
        r"$\|a - b\| \le 2$, hence $\|P^n(a) - y^*\| \le 2 q^n$."
    )
    yield Prose(
        r"So the last events of a motion of $10^5$ periods are known to as many digits as are asked for: "
        r"the orbit is enclosed by Theorem~\ref{thm:certificates-krawczyk}, and $2 q^n$ is added. The checker "
        r"follows $B$ once round with exponentials of matrices, and judges $q$ anew."
    )
