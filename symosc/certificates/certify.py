"""`certify`: hand over a scene, get a proof."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from symosc.certificates.certificate import Certificate
from symosc.certificates.trajectory import EXACT, ToProve, prove_trajectory
from symosc.errors import ParameterError
from symosc.exact import read_start_error
from symosc.scenes import Scene, load_scene


def certify(what: Scene | str | Path, *, t_end: Any = None, start_error: Any = None) -> Certificate:
    """Prove a motion: every event until t_end, that it is the next one, of its kind, and what follows it.

    Nothing is taken from a simulation. All numbers are enclosed by balls (python-flint); the precision is raised until
    everything is decided, or a limit is reached.

    Parameters
    ----------
    what : Scene, str or Path
        A scene, the name of one, or the path of a TOML file.
    t_end : number, optional
        End in place of the scene's.
    start_error : number or three numbers, optional
        Half-widths to which t0, x0 and v0 are known; one number serves for all. None: those of the scene, or exact.
        Then the proof is for every start within them. Where a contact may be a graze it is for some of them: one that
        grazes.

    Returns
    -------
    Certificate
        With ``proven`` False where something stays open; ``message`` says what and where.

    Raises
    ------
    ParameterError
        If a number is not one, or t_end is not later than t0.
    SceneError
        If there is no such scene.
    MissingExtraError
        Without python-flint.

    Examples
    --------
    >>> from symosc import certify
    >>> certificate = certify("fig5", t_end=7)
    >>> certificate.proven, certificate.message
    (True, '5 events until t = 7')
    >>> [event[0] for event in certify("fig7-exact").events]
    ['graze']
    """
    if isinstance(what, str | Path):
        what = load_scene(what)
    if not isinstance(what, Scene):
        raise ParameterError("what", what, "give a Scene, the name of a scene, or the path of a TOML file")
    scene = what if t_end is None else what.started({"t_end": t_end})
    if start_error is not None:
        scene = replace(scene, start_error=start_error)
    errors = read_start_error(scene.start_error) or EXACT
    return prove_trajectory(ToProve(scene.parameters, (scene.t0, scene.x0, scene.v0), errors, scene.t_end))
