"""Runs that are stopped or killed between two steps, and small scenes for them."""

import shutil

from rodsim import load_case, simulate

MODULI = "moduli: {bending: 3.5e-3, twisting: 2.5e-3, shear: 0.7, stretch: 0.9}"
DRIVEN = f"""
fluid: {{viscosity: 1.3e-6, epsilon: 0.3, density: 2.0e-12}}
rods:
  tail:
    shape: {{kind: straight, points: 12, spacing: 0.11, perturbation: 1.0e-4}}
    {MODULI}
    strain_twist: ["1.3*sin(3*s + 900*t)", 0, 0.4]
  ring:
    shape: {{kind: ring, radius: 0.4, points: 14, origin: [0.2, 1.1, 0.3], twist_perturbation: 0.7}}
    {MODULI}
    strain_twist: [1.2, 0, 0.6]
tracers:
  here: [[0.3, 0.4, 0.5], [0.7, 0.2, 0.1]]
  tube: {{kind: tube, rod: ring, radius: 0.2, around: 3, along: 5}}
time: {{end: 7.3e-3, tolerance: 1.0e-5}}
output: {{interval: 5.0e-4, fields: [position, director, velocity, torque]}}
"""
PLANAR = f"""
fluid: {{viscosity: 1.3e-6, epsilon: 0.3, blob: algebraic9}}
rods:
  tail:
    shape: {{kind: straight, points: 24, spacing: 0.11}}
    {MODULI}
    strain_twist: [1.3, 0, 0]
plane: yz
time: {{end: 1.1e-2, tolerance: 1.0e-5}}
output: {{interval: 7.0e-4, fields: [position]}}
"""


def make(folder, text, overrides=()):
    (folder / "case.yaml").write_text(text)
    return load_case(folder / "case.yaml", overrides)


def after(steps, then=lambda: "the test"):
    """Return a ``stop`` that calls ``then`` once so many steps were made."""
    made = [0]

    def stop():
        made[0] += 1
        return then() if made[0] == steps else ""

    return stop


def run_with_copies(case, folder, **options):
    """Run a case to ``out.h5``; return its path, copies of it after each step, and the summary.

    A copy is what a kill would leave.
    """
    path, copies = folder / "out.h5", []

    def stop():
        copies.append(folder / f"killed{len(copies)}.h5")
        shutil.copy(path, copies[-1])
        return ""

    return path, copies, simulate(case, path, stop=stop, **options)
