"""Figures 4 and 5: the closed ring that writhes into a coil."""

import numpy as np

from figures.open_rod import constraint_row, draw_energies, write_energies
from figures.report import Row, new_figure, save, verdict, write_csv
from figures.runs import SPACING, energies, nearest, text_of
from rodsim import open_trajectory
from rodsim.analysis.curve import misalignment, radius_of_gyration, stretch
from rodsim.analysis.topology import twist, writhe

CONFIG = "closed_ring_low_twist"
TIMES = (0.03, 0.048, 0.065, 0.083, 0.1)
EPSILONS = (3, 4, 5, 6)
LATE = 0.05  # s; by then the ring has buckled
EARLY = 0.02  # s; kinetic energy is looked at after the flow of the first straightening


def figure_4(place) -> list[Row]:
    """Shapes from 0.03 to 0.1 s for both twists, with two layers of fluid markers."""
    figure, coils, table = new_figure(10.0, 4.6), {}, {}
    worst, angle = 0.0, 0.0
    for line, omega in enumerate((0.6, 0.5)):
        output = place.run(
            f"fig4-{omega}", CONFIG, f"rods.ring.strain_twist=[1.2, 0, {omega}]", *_short(place)
        )
        with open_trajectory(output) as run:
            for column, time in enumerate(TIMES):
                frame = int(np.argmin(abs(run.time - time)))
                axes = figure.add_subplot(2, 5, 5 * line + column + 1, projection="3d")
                title = f"{omega}, {1e3 * time:g} ms"
                _draw(axes, run.read("position", frame), run.read("tracers", frame), title)
            coils[omega] = _history(run)
            for frame in range(1, run.frames):
                X = run.read("position", frame)
                worst = max(worst, abs(stretch(X, SPACING, True)).max())
                angle = max(angle, misalignment(X, run.read("director", frame), True).max())
        table |= {f"{name}, {omega}": values for name, values in coils[omega].items()}
    save(figure, place.path("fig4.png"), dpi=75)
    write_csv(place.path("fig4.csv"), table)
    return [_coil_row(coils), _settled_row(place), constraint_row("Rings", worst, angle)]


def _short(place):
    return ("tracers.inner.along=40", "tracers.outer.along=40") if place.quick else ()


def _draw(axes, shape, markers, title):
    axes.plot(*np.append(shape, shape[:1], axis=0).T, lw=2.6, color="C3")
    axes.plot(*markers.T, ".", ms=0.7, color="0.45", alpha=0.5)
    axes.set(xlim=(-2.6, 2.6), ylim=(-2.6, 2.6), zlim=(-1.7, 1.7), title=title)
    axes.set_box_aspect((5.2, 5.2, 3.4), zoom=1.45)
    axes.view_init(elev=38, azim=-60)
    axes.set_axis_off()


def _history(run):
    """Return time, writhe, twist, radius of gyration of every second frame."""
    frames = range(0, run.frames, 2)
    shapes = [(run.read("position", f), run.read("director", f)) for f in frames]
    return {
        "time (s)": run.time[::2],
        "writhe": np.array([writhe(X) for X, _ in shapes]),
        "twist": np.array([twist(X, D) for X, D in shapes]),
        "radius of gyration (um)": np.array([radius_of_gyration(X) for X, _ in shapes]),
    }


def _coil_row(coils):
    high, low = coils[0.6], coils[0.5]
    after = high["time (s)"] >= TIMES[0]
    link = max(abs(c["writhe"] + c["twist"]).max() for c in coils.values())
    size = "radius of gyration (um)"
    return Row(
        "Fig. 4",
        "more coiled at Omega_3 = 0.6 than at 0.5",
        f"writhe at 0.1 s {high['writhe'][-1]:.2f} at 0.6, {low['writhe'][-1]:.2f} at 0.5 (largest "
        f"{_largest(high['writhe']):.2f} and {_largest(low['writhe']):.2f}); radius of gyration "
        f"{high[size][-1]:.2f} and {low[size][-1]:.2f} um. "
        f"The linking number stays 0 (to {link:.0e})",
        verdict(
            [
                abs(high["writhe"][-1]) > abs(low["writhe"][-1]),
                (abs(high["writhe"]) > abs(low["writhe"]))[after].mean() > 0.5,
            ]
        ),
    )


def _largest(values):
    return values[np.argmax(abs(values))]


def _settled_row(place):
    """How far from rest the coil is at 0.1 s: what the energy still falls until 0.5 s."""
    after = 0.2 if place.quick else 0.5
    late = place.run("fig4-late", "closed_ring", f"time.end={after}", "fluid.density=1e-12")
    with open_trajectory(late) as run:
        coil = [writhe(run.read("position", f)) for f in range(run.frames)]
        times = run.time
    total = energies(late).total
    at = int(np.argmin(abs(times - 0.1)))
    return Row(
        "Fig. 4",
        "a stable coil is reached at around 0.1 s",
        f"Omega_3 = 0.6: from 0.1 to {after:g} s the writhe goes from {coil[at]:.2f} to "
        f"{coil[-1]:.2f}, the total energy from {100 * total[at] / total[0]:.1f} % of "
        f"the initial to {100 * total[-1] / total[0]:.1f} %",
        verdict([abs(coil[at]) > 0.8 * abs(coil[-1]), total[at] - total[-1] < 0.01 * total[0]]),
    )


def figure_5(place) -> list[Row]:
    """Energies in kT for epsilon = 3..6 ds and gIB, Omega_3 = 0.5."""
    plain = "tracers=null"
    curves = {
        e: energies(place.run(f"fig5-eps{e}", CONFIG, plain, f"fluid.epsilon.spacings={e}"))
        for e in EPSILONS
    }
    gib = energies(place.run_gib("fig5-gib", CONFIG, plain))
    panels = {
        "(a) bending": lambda c: c.parts["bending"],
        "(b) kinetic": lambda c: c.kinetic,
        "(c) stretching": lambda c: c.parts["stretch"],
        "(d) total": lambda c: c.total,
    }
    draw_energies(place.path("fig5.png"), panels, curves, gib)
    write_energies(place.path("fig5.csv"), curves, gib)
    everyone = {**{f"{e} ds": c for e, c in curves.items()}, "gIB": gib}
    everyone = {name: c for name, c in everyone.items() if c.time[-1] > LATE}  # or it was cut
    return [
        _level_row(everyone),
        _kinetic_row(everyone),
        _stretch_row(everyone),
        *_range_rows(curves, gib),
    ]


def _level_row(everyone):
    left = {
        name: (c.parts["bending"][-1] / c.parts["bending"][0], c.total[-1] / c.total[0], c.time[-1])
        for name, c in everyone.items()
    }
    return Row(
        "Fig. 5a, d",
        "bending and total energy approach zero",
        "left of the initial bending and total energy: "
        + ", ".join(
            f"{100 * bending:.0f} and {100 * total:.0f} % ({name}, {1e3 * time:.0f} ms)"
            for name, (bending, total, time) in left.items()
        )
        + ": they fall, and level off",
        verdict([total < 0.02 for _, total, _ in left.values()]),
    )


def _kinetic_row(everyone):
    last = {name: c.kinetic[-1] / c.kinetic[1:].max() for name, c in everyone.items()}
    bursts = {}
    for name, curve in everyone.items():
        start = np.searchsorted(curve.time, 0.01)
        quiet = start + np.argmin(curve.kinetic[start : np.searchsorted(curve.time, EARLY) + 1])
        top = quiet + np.argmax(curve.kinetic[quiet:])
        bursts[name] = curve.kinetic[top] > 1.5 * curve.kinetic[quiet], curve.time[top]
    second = ", ".join(f"{1e3 * t:.0f} ms ({name})" for name, (b, t) in bursts.items() if b)
    return Row(
        "Fig. 5b",
        "kinetic energy decreases to zero",
        "at the end, of the largest after 1 ms: "
        + ", ".join(f"{100 * share:.2f} % ({name})" for name, share in last.items())
        + f"; on the way it rises again while the ring buckles, to a maximum at {second or 'none'}",
        verdict([share < 0.05 for share in last.values()]),
    )


def _stretch_row(everyone):
    grown = {}
    for name, curve in everyone.items():
        part, after = curve.parts["stretch"], curve.time >= EARLY
        grown[name] = part[after][0], part.max(), curve.time[int(np.argmax(part))], part[-1]
    return Row(
        "Fig. 5c",
        "stretching energy increases due to the coil",
        "kT at 20 ms, largest (when), at the end: "
        + ", ".join(
            f"{a:.2f}, {b:.1f} ({1e3 * t:.0f} ms), {c:.2f} ({name})"
            for name, (a, b, t, c) in grown.items()
        ),
        verdict([last > 1.2 * first for first, _, _, last in grown.values()]),
    )


def _range_rows(curves, gib):
    band = np.array([np.interp(gib.time, c.time, c.total) for c in curves.values()])
    slack = 0.02 * gib.total[0]
    inside = (gib.total >= band.min(axis=0) - slack) & (gib.total <= band.max(axis=0) + slack)
    best, distances = nearest(curves, gib)
    whole = f"to {1e3 * gib.time[-1]:.0f} ms"
    return [
        Row(
            "Fig. 5",
            "the gIB method's energies lie in the range of epsilon = 3..6 ds",
            f"total energy within 2 % of that range in {100 * inside.mean():.0f} % of the frames "
            f"({whole}); nearest is {best} ds: {text_of(distances)}",
            verdict(inside.mean() > 0.95),
        )
    ]
