"""The fluid around a stored run: against what the run stored, twins, and tracers it carried."""

import h5py
import numpy as np
import pytest
import twins
from scenes import load

from rodsim import open_trajectory, simulate
from rodsim.analysis.flow import flow_at, tracer_paths
from rodsim.analysis.grid import make_grid
from rodsim.analysis.replay import Replay
from rodsim.case import load_case

FIELDS = "output.fields=[position,director,velocity,force,torque]"
TWO_RODS = """
fluid: {viscosity: 1.7e-6, epsilon: 0.57, blob: algebraic9}
parameters: {sigma: 300}
rods:
  ring:
    shape: {kind: ring, radius: 0.7, points: 30, twist_perturbation: 0.8}
    moduli: {bending: [3.1e-3, 3.4e-3], twisting: 2.9e-3, shear: 0.8, stretch: 0.7}
    strain_twist: [1.2, 0, "0.6*cos(sigma*t)"]
  rod:
    shape: {kind: file, path: rod.txt, spacing: 0.1466}
    moduli: {bending: 3.3e-3, twisting: 2.7e-3, shear: 0.6, stretch: 0.9}
    strain_twist: [1.3, 0.2, 1.5]
time: {end: 2.0e-3, tolerance: 1.0e-6}
output: {interval: 4.0e-4, fields: [position, director, velocity, force, torque]}
"""


@pytest.fixture(scope="module")
def two_rods(tmp_path_factory):
    """A run of two rods, one of a shape file that is gone by now."""
    folder = tmp_path_factory.mktemp("run")
    table = np.zeros((14, 12))
    table[:, 0], table[:, 2] = 0.3, 0.1466 * np.arange(14) - 0.9
    table[:, 3:] = np.eye(3).ravel()
    np.savetxt(folder / "rod.txt", table)
    (folder / "case.yaml").write_text(TWO_RODS)
    simulate(load_case(folder / "case.yaml"), folder / "out.h5")
    (folder / "rod.txt").unlink()
    (folder / "case.yaml").unlink()
    return folder / "out.h5"


@pytest.mark.parametrize("frame", [0, 3, 5])
def test_the_fluid_moves_with_the_rods_own_points(two_rods, frame):
    """The raw loads and velocities are those the run stored: other rooms, the same formulas."""
    with open_trajectory(two_rods) as run:
        sources = Replay(run).sources(frame)
        for found, name in ((sources.loads[:3].T, "force"), (sources.loads[3:].T, "torque")):
            stored = run.read(name, frame)
            # Rounding of strains near 1e-2, with ds = 0.15, against moduli near 1.
            assert found == pytest.approx(stored, abs=1e-12 * abs(stored).max())
        if frame == 0:  # later ones are the derivative of the motion, not evaluated at the frame
            speed = run.read("velocity", frame)
            found = sources.velocity(run.read("position", frame))
            assert found == pytest.approx(speed, abs=1e-10 * abs(speed).max())


def test_flow_on_a_grid_equals_its_twin(two_rods):
    with open_trajectory(two_rods) as run:
        flow = flow_at(
            Replay(run), 4, make_grid("0.2,-1:1:3,-0.6:1.1:4", run.position[4]), raw=True
        )
        X, g, m = (run.read(name, 4) for name in ("position", "force", "torque"))
    assert flow.time == pytest.approx(1.6e-3)
    expected, _ = twins.velocity(flow.grid.points, X, g, m, 0.57, 1.7e-6, "algebraic9")
    assert flow.velocity == pytest.approx(expected, abs=1e-10 * abs(expected).max())
    pressure = np.zeros(12)
    for i, x in enumerate(flow.grid.points):
        for source, f in zip(X, g, strict=True):
            r = x - source
            pressure[i] += f.dot(r) * twins.scalars("algebraic9", np.linalg.norm(r), 0.57)[2]
    assert flow.pressure == pytest.approx(pressure, abs=1e-10 * abs(pressure).max())


def test_flow_on_a_grid_is_incompressible_and_balances_the_pressure(two_rods):
    """div u = 0 and mu Laplace(u) = grad p - f psi, by central differences on a fine box."""
    h = 0.01
    with open_trajectory(two_rods) as run:
        text = ",".join(f"{c}:{c + 4 * h}:5" for c in (3.1, -2.2, 1.9))
        flow = flow_at(Replay(run), 2, make_grid(text, run.position[2]))
        X, g = run.read("position", 2), run.read("force", 2)
    u = flow.velocity.reshape(5, 5, 5, 3)
    p = flow.pressure.reshape(5, 5, 5)
    gradient = [np.gradient(u[..., c], h, axis=c) for c in range(3)]
    size = max(abs(part).max() for part in gradient)
    inside = np.s_[1:-1, 1:-1, 1:-1]
    # Second differences: relative error h^2 / distance^2, near 1e-5.
    assert sum(gradient)[inside] == pytest.approx(0.0, abs=1e-4 * size)
    middle, laplacian = (2, 2, 2), 0.0
    for axis in range(3):
        laplacian = (
            laplacian
            + np.diff(u, 2, axis=axis)[tuple(1 if axis == a else 2 for a in range(3))] / h**2
        )
    grad_p = np.array([np.gradient(p, h, axis=axis)[middle] for axis in range(3)])
    # The blobs' tails are left out: 7.5 (eps/r)^4 = 6e-3 of the gradient at r = 3.4.
    assert 1.7e-6 * laplacian == pytest.approx(grad_p, abs=1e-2 * abs(grad_p).max())
    assert np.linalg.norm(X - flow.grid.points[62], axis=1).min() > 2.5
    assert abs(g).max() > 0


@pytest.mark.compiled
def test_settling_keeps_the_motion_and_removes_noise(tmp_path):
    """Noise of 1e-6 of the length changes the raw flow much, the settled one a tenth of that."""
    simulate(
        load(
            "closed_ring",
            "rods.ring.shape.points=60",
            "time.end=0.02",
            "output.interval=5e-3",
            "time.tolerance=1e-7",
        ),
        tmp_path / "out.h5",
    )

    def both():
        with open_trajectory(tmp_path / "out.h5") as run:
            replay = Replay(run)
            assert not replay.rough
            replay.rough = True
            raw = replay.sources(2)
            return raw.velocity(raw.position.T), replay.settled_velocity(2)

    raw, settled = both()
    # Motions of 100 1/s against 10 steps of 1/rho = 2.4e-4 s: n x = 0.02, its square 4e-4, and
    # bending modes near 1e3 1/s a little more.
    assert settled == pytest.approx(raw, abs=0.03 * abs(raw).max())
    with h5py.File(tmp_path / "out.h5", "r+") as file:
        value = file["particles/trajectory/position/value"]
        value[2] += 1.5e-5 * np.random.default_rng(5).normal(size=value[2].shape)
    rough, smooth = both()
    noise = abs(rough - raw).max()
    assert noise > 0.05 * abs(raw).max()
    assert abs(smooth - settled).max() < 0.2 * noise


@pytest.mark.compiled
def test_tracers_afterwards_follow_those_the_run_carried(tmp_path):
    case = load(
        "open_rod",
        "time.end=2e-3",
        "time.tolerance=1e-6",
        "output.interval=2e-5",
        "tracers={a: {kind: tube, rod: rod, radius: 0.37, around: 3, along: 5}}",
    )
    simulate(case, tmp_path / "out.h5")
    with open_trajectory(tmp_path / "out.h5") as run:
        carried = run.tracers
        paths = tracer_paths(Replay(run), carried[20], 20, 100)
        moved = np.linalg.norm(carried[100] - carried[20], axis=1).max()
        assert moved > 0.05
        assert paths.position[0] == pytest.approx(carried[20])
        # Linear in between frames: (rate x interval)^2/12 = (2e3 x 2e-5)^2/12 of the motion a
        # frame; the settling shifts rates of 2e3 1/s by (2e3 x 3.4e-5)^2 = 0.5 %.
        assert paths.position == pytest.approx(carried[20:], abs=0.02 * moved)
        assert paths.miss.max() < 0.02 * moved
        assert np.array_equal(paths.time, run.time[20:])


def test_a_file_without_triads_says_what_is_missing(tmp_path):
    case = load(
        "closed_ring", "rods.ring.shape.points=20", "time.end=1e-4", "output.fields=[position]"
    )
    simulate(case, tmp_path / "out.h5")
    with (
        open_trajectory(tmp_path / "out.h5") as run,
        pytest.raises(Exception, match="has no director"),
    ):
        Replay(run)
