"""A run as xarray and pandas have it: names, coordinates and units (extra ``table``)."""

from __future__ import annotations

from contextlib import contextmanager

from rodsim.analysis.measuring import over_time, pick
from rodsim.errors import FileError, UsageError
from rodsim.output import layout

AXES, TRIAD = ["x", "y", "z"], ["D1", "D2", "D3"]


def to_xarray(run, measures=()):
    """Return the ``xarray.Dataset`` of a run.

    Fields (time, point, axis), ``director`` (time, point, triad, axis); observables (time, rod),
    (time, axis) or (time). Each has an attribute ``units``; the rod of a point and its s are
    coordinates.
    """
    with _needed():
        import xarray

    points = [(rod.name, s) for rod in run.rods for s in rod.points_at]
    coordinates = {
        "time": ("time", run.time, {"units": run.units["time"]}),
        "rod": [*run.rods.names],
        "axis": AXES,
        "triad": TRIAD,
        "rod_of_point": ("point", [name for name, _ in points]),
        "s": ("point", [s for _, s in points], {"units": run.units["length"]}),
    }
    data = {name: (*_field(run, name), {"units": run.unit(name)}) for name in run.fields}
    data |= {name: (*_series(run, name), {"units": run.unit(name)}) for name in run.observables}
    for name in measures:
        measure, found = pick(run, [name])[0].measure, run.measure(name)
        of_rods = found.ndim == 2 + bool(measure.components) and measure.per == "rod"
        units = {"units": measure.unit_in(run.units), "long_name": measure.about}
        data[name] = (_dimensions(found, of_rods), found, units)
    about = {"title": title_of(run), "source": str(run.path), "status": run.status}
    return xarray.Dataset(data, coordinates, about)


def to_dataframe(run, measures=()):
    """Return the ``pandas.DataFrame`` of the observables of a run, and of ``measures``.

    One row a frame, with the time as index; ``attrs["units"]`` has the unit of each column.
    """
    with _needed():
        import pandas

    table = over_time(run, pick(run, [*run.observables, *measures]))
    index = pandas.Index(table.time, name="time")
    frame = pandas.DataFrame(table.values, index, [column.name for column in table.columns])
    frame.attrs["units"] = {column.name: column.unit for column in table.columns}
    frame.attrs["units"]["time"] = table.time_unit
    return frame


def title_of(run) -> str:
    """Return the title of the case in a file, or an empty text."""
    try:
        return str(run.case_data().get("title", ""))
    except FileError:
        return ""


def _field(run, name):
    point = "tracer" if name == "tracers" else "point"
    between = ("triad",) if name == "director" else ()
    return ("time", point, *between, "axis"), run.read(name)


def _series(run, name):
    values = run.observable(name)
    return _dimensions(values, name in layout.PER_ROD, name), values


def _dimensions(values, of_rods, name=""):
    """Return the names of the dimensions of numbers over time; vectors have an axis."""
    found = ["time", "rod"] if of_rods else ["time"]
    if values.ndim > len(found):
        vector = values.shape[-1] == 3 and not name.endswith("_energy")
        found.append("axis" if vector else f"{name}_number")
    return tuple(found)


@contextmanager
def _needed():
    try:
        yield
    except ImportError as error:
        raise UsageError(f"this needs {error.name}: pip install 'rodsim[table]'") from error
