"""How bodies move, and what their motors do: quantities of ``rodsim measure``."""

from __future__ import annotations

import numpy as np

from rodsim.analysis.swimming import mean_rate, rate
from rodsim.scene.quaternions import to_matrix


class BodyFrame:
    """A body at one frame of a run.

    position (3,) of its centre; turn (3, 3) from its own frame to space; spin (3,), its angular
    velocity.
    """

    def __init__(self, frame, body: str):
        self._frame, self.name, self.time = frame, body, frame.time
        self._index = frame.run.bodies.index(body)

    def _read(self, name):
        return self._frame.run.of_bodies(name, self._frame.number)[self._index]

    @property
    def position(self) -> np.ndarray:
        """Where its centre is."""
        return self._read("position")

    @property
    def turn(self) -> np.ndarray:
        """The rotation matrix of its orientation."""
        return to_matrix(self._read("orientation"))

    @property
    def spin(self) -> np.ndarray:
        """Its angular velocity."""
        return self._read("angular_velocity")

    def observable(self, name: str) -> float:
        """Return a stored number of the whole scene."""
        return float(np.sum(self._frame.observable(name)))


class MotorFrame:
    """A motor at one frame of a run, by the rod's end that it turns."""

    def __init__(self, frame, motor: str):
        self._frame, self.name, self.time = frame, motor, frame.time
        self._index = motors_of(frame.run).index(motor)

    def observable(self, name: str) -> float:
        """Return its own value of what every motor has."""
        return float(self._frame.observable(name)[self._index])


def motors_of(run) -> list[str]:
    """Return the ends that motors turn, such as ``tail.start``, in order."""
    return run.labels("motor_rate") if "motor_rate" in run.observables else []


def motors_of_case(case) -> list[str]:
    """Return the same of a resolved case."""
    return [
        f"{name}.{which}"
        for name, rod in case["rods"].items()
        for which in ("start", "end")
        if (rod.get(which) or {}).get("motor")
    ]


def place(body) -> np.ndarray:
    """Return where a body is and where its own z axis points, (6,)."""
    return np.append(body.position, body.turn[:, 2])


def place_and_work(body) -> np.ndarray:
    """Return the same and the work of all motors, (7,)."""
    return np.append(place(body), body.observable("motor_work"))


def _path(values):
    """Return the axis of a path: the mean over time of the body's z axis, a unit vector."""
    axis = values[:, 3:6].mean(axis=0)
    return axis / np.linalg.norm(axis)


def swimming_speed(time, values, *_):
    """Return the velocity (T,) along the axis of the path, > 0 along the body's own z axis."""
    return rate(time, values[:, :3]) @ _path(values)


def swimming_speed_of_run(time, values, *_):
    """Return the slope of the straight line through the places, along the axis of the path."""
    return mean_rate(time, values[:, :3]) @ _path(values)


def froude(time, values, body, run):
    """Return R U^2/P (T,): drag of the body alone, speed along the path, power of all motors.

    R is the drag of the body along its own z axis, which is that of a body of revolution.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        return _drag(body, run) * swimming_speed(time, values) ** 2 / rate(time, values[:, 6])


def froude_of_run(time, values, body, run):
    """Return the same of the mean speed and the mean power."""
    power = (values[-1, 6] - values[0, 6]) / (time[-1] - time[0])
    return _drag(body, run) * swimming_speed_of_run(time, values) ** 2 / power


def _drag(body, run):
    return run.body(body)["resistance"][2, 2]
