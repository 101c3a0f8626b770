"""Rods like others, rods repeated, parameters of a rod: what becomes of them, and their errors."""

import math

import numpy as np
import pytest

from rodsim.case import case_from_mapping, load_case
from rodsim.errors import CaseError

CASE = """\
parameters: {d: 0.7, phi: 0, sigma: 40, wave: 2*pi/sigma}
fluid: {viscosity: 1.3e-6, epsilon: 0.3}
rods:
  right:
    like: left
    shape: {origin: [0, d, 0]}
    parameters: {phi: pi, sigma: 50}
  left:
    shape: {kind: straight, points: 40 + 2, length: 4*d, origin: [9, 8, 7]}
    moduli: {bending: [3e-3, 4e-3], twisting: 5e-3, shear: 0.8, stretch: 0.9}
    strain_twist: ["0.5*sin(2*pi*t/wave + phi)", 0, 0.1]
time: {end: 3*wave}
"""
TAIL = "  tail:\n    like: left\n"


@pytest.fixture
def load(tmp_path):
    def make(text=CASE, *overrides):
        path = tmp_path / "case.yaml"
        path.write_text(text)
        return load_case(path, overrides)

    return make


def problems(load, text, *overrides):
    with pytest.raises(CaseError) as caught:
        load(text, *overrides)
    return [str(problem).rpartition("/")[2] for problem in caught.value.problems]


def test_a_rod_like_another_has_its_own_keys_and_all_else(load):
    case = load()
    left, right = case.rods["left"], case.rods["right"]
    assert list(case.rods) == ["right", "left"]
    assert right.moduli == left.moduli
    assert right.shape.origin == (0.0, 0.7, 0.0)
    assert (right.shape.points, right.shape.length) == (42, 2.8)
    assert case.time.end == 3 * (2 * math.pi / 40)


def test_parameters_of_a_rod_and_what_follows_from_them(load):
    case = load()
    s, t = np.zeros(1), 0.013
    left, right = (case.rods[name].strain_twist[0](s, t) for name in ("left", "right"))
    assert left == pytest.approx(0.5 * math.sin(40 * t), rel=1e-14)
    assert right == pytest.approx(0.5 * math.sin(50 * t + math.pi), rel=1e-14)  # wave is 2 pi/50
    assert case.rods["right"].parameters == {
        "phi": math.pi, "sigma": 50.0, "wave": 2 * math.pi / 50
    }  # fmt: skip
    assert case.parameters["wave"] == 2 * math.pi / 40


def test_resolved_says_all_by_itself(load):
    case = load(CASE + "tracers: {tube: {kind: tube, rod: right, radius: d, around: 8, along: 9}}")
    resolved = case.resolved()
    assert not any("like" in rod or "repeat" in rod for rod in resolved["rods"].values())
    assert "parameters" not in resolved["rods"]["left"]
    again = case_from_mapping(resolved)
    assert again.resolved() == resolved
    assert again.rods == case.rods


def test_repeat_makes_rods_with_numbers(load):
    text = CASE.replace("    like: left\n", "    like: left\n    repeat: 2*d + 1.6\n").replace(
        "origin: [0, d, 0]", "origin: [0, i*d, 0]"
    )
    case = load(text)
    assert list(case.rods) == ["right_0", "right_1", "right_2", "left"]
    assert [rod.shape.origin[1] for rod in case.rods.values()] == [0.0, 0.7, 1.4, 8.0]
    assert case.rods["right_2"].parameters["i"] == 2.0
    assert case_from_mapping(case.resolved()).rods == case.rods
    assert case.source.origins["right_1"] == "number 1 of right"


def test_one_copy_can_be_changed_and_copied(load):
    text = CASE.replace("like: left\n", "like: left\n    repeat: 3\n").replace("[0, d,", "[0, i,")
    text = text.replace("time:", "  more: {like: right_2, shape: {points: 12}}\ntime:")
    case = load(text, "rods.right_1.shape.points=30", "rods.right.shape.origin.2=4*d")
    assert [rod.shape.points for rod in case.rods.values()] == [42, 30, 42, 42, 12]
    assert [rod.shape.origin for rod in case.rods.values()] == [
        (0.0, 0.0, 2.8), (0.0, 1.0, 2.8), (0.0, 2.0, 2.8), (9.0, 8.0, 7.0), (0.0, 2.0, 2.8)
    ]  # fmt: skip


def test_chains_in_any_order(load):
    text = CASE.replace("time:", "  last: {like: right, moduli: {shear: [1.1, 1.2]}}\ntime:")
    last = load(text).rods["last"]
    assert last.moduli.values == (3e-3, 4e-3, 5e-3, 1.1, 1.2, 0.9)
    assert last.shape.origin == (0.0, 0.7, 0.0)
    long = "".join(f"  r{n}: {{like: r{n + 1}}}\n" for n in range(2_000)) + "  r2000: {like: left}"
    assert load(CASE.replace("time:", f"{long}\ntime:")).rods["r0"].shape.points == 42


def test_null_takes_a_key_out_and_another_kind_leaves_its_keys_behind(load):
    right = load(CASE.replace("like: left", "like: left\n    strain_twist: null")).rods["right"]
    assert right.strain_twist == (0.0, 0.0, 0.0)
    helix = "{kind: helix, radius: 0.2, pitch: d}"
    left = CASE.replace("length: 4*d", "length: 4*d, perturbation: 1e-3")
    shape = load(left.replace("{origin: [0, d, 0]}", helix)).rods["right"].shape
    assert (shape.kind, shape.length, shape.origin) == ("helix", 2.8, (9.0, 8.0, 7.0))


def test_overrides_reach_the_rods_that_are_like_it(load):
    case = load(CASE, "rods.left.moduli.twisting=6e-3", "rods.right.moduli.stretch=d")
    assert [rod.moduli.twisting for rod in case.rods.values()] == [6e-3, 6e-3]
    assert [rod.moduli.stretch for rod in case.rods.values()] == [0.7, 0.9]
    case = load(CASE, "rods.right.strain_twist.2=0.3")  # of the list that it has from left
    assert case.rods["right"].strain_twist[2] == 0.3
    assert case.rods["right"].strain_twist[0].uses_t
    assert case.rods["left"].strain_twist[2] == 0.1


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("like: left", "like: lfet",
         "case.yaml:5: rods.right.like = lfet: no such rod: did you mean 'left'?"),
        ("like: left", "like: right", "rods.right.like = right: goes in a circle: right -> right"),
        ("  left:\n", "  left:\n    like: right\n", "like = left: goes in a circle: right -> left"),
        ("like: left", "like: [left]", "rods.right.like = [left]: must be the name of a rod"),
        ("like: left", "like: left\n    repeat: 2*d",
         "case.yaml:6: rods.right.repeat = 2*d: must be a whole number, and is 1.4"),
        ("like: left", "like: left\n    repeat: 0", "repeat = 0: must be between 1 and 10000"),
        ("like: left", "like: left\n    repeat: 10**9", "must be between 1 and 10000"),
        ("like: left", "like: left\n    repeat: 2.5", "must be a whole number"),
        ("like: left", "like: left\n    repeat: q", "repeat = q: unknown name 'q'"),
        ("like: left", "like: left\n    repeat: 2\n    strain_twist: [i, 0, 0]", "i: 3"),
        ("parameters: {phi: pi,", "repeat: 2\n    parameters: {i: pi,", "the parameter i is the"),
        ("  left:\n", "  right_1: {like: left}\n  left:\n", None),
        ("[0, d, 0]", "[0, dd, 0]", "case.yaml:6: rods.right.shape.origin.1 = dd: there is no par"),
        ("phi: pi", "phi: phi + pi", "case.yaml:7: rods.right.parameters.phi = phi + pi: goes in"),
        ("phi: pi", "phi: wave, wave: phi", "goes in a circle: phi -> wave -> phi"),
        ("{phi: pi", "{sin: 3, phi: pi", "rods.right.parameters.sin: 'sin' already has a meaning"),
        ("points: 40 + 2", "points: 1", "case.yaml:9: rods."),
        ("stretch: 0.9", "strech: 0.9", "case.yaml:10: rods."),
    ],
)  # fmt: skip
def test_errors_are_named_once_with_the_line_that_is_wrong(load, old, new, words):
    text = CASE.replace(old, new, 1)
    assert text != CASE
    if words is None:
        text = text.replace("    parameters: {phi: pi", "    repeat: 2\n    parameters: {phi: pi")
        words = "case.yaml:7: rods.right.repeat = 2: there is a rod 'right_1' already"
    if words == "i: 3":
        text = text.replace("phi: 0,", "phi: 0, i: 3,")
        words = "case.yaml:6: rods.right.repeat = 2: the parameter i is the number of a repeated"
    found = problems(load, text)
    assert words in found[0]
    assert len(found) == 1 + ("strech" in new)  # an unknown key and a missing one


def test_what_ten_copies_have_is_said_once(load):
    text = CASE.replace("like: left", "like: left\n    repeat: 10")
    found = problems(load, text.replace("[0, d, 0]", "[0, d*q, 0]"))
    assert len(found) == 1
    assert "case.yaml:7: rods.right_0.shape.origin.1 = d*q: unknown name 'q'" in found[0]


def test_a_wrong_copy_does_not_hide_other_problems(load):
    found = problems(load, CASE.replace("like: left", "like: lfet").replace("3*wave", "-wave"))
    assert len(found) == 2
    assert "time.end = -wave (= -0.15708): must be > 0" in found[1]
    found = problems(
        load, CASE.replace("like: left", "like: lfet\n  tail: {}\n  lost:\n    repeat: x")
    )
    assert any("lost.repeat" in line for line in found)


def test_too_many_keys_are_refused_before_they_fill_the_memory(load):
    many = ", ".join(["0"] * 300)
    text = CASE.replace("like: left", "like: left\n    repeat: 10000")
    found = problems(load, text.replace("strain_twist: [", f"strain_twist: [{many}, "))
    assert "too much: more than 500000 keys" in found[0]
