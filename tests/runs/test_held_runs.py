"""Runs with bodies, motors, hooks and anchors: files, resume, and what other commands do."""

import shutil

import numpy as np
import pytest
from contents import differences

from rodsim import load_case, open_trajectory, resume, simulate
from rodsim.blocks.surface import surface_of
from rodsim.blocks.words import Spherocylinder

MODULI = "moduli: {bending: 3.5e-3, twisting: 3.3e-3, shear: 0.8, stretch: 0.9}"
ALL = f"""
fluid: {{viscosity: 1.3e-6, epsilon: 0.25}}
bodies:
  cell:
    shape: {{kind: spheroid, length: 2.2, radius: 0.6, points: 20, origin: [0.1, 0.2, 0.3]}}
    force: [0, "2.0e-6*sin(700*t)", -1.2e-6]
  cargo:
    shape: {{kind: file, path: cargo.csv, origin: [3.1, 0.2, 0.4]}}
    motion: {{velocity: [0, "3*t*900", 0], turn: [0, 0, "300*t"]}}
rods:
  tail:
    shape: {{kind: straight, points: 7, spacing: 0.22, origin: [0.1, 0.2, 1.4], perturbation: 0.01}}
    {MODULI}
    start:
      hold: clamped
      to: cell
      motor: {{rate: "2*pi*90*min(t/4e-4, 1)"}}
      hook: {{bending: 3.0e-4, twisting: 2.0e-4}}
  flag:
    shape: {{kind: straight, points: 7, spacing: 0.23, origin: [3.1, 0.2, 1.5]}}
    {MODULI}
    start: {{hold: clamped, to: cargo, gap: true, motor: {{torque: 7.0e-4, free_rate: 900}}}}
  cilium:
    shape: {{kind: straight, points: 7, spacing: 0.21, origin: [-2.5, 0, 0]}}
    {MODULI}
    start:
      hold: clamped
      move: {{displace: [0.02, "0.03*cos(900*t)", 0], turn: ["0.1 + 0.2*sin(900*t)", 0, 0]}}
tracers:
  here: [[0.9, 1.4, 0.5]]
time: {{end: 1.3e-3, tolerance: 1.0e-4}}
output: {{interval: 2.5e-4}}
"""


def make(folder, text=ALL, overrides=()):
    cargo = Spherocylinder(kind="spherocylinder", length=1.9, radius=0.5, points=24)
    points = surface_of(cargo, "algebraic7").skin.T
    np.savetxt(folder / "cargo.csv", points, delimiter=",", header="x,y,z", comments="")
    (folder / "case.yaml").write_text(text)
    return load_case(folder / "case.yaml", overrides)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """An unbroken run, and copies of its file after every step; the table it read is gone."""
    folder = tmp_path_factory.mktemp("whole")
    path, kept = folder / "out.h5", []

    def stop():
        kept.append(shutil.copy(path, folder / f"{len(kept)}.h5"))
        return ""

    simulate(make(folder), path, stop=stop)
    (folder / "cargo.csv").unlink()
    return path, kept


def test_all_that_is_held_goes_on_with_the_same_bits(whole, tmp_path):
    path, kept = whole
    for number in (0, len(kept) // 3, 2 * len(kept) // 3, len(kept) - 1):
        copy = shutil.copy(kept[number], tmp_path)
        resume(copy)
        assert differences(copy, path) == []
