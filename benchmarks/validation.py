"""Held and driven: exact and published numbers beside rodsim's own (docs/validation.md).

    python benchmarks/validation.py --markdown --plot validation.png     # some minutes

Each table says what is compared, with what, and by how much they differ.
"""

import numpy as np
import validation_cases as ours
import validation_rods as rods
from bodies_theory import STIMSON_JEFFERY, along_wall, brenner, faxen, stimson_jeffery
from common import benchmark
from tables import Table

SHAPES = {
    "sphere": {"kind": "sphere", "radius": 1.0},
    "spheroid 2:1": {"kind": "spheroid", "length": 4.0, "radius": 1.0},
    "spheroid 4:1": {"kind": "spheroid", "length": 8.0, "radius": 1.0},
}
# pitch, axial length, a, all over R; F, T, D of Lighthill's slender-body theory, and as measured
HELICES = (
    (9.811, 20.63, 0.063, (9.251, 69.27, 34.13), (9.569, 72.69, 35.29)),
    (10.2, 30.9, 0.04, (12.186, 91.15, 43.08), None),
    (15.241, 20.635, 0.063, None, (7.845, 68.1, 34.12)),
    (2.226, 20.635, 0.063, None, (6.264, 131.9, 52.06)),
    (2.42, 27.225, 0.0625, (7.810, 170.31, 62.29), (8.935, 171.7, 59.83)),
)
ROD = (51, 20.0, 0.6)  # points, length, epsilon: L/a = 55
# drive, sperm number: Y and p of the elastica with one drag coefficient (zeta_perp = 3.145)
DRIVES = {("pivot", 2): (0.058308, 0.065358), ("hinge", 3): (0.119618, 0.117845),
          ("heave", 2): (0.383524, 0.307949)}  # fmt: skip
ZETA = 3.145, 2.097
# of a separate program, tail and all as one rigid system: U, spin, torque
SWIMMERS = {(86, True): (0.013815, -0.050363, 1.32912), (128, True): (0.013889, -0.050826, 1.34145),
            (86, False): (0.013662, -0.041371, 1.08481)}  # fmt: skip


def percent(found, exact):
    """Return a difference in per cent as text."""
    return f"{100.0 * (found / exact - 1.0):+.2f}"


def row(what, found, exact, **more):
    """Return one row of most tables."""
    return {"what": what, "ours": f"{found:.5g}", "theirs": f"{exact:.5g}",
            "off": percent(found, exact), **more}  # fmt: skip


COLUMNS = {"what": "", "ours": "rodsim", "theirs": "exact", "off": "off by, %"}


def bodies(counts):
    """Drag and torque of spheres and spheroids."""
    names = ("drag along", "drag across", "torque along", "torque across")
    rows = []
    for shape in SHAPES:
        for points in counts:
            found, exact = ours.drag_factors({**SHAPES[shape], "points": points})
            off = [percent(f, e) for f, e in zip(found, exact, strict=True)]
            rows.append({"what": shape, "points": points, **dict(zip(names, off, strict=True))})
    columns = {"what": "", "points": "points", **{n: f"{n}, %" for n in names}}
    return Table("Drag and torque: off by", columns, rows)


def interactions(points):
    """Two spheres, a sphere near a wall and beside a point force."""
    rows = [
        row(f"two spheres, {d} a apart: U 6πμa/F", ours.two_spheres(d, points), stimson_jeffery(d))
        for d in STIMSON_JEFFERY
    ]
    for height in (1.5, 2.0, 3.0, 6.0):
        rows.append(row(f"away from a wall, {height:g} a above: F/6πμaU",
                        ours.near_wall(height, 2, points), brenner(height)))  # fmt: skip
    for height in (3.0, 6.0):
        rows.append(row(f"along a wall, {height:g} a above: F/6πμaU",
                        ours.near_wall(height, 0, points), along_wall(height)))  # fmt: skip
    for distance, way in ((1.25, (0, 0, 1)), (1.5, (0.6, 0, 0.8)), (2.5, (0.28, 0.96, 0))):
        found = ours.beside_a_force(distance, points, np.array(way, dtype=float))
        names = ("U along", "U across", "Ω")
        where = f"{distance:g} a from a force"
        rows += [row(f"{where}: {name}", abs(f), e)
                 for name, f, e in zip(names, found, faxen(distance), strict=True)]  # fmt: skip
    return Table(f"Spheres of {points} points", COLUMNS, rows)


def helices(some):
    """A rigid helix that turns: thrust, torque, drag."""
    rows = []
    for pitch, axial, a, theory, measured in some:
        found = ours.rotating_helix(pitch, axial, a)
        for name, f, e, m in zip("FTD", found, theory or (None,) * 3, measured or (None,) * 3,
                                 strict=True):  # fmt: skip
            rows.append({
                "helix": f"λ = {pitch:g}, L = {axial:g}, a = {a:g}", "what": name,
                "ours": f"{f:.4g}", "theory": e and f"{e:.4g}", "off": e and percent(f, e),
                "measured": m and f"{m:.4g}", "off_measured": m and percent(f, m),
            })  # fmt: skip
    columns = {
        "helix": "helix, in radii", "what": "", "ours": "rodsim", "theory": "Lighthill's theory",
        "off": "off by, %", "measured": "measured", "off_measured": "off by, %",
    }  # fmt: skip
    return Table("Rotating helix", columns, rows)


def thresholds():
    """Buckling, flutter and whirling of a clamped rod."""
    buckles, (flutters, _), whirls = rods.euler(*ROD), rods.flutter(*ROD), rods.whirl(*ROD)
    found = (
        ("Euler: F L²/A under a dead load", buckles, 2.46740, 2.4678),
        ("flutter: F L²/A under a follower force", flutters, 37.695, 31.25),
        ("whirling: ζ_r ω L²/A, turned at its base", whirls, 8.8651, 6.95),
    )
    rows = [
        {"what": what, "ours": f"{f:.5g}", "theirs": f"{e:.5g}", "off": percent(f, e),
         "twin": f"{t:.4g}", "off_twin": percent(f, t)}
        for what, f, e, t in found
    ]  # fmt: skip
    columns = {
        "what": "", "ours": "rodsim", "theirs": "exact with one drag coefficient",
        "off": "off by, %", "twin": "a separate program, same fluid", "off_twin": "off by, %",
    }  # fmt: skip
    return Table("Thresholds at L/a = 55", columns, rows)


def elasticae(drives, periods=6):
    """Filaments driven at their base: force, power, and the ledger."""
    rows, curves = [], {}
    perp, along = ZETA
    for (drive, sp), (Y, p) in drives.items():
        found = rods.elastica(drive, sp, periods)
        force, power, lost = found[-1]
        curves[f"{drive}, Sp = {sp}"] = found[:, 0] / force
        rows.append({
            "what": f"{drive}, Sp = {sp}",
            "force": f"{force:.5f}", "rft": f"{(perp - along) * Y:.5f}",
            "power": f"{power:.5f}", "rft_power": f"{perp * p:.5f}", "lost": f"{lost:.5f}",
            "ledger": percent(lost, power),
        })  # fmt: skip
    columns = {
        "what": "", "force": "mean force/(ω a²)", "rft": "one drag coefficient",
        "power": "power in/(ω² a² L)", "rft_power": "one drag coefficient",
        "lost": "dissipated", "ledger": "of the power in, %",
    }  # fmt: skip
    return Table("Driven filaments, L/a = 33", columns, rows), curves


def swimmers(some):
    """A swimmer whose tail does not bend."""
    rows = [
        row(f"{name}, {points} points, {'forces and torques' if torques else 'forces only'}",
            found, exact)
        for (points, torques), numbers in some.items()
        for name, found, exact in zip(("speed", "spin of the head", "torque of the motor"),
                                      ours.rigid_swimmer(points, torques), numbers, strict=True)
    ]  # fmt: skip
    return Table("Swimmer with a rigid tail", {**COLUMNS, "theirs": "a separate program"}, rows)


@benchmark(full=1, short=1)
def main(quick, repeats):
    """Exact and published numbers of bodies, held and driven rods beside rodsim's."""
    some = dict(list(DRIVES.items())[:1]) if quick else DRIVES
    driven, curves = elasticae(some, 4 if quick else 6)
    tables = [
        bodies((100,) if quick else (50, 100, 200)),
        interactions(100),
        helices(HELICES[:1] if quick else HELICES),
        thresholds(),
        driven,
        Table("Hook", COLUMNS, [row(*found) for found in rods.hook()]),
        swimmers(dict(list(SWIMMERS.items())[: 1 if quick else 3])),
    ]
    return tables, lambda *axes: draw(curves, *axes)


def draw(curves, left, right):
    """The drag of a sphere above a wall, and how fast driven filaments become periodic."""
    heights = np.linspace(1.15, 5.0, 60)
    left.plot(heights, [brenner(h) for h in heights], c="0.3", label="Brenner 1961")
    some = (1.2, 1.35, 1.5, 2.0, 3.0, 4.5)
    for points, marker in ((100, "o"), (400, "s")):
        found = [ours.near_wall(h, 2, points) for h in some]
        left.plot(some, found, marker, mfc="none", label=f"{points} points")
    left.set_xlabel("height of the centre over the radius")
    left.set_ylabel("drag away from a wall over 6πμaU")
    for name, force in curves.items():
        right.semilogy(np.arange(1, len(force)), abs(force[:-1] - 1.0), "o-", label=name)
    right.set_xlabel("period")
    right.set_ylabel("force, off its last value")
    for axis in (left, right):
        axis.grid(color="0.9")
        axis.legend(frameon=False)


if __name__ == "__main__":
    main()
