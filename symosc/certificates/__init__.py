"""Proofs: what the engine computes is proposed as enclosures, and the checker proves them (extra
``certify``: python-flint).

Modules, lowest layer first:

    certificate     `Certificate` and its JSON; the checker's verdict on a statement
    corners         the corners of friction curves that a motion passes
    balls           balls, and an oscillator of balls: for plane.py only
    propose         enclosures of motions, of grazes within the error of a start, of motions that settle
    propose_orbits  enclosures of orbits, of branches of orbits up to their ends, of grazing windows
    propose_law_orbits  enclosures of orbits of any friction law
    certify         `certify`: proposes, and returns what the checker says
    verify          the checker of motions and windows; one file, independent of symosc
    verify_orbits   the checker of orbits, branches and atlases; needs verify.py only
    plane           a box of two parameters: one word for all of them
    atlas           `atlas`: a plane of two parameters, its words, borders, and proven boxes

Nothing but the checkers decides what is proven: a wrong proposal is refused. Another kind of proof
is another function of a checker (`verify.KINDS` names what proves a kind of file, `verify.SHAPES`
its shape) and what proposes such a file. A family over a parameter may pass through critical
damping, but not through resonance.

Motions and orbits may have any friction law; all else is for at most two Coulomb belts.

Not proven, and reported as such: grazes from exact starts with damping or drive (double zeros),
touches of a belt with static friction or of a corner,
forces that are exactly 0 where they turn, motions of more than 20,000 events that settle on no
orbit.
"""
