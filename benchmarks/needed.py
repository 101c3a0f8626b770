"""What is saved by computing and storing only what a scene needs: with and without, one by one."""

import tempfile
import time
from dataclasses import replace
from pathlib import Path

import click
import numpy as np
from common import CONFIGS, Timed, benchmark, interleaved
from kernel import call
from tables import Spread, Table

COLUMNS = {
    "what": "left out",
    "points": "M",
    "full": "with it, us",
    "lean": "without, us",
    "ratio": "with / without",
}
FLAT = ("rods.ring.shape.twist_perturbation=0", "rods.ring.strain_twist=[1.2, 0, 0]",
        "rods.ring.shape.rotate={axis: [0, 1, 0], degrees: 90}")  # fmt: skip
DRIVEN = "rods.ring.strain_twist=['1.2 + 0*t', 0, 0.6]"
PARTS = {
    "loads: weight along the ring": "rods.ring.loads={w: {along: all, force: [0, 0, -1e-4]}}",
    "loads: a follower, driven": "rods.ring.loads={w: {s: 0.3, force: [0, 0, '-1e-4*cos(t)'],"
                                 " frame: triad}}",
    "tethers: one": "tethers={t: {from: {rod: ring, s: 0.3}, to: [3, 0, 0], stiffness: 1e-4}}",
    "contact: nothing touches": "contact={}",
    "fluid.flow: a shear": "fluid.flow=['2.3*z', 0, 0]",
    "fluid.flow: sin, exp, t": "fluid.flow=['sin(2.3*z + t)*exp(-y**2)', 0, 0]",
}  # fmt: skip
ALL_FIELDS = "[position, director, velocity, angular_velocity, force, torque]"


@benchmark(full=21, short=5)
@click.option("--points", type=click.IntRange(8), default=600, show_default=True, help="M.")
def main(quick, repeats, points):
    """Measure pairs of the same work, with and without what a scene may not need; serial, CPU time.

    Both of a pair run in every round, and the ratio is taken within a round. A frame is written
    to a temporary folder.
    """
    with tempfile.TemporaryDirectory() as folder:
        pairs = {**sums(points), **evaluations(points), **parts(points)}
        pairs |= frames(points, Path(folder))
        timers = {
            (name, side): Timed(work, clock=time.process_time)
            for name, both in pairs.items()
            for side, work in zip(("full", "lean"), both, strict=True)
        }
        times = interleaved(timers, repeats, "pairs")
    rows = [
        row(name, points, *(np.array(times[name, s]) for s in ("full", "lean"))) for name in pairs
    ]
    table = Table("Only what is needed", COLUMNS, rows)
    return [table], lambda *axes: draw(rows, *axes)


def row(name, points, full, lean):
    """Return one row of the table."""
    return {
        "what": name,
        "points": points,
        "full": Spread.of(full, 1e6),
        "lean": Spread.of(lean, 1e6),
        "ratio": Spread.of(full / lean),
    }


def sums(points):
    """Return pairs of sums, (32) and (33), over one ring."""
    spatial = call("algebraic7", points, 1, "spatial")
    return {
        "third dimension, sum (plane: yz)": (spatial, call("algebraic7", points, 1, "planar")),
        "angular sum (tracers, flow)": (spatial, call("algebraic7", points, 1, "no_w")),
    }


def evaluations(points):
    """Return pairs of evaluations of a ring: flat, with a constant strain twist, with energies."""
    spatial, planar = system(points, *FLAT), system(points, *FLAT, "plane=yz")
    steady, driven = system(points), system(points, DRIVEN)
    state = steady.scene.initial

    def with_energies():
        evaluate(steady)()
        steady.observe(state)

    return {
        "third dimension, evaluation": (evaluate(spatial), evaluate(planar)),
        "strain twist at every evaluation": (evaluate(driven), evaluate(steady)),
        "energies and power between frames": (with_energies, evaluate(steady)),
    }


def parts(points):
    """Return pairs of evaluations: with a part, its ledger and all, and without it."""
    plain = evaluate(system(points))
    pairs = {name: (evaluate(system(points, text)), plain) for name, text in PARTS.items()}
    pairs["the same list twice (the error of all this)"] = evaluate(system(points)), plain
    heavy = system(points, *list(PARTS.values())[:1])
    pairs["the ledger, of a weight"] = evaluate(heavy), evaluate(without_ledger(heavy))
    return pairs


def system(points, *overrides):
    """Return the system of the closed ring with so many points."""
    from rodsim.case import load_case
    from rodsim.scene.build import build_scene
    from rodsim.scene.system import RodSystem

    change = f"rods.ring.shape.points={points}"
    return RodSystem(build_scene(load_case(CONFIGS / "closed_ring.yaml", [change, *overrides])))


def without_ledger(system):
    """Return a system with the same parts, none of which counts as acting from outside."""
    from rodsim.scene.build import with_parts
    from rodsim.scene.system import RodSystem

    parts = [replace(part, external=False) for part in system.scene.parts]
    return RodSystem(with_parts(system.scene, parts))


def evaluate(system):
    """Return a function that evaluates the rates of a system once."""
    import numba

    state, y, out = system.scene.initial, system.zeros(), system.zeros()

    def once():
        numba.set_num_threads(1)
        system.velocities(0.0, state, y, out)

    return once


def frames(points, folder):
    """Return pairs of writing one frame: with more fields and with the position alone."""
    names = {"all": ALL_FIELDS, "default": "[position, director]", "position": "[position]"}
    writers = {name: frame(points, folder / f"{name}.h5", text) for name, text in names.items()}
    return {
        "director in a frame": (writers["default"], writers["position"]),
        "velocities and loads in a frame": (writers["all"], writers["default"]),
    }


def frame(points, path, fields):
    """Return a function that writes a frame, over and over the same one, of a file of its own."""
    from rodsim.case import load_case
    from rodsim.output.writer import TrajectoryWriter
    from rodsim.run.machine import Machine
    from rodsim.run.recorder import Recorder, plan_output
    from rodsim.run.snapshot import capture
    from rodsim.scene.build import build_scene

    changes = f"rods.ring.shape.points={points}", f"output.fields={fields}", "output.interval=0.1"
    case = load_case(CONFIGS / "closed_ring.yaml", changes)
    scene = build_scene(case)
    machine = Machine(case, scene, force=True)
    snapshot = capture(machine, Recorder(machine, time.perf_counter(), 0.0), scene.initial)
    writer = TrajectoryWriter.create(path, plan_output(case, scene, snapshot))
    fields, observables = machine.system.observe(scene.initial)
    content = fields, observables | machine.gap.measure(scene.initial)
    return lambda: writer.write_frame(0, 0, *content)


def draw(rows, left, right):
    """Left: the ratios; right: the times."""
    names = [row["what"] for row in rows]
    errors = np.array([row["ratio"].error for row in rows]).T
    left.barh(names, [row["ratio"].median for row in rows], xerr=errors, capsize=3)
    left.set(xlabel="with / without")
    for shift, key, label in ((-0.2, "full", "with"), (0.2, "lean", "without")):
        places = np.arange(len(rows)) + shift
        right.barh(places, [row[key].median for row in rows], height=0.4, label=label)
    right.set(xscale="log", xlabel="us", yticks=np.arange(len(rows)), yticklabels=[])
    right.legend()
    for axes in (left, right):
        axes.invert_yaxis()


if __name__ == "__main__":
    main()
