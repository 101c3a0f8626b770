"""Loads, tethers and flows that cannot be: exit code 2, file:line, key and reason, no output."""

import numpy as np
import pytest
from calls import command

CASE = """\
fluid: {viscosity: 1.3e-6, epsilon: 0.3, flow: ["2.3*z", 0.7, 0]}
parameters: {f: 0.4}
rods:
  tail:
    shape: {kind: straight, points: 12, spacing: 0.11, origin: [0.3, 0.2, 0.7]}
    moduli: {bending: 3.5e-3, twisting: 2.5e-3, shear: 0.7, stretch: 0.9}
    loads:
      weight: {along: all, force: [0, 0, -2.0e-3]}
      tip: {at: end, force: [0, 0.03, "-f*t"], frame: triad}
  ring:
    shape: {kind: ring, radius: 0.6, points: 40}
    moduli: {bending: 3.5e-3, twisting: 2.5e-3, shear: 0.7, stretch: 0.9}
tethers:
  link: {from: {rod: tail, at: end}, to: {rod: ring, s: 0.7}, stiffness: 2.0e-2, length: 0.3}
time: {end: 0.3}
"""
PLANAR = """\
fluid: {viscosity: 1.3e-6, epsilon: 0.3, flow: [0, "2.3*z", 0]}
plane: yz
rods:
  tail:
    shape: {kind: straight, points: 12, spacing: 0.11, origin: [0.3, 0.2, 0.7]}
    moduli: {bending: 3.5e-3, twisting: 2.5e-3, shear: 0.7, stretch: 0.9}
    loads:
      tip: {at: end, force: [0, 0.03, 0.02], torque: [0.01, 0, 0], frame: triad}
tethers:
  link: {from: {rod: tail, at: end}, to: [0.3, 1.2, 0.7], stiffness: 2.0e-2}
time: {end: 0.3}
"""
WEIGHT, TIP, LINK, FLOW = (
    "rods.tail.loads.weight", "rods.tail.loads.tip", "tethers.link", "fluid.flow",
)  # fmt: skip

# text to replace, its replacement, line, key and value shown, words of the reason
SPATIAL = [
    # loads
    ("along: all", "along: half", 8, f"{WEIGHT}.along = half", "must be all"),
    ("along: all, ", "", 8, WEIGHT, "needs one of at: start, at: end, s:"),
    ("along: all", "along: all, s: 0.2", 8, WEIGHT, "along the whole rod: leave out at and s"),
    ("along: all, force: [0, 0, -2.0e-3]", "along: all", 8, WEIGHT, "neither a force nor"),
    ("along: all", "alnog: all", 8, f"{WEIGHT}.alnog", "did you mean 'along'?"),
    ("at: end, force", "at: end, s: 0.2, force", 9, TIP, "needs one of at"),
    ("at: end, force", "at: middle, force", 9, f"{TIP}.at = middle", "must be one of start, end"),
    ("at: end, force", "s: 1.3, force", 9, f"{TIP}.s = 1.3",
     "must be <= 1.21, the length of rod 'tail'"),
    ("at: end, force", "s: -0.2, force", 9, f"{TIP}.s = -0.2", "must be >= 0 (um)"),
    ("[0, 0.03, \"-f*t\"]", "[0, 0.03]", 9, f"{TIP}.force", "list of 3 numbers or expressions"),
    ("-f*t", "-g*t", 9, f"{TIP}.force.2 = -g*t", "unknown name 'g'"),
    ("-f*t", "f/(t - t)", 9, f"{TIP}.force.2 =", "is not finite at s = 1.21, t = 0"),
    ("-f*t", "sqrt(0.2 - t)", 9, f"{TIP}.force.2 =", "is not finite at s = 1.21, t = 0.2"),
    ("frame: triad", "frame: rod", 9, f"{TIP}.frame = rod", "must be one of space, triad"),
    ("    loads:\n      weight: {along: all, force: [0, 0, -2.0e-3]}\n"
     "      tip: {at: end, force: [0, 0.03, \"-f*t\"], frame: triad}\n", "    loads: {}\n",
     7, "rods.tail.loads = {}", "must not be empty"),
    ("points: 40}", "points: 40}\n    loads: {a: {at: start, force: [1.2, 0, 0]}}", 12,
     "rods.ring.loads.a.at = start", "rod 'ring' is closed and has no start: give s"),
    # tethers
    ("rod: tail, at", "rod: tial, at", 14, f"{LINK}.from.rod = tial", "did you mean 'tail'?"),
    ("rod: ring, s: 0.7", "rod: ring, s: 7", 14, f"{LINK}.to.s = 7", "must be <= 3.76"),
    ("rod: ring, s: 0.7", "rod: ring, at: end", 14, f"{LINK}.to.at = end", "is closed"),
    ("rod: ring, s: 0.7", "rod: ring", 14, f"{LINK}.to", "needs one of at"),
    ("{rod: ring, s: 0.7}", "{rod: tail, at: end}", 14, LINK, "holds a place to itself"),
    ("{rod: ring, s: 0.7}", "[0, 1]", 14, f"{LINK}.to = [0, 1]", "list of 3 numbers"),
    ("{rod: ring, s: 0.7}", "ring", 14, f"{LINK}.to = ring", "a mapping with rod, at, s"),
    ("{rod: ring, s: 0.7}", "[0, 1, q]", 14, f"{LINK}.to.2 = q", "must be a number"),
    ("from: {rod: tail, at: end}, to: {rod: ring, s: 0.7}", "from: [0, 0, 0], to: [2, 3, 4]", 14,
     LINK, "holds no rod"),
    ("to: {rod: ring, s: 0.7}, ", "", 14, f"{LINK}.to", "missing: needs"),
    ("stiffness: 2.0e-2", "stiffness: 0", 14, f"{LINK}.stiffness = 0", "must be > 0 (g s^-2)"),
    ("length: 0.3}", "length: -0.3}", 14, f"{LINK}.length = -0.3", "must be >= 0 (um)"),
    ("length: 0.3}", "only: push}", 14, f"{LINK}.length", "needed where a tether can only push"),
    ("length: 0.3}", "only: pusch}", 14, f"{LINK}.only = pusch", "one of pull, push"),
    # flow
    ("2.3*z", "2.3*x", 1, FLOW,
     "not incompressible: at point 0 of rod 'tail' at t = 0 its divergence is 2.3"),
    ("2.3*z", "2.3*z + t*x", 1, FLOW, "not incompressible: at point 0 of rod 'tail' at t = 0.02"),
    ("2.3*z", "2.3*s", 1, f"{FLOW}.0 = 2.3*s", "unknown name 's': it can use"),
    ("2.3*z", "log(z - 0.9)", 1, FLOW, "is not finite, or has no slope, at the points"),
    ("2.3*z", "snn(z)", 1, f"{FLOW}.0 = snn(z)", "unknown function 'snn'"),
    ("[\"2.3*z\", 0.7, 0]", "[2.3, 0.7]", 1, FLOW, "list of 3 numbers or expressions"),
    ("[\"2.3*z\", 0.7, 0]", "shear", 1, f"{FLOW} = shear", "list of 3 numbers or expressions"),
    ("{f: 0.4}", "{f: 0.4, z: 2.1}", 1, f"{FLOW}.0 = 2.3*z", "rename the parameter"),
]  # fmt: skip
IN_PLANE = [
    ("[0, 0.03, 0.02]", "[0.1, 0.03, 0.02]", 8, f"{TIP}.force.0 = 0.1", "must be the number 0"),
    ("[0.01, 0, 0]", "[0.01, \"0*t\", 0]", 8, f"{TIP}.torque.1 = 0*t", "where plane is yz"),
    ("[0.3, 1.2, 0.7]", "[0.4, 1.2, 0.7]", 10, f"{LINK}.to = [0.4, 1.2, 0.7]",
     "lies beside the plane of the scene, x = 0.3"),
    ("[0, \"2.3*z\", 0]", "[0.2, \"2.3*z\", 0]", 1, FLOW, "leaves the plane of the scene"),
    ("[0, \"2.3*z\", 0]", "[0, \"2.3*z + x\", 0]", 1, FLOW, "leaves the plane of the scene"),
]  # fmt: skip


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Run a case that must be refused; return the lines of the message."""
    monkeypatch.chdir(tmp_path)

    def run(text):
        (tmp_path / "bad.yaml").write_text(text)
        result = command("run", "bad.yaml", "-o", "out.h5", code=2)
        assert not (tmp_path / "out.h5").exists()
        return result.stderr.splitlines()

    return run


@pytest.mark.parametrize(
    ("text", "old", "new", "line", "start", "words"),
    [(CASE, *row) for row in SPATIAL] + [(PLANAR, *row) for row in IN_PLANE],
)
def test_one_problem(run, text, old, new, line, start, words):
    assert old in text
    (message,) = run(text.replace(old, new))
    assert message.startswith(f"bad.yaml:{line}: {start}")
    assert words in message


@pytest.mark.parametrize("text", [CASE, PLANAR])
def test_the_cases_themselves_are_valid(text, tmp_path):
    (tmp_path / "good.yaml").write_text(text)
    command("validate", tmp_path / "good.yaml")


def test_several_at_once(run):
    bad = CASE.replace("s: 0.7", "s: 7").replace("along: all", "along: all, at: start")
    bad = bad.replace("rod: tail", "rod: rail").replace("at: end, force", "force")
    assert [line.split(" ")[1] for line in run(bad)] == [
        f"{WEIGHT}", f"{TIP}", f"{LINK}.from.rod", f"{LINK}.to.s"
    ]  # fmt: skip


def test_a_place_on_a_rod_from_a_file(run, tmp_path):
    """Its length and whether it is closed are known only once the file is read."""
    table = np.hstack([np.zeros((12, 2)), 0.11 * np.arange(12)[:, None], [np.eye(3).ravel()] * 12])
    np.savetxt(tmp_path / "rod.txt", table)
    shape = "{kind: straight, points: 12, spacing: 0.11, origin: [0.3, 0.2, 0.7]}"
    case = CASE.replace(shape, "{kind: file, path: rod.txt, spacing: 0.11}")
    (message,) = run(case.replace("at: end, force", "s: 1.3, force"))
    assert message.startswith(f"bad.yaml:9: {TIP}.s = 1.3 (um): must be <= 1.21, the length of rod")
    (message,) = run(case.replace("from: {rod: tail, at: end}", "from: {rod: tail, s: 1.3}"))
    assert message.startswith(f"bad.yaml:14: {LINK}.from.s = 1.3 (um): must be <= 1.21")
