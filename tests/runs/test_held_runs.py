"""Runs with bodies, motors, hooks and anchors: files, resume, and what other commands do."""

import shutil

import numpy as np
import pytest
from click.testing import CliRunner
from contents import differences

from rodsim import load_case, open_trajectory, resume, simulate
from rodsim.blocks.surface import surface_of
from rodsim.blocks.words import Spherocylinder
from rodsim.cli import main
from rodsim.output.verify import verify
from rodsim.scene.build import build_scene

MODULI = "moduli: {bending: 3.5e-3, twisting: 3.3e-3, shear: 0.8, stretch: 0.9}"
END = "time: {end: 1.1e-3, tolerance: 1.0e-4}\noutput: {interval: 2.5e-4}\n"
SWIMMER = f"""
fluid: {{viscosity: 1.3e-6, epsilon: 0.25}}
bodies:
  cargo:
    shape: {{kind: file, path: cargo.csv, origin: [0.1, 0.2, 0.3]}}
    force: [0, "2.0e-6*sin(700*t)", -1.2e-6]
rods:
  tail:
    shape:
      {{kind: straight, points: 7, spacing: 0.22, origin: [0.1, 0.2, 1.35], perturbation: 0.01}}
    {MODULI}
    start:
      hold: clamped
      to: cargo
      motor: {{rate: "2*pi*90*min(t/4e-4, 1)"}}
      hook: {{bending: 3.0e-4, twisting: 2.0e-4}}
tracers:
  here: [[0.9, 1.4, 0.5]]
{END}"""
TOWED = f"""
fluid: {{viscosity: 1.3e-6, epsilon: 0.25}}
bodies:
  cell:
    shape: {{kind: spheroid, length: 2.2, radius: 0.6, points: 20, origin: [0.1, 0.2, 0.3]}}
    motion: {{velocity: [0, "2700*t", 0], turn: [0, 0, "300*t"]}}
rods:
  flag:
    shape: {{kind: straight, points: 7, spacing: 0.23, origin: [0.1, 0.2, 1.4]}}
    {MODULI}
    start: {{hold: clamped, to: cell, motor: {{torque: 7.0e-4, free_rate: 900}}}}
{END}"""
CILIUM = f"""
fluid: {{viscosity: 1.3e-6, epsilon: 0.25}}
rods:
  cilium:
    shape: {{kind: straight, points: 7, spacing: 0.21, origin: [-2.5, 0, 0]}}
    {MODULI}
    start:
      hold: clamped
      move: {{displace: [0.002, "0.003*cos(900*t)", 0], turn: ["0.01 + 0.2*sin(900*t)", 0, 0]}}
{END}"""
SCENES = {"swimmer": SWIMMER, "towed": TOWED, "cilium": CILIUM}


def make(folder, text, overrides=()):
    cargo = Spherocylinder(kind="spherocylinder", length=1.9, radius=0.5, points=24)
    points = surface_of(cargo, "algebraic7").skin.T
    np.savetxt(folder / "cargo.csv", points, delimiter=",", header="x,y,z", comments="")
    (folder / "case.yaml").write_text(text)
    return load_case(folder / "case.yaml", overrides)


@pytest.fixture(scope="module", params=SCENES)
def whole(request, tmp_path_factory):
    """An unbroken run, and copies of its file after every step; the table it read is gone."""
    folder = tmp_path_factory.mktemp("whole")
    path, kept = folder / "out.h5", []

    def stop():
        kept.append(shutil.copy(path, folder / f"{len(kept)}.h5"))
        return ""

    simulate(make(folder, SCENES[request.param]), path, stop=stop)
    (folder / "cargo.csv").unlink()
    return path, kept


def test_what_is_held_goes_on_with_the_same_bits(whole, tmp_path):
    path, kept = whole
    assert len(kept) > 10
    for number in (0, len(kept) // 2, len(kept) - 2):
        copy = shutil.copy(kept[number], tmp_path)
        resume(copy)
        assert differences(copy, path) == []


def test_a_later_end_and_more_fields_keep_what_is_there(whole, tmp_path):
    path, _ = whole
    copy = shutil.copy(path, tmp_path)
    with open_trajectory(path) as run:
        before = {name: run.observable(name) for name in run.observables}
        bodies = run.bodies and run.of_bodies("position")
        rotors, frames = run.of_rotors(), run.frames
    resume(copy, overrides=["time.end=1.4e-3"])
    with open_trajectory(copy) as run:
        assert run.time[-1] == pytest.approx(1.4e-3)
        assert verify(run) == []
        for name, values in before.items():
            assert np.array_equal(run.observable(name)[:frames], values)
        assert np.array_equal(run.of_rotors()[:frames], rotors)
        if run.bodies:
            assert np.array_equal(run.of_bodies("position")[:frames], bodies)
            assert len(run.of_bodies("orientation")) == run.frames


def test_the_commands_read_it(whole, tmp_path):
    path, _ = whole
    for arguments in (["info", path, "--check"], ["energy", path],
                      ["export", path, "-o", tmp_path / "out.csv"],
                      ["export", path, "-o", tmp_path / "out.npz"]):  # fmt: skip
        done = CliRunner().invoke(main, [str(argument) for argument in arguments])
        assert done.exit_code == 0, done.output


def test_a_rod_starts_from_such_an_output(whole, tmp_path):
    path, _ = whole
    with open_trajectory(path) as run:
        rod, end = run.rods[0].name, run.position[-1]
        triads = run.director[-1]
    text = f"""
fluid: {{viscosity: 1.3e-6, epsilon: 0.25}}
rods:
  again:
    shape: {{kind: file, path: {path}, rod: {rod}}}
    {MODULI}
    start: {{hold: clamped, motor: {{rate: 300}}}}
time: {{end: 1.0e-4}}
"""
    scene = build_scene(make(tmp_path, text))
    assert np.array_equal(scene.initial.position.T, end)
    assert np.array_equal(scene.initial.director.transpose(2, 0, 1), triads)
