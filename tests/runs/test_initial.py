"""A scene that begins in a state of an earlier run: `initial:` and `--from`."""

import copy
import shutil

import numpy as np
import pytest
from calls import command
from contents import differences

from rodsim import load_case, open_trajectory, resume, simulate
from rodsim.errors import CaseError, FileError
from rodsim.scene.build import build_scene

pytestmark = pytest.mark.compiled

MODULI = {"bending": 3.5e-3, "twisting": 3.3e-3, "shear": 0.8, "stretch": 0.9}
FLUID = {"viscosity": 1.3e-6, "epsilon": 0.25}
SWIMMER = {
    "fluid": FLUID,
    "bodies": {
        "weight": {"shape": {"kind": "sphere", "radius": 0.3, "points": 20, "origin": [3, 0, 0]}},
        "cell": {
            "shape": {
                "kind": "spheroid", "length": 2.2, "radius": 0.6, "points": 20,
                "rotate": {"axis": [1, 2, 0], "degrees": 15}, "origin": [0.1, 0.2, 0],
            },
            "torque": [0, 3e-3, 0],
        },
    },
    "rods": {
        "tail": {
            "shape": {"kind": "straight", "points": 7, "spacing": 0.22, "origin": [0.1, 0.2, 1.3]},
            "moduli": MODULI,
            "strain_twist": [0.4, 0, 0.3],
            "start": {
                "hold": "clamped", "to": "cell", "gap": True,
                "motor": {"rate": 2700, "axis": [0.1, 0, 1]},
                "hook": {"bending": 3e-4, "twisting": 2e-4},
            },
        }
    },
    "time": {"end": 8e-4, "tolerance": 1e-8},
    "output": {"interval": 2e-4},
}  # fmt: skip
BEAM = {
    "fluid": FLUID,
    "rods": {
        "beam": {
            "shape": {"kind": "straight", "points": 9, "spacing": 0.21, "perturbation": 0.02},
            "moduli": MODULI,
            "strain_twist": "natural",
            "start": {"hold": "clamped"},
            "end": {
                "hold": "clamped", "move": {"displace": [0, 0.05, -0.07], "turn": [0.2, 0, 0]},
            },
        }
    },
    "time": {"end": 3e-4},
    "output": {"interval": 1e-4},
}  # fmt: skip


def changed(data, **sections):
    return copy.deepcopy(data) | sections


def nodes(run, frame):
    """Return all that has a place in a frame: points, bodies and rotors."""
    parts = [run.read("position", frame), run.of_rotors(frame)[:, :3]]
    if run.bodies:
        parts += [run.of_bodies("position", frame), run.surfaces(frame)]
    return np.vstack(parts)


@pytest.fixture(scope="module")
def swum(tmp_path_factory):
    """A swimmer's run, and the first half of it."""
    folder = tmp_path_factory.mktemp("swum")
    simulate(load_case(SWIMMER), folder / "whole.h5")
    simulate(load_case(SWIMMER, {"time.end": 4e-4}), folder / "half.h5")
    return folder


@pytest.fixture(scope="module")
def bent(tmp_path_factory):
    path = tmp_path_factory.mktemp("bent") / "bent.h5"
    simulate(load_case(BEAM), path)
    return path


def test_a_run_that_begins_where_another_ended_goes_its_way(swum):
    """Bodies, the rotor of a motor, a hook that is bent: the sum of two halves is the whole.

    The motor's rate is constant, so nothing knows the time. 3e-8 um: three times what the same
    run at a tolerance of 1e-7 differs by.
    """
    rest = changed(SWIMMER, initial={"path": str(swum / "half.h5")})
    rest["time"]["end"] = 4e-4
    simulate(load_case(rest), swum / "rest.h5")
    with open_trajectory(swum / "whole.h5") as whole, open_trajectory(swum / "rest.h5") as second:
        half = whole.frames // 2
        assert abs(nodes(second, 0) - nodes(whole, half)).max() < 3e-8
        assert abs(nodes(second, -1) - nodes(whole, -1)).max() < 3e-8
        assert abs(nodes(whole, -1) - nodes(whole, half)).max() > 0.05


def test_it_begins_exactly_there_and_remembers_what_it_was_built_as(bent):
    """Natural twist, and where the ends are held, are of the shapes: nothing is moved twice."""
    scene = build_scene(load_case(changed(BEAM, initial={"path": str(bent), "frame": 2})))
    first = build_scene(load_case(BEAM))
    with open_trajectory(bent) as run:
        assert np.array_equal(scene.initial.position.T, run.read("position", 2))
        assert np.array_equal(scene.initial.director.transpose(2, 0, 1), run.read("director", 2))
    natural = [np.array([entry(0.3, 0.0) for entry in s.entries[0]]) for s in (scene, first)]
    assert np.array_equal(*natural)
    assert np.array_equal(scene.arrays["beam"]["held_end"], first.arrays["beam"]["held_end"])


def test_an_end_that_is_held_elsewhere_begins_there(bent):
    case = changed(BEAM, initial={"path": str(bent)})
    case["rods"]["beam"]["end"]["move"]["displace"] = [0, 0.05, -0.09]
    there, here = build_scene(load_case(case)).initial, build_scene(load_case(BEAM)).initial
    assert there.position[:, -1] == pytest.approx(here.position[:, -1] - [0, 0, 0.02], abs=1e-15)
    with open_trajectory(bent) as run:
        assert np.array_equal(there.position.T[:-1], run.position[-1, :-1])
    told = " ".join(str(problem) for problem in build_scene(load_case(case)).warnings)
    assert "rods.beam.end" in told
    assert "is held 0.02 um from where the output has it" in told
    same = build_scene(load_case(changed(BEAM, initial={"path": str(bent)})))
    assert "from where the output has it" not in " ".join(map(str, same.warnings))


def test_a_state_below_the_wall_is_one_of_the_output(bent):
    case = changed(BEAM, initial={"path": str(bent)})
    case["rods"]["beam"]["shape"]["origin"] = [0, 0, 1.2]
    case["fluid"] = FLUID | {"wall": {"z": 0.3}}
    case["rods"]["beam"] |= {"start": {"hold": "free"}, "end": {"hold": "free"}}
    with pytest.raises(CaseError, match=r"initial.path.*of rod 'beam' is at z = .* above the wall"):
        build_scene(load_case(case))


def test_it_resumes_with_the_same_bits_when_the_earlier_run_is_gone(bent, tmp_path):
    earlier, path, kept = shutil.copy(bent, tmp_path / "e.h5"), tmp_path / "out.h5", []

    def stop():
        kept.append(shutil.copy(path, tmp_path / f"{len(kept)}.h5"))
        return ""

    simulate(load_case(changed(BEAM, initial={"path": str(earlier)})), path, stop=stop)
    (tmp_path / "e.h5").unlink()
    again = kept[len(kept) // 2]
    resume(again)
    assert differences(again, path) == []


def test_bodies_are_found_by_name(swum):
    data = changed(SWIMMER, initial={"path": str(swum / "half.h5")})
    data["bodies"] = dict(reversed(data["bodies"].items()))
    with open_trajectory(swum / "half.h5") as run:
        cell = run.of_bodies("position", -1)[run.bodies.index("cell")]
    assert np.array_equal(build_scene(load_case(data)).initial.position[:, 7], cell)


def test_lengths_are_converted(bent):
    data = changed(BEAM, initial={"path": str(bent)}, units={"length": "nm"})
    data["fluid"]["epsilon"] = 250.0
    data["rods"]["beam"]["shape"] |= {"spacing": 210.0, "perturbation": 0.0}
    data["rods"]["beam"]["end"] = {"hold": "free"}
    nodes = build_scene(load_case(data)).initial.position[:, 1:]
    with open_trajectory(bent) as run:
        assert np.allclose(nodes.T, 1e3 * run.position[-1, 1:], rtol=1e-15, atol=0.0)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"rods.beam.shape.points": 10}, "rod 'beam' has 9 points there, not 10"),
        ({"rods.beam.shape.spacing": 0.2}, "rod 'beam' has a spacing of 0.21 there, not 0.2"),
        ({"initial.frame": 4}, r"initial\.frame = 4: has frames 0 to 3"),
        ({"initial.path": "gone.h5"}, "no such file"),
        ({"initial.frame": 1.5}, "initial.frame"),
    ],
)
def test_what_does_not_fit_is_refused(bent, change, reason):
    with pytest.raises((CaseError, FileError), match=reason) as error:
        build_scene(load_case(changed(BEAM, initial={"path": str(bent)}), change))
    assert "initial" in str(error.value)


def test_other_rods_and_bodies_are_refused(bent, swum):
    for data, path, reason in (
        (SWIMMER, bent, "has no rod 'tail': its rods are beam"),
        (SWIMMER | {"bodies": SWIMMER["bodies"] | {"more": SWIMMER["bodies"]["weight"]}},
         swum / "half.h5", "has no body 'more'"),
    ):  # fmt: skip
        with pytest.raises(CaseError, match=reason):
            build_scene(load_case(changed(data, initial={"path": str(path)})))


def test_the_command_says_where_it_begins(bent, tmp_path):
    import yaml

    (tmp_path / "beam.yaml").write_text(yaml.safe_dump(BEAM))
    out = tmp_path / "out.h5"
    command("run", tmp_path / "beam.yaml", "--from", bent, "-o", out, "-q")
    with open_trajectory(out) as run:
        assert run.case_data()["initial"] == {"path": str(bent), "frame": -1}
        assert "initial.path" in run.inputs
