"""Real runs as processes, killed at random times, again and again, until they have finished.

The result is compared, bit for bit, with that of a run nobody has touched. ``RODSIM_KILLS`` sets
the number of kills of the long test.
"""

import os
import random
import subprocess
import sys
import time

import pytest
from contents import differences

from rodsim import open_trajectory

pytestmark = pytest.mark.compiled  # a process without the JIT is too slow to be killed often

CASE = """
fluid: {viscosity: 1.3e-6, epsilon: 0.3, density: 2.0e-12}
rods:
  tail:
    shape: {kind: straight, points: 40, spacing: 0.11, perturbation: 1.0e-4}
    moduli: {bending: 3.5e-3, twisting: 2.5e-3, shear: 0.7, stretch: 0.9}
    strain_twist: ["1.3*sin(3*s + 900*t)", 0, 0.4]
  ring:
    shape: {kind: ring, radius: 0.9, points: 50, origin: [0.2, 2.1, 0.3], twist_perturbation: 0.7}
    moduli: {bending: 3.5e-3, twisting: 2.5e-3, shear: 0.7, stretch: 0.9}
    strain_twist: [1.2, 0, 0.6]
tracers:
  tube: {kind: tube, rod: ring, radius: 0.2, around: 3, along: 5}
time: {end: 0.02, tolerance: 1.0e-6}
output: {interval: 1.0e-4, fields: [position, director, velocity]}
"""
EULER = ("time.integrator=euler", "time.step=2e-6", "time.end=6e-3", "output.interval=5e-5")


def start(folder, *arguments):
    return subprocess.Popen(
        [sys.executable, "-m", "rodsim", *arguments],
        cwd=folder, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def finish(process, code=0):
    _, said = process.communicate()
    assert process.returncode == code, said
    assert "Traceback" not in said


def checked(path):
    """Return how many frames a killed file has; all of them are there, and so is a checkpoint."""
    with open_trajectory(path) as run:
        assert all((run.read(name) == run.read(name)).all() for name in run.fields)  # no NaN
        assert run.checkpoint() is not None
        return run.frames


def resumes(path):
    with open_trajectory(path) as run:
        return len(run.resumes)


def kill_until_finished(folder, rng, options, whole, kills, pace):
    """Run and resume, killing after ``pace`` seconds on average; return (kills, frames lost).

    Frames lost: those that a kill has taken from what the file had. It must be none.
    """
    path, survived, lost, frames, went_on = folder / "out.h5", 0, 0, 0, 0
    process = start(folder, "run", "case.yaml", "-q", *options)
    # At first wait for the file: a kill before it appears leaves nothing, and proves little.
    while not path.exists() and process.poll() is None:
        time.sleep(0.005)
    while True:
        limit = rng.expovariate(1 / pace) if survived < kills else None
        while rng.random() < 0.99 and resumes(path) < went_on and process.poll() is None:
            time.sleep(0.02)  # starting Python is seldom what is to be killed
        try:
            process.wait(limit)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            survived += 1
            now = checked(path)
            lost += max(0, frames - now)
            frames = max(frames, now)
            went_on = resumes(path) + 1
            process = start(folder, "resume", "out.h5", "-q")
        else:
            finish(process)
            assert differences(path, whole) == []
            return survived, lost


def harness(tmp_path, kills, seed, schemes, pace=0.25):
    """Kill runs of the schemes in turn, until there were enough kills."""
    rng, total, runs, lost = random.Random(seed), 0, 0, 0
    (tmp_path / "case.yaml").write_text(CASE)
    options = {}
    for name, changes in schemes.items():
        options[name] = [word for change in changes for word in ("--set", change)]
        finish(start(tmp_path, "run", "case.yaml", "-q", "-o", f"{name}.h5", *options[name]))
    while total < kills:
        name = list(schemes)[runs % len(schemes)]
        folder = tmp_path / f"{runs}"
        folder.mkdir()
        (folder / "case.yaml").write_text(CASE)
        whole = tmp_path / f"{name}.h5"
        done = kill_until_finished(folder, rng, options[name], whole, kills - total, pace)
        total, lost, runs = total + done[0], lost + done[1], runs + 1
        assert sorted(os.listdir(folder)) == ["case.yaml", "out.h5"]
        print(f"{total} kills in {runs} runs, {lost} acknowledged frames lost", flush=True)
    assert lost == 0


def test_killed_five_times(tmp_path):
    harness(tmp_path, kills=5, seed=5, schemes={"rkc": ()}, pace=0.06)


@pytest.mark.long
def test_killed_hundreds_of_times(tmp_path):
    kills = int(os.environ.get("RODSIM_KILLS", "220"))
    harness(tmp_path, kills, seed=20130101, schemes={"rkc": (), "euler": EULER})
