"""Stiff and extreme scenes, as plain cases: what ``stability.py`` runs and the tests sample.

Each is small, so that the whole table takes minutes: an open rod of 41 points that coils (the
paper's moduli), a ring of 60, a flagellum of 80. ``SCENES`` maps a group to its scenes by name.
"""

import copy
import math

import numpy as np

LENGTH, POINTS = 5.9, 41
ROD = {
    "fluid": {"viscosity": 1e-6, "epsilon": 0.47},
    "rods": {
        "rod": {
            "shape": {"kind": "straight", "points": POINTS, "length": LENGTH, "perturbation": 1e-4},
            "moduli": {"bending": 3.5e-3, "twisting": 3.5e-3, "shear": 0.8, "stretch": 0.8},
            "strain_twist": [1.3, 0, 1.7],
        }
    },
    "time": {"end": 1e-3, "tolerance": 1e-4},
}
RING = {
    "fluid": {"viscosity": 1e-6, "epsilon": 0.314},
    "rods": {
        "ring": {
            "shape": {"kind": "ring", "radius": 2.5, "points": 60, "twist_perturbation": 1e-3},
            "moduli": {"bending": 3.5e-3, "twisting": 3.5e-3, "shear": 0.8, "stretch": 0.8},
            "strain_twist": ["1e-3*cos(0.8*s)", 0, 0.6],
        }
    },
    "time": {"end": 0.05, "tolerance": 1e-4},
}
TAIL = {
    "parameters": {"k": 1.2566370614, "b": 0.3, "sigma": 400},
    "fluid": {"viscosity": 1e-6, "epsilon": 0.47},
    "rods": {
        "tail": {
            "shape": {"kind": "straight", "points": 80, "length": 10.5},
            "moduli": {"bending": 3.5e-2, "twisting": 3.5e-2, "shear": 0.8, "stretch": 0.8},
            "strain_twist": ["-k**2*b*sin(k*s + sigma*t)", 0, 0],
        }
    },
    "plane": "yz",
    "time": {"end": 0.0157, "tolerance": 1e-4},
}
MODULI = ("bending", "twisting", "shear", "stretch")


def changed(base, changes):
    """Return a copy of a case with some values, by dotted path, set or removed (None)."""
    case = copy.deepcopy(base)
    for path, value in changes.items():
        *parents, last = path.split(".")
        node = case
        for key in parents:
            node = node.setdefault(key, {})
        if value is None:
            node.pop(last, None)
        else:
            node[last] = copy.deepcopy(value)
    return case


def stiffer(factor, names=MODULI):
    """The rod with some of its moduli multiplied."""
    moduli = ROD["rods"]["rod"]["moduli"]
    return changed(ROD, {f"rods.rod.moduli.{name}": factor * moduli[name] for name in names})


def rod(**changes):
    """The rod with changes; ``__`` stands for a dot."""
    return changed(ROD, {path.replace("__", "."): value for path, value in changes.items()})


def of_shape(points, epsilon_in_spacings):
    """The rod at its length with other points, epsilon in their spacing."""
    return rod(
        rods__rod__shape__points=points,
        fluid__epsilon=epsilon_in_spacings * LENGTH / (points - 1),
    )


def rescaled(length, mass, time):
    """The rod in other units: the same motion, every number scaled."""
    force = mass * length / time**2
    changes = {f"rods.rod.moduli.{name}": v * force * (length**2 if i < 2 else 1)
               for i, (name, v) in enumerate(ROD["rods"]["rod"]["moduli"].items())}  # fmt: skip
    return changed(ROD, changes | {
        "fluid.viscosity": 1e-6 * mass / length / time,
        "fluid.epsilon": 0.47 * length,
        "rods.rod.shape.length": LENGTH * length,
        "rods.rod.strain_twist": [1.3 / length, 0, 1.7 / length],
        "time.end": 1e-3 * time,
    })  # fmt: skip


def table(stretch=1.0, turn=0.0, at_all=False):
    """A straight rod as rows x y z D1 D2 D3: stretched, triads turned about D3 by degrees
    between the two middle points, or between all neighbours.
    """
    rows = np.zeros((POINTS, 12))
    rows[:, 2] = stretch * LENGTH / (POINTS - 1) * np.arange(POINTS)
    steps = np.arange(POINTS) if at_all else np.arange(POINTS) >= POINTS // 2
    angle = np.radians(turn) * steps
    rows[:, 3], rows[:, 4] = np.cos(angle), np.sin(angle)
    rows[:, 6], rows[:, 7] = -np.sin(angle), np.cos(angle)
    rows[:, 11] = 1.0
    return rows


def from_table(**options):
    """The rod from a text table; ``stability.run`` writes the file."""
    shape = {"kind": "file", "path": "rod.txt", "spacing": LENGTH / (POINTS - 1), "as_is": True}
    case = changed(ROD, {"rods.rod.shape": shape})
    return case | {"table": table(**options)}


def pair(gap, along=0.0):
    """Two rods side by side, ``gap`` times epsilon apart, one further on by ``along``."""
    case = copy.deepcopy(ROD)
    case["rods"]["other"] = copy.deepcopy(case["rods"]["rod"])
    case["rods"]["other"]["shape"]["origin"] = [gap * 0.47, 0, along]
    case["rods"]["other"]["strain_twist"] = [-1.3, 0, 1.7]
    return case


def at_wall(base, heights, turn, **changes):
    """A scene lying so many epsilon above a plane wall, or standing where ``turn`` is 0."""
    ((name, _),) = base["rods"].items()
    return changed(base, {
        "fluid.wall": {"z": 0.0},
        f"rods.{name}.shape.origin": [0, 0, heights * base["fluid"]["epsilon"]],
        f"rods.{name}.shape.rotate": {"axis": [1, 0, 0], "degrees": turn},
    } | {path.replace("__", "."): value for path, value in changes.items()})  # fmt: skip


def crossing(force, apart=1.2):
    """The rod and another across it, ``apart`` contact diameters off, pressed onto each other in
    their middles with so many of a/d^2; contact holds against 30."""
    diameter = 1.213 * 0.47
    shape = {"kind": "straight", "points": POINTS, "length": LENGTH}
    push = force * 3.5e-3 / diameter**2
    loads = [{"push": {"s": 0.5 * LENGTH, "force": [f, 0, 0]}} for f in (push, -push)]
    turned = {"axis": [1, 0, 0], "degrees": 90}
    origin = [apart * diameter, 0.5 * LENGTH, 0.5 * LENGTH]
    return changed(ROD, {
        "rods.rod.shape": shape, "rods.rod.strain_twist": [0, 0, 0], "rods.rod.loads": loads[0],
        "rods.other": {**ROD["rods"]["rod"], "strain_twist": [0, 0, 0], "loads": loads[1],
                       "shape": {**shape, "rotate": turned, "origin": origin}},
        "contact": {},
    })  # fmt: skip


def plectoneme(points, epsilons, diameter):
    """A ring with four times the twist at which it buckles, epsilon in spacings."""
    twist = ["0.05*sin(2*s/2.5)", "0.05*cos(3*s/2.5)", 2.7713]
    return changed(RING, {
        "rods.ring.shape": {"kind": "ring", "radius": 2.5, "points": points},
        "rods.ring.strain_twist": twist, "contact": {"diameter": diameter},
        "fluid.epsilon": {"spacings": epsilons}, "time.end": 0.02,
    })  # fmt: skip


def trefoil(diameter):
    """A trefoil knot of length 20 with the linking number -3; an ideal one has 16.4 diameters."""
    c, u = 0.62699, "(2 + cos(3*u))"
    return changed(RING, {
        "rods.ring.shape": {
            "kind": "curve", "closed": True, "points": 120, "from": 0, "to": 2 * math.pi,
            "position": [f"{c}*{u}*cos(2*u)", f"{c}*{u}*sin(2*u)", f"{c}*sin(3*u)"], "turns": 1,
        },
        "rods.ring.strain_twist": [0, 0, 0], "contact": {"diameter": diameter},
        "fluid.epsilon": 0.4, "time.end": 0.05,
    })  # fmt: skip


def ring_twist(omega_r0):
    """A ring with total intrinsic twist 2 pi omega_r0; unstable above about 1.7345."""
    seeded = ["1e-3*cos(0.8*s)", 0, omega_r0 / 2.5]
    return changed(RING, {"rods.ring.strain_twist": seeded, "time.end": 0.2})


def tethered(stiffness):
    """The rod, its end tied to a point in space that it is 1 um away from."""
    link = {"from": [0, 1, LENGTH], "to": {"rod": "rod", "at": "end"}, "stiffness": stiffness}
    return changed(ROD, {"tethers": {"link": link}})


def followed(force, turning=0.0):
    """The rod, pushed at its end along its own axis, and across it at a rate."""
    across = [f"{force}*cos({turning}*t)", f"{force}*sin({turning}*t)"] if turning else [0, 0]
    tip = {"at": "end", "force": [*across, -force], "frame": "triad"}
    return changed(ROD, {"rods.rod.loads": {"tip": tip}})


def sheared(times):
    """The rod, straight at rest, in a shear so many times its threshold of buckling, four units of
    strain: 8 pi mu (gamma/2) L^4/B = 372 at L/epsilon = 12.6, from slender-body theory's slope."""
    gamma = 2 * times * 372 * 3.5e-3 / (8 * math.pi * 1e-6 * LENGTH**4)
    return changed(ROD, {
        "fluid.flow": [f"{gamma}*z", 0, 0], "time.end": 4 / gamma,
        "rods.rod.strain_twist": [0, 0, 0], "rods.rod.moduli.shear": 80.0,
        "rods.rod.shape.rotate": {"axis": [0, 1, 0], "degrees": -60},
    })  # fmt: skip


def swimming(radius=1.0, start=None, base=None):
    """The rod on a motor, 100 turns a second, of a sphere of 50 points; more words of its start."""
    motor = {"hold": "clamped", "to": "head", "motor": {"rate": 628.0}}
    return changed(base or ROD, {
        "bodies": {"head": {"shape": {"kind": "sphere", "radius": radius, "points": 50}}},
        "rods.rod.shape.origin": [0, 0, radius], "rods.rod.start": {**motor, **(start or {})},
    })  # fmt: skip


def hooked(stiffer):
    """The same behind a hook, so many times as stiff as a segment of the rod."""
    return swimming(start={"hook": {"bending": stiffer * 3.5e-3 / SPACING}})


def close_bodies(gap):
    """The same, and another sphere ``gap`` radii beside the first that is pushed onto it."""
    shape = {"kind": "sphere", "radius": 1.0, "points": 50, "origin": [2.0 + gap, 0, 0]}
    return changed(swimming(), {"bodies.other": {"shape": shape, "force": [-1e-2, 0, 0]}})


POWERS = (-3, -2, -1, 1, 2, 3, 4)
SPACING = LENGTH / (POINTS - 1)
SCENES = {
    "moduli, all": {f"x 1e{p}": stiffer(10.0**p) for p in POWERS},
    "shear and stretch": {f"x 1e{p}": stiffer(10.0**p, MODULI[2:]) for p in POWERS},
    "bending and twisting": {f"x 1e{p}": stiffer(10.0**p, MODULI[:2]) for p in POWERS},
    "a/a3": {f"{r:g}": stiffer(1.0 / r, ["twisting"]) for r in (0.1, 0.3, 3.0, 10.0)},
    "epsilon, spacings": {f"{n:g}": rod(fluid__epsilon=n * SPACING)
                          for n in (0.25, 0.5, 1.5, 4, 10, 20, 40)},
    "points at fixed length": {
        **{f"{n}": rod(rods__rod__shape__points=n, rods__rod__strain_twist=[0.3, 0, 0.2])
           for n in (3, 5)},
        **{f"{n}": rod(rods__rod__shape__points=n) for n in (20, 200, 2000)},
        "200, epsilon = 4 spacings": of_shape(200, 4),
        "2000, epsilon = 4 spacings, to 0.1 us": changed(of_shape(2000, 4), {"time.end": 1e-7}),
    },
    "viscosity": {f"{mu:g}": rod(fluid__viscosity=mu) for mu in (1e-9, 1e-7, 1e-4, 1e3)},
    "units": {
        "length x 2^20, mass x 2^-30, time x 2^10": rescaled(2.0**20, 2.0**-30, 2.0**10),
        "metres": rescaled(1e-6, 1e-3, 1e-3),
        "nanometres": rescaled(1e3, 1e6, 1e6),
    },
    "rest state": {
        "Omega ds = 1.992, curvature": rod(rods__rod__strain_twist=[1.992 / SPACING, 0, 0]),
        "Omega ds = 1.992, twist": rod(rods__rod__strain_twist=[0, 0, 1.992 / SPACING]),
        "Omega ds = 2.001": rod(rods__rod__strain_twist=[2.001 / SPACING, 0, 0]),
        "50 turns on 200 points": rod(rods__rod__shape__points=200,
                                      rods__rod__strain_twist=[0, 0, 100 * math.pi / LENGTH]),
    },
    "waves": {
        "sigma = 400 rad/s": TAIL,
        "sigma = 6.28e4 rad/s": changed(TAIL, {"parameters.sigma": 6.28e4, "time.end": 2e-3}),
        "tolerance 0.5": changed(TAIL, {"time.tolerance": 0.5}),
        "steepens to 25 times": changed(TAIL, {
            "rods.tail.strain_twist": ["-k**2*b*sin(k*s + sigma*t)*(1 + 4e8*t**4)", 0, 0]}),
    },
    "starts": {
        "stretched by 2": from_table(stretch=2.0),
        "compressed by half": from_table(stretch=0.5),
        "one triad turned by 179 degrees": from_table(turn=179.0),
        "all triads turned by 179 degrees": from_table(turn=179.0, at_all=True),
        "a triad turned by 180 degrees": from_table(turn=180.0),
    },
    "neighbours": {
        "two rods 0.1 epsilon apart": pair(0.1),
        "on one line": pair(0.0, 0.5 * LENGTH / (POINTS - 1)),
    },
    "at a wall": {
        "2 epsilon above": at_wall(ROD, 2, -90),
        "0.66 epsilon above": at_wall(ROD, 0.66, -90),
        "0.66 epsilon above, moduli x 1e2": at_wall(stiffer(100.0), 0.66, -90),
        "0.1 epsilon above": at_wall(ROD, 0.1, -90),
        "upright, 0.66 epsilon above": at_wall(ROD, 0.66, 0),
        "falling on it, 1000 of its own bending forces": at_wall(ROD, 3, -80, rods__rod__loads={
            "weight": {"along": "all", "force": [0, 0, -1000 * 3.5e-3 / LENGTH**3]}}),
        "flagellum, 2 epsilon above": at_wall(TAIL, 2, -90),
    },
    "contact": {
        **{f"across each other, pressed with {n} a/d^2": crossing(n) for n in (1, 10, 20, 60)},
        "starting 0.7 diameters apart": crossing(0.1, 0.7),
        "starting 0.4 diameters apart": crossing(0.1, 0.4),
        "plectoneme, epsilon = ds": plectoneme(100, 1, 0.4),
        "plectoneme, epsilon = 4 ds": plectoneme(100, 4, 0.6),
        "trefoil, d = L/33": trefoil(0.6),
        "trefoil, tight, d = L/18": trefoil(1.1),
    },
    "ring": {"just below its instability": ring_twist(1.70),
             "just above it": ring_twist(1.80)},
    "acting": {
        **{f"tether, k = 1e{p} g s^-2": tethered(10.0**p) for p in (-2, 0, 2, 4)},
        **{f"follower, f L^2/B = {n}": followed(n * 3.5e-3 / LENGTH**2) for n in (30, 300, 3000)},
        "follower, 300, turning at 6e4 rad/s": followed(300 * 3.5e-3 / LENGTH**2, 6e4),
        **{f"shear, {n} times the threshold": sheared(n) for n in (3, 30, 300)},
    },
    "held": {
        "clamped at one end": rod(rods__rod__start={"hold": "clamped"}),
        "clamped at both ends": rod(rods__rod__start={"hold": "clamped"},
                                    rods__rod__end={"hold": "clamped"}),
        "on a motor of a body": swimming(),
        "a light body, moduli x 1e2": swimming(0.2, base=stiffer(100.0)),
        "motor, 2.5e3 rad/s": swimming(start={"motor": {"rate": 2.5e3}}),
        "motor, 6.28e4 rad/s": swimming(start={"motor": {"rate": 6.28e4}}),
        **{f"hook, {n} times a segment": hooked(n) for n in (1, 100, 10_000)},
        "two bodies 0.05 radii apart": close_bodies(0.05),
    },
    "long": {"rod, 100 times the time": rod(time__end=0.1),
             "ring, 100 times the time": changed(RING, {"time.end": 5.0})},
}  # fmt: skip
