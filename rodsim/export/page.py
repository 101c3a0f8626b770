"""A stored run as one page for any browser, without a network: drawn by K3D, from its own data.

The page is K3D's snapshot, its script and the data inside, with a panel of ours (``page.js``): a
slider and play over the frames, what colours mean, energies beside.
"""

from __future__ import annotations

import base64
import json
from importlib.resources import files
from io import StringIO

import numpy as np

from rodsim.analysis.energy import energy_table
from rodsim.analysis.frames import spread_frames
from rodsim.analysis.strain import at_points
from rodsim.errors import FileError
from rodsim.export.run import tube_radius
from rodsim.export.stage import build_stage, grid_spacing, packed
from rodsim.files import replacing
from rodsim.plotting import style
from rodsim.plotting.colours import of_rods, scale_of, sequential
from rodsim.plotting.energy import draw_energies

FRAMES = 200  # at most, where none are asked for
COLOURS = ("rod", "time", "curvature", "twist")
SHADES = 255  # of a colour map: a value is one byte


def write_page(run, path, *, frames=None, radius=None, colour="rod") -> int:
    """Write up to ``frames`` frames of an open run, at equal distances, as a page.

    radius : of the tubes, a length; by default that of the cylinder that moves the fluid as the
    rod does. colour : what the colours mean at first, one of ``COLOURS``. Returns the
    number of frames; raises FileError.
    """
    if not run.frames:
        raise FileError(f"{run.path}: has no frames yet ({run.status})")
    chosen = spread_frames(run.frames, frames or FRAMES)
    radius = radius or tube_radius(run)
    hues = [packed(colour) for colour in of_rods(run.rods.names).values()]
    stage = build_stage(run, chosen, radius, hues)
    unit = style.pretty_unit(run.units["length"])
    data = _panel(run, chosen, colour) | {
        "radius": f"{radius:.3g} {unit}",
        "grid": f"{grid_spacing(stage.plot.grid):g} {unit}",
        "rods": [
            {"name": rod.name, "hue": f"#{hue:06x}", "object": number, "points": points}
            for rod, hue, (number, points) in zip(run.rods, hues, stage.tubes, strict=True)
        ],
        "stripes": stage.stripes,
    }
    page = stage.plot.get_snapshot(9, [], _script(data))
    with replacing(path) as temporary:
        temporary.write_text(page, encoding="utf-8")
    return len(chosen)


def _script(data):
    """Return the panel's script: the data as it finds them, then what it does."""
    ours = files("rodsim.export")
    data = data | {"css": ours.joinpath("page.css").read_text(encoding="utf-8")}
    text = json.dumps(data, allow_nan=False).replace("<", "\\u003c")  # no tag ends the script
    return f"const RUN = {text};\n{ours.joinpath('page.js').read_text(encoding='utf-8')}"


def _panel(run, chosen, colour):
    """Return what the panel shows, ready for JSON."""
    case = run.case_data()
    data = {
        "title": str(case.get("title") or run.path),
        "times": [float(time) for time in run.time[chosen]],
        "time_unit": style.pretty_unit(run.units["time"]),
        "colour": colour,
        "scales": {"time": _scale(run.time[chosen], run.units["time"], sequential())},
    }
    if "director" in run.fields:
        values = np.array([at_points(run.rods, run.read("director", frame)) for frame in chosen])
        for k, name in enumerate(("curvature", "twist")):
            data["scales"][name] = _along(values[:, k], run)
    if run.frames > 1:
        data["energies"] = _energies(run)
    return data


def _along(values, run):
    """Return the scale of a quantity (T, N), and its values as bytes, rod by rod."""
    unit = f"{run.units['length']}^-1"
    scale = scale_of([values], "", unit)
    parts = np.clip((values - scale.low) / (scale.high - scale.low), 0.0, 1.0)
    shades, packed_rods = np.uint8(np.round(SHADES * parts)), []
    for rod in run.rods:
        of_rod = shades[:, rod.nodes]
        if rod.closed:
            of_rod = np.concatenate([of_rod, of_rod[:, :1]], axis=1)
        packed_rods.append(base64.b64encode(of_rod.tobytes()).decode())
    return _scale([scale.low, scale.high], unit, scale.colours) | {"values": packed_rods}


def _scale(ends, unit, colours):
    """Return what a colour bar says: ends, unit, and colours from 0 to 1 as K3D has them."""
    stops = [(x, *colours(x)[:3]) for x in np.linspace(0.0, 1.0, 33).tolist()]
    texts = [f"{ends[0]:.3g}", f"{ends[-1]:.3g} {style.pretty_unit(unit)}"]
    return {"ends": texts, "map": [round(part, 4) for stop in stops for part in stop]}


def _energies(run):
    """Return the picture of the energies as SVG text, and where on it first and last time are.

    The line with the name ``now`` stands at the first time.
    """
    table = energy_table(run.path)
    figure = style.new_figure(3.9, 3.0)
    figure.set_dpi(72)  # a point is a unit of the SVG
    axis = draw_energies(figure.add_subplot(), table)
    axis.axvline(run.time[0], color="0.2", lw=1.0, gid="now")
    text = StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None})
    frame = axis.get_window_extent()
    span = [float(run.time[0]), float(run.time[-1])]
    return {"svg": text.getvalue(), "from": frame.x0, "to": frame.x1, "span": span}
