"""The paper's figures: dots at computed events, insets over what they magnify, nothing over anything else."""

from __future__ import annotations

import re
from functools import cache
from math import pi

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox
from scipy.integrate import solve_ivp

from symosc import find_orbit, load_scene, residual, simulate
from symosc.paper import figures
from symosc.paper.pictures import PICTURES, SEVERAL_PERIODS
from symosc.plot.windows import INSIDE_COLOR
from symosc.words import MAPS

pytestmark = pytest.mark.slow  # draws all figures

WINDOWS = {"theorem7-p2", "theorem7-p3", "theorem7-p5", "theorem7-p6"}
OTHERS = {"fig1", "fig2", "fig3", "fig4", "force-product"} | WINDOWS
COMPUTED = [key for key in PICTURES if key not in OTHERS]
ENDS = {"fig5": 9, "fig6": 5, "fig8": 9, "fig8-exact": 9, "fig9": 3, "fig10": 8}


@cache
def drawn(key: str) -> Figure:
    return PICTURES[key].build()


def number_of(key: str) -> str:
    return key.removeprefix("fig").partition("-")[0]


def dots(ax: Axes, label: str) -> np.ndarray:
    found = [np.column_stack(line.get_data()) for line in ax.lines if line.get_label() == label]
    return np.concatenate(found) if found else np.empty((0, 2))


@pytest.mark.parametrize("key", ["fig5", "fig6", "fig9", "fig10"])
def test_dots_are_at_the_events(key: str) -> None:
    trajectory = simulate(key, t_end=ENDS[key])
    displacement, velocity, phase = drawn(key).axes[:3]
    kinds = {"stick": "onset of stick", "slip": "end of stick", "cross": "crossing"}
    assert trajectory.events
    for event in trajectory.events:
        for ax, place in (
            (displacement, (event.t, event.x)),
            (velocity, (event.t, event.v)),
            (phase, (event.x, event.v)),
        ):
            assert np.abs(dots(ax, kinds[event.kind]) - place).max(axis=1).min() < 1e-12


@pytest.mark.parametrize(("key", "v"), [("fig7-exact", 5), ("fig8-exact", -4)])
def test_exact_starts_graze(key: str, v: float) -> None:
    velocity = drawn(key).axes[1]
    assert dots(velocity, "grazing point") == pytest.approx(np.array([[pi, v]]))
    (inset,) = velocity.child_axes
    curve = inset.lines[0].get_ydata()
    # A tangency: the curve stays on one side of the belt and touches it in one point.
    assert np.abs(curve).min() == pytest.approx(0, abs=1e-9)
    assert np.sum(np.abs(curve) < 1e-9) == 1
    assert (np.sign(v) * np.array(curve) <= 1e-9).all()


@pytest.mark.parametrize("number", ["9", "10"])
def test_orbits_are_closed_and_show_how_far_the_printed_start_is(number: str) -> None:
    drawing, scene = drawn(f"fig{number}-orbit"), load_scene(f"fig{number}")
    orbit = find_orbit(scene.parameters, scene.structure)
    displacement, velocity, phase = drawing.axes[:3]
    t, x = next(line.get_data() for line in displacement.lines if line.get_label() == "mass")
    np.testing.assert_allclose(x, orbit(t)[0], rtol=0, atol=1e-9)
    assert t[-1] - t[0] >= float(orbit.period)
    place = [float(scene.t0), float(scene.x0), float(scene.v0)]
    for ax, (i, j) in ((displacement, (0, 1)), (velocity, (0, 2)), (phase, (1, 2))):
        assert dots(ax, "printed start") == pytest.approx(np.array([[place[i], place[j]]]))
        low, high = ax.get_ylim()
        assert low < place[j] < high
    for inset in phase.child_axes:
        diamonds = [line.get_xydata() for line in inset.lines if line.get_marker() == "D"]
        assert np.array_equal(diamonds, [[place[1:]]])
    assert len(phase.child_axes) == (number == "10")
    named = {"9": ("crossing",), "10": ("onset of stick", "end of stick")}[number]
    switchings = np.concatenate([dots(displacement, name) for name in named])
    for point in orbit.points:
        assert np.abs(switchings - np.array([float(point.t), float(point.x)])).max(axis=1).min() < 1e-9


@pytest.mark.full(4)
@pytest.mark.parametrize("form", ["build", "narrow"])
@pytest.mark.parametrize("key", COMPUTED)
def test_nothing_overlaps(key: str, form: str) -> None:
    drawing = getattr(PICTURES[key], form)()
    drawing.draw_without_rendering()
    assert len({ax.get_subplotspec().colspan.stop for ax in drawing.axes}) == (1 if form == "narrow" else 2)
    boxes = [Bbox(ax.get_tightbbox()) for ax in drawing.axes]
    boxes.append(drawing.legends[0].get_window_extent())
    for i, box in enumerate(boxes):
        assert not any(box.overlaps(other) for other in boxes[i + 1 :])
    page = Bbox([[0, 0], drawing.bbox.size])
    assert all(page.x0 <= box.x0 and box.x1 <= page.x1 and page.y0 <= box.y0 and box.y1 <= page.y1 for box in boxes)
    for ax in drawing.axes:
        for inset in ax.child_axes:
            box = inset.get_tightbbox()
            for line in [line for line in ax.lines if line.get_label() != "belt"]:
                x, y = ax.transData.transform(np.column_stack(line.get_data()).astype(float)).T
                assert not ((box.x0 < x) & (x < box.x1) & (box.y0 < y) & (y < box.y1)).any()


def test_the_caption_of_fig7_has_the_numbers_of_its_flight() -> None:
    """By another integrator, in the domain below belt 1: v at its largest, and the change over the first period."""
    scene, caption = load_scene("fig7"), PICTURES["fig7"].describe().replace("−", "-")
    p = scene.parameters
    m, c, k, B0, Omega, A = map(float, (p.m, p.c, p.k, p.B0, p.Omega, p.A(1)))
    period, t0 = 2 * pi / Omega, float(scene.t0)

    def rates(t: float, y: np.ndarray) -> tuple[float, float]:
        return y[1], (A + B0 * np.cos(Omega * t) - c * y[1] - k * y[0]) / m

    times = np.linspace(t0, t0 + SEVERAL_PERIODS * period, 40_001)
    start = float(scene.x0), float(scene.v0)
    x, v = solve_ivp(rates, (t0, times[-1]), start, "DOP853", times, rtol=1e-12, atol=1e-12).y
    top = int(np.argmax(v))
    change = x[10_000] - x[0], v[10_000] - v[0]
    numbers = re.search(r"velocity is (.*?) at t = (.*?),.* changes by [(](.*?), (.*?)[)]", caption)
    assert numbers
    largest, when, *changes = map(float, numbers.groups())
    assert [largest, *changes] == pytest.approx([v[top], *change], abs=6e-4)
    assert (when - times[top] + period / 2) % period - period / 2 == pytest.approx(0, abs=2e-3)  # it has settled


@pytest.mark.parametrize(
    ("key", "graze", "left_out"), [("theorem7-p3", (-4, 0), (-4, pi / 2)), ("theorem7-p5", None, (5.25, 1.5 * pi))]
)
def test_windows_of_theorem_7(key: str, graze: tuple | None, left_out: tuple) -> None:
    picture = PICTURES[key]
    drawing = picture.build()
    drawing.draw_without_rendering()
    (axes,), (legend,) = drawing.axes, drawing.legends
    assert not Bbox(axes.get_tightbbox()).overlaps(legend.get_window_extent())
    assert axes.get_xlabel() == ("$v_1$" if key == "theorem7-p3" else "$v_2$")
    assert dots(axes, "grazing point") == pytest.approx(np.array([graze] if graze else np.empty((0, 2))))
    # What the theorem leaves out at equality is a full dot, what does not graze there an open one: both are named.
    ends = [line for line in axes.lines if line.get_marker() == "o"]
    grazes, not_grazing = sorted(ends, key=lambda line: line.get_markerfacecolor() == "white")
    assert np.ravel(grazes.get_data()) == pytest.approx(np.array(left_out))
    assert (grazes.get_markerfacecolor(), not_grazing.get_markerfacecolor()) == (INSIDE_COLOR, "white")
    # Equality is where the scene's k |v| is B0 Omega, and the picture shows as much again beyond it.
    p = load_scene({"theorem7-p3": "fig8", "theorem7-p5": "fig10"}[key]).parameters
    assert axes.get_xlim() == pytest.approx((-2 * float(p.B0 * p.Omega / p.k), 2 * float(p.B0 * p.Omega / p.k)))
    assert f"At the full dot, v{1 if graze else 2} = " in picture.describe()
    assert "it grazes, though" in picture.describe()


# --- Figs. 1 to 4 ---

LABELS = {
    "fig1": ["$k$", "$c$", "$m$", "$x$", "$v_1$", "$v_2$", "$F_N$", "belt 1", "belt 2", r"$A_0 + B_0\cos\Omega t$"],
    "fig2": [r"$\Omega_1$", r"$\Omega_2$", r"$\Omega_3$", "friction force $F_f$"],
    "fig3": [r"$\Omega_1$", r"$\Omega_2$", r"$\Omega_3$", r"$\partial\Omega_{12}$", r"$\partial\Omega_{23}$", "$v_1$"],
    "fig4": [f"$P_{number}$" for number in range(1, 9)],
}


@pytest.mark.parametrize("name", LABELS)
def test_drawings_have_their_labels_on_the_page_and_apart(name: str) -> None:
    drawing: Figure = getattr(figures, name)()
    drawing.draw_without_rendering()
    shown = [each for each in drawing.findobj(Text) if isinstance(each, Text) and each.get_visible()]
    boxes = [(each.get_text(), each.get_window_extent()) for each in shown if each.get_text()]
    assert set(LABELS[name]) <= {words for words, _ in boxes}
    page = drawing.bbox
    for number, (words, box) in enumerate(boxes):
        assert page.x0 <= box.x0 < box.x1 <= page.x1, words
        assert page.y0 <= box.y0 < box.y1 <= page.y1, words
        assert not [other for other, further in boxes[number + 1 :] if box.overlaps(further)], words


def test_fig3_marks_where_the_mass_sticks() -> None:
    p = load_scene("fig5").parameters
    for belt in (1, 2):
        low, high = figures.stick_zone(p, belt)
        for x, sticks in ((low + 0.01, True), (high - 0.01, True), (low - 0.01, False), (high + 0.01, False)):
            motion = simulate(p, t0=0, x0=x, v0=p.belt(belt), t_end="1e-6", max_events=1)
            assert (motion.mode(0.0) == f"belt{belt}") == sticks


def test_fig4_shows_each_mapping() -> None:
    ax = figures.fig4().axes[0]
    curves = {str(line.get_label()): line for line in ax.lines if str(line.get_label()) in MAPS}
    assert set(curves) == set(MAPS)
    p = figures.MAPPING_PARAMETERS
    for label, curve in curves.items():
        x, v = np.asarray(curve.get_xdata(), dtype=float), np.asarray(curve.get_ydata(), dtype=float)
        start, end = (float(p.belt(plane.boundary)) for plane in (MAPS[label].start, MAPS[label].end))
        assert (v[0], v[-1]) == pytest.approx((start, end), abs=1e-12)
        edges = [-np.inf, float(p.v1), float(p.v2), np.inf]
        domain = MAPS[label].domain
        low, high = edges[domain - 1 : domain + 1] if domain else (start, start)
        assert np.all(v[1:-1] >= low - 1e-12)
        assert np.all(v[1:-1] <= high + 1e-12)
        motion = figures.mapping_motion(label)
        event = motion.events[0]
        phases = float(p.Omega) * motion.t_start, float(p.Omega) * event.t
        assert (x[0], x[-1]) == pytest.approx((float(figures.MAPPINGS[label][0]), event.x))
        assert residual(p, label, (x[0], phases[0]), (event.x, phases[1])) == pytest.approx((0.0, 0.0), abs=1e-9)
