"""`certify`: the proof of a motion, an orbit, a branch or a window.

What proposes and proves is loaded on demand.

`symosc.certify` therefore exists even without python-flint: `from symosc import *` and completion
need no extra.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from symosc.base.aliases import NumberLike, SceneName, StartError
from symosc.base.arguments import (
    FLAG,
    NAMES,
    NUMBER,
    SCENE_NAME,
    START_ERROR,
    WHOLE,
    function_of,
    public,
    require,
    require_or_none,
)
from symosc.base.errors import ParameterError
from symosc.base.exact import read_digits, read_start_error
from symosc.certificates.atlas import Atlas
from symosc.certificates.certificate import Certificate, confirmed
from symosc.grazing.window import GrazingWindow
from symosc.model import Model, Oscillator, Parameters
from symosc.orbits.branch import Branch
from symosc.orbits.closing_equations import ConvergenceError
from symosc.orbits.find import find_orbit, is_of_paper
from symosc.orbits.followed_orbit import FollowedOrbit
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.scenes import Scene, from_rest, model_of, passed, scene_of
from symosc.simulation.tangents import read_wrt
from symosc.words import Word, of_belts

#: Omega t from which on a motion is first tried to be proven by the orbit on which it settles.
LONG_MOTION = 6000
#: The most digits of enclosures that may be asked for.
MOST_DIGITS = 500


@public
def certify(
    what: Scene | Model | SceneName | PeriodicOrbit | Branch | GrazingWindow | Atlas,
    *,
    t_end: NumberLike | None = None,
    start_error: StartError | None = None,
    digits: int | None = None,
    wrt: str | Sequence[str] | None = None,
    progress: Callable[[float], None] | bool | None = None,
) -> Certificate:
    """Prove when, where and of what kind every event up to t_end is, and that none is missing.

    The friction law may be any: static friction, curves, any number of belts. Or prove an orbit: it
    exists, is the only one in a box and has its word; its multipliers are enclosed. Or prove a
    branch: there is such an orbit for every value of its parameter, up to where the branch ends. Or
    prove a grazing window, for all phases. A motion of a thousand periods is proven to settle on an
    orbit (kind "settled") if its scene names the word of that orbit as its structure: from some
    event on, a cycle of events repeats.

    The engine proposes the enclosures: what it computes in many digits, with a radius. The checker
    (`symosc verify`) proves them by ball arithmetic (python-flint) and uses nothing of the engine.

    Parameters
    ----------
    what : Scene, str, Path, Parameters, Oscillator, PeriodicOrbit, Branch, GrazingWindow or Atlas
        A scene, the name of one, or the path of a TOML file; Parameters or an Oscillator, from rest
        until `t_end`. Or what `symosc.find_orbit`, `symosc.continue_orbit` or `symosc.grazing_window` returns.
    t_end : number, optional
        End in place of the scene's.
    start_error : number or three numbers, optional
        Half-widths to which t0, x0, v0 are known; one number serves for all. None: those of the
        scene, or exact. The proof is for every start within them; where a contact may be a graze
        for some of them: one that grazes.
    digits : int, optional
        Digits of a scene's enclosures; default 25, and more where events are closer to each other.
    wrt : str or sequence of str, optional
        Names of parameters, and t0, x0, v0: the derivatives of all events by them are enclosed too.
        For exact starts, motions without a graze, and at most two Coulomb belts.
    progress : bool or callable, optional
        For a branch. True: a bar on stderr, on a terminal. Or a function of the part of it that is
        proven.

    Returns
    -------
    Certificate
        With ``proven`` False where something stays undecided; ``message`` says what and where.

    Raises
    ------
    ParameterError
        If a number is not one, or t_end is not later than t0; or if the friction law is another
        than that of at most two Coulomb belts, where only these can be proven.
    SceneError
        If there is no such scene.
    MissingExtraError
        Without python-flint.

    Examples
    --------
    >>> from symosc import certify, find_orbit, load_scene
    >>> certify("fig5", t_end=7).message
    '5 events until t = 7'
    >>> certify(find_orbit(load_scene("fig9").parameters, "P32")).points[0][0]
    ('0.181670397924320463014137', '0.18167039792432046301414')
    >>> dt, dx = certify("fig5", t_end=1, wrt="mu1").derivatives[0]
    >>> dt[0][0][:12]
    '-0.148289299'

    Static friction, which begins slips with a jump of the force:

    >>> from symosc import Belt, Oscillator
    >>> stick_slip = Oscillator(m=1, c=0, k=1, belts=[Belt("1/5", mu="1/2", mu_s=1)])
    >>> certify(stick_slip, t_end=14).events[0][:3]
    ('stick', 'Omega1', 'belt1')
    """
    of_orbits = (PeriodicOrbit, Branch, GrazingWindow, Atlas)
    require(Scene, Parameters, Oscillator, SCENE_NAME, *of_orbits, what=what)
    require_or_none(NUMBER, t_end=t_end)
    require_or_none(*START_ERROR, start_error=start_error)
    require_or_none(WHOLE, digits=digits)
    require_or_none(*NAMES, wrt=wrt)
    require_or_none(function_of(1), FLAG, progress=progress)
    given = passed(what)
    if isinstance(what, Scene | Model | str | Path):
        what = scene_of(what, "what", any_law=True)
        if is_of_paper(model_of(what)):
            what = scene_of(what, "what")
    if isinstance(what, Model):
        if t_end is None:
            raise ParameterError("t_end", None, f"t_end is required when you pass {given}")
        what = from_rest(what, t_end)
    import symosc.certificates.balls  # noqa: F401  says so if python-flint is not installed

    if isinstance(what, Scene):
        return _motion(what, t_end, start_error, digits, () if wrt is None else read_wrt(wrt))
    for name, value in (
        ("t_end", t_end),
        ("start_error", start_error),
        ("digits", digits),
        ("wrt", wrt),
    ):
        if value is not None:
            raise ParameterError(
                name, value, f"{name} applies to a scene only, not to a {type(what).__name__}"
            )
    if isinstance(what, FollowedOrbit):
        from symosc.certificates.propose_law_orbits import certify_law_orbit

        return certify_law_orbit(what)
    if isinstance(what, PeriodicOrbit):
        from symosc.certificates.propose_orbits import certify_orbit

        # Certificates are about two belts, of which the second one may never be met.
        labels = of_belts(Word(what.labels), 2).labels
        return certify_orbit(what.parameters.parameters, labels, what.periods, what.points)
    if isinstance(what, Branch):
        from symosc.certificates.propose_orbits import certify_branch

        return certify_branch(what, progress)
    if isinstance(what, Atlas):
        if not what.boxes:
            return Certificate(
                "atlas", False, "nothing is proven in it", statement=what.statement()
            )
        return confirmed("atlas", what.statement())
    from symosc.certificates.propose_orbits import certify_window

    return certify_window(what)


def _motion(
    scene: Scene, t_end: Any, start_error: Any, digits: Any, wrt: tuple[str, ...]
) -> Certificate:
    """Prove a scene's motion event by event, or by the orbit on which it settles.

    Other arguments as in `certify`.
    """
    from symosc.certificates.propose import (
        DIGITS,
        EXACT,
        ToProve,
        certify_motion,
        certify_settled,
    )

    if t_end is not None:
        scene = scene.started({"t_end": t_end})
    if start_error is not None:
        scene = replace(scene, start_error=start_error)
    errors = read_start_error(scene.start_error) or EXACT
    wanted = read_digits(digits, MOST_DIGITS) or DIGITS
    if wrt:
        _ = scene.parameters.parameters  # only the paper's: the error names belt and property
        if any(errors):
            raise ParameterError("wrt", wrt, "wrt requires a start that is known exactly")
    task = ToProve(
        scene.parameters, (scene.t0, scene.x0, scene.v0), errors, scene.t_end, wanted, wrt
    )
    # A long motion in a scene with a word may settle on the orbit of this word: then a cycle proves
    # it, event by event it would take too long.
    turned = scene.parameters.Omega * (scene.t_end - scene.t0)
    if is_of_paper(scene.parameters) and not wrt and scene.structure and turned > LONG_MOTION:
        with suppress(ConvergenceError):  # there is no such orbit
            settled = certify_settled(task, find_orbit(scene.parameters, scene.structure))
            if settled.proven:
                return settled
    return certify_motion(task)
