"""Small scenes with bodies and held ends, as plain data, and states of them out of their places."""

import numpy as np
from acting import changed
from scipy.spatial.transform import Rotation

from rodsim.scene.state import State

ROD = {
    "shape": {"kind": "straight", "points": 5, "spacing": 0.17, "origin": [0.1, -0.2, 0.95]},
    "moduli": {"bending": [0.36, 0.42], "twisting": 0.29, "shear": [21.0, 19.0], "stretch": 17.0},
    "strain_twist": [0.9, 0.25, 0.7],
}
MOVE = {"displace": ["0.11*sin(2.3*t)", 0, "0.07*t"], "turn": ["0.4*sin(1.7*t)", "0.3*t", 0]}
BALL = {"shape": {"kind": "sphere", "radius": 0.8, "points": 20, "origin": [0.1, -0.2, 0.1]}}
EGG = {"shape": {"kind": "spheroid", "length": 2.1, "radius": 0.7, "points": 22,
                 "rotate": {"axis": [0.2, 1.3, 0.4], "degrees": 70}, "origin": [2.4, 0.3, 0.4]},
       "force": [0.3, "-0.2*cos(t)", 0.4], "torque": [0.1, 0.2, -0.3]}  # fmt: skip
PLAIN = {
    "fluid": {"viscosity": 1.3, "epsilon": 0.31},
    "rods": {"tail": ROD},
    "time": {"end": 0.6, "tolerance": 1e-8},
}
MOTOR = {"hold": "clamped", "to": "ball", "gap": True, "motor": {"rate": "0.7 + 0.2*sin(t)"}}
SWIMMER = changed(PLAIN, {"bodies": {"ball": BALL}, "rods.tail.start": MOTOR})
TORQUE = {"torque": 0.23, "axis": [0.2, 0.1, 1.1]}
AFAR = [2.4, 0.3, 1.9]
TWO = changed(SWIMMER, {
    "bodies.egg": EGG,
    "rods.tail.start.motor": {**TORQUE, "free_rate": 1.7},
    "rods.tail.start.hook": {"bending": 0.31},
    "rods.other": {**ROD, "start": {"hold": "clamped", "to": "egg", "gap": True,
                                    "motor": {"rate": 0.9, "axis": [0.1, 0.3, 1.2]},
                                    "hook": {"bending": 0.27, "twisting": 0.41}},
                   "end": {"hold": "hinged", "move": MOVE}},
    "rods.other.shape.origin": AFAR,
})  # fmt: skip
SCENES = {
    "clamped and hinged in space": {"rods.tail.start": {"hold": "clamped", "move": MOVE},
                                    "rods.tail.end": {"hold": "hinged"}},
    "rate": SWIMMER,
    "torque": changed(SWIMMER, {"rods.tail.start.motor": TORQUE}),
    "line": changed(SWIMMER, {"rods.tail.start.motor": {**TORQUE, "free_rate": 1.7}}),
    "ball hinge": changed(SWIMMER, {"rods.tail.start": {"hold": "hinged", "to": "ball",
                                                        "gap": True}}),
    "hook": changed(SWIMMER, {"rods.tail.start.hook": {"bending": 0.31}}),
    "hook without motor": changed(SWIMMER, {"rods.tail.start.motor": None,
                                            "rods.tail.start.hook": {"bending": 0.3,
                                                                     "twisting": 0.2}}),
    "wound hook": changed(SWIMMER, {"rods.tail.start.hook": {"bending": 0.31, "twisting": 0.5}}),
    "torque behind a hook": changed(SWIMMER, {"rods.tail.start.motor": TORQUE,
                                              "rods.tail.start.hook": {"bending": 0.31}}),
    "towed": changed(SWIMMER, {"bodies.ball.motion": {"velocity": [0.3, "0.2*t", -0.1],
                                                      "spin": [0.2, 0, 0.5]}}),
    "fixed": changed(SWIMMER, {"bodies.ball.motion": "fixed"}),
    "two bodies, four ends": TWO,
    "a rod between two bodies": changed(SWIMMER, {
        "bodies.egg": EGG, "rods.tail.end": {"hold": "clamped", "to": "egg", "gap": True}}),
}  # fmt: skip
SCENES = {name: scene if "fluid" in scene else changed(PLAIN, scene)
          for name, scene in SCENES.items()}  # fmt: skip


def out_of_place(system, time, seed=5):
    """Return a state whose rods, bodies and rotors have moved and turned; held ends have not yet.

    What a motor turns has turned about its axis, what a hook bends in all directions.
    """
    scene, rng = system.scene, np.random.default_rng(seed)
    start = scene.initial
    position = start.position + 0.03 * rng.normal(size=start.position.shape)
    director = start.director.copy()
    for node in range(scene.nodes):
        turn = Rotation.from_rotvec(0.15 * rng.normal(size=3)).as_matrix()
        director[:, :, node] = director[:, :, node] @ turn.T
    return State(time, position, director, start.tracer, start.work.copy())


def turn_members(case, system, state):
    """Turn the triads of ends on motors without hooks about their axes alone, by 0.4 rad."""
    scene = system.scene
    for body in scene.bodies:
        R = state.director[:, :, body.node].T @ body.turn.T
        for rod in scene.rods:
            for end, node in ((case.rods[rod.name].start, rod.first),
                              (case.rods[rod.name].end, rod.first + rod.count - 1)):  # fmt: skip
                if end is None or end.to != body.name or end.motor is None or end.hook is not None:
                    continue
                triad = scene.initial.director[:, :, node]
                axis = np.array(end.motor.axis or triad[2])
                turn = Rotation.from_rotvec(0.4 * axis / np.linalg.norm(axis)).as_matrix()
                state.director[:, :, node] = triad @ (R @ turn).T
