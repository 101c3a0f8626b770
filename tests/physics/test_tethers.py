"""Two rods on a tether: balance, energy, and how fast they come together."""

import numpy as np
import pytest
import twins
from acting import ROD, changed
from scenes import end_of, system_from

from rodsim.forces.elastic import ENERGIES

PAIR = changed(ROD, {
    "rods.rod.strain_twist": [0, 0, 0],
    "rods.other": {**ROD["rods"]["rod"], "strain_twist": [0.4, 0, 0.3]},
    "rods.other.shape.origin": [0.9, 0.4, -0.2],
    "tethers": {"link": {"from": {"rod": "rod", "at": "end"}, "to": {"rod": "other", "s": 0.47},
                         "stiffness": 1.9, "length": 0.6}},
})  # fmt: skip


@pytest.mark.compiled
def test_a_tether_between_rods_has_no_net_force_and_no_net_torque():
    state, system = end_of(PAIR)
    fields, seen = system.observe(state)
    size = abs(fields["force"]).max()
    for name in ("net_force", "net_torque", "external_force", "external_torque"):
        assert seen[name] == pytest.approx([0, 0, 0], abs=1e-12 * size)
    assert seen["external_work"] == 0.0  # it keeps its work as energy


@pytest.mark.compiled
def test_all_energy_of_a_tethered_pair_ends_in_the_fluid():
    """E elastic + E tether falls by what is dissipated; the O(ds^2) of the torque is 1e-3 here."""
    state, system = end_of(PAIR)
    _, start = system.observe(system.scene.initial)
    _, end = system.observe(state)

    def energy(seen):
        return sum(seen[name].sum() for name in (*ENERGIES, "tether_energy"))

    lost = energy(start) - energy(end)
    assert end["tether_energy"][0] < 0.7 * start["tether_energy"][0]
    assert lost > 0.05
    assert lost == pytest.approx(end["dissipated"], rel=5e-3)


def test_two_relaxed_rods_start_to_come_together_as_two_blobs_do():
    """Before they deform only the tether acts: two opposite point forces F at a distance d. Their
    speed of approach is 2 F (H1(0) - H1(d) - d^2 H2(d))/mu, from the twin's scalars."""
    case = changed(PAIR, {"rods.other.strain_twist": [0, 0, 0], "tethers.link.to.s": 5 * 0.13})
    _, system = system_from(case)
    fields, seen = system.observe(system.scene.initial)
    first, second = 11, 12 + 5
    d = system.scene.initial.position[:, second] - system.scene.initial.position[:, first]
    distance = np.linalg.norm(d)
    force = 1.9 * (distance - 0.6)
    h1, h2, *_ = twins.scalars("algebraic7", distance, 0.31)
    here = twins.scalars("algebraic7", 0.0, 0.31)[0]
    expected = 2 * force * (here - h1 - distance**2 * h2) / 1.3
    u = fields["velocity"]
    assert (u[:, first] - u[:, second]) @ d / distance == pytest.approx(expected, rel=1e-9)
    assert seen["tether_energy"] == pytest.approx([0.5 * 1.9 * (distance - 0.6) ** 2], rel=1e-12)


@pytest.mark.compiled
@pytest.mark.parametrize(("only", "length", "kept"), [("pull", 3.0, True), ("push", 0.2, True),
                                                      (None, 3.0, False)])  # fmt: skip
def test_a_slack_tether_changes_nothing(only, length, kept):
    """The bits of the pair without it; a spring of the same length does push."""
    link = {**PAIR["tethers"]["link"], "length": length, "only": only}
    with_it, _ = end_of(changed(PAIR, {"tethers.link": link}))
    without, _ = end_of(changed(PAIR, {"tethers": None}))
    assert (with_it.position == without.position).all() == kept
    assert (with_it.director == without.director).all() == kept


@pytest.mark.compiled
def test_a_trap_holds_a_rod_against_its_weight():
    """At rest the trap carries all of it, f L, a distance f L/k above; so does its energy."""
    weight = {"weight": {"along": "all", "force": [0, 0, -0.4]}}
    trap = {"from": [0, 0, 0], "to": {"rod": "rod", "at": "end"}, "stiffness": 3.1}
    hung = changed(ROD, {
        "rods.rod.loads": weight, "tethers": {"trap": trap}, "time.end": 200.0,
        "rods.rod.strain_twist": [0, 0, 0], "time.tolerance": 1e-6,
        "rods.rod.shape.rotate": {"axis": [1, 0, 0], "degrees": 10},
        "rods.rod.shape.origin": [0, 0, -2.0],
    })  # fmt: skip
    state, system = end_of(hung)
    _, seen = system.observe(state)
    load = 0.4 * 11 * 0.13
    assert state.position[2, -1] == pytest.approx(-load / 3.1, rel=1e-5)
    assert seen["tether_energy"] == pytest.approx([0.5 * load**2 / 3.1], rel=1e-5)
    assert seen["net_force"] == pytest.approx([0, 0, 0], abs=1e-4 * load)
