"""Figures 2 and 3: the open rod that coils up into a helix."""

import numpy as np

from figures.report import Row, new_figure, save, verdict, write_csv
from figures.runs import SPACING, energies, nearest, text_of
from rodsim import open_trajectory
from rodsim.analysis.curve import misalignment, stretch
from rodsim.analysis.helix import fit_helix, triad_turns

TWISTS = {"pi/2": ("open_rod_half_twist", np.pi / 2, 1.5), "pi": ("open_rod", np.pi, 3.0)}
TIMES = (1e-3, 2e-3, 3e-3, 4e-3, 5e-3)
EPSILONS = (5, 6, 7, 8)


def figure_2(place) -> list[Row]:
    """Shapes at 1 to 5 ms for both twists, and what they relax to."""
    figure = new_figure(9.0, 4.6)
    rows, table = [], {"time": np.array(TIMES)}
    panels = figure.subplots(1, 2, sharey=True)
    for axes, (label, (config, twist, claimed)) in zip(panels, TWISTS.items(), strict=True):
        output = place.run(f"fig2-{config}", config)
        late = place.run(f"fig2-{config}-60ms", config, "time.end=0.06", "output.interval=1e-3")
        with open_trajectory(output) as run, open_trajectory(late) as relaxed:
            frames = [int(np.argmin(abs(run.time - t))) for t in TIMES]
            shapes = [run.read("position", f) for f in frames]
            triads = [run.read("director", f) for f in frames]
            end = fit_helix(relaxed.read("position", -1))
        _draw(axes, shapes, label)
        turns = [triad_turns(triad) for triad in triads]
        helical = [fit_helix(shape).turns for shape in shapes]
        table |= {f"twist number, {label}": turns, f"turns of the helix, {label}": helical}
        rows.append(_turns_row(label, claimed, twist, turns[-1], helical[-1], end))
    save(figure, place.path("fig2.png"))
    write_csv(place.path("fig2.csv"), table)
    return [*rows, _gib_shapes_row(place), _constraints_row(place)]


def _draw(axes, shapes, label):
    """Draw shapes beside each other as seen along y, and, thin, along x."""
    for column, shape in enumerate(shapes):
        x, y, z = (shape - shape.mean(axis=0)).T
        axes.plot(y + 1.3 * column, z, lw=0.9, color="0.65")
        axes.plot(x + 1.3 * column, z, lw=2.0, color="C0", solid_capstyle="round")
    axes.set_aspect("equal")
    axes.set_xticks(1.3 * np.arange(len(shapes)), [f"{1e3 * t:g} ms" for t in TIMES])
    axes.set(xlabel="time", ylabel="z (um)", title=f"Omega_3 = {label}: x (thick) and y (thin)")


def _turns_row(label, claimed, twist, number, helical, end):
    K = np.hypot(1.3, twist)
    exact = 75 * 2 * np.arcsin(0.5 * K * SPACING) / (2 * np.pi)
    found = (
        f"{helical:.2f} turns at 5 ms, but on its way to {end.turns:.2f} at 60 ms, where theory of "
        f"the rod at rest has {exact:.2f}; (45) is the twist number of the triads, {number:.2f} at "
        f"5 ms and {twist * 75 * SPACING / (2 * np.pi):.2f} at rest"
    )
    return Row(
        "Fig. 2",
        f"Omega_3 = {label}: a stable helix of q = {claimed:g} turns at 5 ms, eq. (45)",
        found,
        verdict([abs(helical - claimed) < 0.1, abs(end.turns - claimed) < 0.1]),
    )


def _gib_shapes_row(place):
    """Shapes of both methods at the same times, Omega_3 = pi."""
    ours, rival = _pair(place)
    with open_trajectory(rival) as gib:
        far = {epsilon: _distances(ours[epsilon], gib) for epsilon in (5, 6)}
        whole = f"to {1e3 * gib.time[-1]:.3g} ms"
    radius = 1.3 / (1.3**2 + np.pi**2)
    return Row(
        "Fig. 2",
        "the shapes match the gIB method's (epsilon = 6 ds)",
        "root mean square distance, largest and at the end ("
        + whole
        + "): "
        + ", ".join(f"{d.max():.3f} and {d[-1]:.3f} um at {e} ds" for e, d in far.items())
        + f"; the helix has a radius of {radius:.2f} um",
        verdict(far[6].max() < 0.5 * radius),
    )


def _distances(output, gib):
    """Root mean square distance of two runs' points, frame by frame."""
    with open_trajectory(output) as run:
        frames = [int(np.argmin(abs(run.time - time))) for time in gib.time]
        gaps = [run.read("position", f) - gib.read("position", i) for i, f in enumerate(frames)]
    return np.array([np.sqrt(np.mean(np.sum(gap**2, axis=1))) for gap in gaps])


def _constraints_row(place):
    """Section 6, below Table 2: within 1 % inextensible and aligned."""
    worst, angle = 0.0, 0.0
    for config, _, _ in TWISTS.values():
        with open_trajectory(place.run(f"fig2-{config}", config)) as run:
            for frame in range(1, run.frames):
                X = run.read("position", frame)
                worst = max(worst, abs(stretch(X, SPACING)).max())
                angle = max(angle, misalignment(X, run.read("director", frame)).max())
    return constraint_row("Open rods", worst, angle)


def constraint_row(name, worst, angle):
    """Return the row for the largest stretch and angle seen after the initial state."""
    return Row(
        "Section 6",
        f"{name}: inextensible and aligned with D3 within 1 %",
        f"largest stretch {100 * worst:.2f} %; largest angle between D3 and tangent "
        f"{np.degrees(angle):.2f} degrees ({100 * np.sin(angle):.2f} % as a sine, "
        f"{100 * (1 - np.cos(angle)):.3f} % off D3.t = 1)",
        verdict([worst < 0.01, 1 - np.cos(angle) < 0.01]),
    )


def _pair(place):
    end = ("time.end=2e-3",) if place.quick else ()
    ours = {
        e: place.run(f"fig3-eps{e}", "open_rod", f"fluid.epsilon.spacings={e}", *end)
        for e in EPSILONS
    }
    return ours, place.run_gib("fig3-gib", "open_rod", *end)


def figure_3(place) -> list[Row]:
    """Energies in kT for epsilon = 5..8 ds and gIB, Omega_3 = pi."""
    ours, rival = _pair(place)
    curves, gib = {e: energies(path) for e, path in ours.items()}, energies(rival)
    panels = {
        "(a) bending": lambda c: c.parts["bending"],
        "(b) kinetic": lambda c: c.kinetic,
        "(c) twisting": lambda c: c.parts["twisting"],
        "(d) total": lambda c: c.total,
    }
    draw_energies(place.path("fig3.png"), panels, curves, gib)
    write_energies(place.path("fig3.csv"), curves, gib)
    everyone = {**{f"{e} ds": c for e, c in curves.items()}, "gIB": gib}
    falls = {
        kind: [name for name, c in everyone.items() if not (np.diff(values(c)) < 0).all()]
        for kind, values in panels.items()
        if kind != "(b) kinetic"
    }
    return [
        Row(
            "Fig. 3a, c, d",
            "bending, twisting and total energy fall monotonically",
            "; ".join(f"{k[4:]}: {_exceptions(v)}" for k, v in falls.items()),
            verdict([not names for names in falls.values()]),
        ),
        _zero_row(everyone),
        _kinetic_row(everyone),
        _nearest_row(curves, gib),
        _small_parts_row(everyone),
    ]


def _zero_row(everyone):
    left = {name: c.total[-1] / c.total[0] for name, c in everyone.items()}
    return Row(
        "Fig. 3d",
        "down to zero at 5 ms",
        "left of the initial total energy at the end: "
        + ", ".join(f"{100 * share:.2f} % ({name})" for name, share in left.items()),
        verdict([share < 0.02 for share in left.values()]),
    )


def _nearest_row(curves, gib):
    best, distances = nearest(curves, gib)
    return Row(
        "Fig. 3",
        "epsilon = 6 ds matches the gIB method's curves",
        f"nearest is {best} ds; root mean square distance in total energy, of the initial: "
        + text_of(distances),
        verdict(best == 6),
    )


def _exceptions(names):
    return "all" if not names else "not " + ", ".join(names)


def _kinetic_row(everyone):
    peaks = {}
    for name, curve in everyone.items():
        later = curve.time > 1e-4
        top = np.argmax(np.where(later, curve.kinetic, 0.0))
        rises = curve.kinetic[top] > 1.2 * curve.kinetic[np.argmax(later)]
        peaks[name] = curve.time[top], rises and curve.kinetic[-1] < 0.5 * curve.kinetic[top]
    return Row(
        "Fig. 3b",
        "kinetic energy increases at first, then decreases",
        "largest after the first 0.1 ms at "
        + ", ".join(f"{1e3 * time:.2f} ms ({name})" for name, (time, _) in peaks.items())
        + "; before that the initial state's own transient, highest at t = 0 without inertia",
        verdict([shape for _, shape in peaks.values()]),
    )


def _small_parts_row(everyone):
    shares = [
        ((c.parts["shear"] + c.parts["stretch"]) / c.total[0])[1:].max() for c in everyone.values()
    ]
    return Row(
        "Fig. 3",
        "shearing and stretching energies are negligible",
        f"at most {100 * max(shares):.2f} % of the initial total energy",
        verdict(max(shares) < 0.02),
    )


def draw_energies(path, panels, curves, gib):
    """Draw the four panels of Fig. 3 or 5."""
    figure = new_figure(8.0, 5.6)
    for axes, (title, values) in zip(figure.subplots(2, 2).flat, panels.items(), strict=True):
        axes.plot(1e3 * gib.time, values(gib), "k", lw=2, label="gIB, c = 2 ds")
        for epsilon, curve in curves.items():
            axes.plot(
                1e3 * curve.time, values(curve), "--", lw=1.3, label=f"epsilon = {epsilon} ds"
            )
        axes.set(xlabel="time (ms)", ylabel="energy (kT)", title=title)
        axes.set_xlim(0, 1e3 * max(curve.time[-1] for curve in curves.values()))
    axes.legend(frameon=False, fontsize=8)
    save(figure, path)


def write_energies(path, curves, gib):
    """Write the curves on the times of rodsim's frames; gIB's own, where it got to, beside them."""
    first = next(iter(curves.values()))
    table = {"time (s)": first.time}
    missing = np.full(len(first.time), np.nan)
    for name, curve in {**{f"{e} ds": c for e, c in curves.items()}, "gIB": gib}.items():
        for kind, values in {**curve.parts, "total": curve.total, "kinetic": curve.kinetic}.items():
            column = missing.copy()
            column[: len(values)] = values
            table[f"{name} {kind} (kT)"] = column
    write_csv(path, table)
