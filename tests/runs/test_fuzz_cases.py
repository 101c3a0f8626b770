"""Case texts of all kinds: each is refused by name, or is a case that can make a step.

``RODSIM_CASES`` sets the number of texts of the long test.
"""

import os
from collections import Counter
from time import perf_counter

import numpy as np
import pytest
from fuzz import mutated
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scenes import CONFIGS

from rodsim.case import TEMPLATES, case_from_mapping, load_case, template
from rodsim.errors import CaseError, FileError, StepFailure
from rodsim.integrators.make import make_integrator
from rodsim.run.watch import Watch
from rodsim.scene.build import build_scene
from rodsim.scene.system import RodSystem

MOST_POINTS = 400  # larger scenes are valid, and only built: their step takes too long here
SMALL = ("points: 200", "points: 600", "points: 151", "points: 41", "points: 76", "points: 101",
         "points: 150", "along: 100")  # fmt: skip
TEXTS = [path.read_text() for path in sorted(CONFIGS.glob("*.yaml"))]
TEXTS += [template(kind) for kind in TEMPLATES]
TEXTS = [text.replace("path: traced", f"path: {CONFIGS}/traced") for text in TEXTS]
for words in SMALL:
    TEXTS = [text.replace(words, words.partition(":")[0] + ": 12") for text in TEXTS]


def one_step(case):
    """Return what becomes of a valid case: refused by its geometry, diverged, or a good step."""
    total = sum(getattr(rod.shape, "points", 0) or 0 for rod in case.rods.values())
    markers = sum(getattr(g, "around", 1) * getattr(g, "along", 1) for g in case.tracers.values())
    if total + markers > MOST_POINTS:
        return "valid, large"
    try:
        scene = build_scene(case)
    except (CaseError, FileError):
        return "refused by its geometry"
    system = RodSystem(scene)
    integrator = make_integrator(case.time, system)
    with np.errstate(all="ignore"):
        try:
            step = next(integrator.steps(scene.initial, case.time.end))
        except StepFailure:
            return "no step can be made"
        if not np.isfinite(step.end.position).all():
            assert case.time.step is not None  # an adaptive step that is accepted is a good one
            return "a step too long"
        Watch(case, system, integrator)
        for values in system.observe(step.end)[0].values():
            assert values.shape[0] == 3
    return "made a step"


def fate(path, text):
    """Return what becomes of a text; any error that is not one of ours is a failure."""
    path.write_text(text, encoding="utf-8", errors="surrogatepass")
    try:
        case = load_case(path)
    except CaseError as error:
        for problem in error.problems:
            line = str(problem)
            assert line.isprintable(), repr(line)
            assert line.startswith((str(path), "and ")), line
        return "refused"
    return one_step(case)


def fuzz(folder, seeds):
    """Return how often what became of the texts made from these seeds."""
    fates, slowest = Counter(), 0.0
    for seed in seeds:
        text = mutated(TEXTS[seed % len(TEXTS)], seed)
        begin = perf_counter()
        try:
            fates[fate(folder / "case.yaml", text)] += 1
        except Exception as error:
            raise AssertionError(f"seed {seed}: {error!r}\n{text}") from error
        slowest = max(slowest, perf_counter() - begin)
    return fates, slowest


def test_a_mutated_case_is_refused_by_name_or_makes_a_step(tmp_path):
    fates, _ = fuzz(tmp_path, range(400))
    assert fates["refused"] > 100
    assert fates["made a step"] > 50


@pytest.mark.long
def test_twenty_thousand_mutated_cases(tmp_path):
    count = int(os.environ.get("RODSIM_CASES", "20000"))
    fates, slowest = fuzz(tmp_path, range(1000, 1000 + count))
    print(f"{count} case texts, slowest {slowest:.2f} s: {dict(fates)}")


def positive(low, high):
    return st.floats(np.log10(low), np.log10(high)).map(lambda x: float(f"{10**x:.4g}"))


shapes = st.one_of(
    st.fixed_dictionaries({"kind": st.just("straight"), "points": st.integers(2, 30),
                           "length": positive(1e-3, 1e3), "perturbation": positive(1e-9, 1e-2)}),
    st.fixed_dictionaries({"kind": st.just("ring"), "points": st.integers(3, 30),
                           "radius": positive(1e-3, 1e3)}),
    st.fixed_dictionaries({"kind": st.just("helix"), "points": st.integers(2, 30),
                           "radius": positive(1e-2, 10), "pitch": positive(1e-2, 10),
                           "length": positive(1e-2, 10)}),
    st.fixed_dictionaries({"kind": st.just("sine"), "points": st.integers(2, 30),
                           "amplitude": positive(1e-4, 1), "wavelength": positive(1e-2, 10),
                           "length": positive(1e-2, 10)}),
)  # fmt: skip
entries = st.one_of(
    st.floats(-2, 2),
    st.sampled_from(
        ["sin(s)", "0.3*cos(7*t)", "where(s < 0.2, 1, -1)", "exp(t)", "tanh(s - t)", "1/s"]
    ),
)
numbers = st.recursive(
    st.sampled_from(["a", "b", "c", "2", "0.5", "pi"]),
    lambda inner: st.tuples(inner, st.sampled_from(["+", "-", "*", "/", "**", " % "]), inner).map(
        lambda parts: f"({''.join(parts)})"
    ),
    max_leaves=6,
)
copies = st.fixed_dictionaries({"like": st.sampled_from("abcde")}, optional={
    "repeat": st.one_of(st.integers(0, 3), numbers),
    "parameters": st.dictionaries(st.sampled_from("abi"), st.one_of(st.floats(-2, 2), numbers)),
    "shape": st.fixed_dictionaries({"origin": st.lists(numbers, min_size=3, max_size=3)}),
    "strain_twist": st.lists(st.one_of(entries, numbers), min_size=3, max_size=3),
})  # fmt: skip
rods = st.fixed_dictionaries({
    "shape": shapes,
    "moduli": st.fixed_dictionaries({
        "bending": positive(1e-6, 1e3), "twisting": positive(1e-6, 1e3),
        "shear": st.lists(positive(1e-6, 1e3), min_size=2, max_size=2),
        "stretch": positive(1e-6, 1e3),
    }),
    "strain_twist": st.lists(entries, min_size=3, max_size=3),
})  # fmt: skip
cases = st.fixed_dictionaries({
    "fluid": st.fixed_dictionaries({
        "viscosity": positive(1e-9, 1e3), "epsilon": positive(1e-3, 1e2),
        "blob": st.sampled_from(["algebraic7", "algebraic9"]),
    }),
    "parameters": st.dictionaries(st.sampled_from("abc"), st.one_of(st.floats(-2, 2), numbers)),
    "rods": st.dictionaries(st.sampled_from("abc"), rods | copies, min_size=1, max_size=3),
    "time": st.fixed_dictionaries({"end": positive(1e-9, 1e6), "tolerance": positive(1e-10, 1e-1)}),
})  # fmt: skip


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(cases)
def test_every_valid_case_makes_a_step_or_is_refused_by_name(data):
    try:
        case = case_from_mapping(data)
    except CaseError:
        return
    assert one_step(case)
    again = case_from_mapping(case.resolved())
    assert again.resolved() == case.resolved()
