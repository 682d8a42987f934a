"""Proofs: what `simulate` computes to a tolerance, here enclosed and proven (extra ``certify``: python-flint).

How the pieces fit, from below:

    balls        exact numbers as balls, certain signs, `Undecided`, decimals rounded outward
    flow         the motion in one domain, enclosed: v, its derivatives, x, and E, E', phi (sensitivities)
    turns        the times where the drift of a belt changes its sign (Theta_cr)
    contact      the first zero of the gap to a belt: pieces between turns, where g/phi is convex or concave
    stick        both exits of a stick, by monotone pieces
    sets         sets of states, carried on by a Jacobian and an orthogonal frame: no growth by wrapping
    circles      exact touches without damping and drive, by an identity of rational numbers
    motion       `begin`, `next_event`: Theorems 4 and 5 on enclosures; sets of (t, x) from event to event
    graze        a touch, as a statement about some start within the start's error
    trajectory   all events up to t_end, with as many bits as it takes
    closing      the closing equations of an orbit, Krawczyk's proof of one root
    course       that an orbit takes the course of its word, by steps that need no turns
    multipliers  enclosed; whether they are inside the unit circle
    orbit        an orbit: exists, alone in a box, word, stability
    orbit_list   the orbits of orbits.csv, proven in processes; collect made the list
    family       one root for every value of a parameter, about a curve
    branch, ends a branch of orbits up to its ends
    window       a grazing window, for all phases
    settled      a motion that settles on an orbit: any number of periods by one of them
    known        the events of a scene as a reference, proven or why not
    certificate  `Certificate` and its JSON
    verify       proves motions and windows again by other means; one file that needs nothing of symosc
    verify_orbits  the same for orbits and branches; needs verify.py only

Another kind of proof builds on `motion`: `next_event` takes a `Moving` (a mode and a set of (t, x), as wide as wanted)
and returns the proven event and the set after it; `contact_jacobian` has the derivatives of a flight's end, and
`StateSet` carries them. `Undecided` says what is open, and a `touch` where it may be one. Parameters are exact in
`flow.Oscillator` and `turns.Turns`: whether a motion is underdamped, resonant or has turns is decided in rationals. A
family over a parameter may pass through critical damping, where entire functions take over, but not through resonance.
Its file has the same "format" and its own "kind", for which `verify.KINDS` names what proves it and `verify.SHAPES`
what it looks like; there `Motion.behind` gives the motion after a stated event with the derivatives of all starts
(`columns`). `certificate.confirmed` asks the checker before a certificate says that it is proven.

What is not proven, and says so: touches from exact starts with damping or drive (double zeros), forces that are exactly
0 where they turn, motions of more than MOST_PROVEN_EVENTS events that settle on no orbit.

The package may import orbits, grazing, simulation and what is below them; plot, bench, paper and cli may import it.
"""
