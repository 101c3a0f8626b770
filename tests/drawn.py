"""Small output files of rods that are only to be drawn, and what can be seen wrong in a picture."""

import json

import numpy as np

from rodsim.case import load_case
from rodsim.nodes import lay_out
from rodsim.output import CaseText, Plan, TrajectoryWriter
from rodsim.plotting.style import SLACK

UNITS = {"length": "um", "mass": "g", "time": "s"}
PARTS = ("bending_energy", "twisting_energy", "shear_energy", "stretch_energy", "power", "length")
MODULI = {"bending": 2e-3, "twisting": 2e-3, "shear": 0.7, "stretch": 0.7}
EPSILON = 0.3


def write(path, rods, times, title="Rods", extra=(), labels=None, values=None):
    """Write frames of rods (position (T, M, 3), director (T, M, 3, 3), closed) by name.

    extra, labels : further observables as in :class:`rodsim.output.Plan`; values : theirs, by name.
    Energies are made up, different in each frame.
    """
    shape = {"kind": "straight", "points": 5, "length": 4.0}
    case = load_case(
        {
            "title": title,
            "fluid": {"viscosity": 2e-6, "epsilon": EPSILON},
            "rods": {name: {"shape": shape, "moduli": MODULI} for name in rods},
            "time": {"end": 0.4},
        }
    )
    entries = []
    for name, (position, _, closed) in rods.items():
        spacing = np.linalg.norm(np.diff(position[0], axis=0), axis=1).mean()
        entries.append(
            (name, position.shape[1], closed, spacing, (2e-3, 2e-3, 2e-3, 0.7, 0.7, 0.7))
        )
    text = CaseText("", json.dumps(case.resolved()), [])
    plan = Plan(
        text, lay_out(entries), np.asarray(times, float), 0, ("position", "director"), UNITS, False,
        {"time": 0.0}, tuple(extra), labels=labels or {},
    )  # fmt: skip
    position, director = (np.concatenate([rod[k] for rod in rods.values()], axis=1) for k in (0, 1))
    with TrajectoryWriter.create(path, plan, False) as writer:
        for k in range(len(times)):
            made_up = {name: (1.0 + 0.3 * k) * np.ones(len(rods)) for name in PARTS}
            balances = dict.fromkeys(("net_force", "net_torque"), np.zeros(3))
            more = {name: rows[k] for name, rows in (values or {}).items()}
            fields = {"position": position[k].T, "director": director[k].transpose(1, 2, 0)}
            writer.write_frame(k, k, fields, made_up | balances | more)
        writer.finish("finished", {})
    return path


def wave(frames=4, points=23, plane="yz", length=20.0, shift=0.0, amplitude=0.8):
    """Return a planar wave that travels, along the second axis of its plane: (position, triads)."""
    across, along = ("xyz".index(name) for name in plane)
    s = np.linspace(0.0, length, points)
    position, director = np.zeros((frames, points, 3)), np.zeros((frames, points, 3, 3))
    normal = np.cross(np.eye(3)[across], np.eye(3)[along])
    for k in range(frames):
        phase = 4.0 * np.pi * s / length - 0.7 * k
        position[k, :, along], position[k, :, across] = s, shift + amplitude * np.sin(phase)
        tangent = np.gradient(position[k], axis=0)
        tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
        director[k, :, 0], director[k, :, 2] = normal, tangent
        director[k, :, 1] = np.cross(tangent, director[k, :, 0])
    return position, director, False


def coil(frames=4, points=40, closed=False, jolt=1.0):
    """Return a helix that winds up, with a twist of its triads that grows: (position, triads).

    jolt : by how much more the first frame is twisted.
    """
    u = np.linspace(0.0, 2.0 * np.pi, points, endpoint=not closed)
    position, director = np.zeros((frames, points, 3)), np.zeros((frames, points, 3, 3))
    for k in range(frames):
        rise = 0.0 if closed else 0.5 + 0.2 * k
        position[k] = np.stack([2.0 * np.cos(u), 1.5 * np.sin(u), rise * u], axis=1)
        tangent = np.stack([-2.0 * np.sin(u), 1.5 * np.cos(u), rise + 0 * u], axis=1)
        tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
        side = np.cross(tangent, [0.0, 0.0, 1.0])
        side /= np.linalg.norm(side, axis=1, keepdims=True)
        up = np.cross(tangent, side)
        angle = ((3.0 + k) * (jolt if k == 0 else 1.0) * u)[:, None]
        director[k, :, 0] = np.cos(angle) * side + np.sin(angle) * up
        director[k, :, 1] = np.cos(angle) * up - np.sin(angle) * side
        director[k, :, 2] = tangent
    return position, director, closed


# What can be seen wrong -------------------------------------------------------------------------


def texts_of(figure):
    """Return every text that is drawn, with its box in points of the picture."""
    found = []
    for axis in figure.axes:
        if not axis.get_visible():
            continue
        found += [axis.title, axis._left_title, axis._right_title, *axis.texts]
        if axis.get_legend():
            found += axis.get_legend().get_texts()
        if axis.axison:
            for side in filter(lambda side: side.get_visible(), (axis.xaxis, axis.yaxis)):
                ticks = side._update_ticks()  # those within the limits
                found += [label for tick in ticks for label in (tick.label1, tick.label2)]
                found += [side.label, side.offsetText]
    found += [*figure.texts, figure._suptitle, figure._supxlabel, figure._supylabel]
    found += [text for legend in figure.legends for text in legend.get_texts()]
    seen = {
        id(text): text for text in found if text and text.get_visible() and text.get_text().strip()
    }
    return [(text.get_text(), text.get_window_extent()) for text in seen.values()]


def faults(figure):
    """Return what is wrong with a drawn figure: texts cut or over each other, collapsed axes."""
    figure.draw_without_rendering()
    width, height = figure.get_size_inches() * figure.dpi
    slack, texts, found = SLACK * figure.dpi, texts_of(figure), []
    for text, box in texts:
        if box.x0 < -slack or box.y0 < -slack or box.x1 > width + slack or box.y1 > height + slack:
            found.append(f"cut: {text!r}")
    for k, (text, box) in enumerate(texts):
        for other, its in texts[:k]:
            across = min(box.x1, its.x1) - max(box.x0, its.x0)
            up = min(box.y1, its.y1) - max(box.y0, its.y0)
            if min(across, up) > 1.0:
                found.append(f"over each other: {text!r}, {other!r}")
    for axis in figure.axes:
        box = axis.get_window_extent()
        if axis.get_visible() and min(box.width, box.height) < 0.03 * figure.dpi:
            found.append(f"collapsed: {box.width:.0f} x {box.height:.0f}")
    return found
