"""What the paper's Figs. 5 to 10 show: how long the motion is followed, where its text puts dots and black curves."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from math import pi

import numpy as np
from scipy.optimize import minimize_scalar

from symosc.plot.figures import default_end
from symosc.plot.panels import END_COLOR, ONSET_COLOR, SWITCH_COLOR, Contact, Mark, View, view_of
from symosc.scenes import load_scene
from symosc.simulation.simulate import simulate

# Fig. 7 shows a little more than the first period, its panel (c) several; Figs. 9 and 10 a little more than two.
FIRST_PERIOD, SEVERAL_PERIODS, TWO_PERIODS = 1.25, 4.0, 2.2
# How far the black curves of Figs. 7 and 8 reach beyond the points that the text names, as fractions of both axes.
LONG_REACH = 0.25, 0.35
# The close-up of a stick shows this part of its length on either side of it.
MARGIN = 1.2
# An orbit is shown for this part of a period longer than one, on either side.
LEAD = 0.06
CROP_POINTS = 200


def period(name: str) -> float:
    """Return the period of the excitation of a scene."""
    return 2 * pi / float(load_scene(name).parameters.Omega)


def printed_scene(name: str) -> str:
    """Return the name of the scene as the paper prints it, of which scene `name` is a correction."""
    return name.partition("-")[0]


def start_time(name: str) -> float:
    """Return t0 of a scene."""
    return float(load_scene(name).t0)


@lru_cache
def stick_view(name: str) -> View:
    """Return what Figs. 5 and 6 show."""
    return view_of(simulate(name, t_end=default_end(load_scene(name))), None)


@lru_cache
def several_periods_view(name: str) -> View:
    """Return what Fig. 7(c), (d) show: several periods, start and end of the first one, a contact if there is one."""
    t0, T = start_time(name), period(name)
    view = view_of(simulate(name, t_end=t0 + SEVERAL_PERIODS * T), 1)
    touching = first_contact(view)
    marks = [Mark("start of period", ONSET_COLOR, t0), Mark("end of period", END_COLOR, t0 + T)]
    marks += [] if touching is None else [_contact_mark(touching)]
    contacts = tuple(Contact(mark.t, mark.t, view.boundary) for mark in marks)
    return replace(view, marks=tuple(marks), contacts=contacts, magnified=(), belt_reach=LONG_REACH)


def first_period_view(name: str) -> View:
    """Return what Fig. 7(a), (b) show: a little more than the first period, with an inset of the contact."""
    view = several_periods_view(name)
    touching = first_contact(view_of(view.trajectory, 1))
    cut = crop(view, start_time(name), start_time(name) + FIRST_PERIOD * period(name))
    return replace(cut, magnified=() if touching is None else (touching,))


@lru_cache
def grazing_view(name: str) -> View:
    """Return what Fig. 8 shows: a red contact with belt 1, later a stick on it."""
    view = view_of(simulate(name, t_end=default_end(load_scene(printed_scene(name)))), 1)
    touching, stick = first_contact(view), later_stick(view)
    assert touching is not None
    marks = (
        view.marks[0],
        _contact_mark(touching),
        Mark("onset of stick", ONSET_COLOR, stick.since),
        Mark("end of stick", END_COLOR, stick.until),
    )
    return replace(view, marks=marks, contacts=(touching, stick), magnified=(touching,), belt_reach=LONG_REACH)


def stick_close_up(name: str) -> View:
    """Return what Fig. 8(c) shows: the stick that follows the graze."""
    view = grazing_view(name)
    stick = later_stick(view)
    reach = MARGIN * (stick.until - stick.since)
    return crop(replace(view, magnified=()), stick.since - reach, stick.until + reach)


def crop(view: View, since: float, until: float) -> View:
    """Return the part of a view between two times, sampled anew."""
    inside = view.t[(since < view.t) & (view.t < until)]
    t = np.union1d(inside, np.linspace(since, until, CROP_POINTS))
    x, v = view.trajectory(t)
    return replace(view, t=t, x=x, v=v, marks=tuple(mark for mark in view.marks if since <= mark.t <= until))


def first_contact(view: View) -> Contact | None:
    """Return the graze, or the short stick that a start of a few digits makes of it; None if nothing is touched."""
    return min(view.contacts, key=lambda contact: contact.since, default=None)


def later_stick(view: View) -> Contact:
    """Return the stick that follows the graze in Fig. 8."""
    return max(view.contacts, key=lambda contact: contact.since)


def largest_velocity(view: View) -> tuple[float, float]:
    """Return when the velocity between the ends of a view is largest, and how large."""
    guess, step = view.t[np.argmax(view.v)], 2 * pi / float(view.trajectory.parameters.Omega) / 60
    bounds = max(guess - step, view.t[0]), min(guess + step, view.t[-1])
    found = minimize_scalar(lambda t: -view.trajectory(t)[1], bounds=bounds, method="bounded")
    return float(found.x), -float(found.fun)


def _contact_mark(contact: Contact) -> Mark:
    return Mark("grazing point" if contact.until == contact.since else "contact", SWITCH_COLOR, contact.since)


@lru_cache
def motion_view(name: str) -> View:
    """Return what Figs. 9 and 10 show with the printed start."""
    return view_of(simulate(name, t_end=start_time(name) + TWO_PERIODS * period(name)), None)


@lru_cache
def orbit_view(name: str) -> View:
    """Return one period of the periodic orbit (scene `name`) and a little more, around the printed start's time."""
    t0, T = start_time(name), period(name)
    since = start_time(printed_scene(name)) - LEAD * T
    # The orbit's own scene starts at a switching; with the period it is known at any time.
    x, v = simulate(name, t_end=t0 + 2 * T)(since + T)
    view = view_of(simulate(load_scene(name).parameters, t0=since, x0=x, v0=v, t_end=since + (1 + 2 * LEAD) * T), None)
    return replace(view, marks=view.marks[1:])
