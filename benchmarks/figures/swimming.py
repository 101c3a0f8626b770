"""Figure 6: the swimming speed of a flagellum, against amplitude, frequency and length."""

import numpy as np
import theory

from figures import prescribed
from figures.report import Row, new_figure, save, verdict, write_csv
from rodsim import open_trajectory
from rodsim.analysis.swimming import swimming_velocity

K, SPACING, VISCOSITY = 2 * np.pi / 5, 0.0666667, 1e-6
EPSILON = 7 * SPACING
AMPLITUDES = (0.075, 0.15, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5)  # um
FREQUENCIES = (250, 350, 450, 550)  # rad/s; the paper prints Hz
THIN = 0.1  # um, a blob small against the wave
LENGTHS = {10: 150, 20: 300, 40: 600, 80: 1200}  # um: points


def figure_6(place) -> list[Row]:
    """Speeds over amplitude and frequency, with Taylor's formula and the exact theory."""
    amplitudes = AMPLITUDES[1::3] if place.quick else AMPLITUDES
    frequencies = FREQUENCIES[::3] if place.quick else FREQUENCIES
    speeds = np.array([[speed(place, b, s) for b in amplitudes] for s in frequencies])
    lengths = dict(list(LENGTHS.items())[: 2 if place.quick else None])
    by_length = {
        b: np.array([speed(place, b, 350, points=points) for points in lengths.values()])
        for b in (0.15, 0.5)
    }
    factors = speeds / (0.5 * K * np.outer(frequencies, np.square(amplitudes)))
    fitted = theory.taylor_radius(K, float(factors[:, 0].mean()))
    rival = {b: prescribed.speed(K, b, 350, EPSILON, 600 * SPACING) for b in amplitudes}
    _draw(place.path("fig6.png"), amplitudes, frequencies, speeds, fitted, rival)
    _write(place, amplitudes, frequencies, speeds, factors, rival)
    write_csv(
        place.path("fig6-lengths.csv"),
        {"length (um)": np.array(list(lengths))}
        | {f"V/(k sigma b^2/2), b = {b} um": _factor(v, b) for b, v in by_length.items()},
    )
    return [
        _quadratic_row(amplitudes, speeds),
        _reversal_row(amplitudes, frequencies, speeds, rival),
        _linear_row(frequencies, factors),
        *_taylor_rows(amplitudes, factors, fitted),
        _amplitude_row(amplitudes, factors),
        _length_row(lengths, by_length),
    ]


def speed(place, amplitude, frequency, points=600) -> float:
    """Return the swimming speed (um/s) of a rod over the two periods after the first."""
    period = 2 * np.pi / frequency
    output = place.run(
        f"fig6-b{amplitude}-s{frequency}-m{points}", "flagellum",
        f"parameters.b={amplitude}", f"parameters.sigma={frequency}",
        f"rods.tail.shape.points={points}", f"time.end={3 * period!r}",
        f"output.interval={period / 20!r}", "time.tolerance=1e-5", "output.fields=[position]",
    )  # fmt: skip
    with open_trajectory(output) as run:
        return float(swimming_velocity(run.time, run.position, period)[2])


def _factor(speeds, amplitude, frequency=350):
    return speeds / (0.5 * K * frequency * amplitude**2)


def curves():
    """Return what the figure is held against: name -> V/(k sigma b^2/2), and the style."""
    exact = theory.swimming_speed(K, 1.0, 2 / K, EPSILON, VISCOSITY)
    printed = theory.taylor_speed(K, 1.0, 2 / K, 10 * SPACING)
    thin = theory.taylor_speed(K, 1.0, 2 / K, theory.SLENDER_RADIUS * EPSILON)
    return {
        "exact, infinite filament": (exact, "k-"),
        "Taylor, r_c = 0.6065 eps": (thin, "k-."),
        "Taylor, r_c = 10 ds (as printed)": (printed, "k:"),
    }


def _draw(path, amplitudes, frequencies, speeds, fitted, rival):
    figure = new_figure(12.0, 3.9)
    left, middle, right = figure.subplots(1, 3)
    b = np.linspace(0, max(amplitudes), 200)
    top, small = max(frequencies), amplitudes[1]
    lines = curves()
    factor = theory.taylor_speed(K, 1.0, 2 / K, fitted)
    lines[f"Taylor, r_c = {fitted / EPSILON:.2f} eps (fitted)"] = factor, "k--"
    for name, (value, style) in lines.items():
        left.plot(b, value * 0.5 * K * top * b**2, style, lw=1, label=name)
        middle.plot([0, top], [0, value * 0.5 * K * top * small**2], style, lw=1)
        right.axhline(value, color="k", ls=style[1:], lw=1)
    for frequency, row in zip(frequencies, speeds, strict=True):
        label = f"rodsim, sigma = {frequency} rad/s"
        left.plot(amplitudes, row, "o-", ms=3.5, lw=0.8, label=label)
        scaled = row / (0.5 * K * frequency * np.square(amplitudes))
        right.plot(amplitudes, scaled, "o-", ms=3.5, lw=0.8)
    for amplitude, column in zip(amplitudes, speeds.T, strict=True):
        middle.plot(frequencies, column, "s-", ms=3.5, lw=0.8, label=f"b = {amplitude:g} um")
    scaled = [_factor(v, amplitude) for amplitude, v in rival.items()]
    right.plot(amplitudes, scaled, "x", color="0.4", label="wave prescribed, forces only")
    for axes in (left, middle):
        axes.set_yscale("symlog", linthresh=1.0)
        axes.set_ylabel("swimming speed (um/s)")
    left.set(xlabel="amplitude b (um)", title=f"(a) theory at {top} rad/s")
    middle.set(xlabel="frequency sigma (rad/s)", title=f"(b) theory at b = {small:g} um")
    right.set(xlabel="amplitude b (um)", ylabel="V / (k sigma b^2 / 2)", title="(c) scaled")
    for axes in (left, middle, right):
        axes.axhline(0.0, color="0.8", lw=0.8, zorder=0)
        axes.legend(frameon=False, fontsize=6.5, loc="lower left")
    save(figure, path)


def _write(place, amplitudes, frequencies, speeds, factors, rival):
    columns = {"b (um)": np.array(amplitudes)}
    for frequency, row, scaled in zip(frequencies, speeds, factors, strict=True):
        columns[f"V (um/s), sigma = {frequency}"] = row
        columns[f"V/(k sigma b^2/2), sigma = {frequency}"] = scaled
    columns["V (um/s), wave prescribed, forces only, sigma = 350"] = np.array(list(rival.values()))
    for name, (value, _) in curves().items():
        columns[f"{name}: V/(k sigma b^2/2)"] = np.full(len(amplitudes), value)
    write_csv(place.path("fig6.csv"), columns)


def _quadratic_row(amplitudes, speeds):
    mean = speeds.mean(axis=0)
    ahead = int(np.argmax(mean))
    local = np.diff(np.log(mean[: ahead + 1])) / np.diff(np.log(amplitudes[: ahead + 1]))
    pairs = zip(amplitudes[: ahead + 1], amplitudes[1 : ahead + 1], local, strict=False)
    return Row(
        "Fig. 6a",
        "the speed grows quadratically with the amplitude, shown up to 1.5 um",
        "exponent "
        + ", ".join(f"{p:.2f} from {a:g} to {b:g} um" for a, b, p in pairs)
        + f"; beyond {amplitudes[ahead]:g} um the speed falls",
        verdict([abs(local[0] - 2) < 0.1, ahead == len(amplitudes) - 1]),
    )


def _reversal_row(amplitudes, frequencies, speeds, rival):
    """Where the swimming turns round, by rodsim and with the wave prescribed."""
    row, other = speeds.mean(axis=0), np.array(list(rival.values()))
    zero, other_zero = (_first_zero(amplitudes, values) for values in (row, other))
    low, high = speeds[0, -1], speeds[-1, -1]
    thin = [prescribed.speed(K, b, 350, THIN, 600 * SPACING, points=400) for b in amplitudes]
    thin_zero = _first_zero(amplitudes, np.array(thin))
    return Row(
        "Fig. 6a",
        "speeds are positive (against the wave) at all amplitudes, as Taylor's",
        f"the rod swims the other way above b = {zero:.2f} um: at {amplitudes[-1]:g} um "
        f"{low:.0f} to {high:.0f} um/s for {frequencies[0]} to {frequencies[-1]} rad/s. A program "
        f"with the wave prescribed and forces only turns too, at {other_zero:.2f} um; with "
        f"eps = {THIN} um instead of {EPSILON:.2f}, at {thin_zero:.2f} um: the thicker, the sooner",
        verdict((row > 0).all()),
    )


def _first_zero(amplitudes, values):
    """Return where values/b^2 first crosses zero, linear between amplitudes; nan if nowhere."""
    scaled = values / np.square(amplitudes)
    below = np.flatnonzero(scaled < 0)
    if not below.size:
        return np.nan
    after = below[0]
    before = after - 1
    share = scaled[before] / (scaled[before] - scaled[after])
    return amplitudes[before] + share * (amplitudes[after] - amplitudes[before])


def _linear_row(frequencies, factors):
    spread = factors[-1] / factors[0] - 1
    return Row(
        "Fig. 6b",
        "the speed grows linearly with the frequency",
        f"V/sigma at {frequencies[-1]} against {frequencies[0]} rad/s differs by "
        f"{100 * spread[0]:+.1f} % at the smallest amplitude, "
        f"{100 * spread[-1]:+.1f} % at the largest",
        verdict(abs(spread).max() < 0.05),
    )


def _taylor_rows(amplitudes, factors, fitted):
    small = float(factors[:, 0].mean())
    lines = {name: value for name, (value, _) in curves().items()}
    printed = lines["Taylor, r_c = 10 ds (as printed)"]
    exact = lines["exact, infinite filament"]
    return [
        Row(
            "Fig. 6",
            "good agreement with Taylor's (51) at r_c = 10 ds",
            f"V/(k sigma b^2/2) is {small:.3f} at b = {amplitudes[0]:g} um; (51) gives "
            f"{printed:.3f} at r_c = 10 ds (k r_c = {K * 10 * SPACING:.2f}; it vanishes at 0.88), "
            f"{lines['Taylor, r_c = 0.6065 eps']:.3f} at r_c = 0.6065 eps; to fit, r_c must be "
            f"{fitted / EPSILON:.2f} eps = {fitted / SPACING:.1f} ds",
            verdict(abs(printed - small) < 0.1 * small),
        ),
        Row(
            "Fig. 6",
            "(not in the paper) exact small-amplitude theory of the infinite regularised filament",
            f"{exact:.3f}; 8 wavelengths reach {100 * small / exact:.0f} % of it",
            "-",
        ),
    ]


def _amplitude_row(amplitudes, factors):
    shares = factors.mean(axis=0) / factors[:, 0].mean()
    largest = K * amplitudes[-1]
    return Row(
        "Fig. 6a",
        "better agreement at smaller amplitudes",
        "V/b^2 against its value at the smallest amplitude: "
        + ", ".join(f"{s:.2f} at {b:g} um" for b, s in zip(amplitudes[1:], shares[1:], strict=True))
        + f"; at the largest the slope k b is {largest:.1f}",
        verdict((np.diff(shares) < 0.02).all() and shares[-1] < 0.9),
    )


def _length_row(lengths, by_length):
    exact = curves()["exact, infinite filament"][0]
    texts = []
    for amplitude, speeds in by_length.items():
        shares = _factor(speeds, amplitude) / exact
        each = ", ".join(f"{s:.2f} at {n} um" for n, s in zip(lengths, shares, strict=True))
        texts.append(f"b = {amplitude:g} um: {each}")
    shares = _factor(by_length[0.15], 0.15) / exact
    return Row(
        "Fig. 6",
        "shorter rods (10, 20 um) do not match as well",
        "speed over that of the infinite filament, " + "; ".join(texts),
        verdict((np.diff(shares) > 0).all()),
    )
