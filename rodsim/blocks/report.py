"""What frames say of blocks: bodies, motors, hooks, what holds and drives them."""

from __future__ import annotations

import numpy as np

from rodsim.blocks import fields as f
from rodsim.compiled.parts import Gauge

FORCE, ENERGY = (1, 1, -2), (1, 2, -2)


class Report:
    """Reads what an evaluation has left in the numbers of the blocks.

    driven : whether anything acts from outside. gauges, series : of the part that holds.
    """

    def __init__(self, blocks, scene):
        self.scene = scene
        self.blocks = tuple(blocks)
        self.members = tuple(member for block in blocks for member in block.members)
        self.held = [b for b, block in enumerate(blocks) if not block.free]
        self.motors = [q for q, m in enumerate(self.members) if m.joint.motor != f.STILL]
        self.hooks = [q for q, m in enumerate(self.members) if m.joint.kind == f.HOOKED]
        self.driven = bool(self.held or self.motors)

    @property
    def gauges(self) -> tuple[Gauge, ...]:
        """Work and impulse of holders and motors, turns of motors, a share of a flow's work."""
        everywhere, held = ("flow_work", "external_work", "dissipated"), bool(self.held)
        holders, motors = (len(self.held), 3), (len(self.motors),)
        return (
            Gauge("anchor_work", ENERGY, ("external_work",), held),
            Gauge("motor_work", ENERGY, ("external_work",), bool(self.motors)),
            Gauge("surface_work", ENERGY, everywhere, False),
            Gauge("anchor_impulse", (1, 1, -1), (), held, holders),
            Gauge("anchor_angular_impulse", (1, 2, -1), (), held, holders),
            Gauge("motor_impulse", (1, 2, -1), (), False, motors),
            Gauge("motor_angle", (0, 0, 0), (), bool(self.motors), motors),
        )

    @property
    def series(self) -> tuple:
        """Observables beyond those of the ledger: (name, shape, dimension) each."""
        found, holders, motors = [], (len(self.held), 3), (len(self.motors),)
        if self.held:
            found += [("anchor_force", holders, FORCE), ("anchor_torque", holders, ENERGY)]
        if self.motors:
            found += [("motor_torque", motors, ENERGY), ("motor_rate", motors, (0, 0, -1))]
        if self.hooks:
            found.append(("hook_energy", (len(self.hooks),), ENERGY))
        return tuple(found)

    @property
    def labels(self) -> dict[str, tuple[str, ...]]:
        """Whose the rows of observables are: bodies and ends of rods such as ``tail.start``."""
        held = tuple(self.blocks[b].name for b in self.held)
        motors, hooks = (
            tuple(self.members[q].name for q in chosen) for chosen in (self.motors, self.hooks)
        )
        anchors = ("force", "torque", "impulse", "angular_impulse")
        found = {f"anchor_{name}": held for name in anchors if held}
        found |= {f"motor_{name}": motors for name in ("torque", "rate", "angle") if motors}
        return found | ({"hook_energy": hooks} if hooks else {})

    def __call__(self, fixed, rates, state) -> tuple[dict, np.ndarray]:
        """Return observables by name, and the correction of the net force and torque (6,).

        Forces and torques of holders and motors are rates of the gauges: those of an interpolated
        state would be what its stiffest modes make of the interpolation's errors.
        """
        seen = fixed[int(fixed[f.GAUGES]) :]
        forces, torques, motor_torques, motor_rates = self._split(seen if rates is None else rates)
        found = {}
        if self.held:
            found |= {"anchor_force": forces, "anchor_torque": torques}
        if self.motors:
            found |= {"motor_torque": motor_torques, "motor_rate": motor_rates}
        if self.hooks:
            begin = int(fixed[f.MEMBER_LEFT])
            members = fixed[begin : begin + f.LEFT * len(self.members)].reshape(-1, f.LEFT)
            found["hook_energy"] = members[self.hooks, f.ENERGY]
        now_forces, now_torques = self._split(seen)[:2]
        forces, torques = forces - now_forces, torques - now_torques
        begin = int(fixed[f.BLOCK_LEFT])
        blocks = fixed[begin : begin + f.BLOCK_ROOM * len(self.blocks)].reshape(-1, f.BLOCK_ROOM)
        moments = np.cross(blocks[self.held, :3], forces) + torques
        return found, np.append(forces.sum(axis=0), moments.sum(axis=0))

    def _split(self, gauges):
        """Return the forces and torques (H, 3) of holders, torques and rates (K,) of motors."""
        sizes = np.cumsum([f.HOLDERS, *[3 * len(self.held)] * 2, len(self.motors)])
        _, forces, torques, motor_torques, motor_rates = np.split(gauges, sizes)
        return forces.reshape(-1, 3), torques.reshape(-1, 3), motor_torques, motor_rates

    def pressure(self, points, sources, loads, t, left):
        """Return the pressure (T,) of the surfaces at points (3, T)."""
        from rodsim.blocks.skins import surface_pressure

        return surface_pressure(self.scene, points, left)
