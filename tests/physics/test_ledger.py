"""The ledger: E(t) - E(0) = W - dissipated, to the O(ds^2) of the torque (31)."""

from dataclasses import replace

import numpy as np
import pytest
from acting import ROD, changed
from scenes import end_of, last, system_from

from rodsim.forces.elastic import ENERGIES
from rodsim.integrators.make import make_integrator
from rodsim.scene.build import with_parts
from rodsim.scene.system import RodSystem

LENGTH = 11 * 0.13
ALL = {
    "fluid.flow": ["0.4*z*cos(2.3*t)", "0.2*x", -0.1],
    "rods.rod.loads": {
        "weight": {"along": "all", "force": [0.3, -0.2, "-0.7*exp(-t)"]},
        "tip": {"at": "end", "force": [0, 0.3, -0.9], "torque": [0.2, 0, 0], "frame": "triad"},
    },
    "tethers": {"link": {"from": {"rod": "rod", "at": "start"}, "to": [0.3, 0.9, 1.1],
                         "stiffness": 1.3}},
}  # fmt: skip
SCENES = {
    "weight": {"rods.rod.loads": {"weight": ALL["rods.rod.loads"]["weight"]}},
    "follower": {"rods.rod.loads": {"tip": ALL["rods.rod.loads"]["tip"]}},
    "tether": {"tethers": ALL["tethers"]},
    "flow": {"fluid.flow": ALL["fluid.flow"]},
    "all": ALL,
}


def energy(seen):
    stored = sum(seen[name].sum() for name in ENERGIES)
    return stored + sum(seen.get("tether_energy", [0.0]))


def balance(points, scene, tolerance=1e-10):
    """Return E(t) - E(0), and by how much W - dissipated misses it."""
    case = changed(ROD, {**scene, "rods.rod.shape.points": points,
                         "rods.rod.shape.spacing": LENGTH / (points - 1), "time.end": 0.3,
                         "time.tolerance": tolerance})  # fmt: skip
    state, system = end_of(case)
    start, end = (system.observe(s)[1] for s in (system.scene.initial, state))
    assert start["external_work"] == start["dissipated"] == 0.0
    gained = energy(end) - energy(start)
    return gained, end["external_work"] - end["dissipated"] - gained


@pytest.mark.compiled
@pytest.mark.parametrize("name", SCENES)
def test_the_ledger_closes_with_second_order_in_the_spacing(name):
    """Epsilon stays, the points double; the error in time is 100 times smaller. Seen: 1.96-2.06."""
    found = [balance(points, SCENES[name]) for points in (13, 25, 49)[: 2 + (name == "all")]]
    misses = np.abs([miss for _, miss in found])
    assert misses[-1] < 1e-4 * abs(found[-1][0])
    orders = np.log2(misses[:-1] / misses[1:])
    assert orders == pytest.approx(np.full(len(orders), 2.0), abs=0.1)


@pytest.mark.compiled
def test_work_is_power_over_time_part_by_part():
    """W of each part against Simpson's rule over its power at dense frames."""
    case, system = system_from(changed(ROD, {**ALL, "time.tolerance": 1e-9, "time.end": 0.2}))
    times, at, work = np.linspace(0.0, 0.2, 41), 0, {"loads": [], "flow": []}
    steps = make_integrator(case.time, system).steps(system.scene.initial, case.time.end)
    for step in steps:
        while at < len(times) and times[at] <= step.end.time * (1 + 1e-12):
            state = step.at(min(times[at], step.end.time))
            y = system.zeros()
            rates = system.velocities(state.time, state, y, system.zeros())
            for i, name in enumerate(work):
                work[name].append((state.work[i], rates[system.size - 3 + i]))
            at += 1
    for name, seen in work.items():
        done, power = np.array(seen).T
        third = (times[1] - times[0]) / 3
        simpson = third * (power[0] + power[-1] + 4 * power[1::2].sum() + 2 * power[2:-1:2].sum())
        # Powers at states inside a step hold what is left there of stiff modes: seen 2e-5.
        assert done[-1] == pytest.approx(simpson, rel=1e-3), name
        assert done[0] == 0.0


@pytest.mark.compiled
def test_the_ledger_changes_no_bit_of_the_motion():
    """Its numbers are no part of the error of a step, nor of anything else. (One load a point: of
    several, the sum is made first where work is counted, which rounds differently.)"""
    one = {**ALL, **SCENES["weight"]}
    case, system = system_from(changed(ROD, {**one, "time.tolerance": 1e-5}))
    bare = with_parts(system.scene, [replace(p, external=False) for p in system.scene.parts])
    ends = []
    for scene in (system.scene, bare):
        integrator = make_integrator(case.time, RodSystem(scene))
        ends.append(last(integrator.steps(scene.initial, case.time.end)).end)
    assert ends[0].work.size == 3
    assert ends[1].work.size == 0
    assert (ends[0].position == ends[1].position).all()
    assert (ends[0].director == ends[1].director).all()


@pytest.mark.compiled
@pytest.mark.parametrize("method", ["euler", "rk4"])
def test_methods_of_fixed_step_keep_the_ledger_too(method):
    fixed = {"time": {"end": 0.2, "integrator": method, "step": 1e-4}}
    state, _ = end_of(changed(ROD, {**ALL, **fixed}))
    exact, _ = end_of(changed(ROD, {**ALL, "time.end": 0.2, "time.tolerance": 1e-10}))  # 2e-7
    assert state.work == pytest.approx(exact.work, rel=2e-2 if method == "euler" else 1e-6)
    assert (exact.work[[0, -1]] != 0).all()


def test_a_scene_without_anything_from_outside_keeps_no_ledger():
    _, system = system_from(ROD)
    _, seen = system.observe(system.scene.initial)
    assert system.scene.ledger == 0
    assert not {"dissipated", "external_work", "external_force"} & seen.keys()
