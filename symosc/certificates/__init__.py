"""Proofs: the events that `simulate` computes to a tolerance, enclosed and proven (extra
``certify``: python-flint).

Modules, lowest layer first:

    balls           exact numbers as balls, certain signs, `Undecided`, decimals rounded outward; sets of states
    flow            the motion in one mode, enclosed; where the drift of a belt changes its sign (Theta_cr)
    motion          `begin`, `next_event`: the first zero of the gap to a belt, both exits of a stick; exact grazes
    orbit           an orbit: one root of its closing equations, the course of its word, its multipliers
    trajectory      all events up to t_end, and their derivatives; a graze of some start within its error; a motion that
                    settles on an orbit: any number of periods by one of them
    branch          a branch of orbits up to its ends, by families of roots about a curve
    window          a grazing window, for all phases
    certificate     `Certificate` and its JSON
    certify         `certify`; the events of a scene as a reference
    verify          proves motions and windows again by other means; one file, independent of symosc
    verify_orbits   the same for orbits, branches and atlases; needs verify.py only
    plane           a box of two parameters: one word for all of them
    atlas           `atlas`: a plane of two parameters, its words, borders, and proven boxes

Another kind of proof builds on `motion`: `next_event` takes a set of states (`Moving`) and returns
the proven event and the set after it, or raises `Undecided`. `verify.KINDS` names what proves a
kind of file again, and `verify.SHAPES` its shape. A family over a parameter may pass through
critical damping, but not through resonance.

Not proven, and reported as such: grazes from exact starts with damping or drive (double zeros),
forces that are exactly 0 where they turn, motions of more than MOST_PROVEN_EVENTS events that
settle on no orbit.
"""
