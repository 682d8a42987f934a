"""Axes of a panel, measured for the layout in a fraction of matplotlib's time: more than half of that of a figure."""

from __future__ import annotations

from typing import Any, NamedTuple

from matplotlib.axes import Axes
from matplotlib.spines import Spine
from matplotlib.text import Text
from matplotlib.transforms import Bbox
from numpy import isfinite


class _Labels(NamedTuple):
    """How far the labels of an axis stand out of axes on each side, in pixels, and the ticks that these were for."""

    ticks: tuple[float, ...]
    sides: tuple[float, ...]


class PanelAxes(Axes):
    """Axes whose ticks point inwards, so that only labels, names and marks stand out of them.

    matplotlib lays a figure out twice, as axes of another size may have other ticks, and asks each axis for its labels
    some nine times. Here it is asked once, and again only if its ticks are others.
    """

    def __init__(self, *args: Any, **options: Any) -> None:
        self._labels: dict[Any, _Labels] = {}
        super().__init__(*args, **options)

    def forget_labels(self) -> None:
        """Measure anew: something may have changed since the figure was laid out."""
        self._labels.clear()

    def get_tightbbox(
        self,
        renderer: Any = None,
        *,
        call_axes_locator: bool = True,
        bbox_extra_artists: Any = None,
        for_layout_only: bool = False,
    ) -> Bbox | None:
        """Return the box of the axes with all that stands out of them."""
        ours = for_layout_only and renderer and self.get_visible() and bbox_extra_artists is None
        if not ours or self.yaxis.get_offset_text().get_text():  # titles give way to that text
            return super().get_tightbbox(
                renderer,
                call_axes_locator=call_axes_locator,
                bbox_extra_artists=bbox_extra_artists,
                for_layout_only=for_layout_only,
            )
        inside = self.get_default_bbox_extra_artists()
        titles = {each for each in self.get_children() if isinstance(each, Text)}.difference(inside)
        boxes: list[Any] = [self.get_window_extent(renderer)]
        boxes += [self._with_labels(axis, renderer) for axis in (self.xaxis, self.yaxis)]
        boxes += [_without_width(title.get_window_extent(renderer)) for title in titles]
        boxes += [each.get_tightbbox(renderer) for each in inside if not isinstance(each, Spine)]
        return Bbox.union([box for box in boxes if box is not None and isfinite(box.extents).all()])

    def _with_labels(self, axis: Any, renderer: Any) -> Bbox:
        """Return the box of these axes and of the labels of one axis."""
        inner: Any = self.bbox.extents
        ticks = (*axis.get_view_interval(), *axis.get_majorticklocs())
        known = self._labels.get(axis)
        if known is None or known.ticks != ticks:
            labels = axis.get_tightbbox(renderer, for_layout_only=True)
            sides = (0.0,) * 4 if labels is None else tuple(Bbox.union([self.bbox, labels]).extents - inner)
            known = self._labels[axis] = _Labels(ticks, sides)
        return Bbox.from_extents(*(inner + known.sides))


def _without_width(box: Any) -> Any:
    """Return a title's box, a pixel wide: margins at the side do not depend on its text."""
    middle = (box.x0 + box.x1) / 2
    return Bbox.from_extents(middle - 0.5, box.y0, middle + 0.5, box.y1) if box.width else box
