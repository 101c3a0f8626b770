"""``kind: curve``: a centreline without triads, made into an even rod."""

from dataclasses import dataclass

import numpy as np

from rodsim.case.fields import MOST_POINTS
from rodsim.scene.arcs import arc_length, equal_arcs
from rodsim.scene.data.points import read_points
from rodsim.scene.frames import plane_normal, transported
from rodsim.scene.geometry import REFUSE, SAME, WARN, WARN_TILT, Geometry
from rodsim.scene.smoothing import smoothed
from rodsim.scene.spline import Spline
from rodsim.scene.stored import Built, find_file, in_unit

SAMPLES = 64  # of expressions, for each point of the rod
FEWEST_SAMPLES, MOST_SAMPLES = 4096, 2**18
BLOCK = 2**18  # values of the spline at a time
GAP = 10.0  # medians: a distance that looks like a place without points
STILL = 1e-9  # of the largest speed along the parameter
SHARPEST = -0.9  # cosine from one tangent to the next


@dataclass
class Knots:
    """Points (n, 3) that the curve goes through, and the parameter u at them."""

    u: np.ndarray
    position: np.ndarray
    period: float | None


def build_curve(shape, folder, unit) -> Built:
    """Return the rod of a ``kind: curve`` shape: points at equal arc steps, D^3 along the tangent.

    Raises FileError for its table. What is wrong with the curve is in ``errors`` of the result.
    """
    built = Built(np.zeros((3, 0)), np.zeros((3, 3, 0)), 1.0, shape.closed)
    knots = _from_table(shape, folder, unit, built) if shape.path else _from_formula(shape, built)
    if shape.smoothing and not built.errors:
        _smooth(knots, shape.smoothing, built)
    if built.errors:
        return built
    spline = Spline(knots.u, knots.position, knots.period)
    _resample(spline, shape, built)
    return built


def _from_table(shape, folder, unit, built):
    """Return the knots at a table's points, their distances as the parameter."""
    points = read_points(
        find_file(shape.path, folder), False, shape.columns, shape.frame, shape.rod
    )
    factor, errors, warnings = in_unit(shape.unit or points.unit, unit, shape.as_is)
    built.errors += errors
    built.warnings += warnings
    position = factor * points.position
    if shape.closed and len(position) > 3 and _repeats(position):
        position = position[:-1]
    after = np.roll(position, -1, axis=0) if shape.closed else position[1:]
    distance = np.linalg.norm(after - position[: len(after)], axis=1)
    least = 3 if shape.closed else 2
    if len(position) < least:
        built.errors.append(("path", f"has {len(position)} points: needs at least {least}"))
    elif points.breaks and not shape.as_is:
        blocks = (
            f"has {len(points.breaks) + 1} blocks, the second from {points.name(points.breaks[0])}"
        )
        reason = f"{blocks} on: choose one, rod: 1; or take blank lines out of a single one"
        built.errors.append(("path", reason))
    elif not distance.min() > SAME * np.median(distance):
        k = int(np.argmin(distance))
        reason = f"{points.name(k)} and {points.name(k + 1)} are the same: a point is given twice"
        built.errors.append(("path", reason))
    else:
        built.warnings += [("path", reason) for reason in _gaps(distance, position, shape, points)]
    u = np.concatenate([[0.0], np.cumsum(distance)])
    return Knots(u[: len(position)], position, float(u[-1]) if shape.closed else None)


def _repeats(position):
    ends = np.linalg.norm(position[-1] - position[0])
    return ends < SAME * np.median(np.linalg.norm(np.diff(position, axis=0), axis=1))


def _gaps(distance, position, shape, points):
    """Yield what looks like a slip: a gap, a closed curve taken as open."""
    typical, k = np.median(distance), int(np.argmax(distance))
    if distance[k] > GAP * typical and not shape.as_is:
        apart = f"{points.name(k)} and {points.name(k + 1)} are {distance[k] / typical:.3g} times"
        slips = "a gap, two curves, or an open one taken as closed?"
        yield f"{apart} the median distance apart: {slips}"
    ends = np.linalg.norm(position[-1] - position[0])
    if not shape.closed and len(position) > 3 and ends < (1.0 + REFUSE) * typical:
        yield f"its ends are {ends / typical:.3g} median distances apart: closed: true joins them"


def _from_formula(shape, built):
    """Return knots at many values of u, so close that the spline is the curve."""
    points = shape.points or 0
    samples = max(FEWEST_SAMPLES, min(SAMPLES * points, MOST_SAMPLES))
    given = np.linspace(*shape.range, samples + 1)
    parts = [
        part(given) if callable(part) else np.full(len(given), part) for part in shape.position
    ]
    position, u = np.stack(parts, axis=1), np.abs(given - given[0])
    finite = np.isfinite(position).all(axis=1)
    if not finite.all():
        reason = f"is not finite at u = {given[np.argmin(finite)]:.6g}"
        built.errors.append(("position", reason))
        return None
    distance = np.linalg.norm(np.diff(position, axis=0), axis=1)
    apart = np.linalg.norm(position[-1] - position[0])
    if not distance.min() > 0.0:
        reason = f"stands still at u = {given[np.argmin(distance)]:.6g}"
        built.errors.append(("position", reason))
    elif shape.closed and apart > SAME * distance.sum():
        reason = f"it ends {apart:.4g} from where it begins: does u run over the whole curve?"
        built.errors.append(("closed", reason))
    elif not shape.closed and apart < SAME * distance.sum():
        built.warnings.append(("position", "ends where it begins: closed: true joins them"))
    if shape.closed:
        return Knots(u[:-1], position[:-1], float(u[-1]))
    return Knots(u, position, None)


def _smooth(knots, distance, built):
    position = smoothed(knots.u, knots.position, distance, knots.period)
    if position is None:
        line = "point" if knots.period else "straight line"
        reason = f"nothing of the curve would be left: it is nearer than that to a {line}"
        built.errors.append(("smoothing", reason))
        return
    after = np.roll(position, -1, axis=0) if knots.period else position[1:]
    steps = np.linalg.norm(after - position[: len(after)], axis=1)
    u = np.concatenate([[0.0], np.cumsum(steps)])
    knots.u, knots.position = u[: len(position)], position
    knots.period = float(u[-1]) if knots.period else None


def _resample(spline, shape, built):
    """Fill in positions at equal arc steps, triads, and the spacing at rest."""

    def speed(u):
        flat, found = u.reshape(-1), np.empty(u.size)
        for begin in range(0, u.size, BLOCK):
            block = slice(begin, begin + BLOCK)
            found[block] = np.linalg.norm(spline.slope(flat[block]), axis=-1)
        return found.reshape(u.shape)

    own, speeds = arc_length(speed, spline.knots), speed(spline.knots)
    if not (np.isfinite(own) and speeds.min() > STILL * speeds.max()):
        key = "path" if shape.position is None else "position"
        built.errors.append(
            (key, f"the curve turns back at {spline(spline.knots[speeds.argmin()])}")
        )
        return
    segments = _segments(shape, own, spline)
    if segments + (not shape.closed) > MOST_POINTS:
        built.errors.append(("spacing", f"would make more than {MOST_POINTS} points"))
        return
    steps = np.arange(segments + (not shape.closed)) * (own / segments)
    u = equal_arcs(speed, spline.knots, steps)
    position, slope = spline(u), spline.slope(u)
    tangent = slope / np.linalg.norm(slope, axis=1)[:, None]
    cosines = np.sum(tangent * np.roll(tangent, -1, axis=0), axis=1)[:segments]
    if not cosines.min() > SHARPEST:
        k = int(np.argmin(cosines))
        reason = f"the curve turns back between points {k} and {k + 1}: more points, or smoothing"
        built.errors.append(("points", reason))
    elif shape.closed and shape.turns != round(shape.turns) and not shape.as_is:
        reason = "must be a whole number on a closed curve: its triads close up"
        built.errors.append(("turns", reason))
    else:
        triads = transported(tangent, plane_normal(position), shape.closed, shape.turns)
        built.position, built.director = position.T.copy(), triads.transpose(1, 2, 0).copy()
        given = shape.length / segments if shape.length is not None else shape.spacing
        built.spacing = own / segments if given is None else given
        if not shape.as_is:
            _hold(built, own / segments)


def _hold(built, step):
    """Hold the rod against the curve, ``step`` of arc between points, and against its length."""
    geometry = Geometry(built.position, built.director, step, built.closed)
    shortest, tilt = geometry.distances.min(), geometry.tilt.max()
    if shortest < 1.0 - WARN or tilt > WARN_TILT:
        refused = shortest < 1.0 - REFUSE or np.sin(min(tilt, np.pi / 2)) > REFUSE
        found = (
            f"chords down to {shortest:.4g} of the arcs, up to {np.degrees(tilt):.3g} degrees off"
        )
        reason = f"{found} D3: more points" + (", smoothing, or as_is: true" if refused else "")
        (built.errors if refused else built.warnings).append(("points", reason))
    off = step / built.spacing - 1.0
    if abs(off) > WARN:
        refused = abs(off) > REFUSE
        reason = f"the curve is {1.0 + off:.4g} times as long as the rod at rest"
        reason += "; as_is: true takes it so" if refused else ""
        (built.errors if refused else built.warnings).append(("length", reason))


def _where(spline, speeds):
    """Return where the curve is slowest, as x, y, z."""
    return ", ".join(f"{x:.4g}" for x in spline(spline.knots[np.argmin(speeds)]))


def _segments(shape, own, spline):
    """Return the number of segments: as given, as fit the spacing, or as the table has."""
    if shape.segments is not None:
        return shape.segments
    least = 3 if shape.closed else 1
    if shape.spacing is not None:
        return max(least, round(min(own / shape.spacing, 10 * MOST_POINTS)))
    return len(spline.knots) - 1
