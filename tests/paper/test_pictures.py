"""The paper's figures: nothing covers anything else, and numbers and curves are those of other computations."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from symosc import load_scene, residual, simulate
from symosc.friction import MAPS
from symosc.paper import figures
from symosc.paper.pictures import PICTURES

pytestmark = pytest.mark.slow  # draws all figures

WINDOWS = {"theorem7-p2", "theorem7-p3", "theorem7-p5", "theorem7-p6"}
OTHERS = {"fig1", "fig2", "fig3", "fig4", "force-product"} | WINDOWS
COMPUTED = [key for key in PICTURES if key not in OTHERS]


@pytest.mark.full(4)
@pytest.mark.parametrize("form", ["build", "narrow"])
@pytest.mark.parametrize("key", COMPUTED)
def test_nothing_overlaps(key: str, form: str) -> None:
    drawing = getattr(PICTURES[key], form)()
    drawing.draw_without_rendering()
    assert len({ax.get_subplotspec().colspan.stop for ax in drawing.axes}) == (
        1 if form == "narrow" else 2
    )
    boxes = [Bbox(ax.get_tightbbox()) for ax in drawing.axes]
    boxes.append(drawing.legends[0].get_window_extent())
    for i, box in enumerate(boxes):
        assert not any(box.overlaps(other) for other in boxes[i + 1 :])
    page = Bbox([[0, 0], drawing.bbox.size])
    assert all(
        page.x0 <= box.x0 and box.x1 <= page.x1 and page.y0 <= box.y0 and box.y1 <= page.y1
        for box in boxes
    )
    for ax in drawing.axes:
        for inset in ax.child_axes:
            box = inset.get_tightbbox()
            for line in [line for line in ax.lines if line.get_label() != "belt"]:
                x, y = ax.transData.transform(np.column_stack(line.get_data()).astype(float)).T
                assert not ((box.x0 < x) & (x < box.x1) & (box.y0 < y) & (y < box.y1)).any()


# --- Figs. 1 to 4 ---


@pytest.mark.parametrize("name", ["fig1", "fig2", "fig3", "fig4"])
def test_labels_of_drawings_are_on_the_page_and_apart(name: str) -> None:
    drawing: Figure = getattr(figures, name)()
    drawing.draw_without_rendering()
    shown = [
        each for each in drawing.findobj(Text) if isinstance(each, Text) and each.get_visible()
    ]
    boxes = [(each.get_text(), each.get_window_extent()) for each in shown if each.get_text()]
    page = drawing.bbox
    for number, (words, box) in enumerate(boxes):
        assert page.x0 <= box.x0 < box.x1 <= page.x1, words
        assert page.y0 <= box.y0 < box.y1 <= page.y1, words
        assert not [other for other, further in boxes[number + 1 :] if box.overlaps(further)], words


def test_fig3_marks_where_the_mass_sticks() -> None:
    p = load_scene("fig5").parameters
    for belt in (1, 2):
        low, high = figures.sticking_interval(p, belt)
        for x, sticks in (
            (low + 0.01, True),
            (high - 0.01, True),
            (low - 0.01, False),
            (high + 0.01, False),
        ):
            motion = simulate(p, t0=0, x0=x, v0=p.belt(belt), t_end="1e-6", max_events=1)
            assert (motion.mode(0.0) == f"belt{belt}") == sticks


def test_fig4_shows_each_mapping() -> None:
    ax = figures.fig4().axes[0]
    curves = {str(line.get_label()): line for line in ax.lines if str(line.get_label()) in MAPS}
    assert set(curves) == set(MAPS)
    p = figures.MAPPING_PARAMETERS
    for label, curve in curves.items():
        x = np.asarray(curve.get_xdata(), dtype=float)
        v = np.asarray(curve.get_ydata(), dtype=float)
        start, end = (
            float(p.belt(plane.boundary)) for plane in (MAPS[label].start, MAPS[label].end)
        )
        assert (v[0], v[-1]) == pytest.approx((start, end), abs=1e-12)
        edges = [-np.inf, float(p.v1), float(p.v2), np.inf]
        domain = MAPS[label].domain
        if domain:
            low, high = edges[domain - 1 : domain + 1]
        else:
            low, high = (start, start)
        assert np.all(v[1:-1] >= low - 1e-12)
        assert np.all(v[1:-1] <= high + 1e-12)
        motion = figures.mapping_motion(label)
        event = motion.events[0]
        phases = float(p.Omega) * motion.t_start, float(p.Omega) * event.t
        assert (x[0], x[-1]) == pytest.approx((float(figures.MAPPINGS[label][0]), event.x))
        assert residual(p, label, (x[0], phases[0]), (event.x, phases[1])) == pytest.approx(
            (0.0, 0.0), abs=1e-9
        )
