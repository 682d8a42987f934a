"""symosc: exact solutions of the double-belt friction oscillator.

Call sequence, from a scene to its events:

    simulate            simulation.simulate     reads the problem, and asks for more digits where they are needed
      follow_all        engine.batch            the loop, which simulate_many calls too: events and pieces in columns
        advance         engine.next_event       the next event: its kind, the state after it, their errors
          first_exit    engine.first_exit       where a flight meets a belt (in the bounds: gap_bound)
          belt_exit     engine.first_exit       where a stick ends
            basis       kernels                 the closed form, printed by sympy (symbolic.codegen)

The packages, each using only those before it, are listed in `symosc.base.layers`: first what all of
them use, last the commands. The public names are listed in ``__init__.pyi`` and loaded on first use:
importing symosc loads neither sympy nor matplotlib nor numba.
"""

import lazy_loader

__version__ = "0.4.0"

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
