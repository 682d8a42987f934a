"""The result of a sweep as an xarray.Dataset: coordinates, units where they are known, and what reproduces it."""

from __future__ import annotations

import json
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

import symosc
from symosc.aliases import Record
from symosc.display.drawable import Drawable
from symosc.errors import MissingExtraError
from symosc.exact import show
from symosc.scenes import Scene
from symosc.scenes.quantities import QUANTITIES
from symosc.sweeps.grid import SET_AXIS, SWEPT_STARTS, Coordinate
from symosc.sweeps.plan import SweepPlan

if TYPE_CHECKING:
    import xarray

#: Long name and dimension of what is recorded; QUANTITIES has those of what is swept.
VARIABLES = {
    "word": ("mappings of the last forcing period as a cycle, from right to left", "1"),
    "multiplicity": ("forcing periods after which word and section repeat, 0 if they do not", "1"),
    "events": ("number of events", "1"),
    "sticks": ("number of onsets of a stick", "1"),
    "stuck": ("share of the time that the mass sticks", "1"),
    "status": ("why the motion ended", "1"),
    "t": ("time of the last state", "time"),
    "x": ("last position", "length"),
    "v": ("last velocity", "length/time"),
    "mode": ("last mode", "1"),
    "x_min": ("least position", "length"),
    "x_max": ("largest position", "length"),
    "v_min": ("least velocity", "length/time"),
    "v_max": ("largest velocity", "length/time"),
    "section": ("position and velocity at the last whole forcing periods", ""),
}
#: The attribute by which a Dataset has what is ours.
ACCESSOR = "symosc"
PLAN_ATTRIBUTE, CALL_ATTRIBUTE = "plan", "call"
#: Axes with more values are not written out in the call; the coordinates have them.
MOST_WRITTEN = 2000


def need_xarray() -> ModuleType:
    """Return xarray.

    Raises
    ------
    MissingExtraError
        If it is not installed.
    """
    try:
        import xarray
    except ImportError:
        raise MissingExtraError("sweep", "sweep") from None
    if ACCESSOR not in vars(xarray.Dataset):
        xarray.register_dataset_accessor(ACCESSOR)(SweptDataset)
    return xarray


class SweptDataset(Drawable):
    """What a sweep's Dataset has of symosc, as ``dataset.symosc``: ``dataset.symosc.plot()`` draws it.

    Examples
    --------
    >>> from symosc import sweep
    >>> found = sweep("fig9", {"Omega": "3:5:3"}, t_end="12T", skip="10T")
    >>> [axes.get_xlabel() for axes in found.symosc.plot().axes]
    ['$\\\\Omega$']
    """

    def __init__(self, dataset: xarray.Dataset) -> None:
        self.dataset = dataset

    @property
    def call(self) -> str:
        """The call of `sweep` that gives this result again, as Python source."""
        return str(self.dataset.attrs.get(CALL_ATTRIBUTE, ""))


def dataset_of(plan: SweepPlan, columns: dict[str, np.ndarray], given: Record) -> xarray.Dataset:
    """Return the result.

    Parameters
    ----------
    plan : SweepPlan
    columns : dict of str to array
        Over all cells, in C order.
    given : dict
        The arguments of `sweep` as they were given, for the call that reproduces it.
    """
    grid = plan.grid
    variables = {}
    for name in dict.fromkeys((*plan.record, "status")):
        values = columns[name].reshape(*grid.shape, *columns[name].shape[1:])
        dimensions = (*grid.sizes, "period", "component") if name == "section" else tuple(grid.sizes)
        variables[name] = (dimensions, values, _about(*VARIABLES[name]))
    coordinates: dict[str, Any] = {
        name: (dimension, values, _about(*QUANTITIES[name])) for name, (dimension, values) in grid.coordinates.items()
    }
    if plan.sections:
        coordinates |= {"period": np.arange(-plan.sections, 0), "component": ["x", "v"]}
    attributes = _attributes(plan, given)
    return need_xarray().Dataset(variables, coordinates, attributes)


def _about(name: str, dimension: str) -> dict[str, str]:
    units = {"units": "1"} if dimension == "1" else {"dimension": dimension} if dimension else {}
    return {"long_name": name} | units


def _attributes(plan: SweepPlan, given: Record) -> dict[str, str]:
    return {
        "title": f"Sweep of {plan.scene.name} over {', '.join(plan.grid.coordinates)}",
        "source": f"symosc {symosc.__version__}, kernels {plan.content['kernels']}",
        "scene": json.dumps(plan.content["parameters"] | plan.content["start"]),
        CALL_ATTRIBUTE: call_text(plan, given),
        PLAN_ATTRIBUTE: plan.key,
    }


def call_text(plan: SweepPlan, given: Record) -> str:
    """Return the call of `sweep` that gives this result again, as Python source.

    Names in it are those of `symosc`. A table, and an axis of many values, are called by the name of the coordinate.
    """
    over: Any = given["over"]
    coordinates = plan.grid.coordinates
    if plan.grid.is_table():
        names = [name for name, each in coordinates.items() if each.dimension == SET_AXIS]
        written = f"[{{name: float(dataset[name][i]) for name in {names}}} for i in range(dataset.sizes['set'])]"
    else:
        axes = {name: _axis_text(name, over[name], coordinates[name]) for name in over}
        written = "{" + ", ".join(f"{name!r}: {text}" for name, text in axes.items()) + "}"
    options = [f"record={plan.record_names!r}", f"t_end={str(plan.t_end)!r}", f"skip={str(plan.skip)!r}"]
    if given["starts"] is not None:
        rows = np.stack([coordinates[name].values for name in SWEPT_STARTS], axis=-1).tolist()
        options.append(f"starts={rows!r}")
    return f"sweep({_scene_text(plan.scene)}, {written}, {', '.join(options)})"


def _axis_text(name: str, given: Any, coordinate: Coordinate) -> str:
    if isinstance(given, str):
        return repr(given)
    if len(coordinate.values) > MOST_WRITTEN:
        return f"dataset[{name!r}].values"
    return repr(coordinate.values.tolist())


def _scene_text(scene: Scene) -> str:
    parameters = ", ".join(f"{name}={text!r}" for name, text in scene.parameters.as_dict().items())
    start = ", ".join(f"{name}={show(getattr(scene, name))!r}" for name in (*SWEPT_STARTS, "t_end"))
    if scene.start_error is not None:
        start += f", start_error={[show(each) for each in scene.start_error]!r}"
    return f"Scene({scene.name!r}, Parameters({parameters}), {start})"
