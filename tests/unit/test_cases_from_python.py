"""Cases and overrides as Python gives them; what the package shows of itself; progress."""

import subprocess
import sys
import types
from pathlib import Path

import numpy as np
import pytest
from scenes import CONFIGS

import rodsim
from rodsim.errors import CaseError, UsageError
from rodsim.progress import Notebook, make_progress
from rodsim.run.listener import Functions

BOW = {
    "fluid": {"viscosity": np.float32(0.5), "epsilon": np.float64(0.3)},
    "rods": {
        "bow": {
            "shape": {"kind": "straight", "points": np.int64(12), "spacing": np.array(0.25)},
            "moduli": {"bending": (3.5e-3, 2.5e-3), "twisting": 2.5e-3, "shear": 0.7,
                       "stretch": np.float32(0.875)},
            "strain_twist": np.array([1.3, 0.0, 0.6]),
        }
    },
    "tracers": {"here": np.arange(6.0).reshape(2, 3)},
    "time": {"end": np.float64(0.02)},
}  # fmt: skip


def test_a_dict_is_a_case_with_numbers_of_numpy_too():
    case = rodsim.load_case(BOW)
    assert isinstance(case, rodsim.Case)
    bow = case.rods["bow"]
    assert (case.fluid.viscosity, case.fluid.epsilon, case.time.end) == (0.5, 0.3, 0.02)
    assert (bow.shape.points, bow.shape.spacing, bow.moduli.stretch) == (12, 0.25, 0.875)
    assert bow.strain_twist == (1.3, 0.0, 0.6)
    assert case.tracers["here"] == ((0.0, 1.0, 2.0), (3.0, 4.0, 5.0))
    assert rodsim.load_case(case.resolved()).resolved() == case.resolved()
    assert isinstance(BOW["fluid"]["viscosity"], np.float32)  # ours is left alone


def test_overrides_are_a_list_or_a_dict():
    path = CONFIGS / "closed_ring.yaml"
    texts = ["time.end=0.03", "rods.ring.strain_twist=[1.1, 0, a]", "parameters.a=0.5", "title=x y",
             "output.interval=null"]  # fmt: skip
    given = {
        "time.end": np.float64(0.03), "rods.ring.strain_twist": (1.1, 0, "a"),
        "parameters.a": 0.5, "title": "x y", "output.interval": None,
    }  # fmt: skip
    assert rodsim.load_case(path, given).resolved() == rodsim.load_case(path, texts).resolved()
    assert rodsim.load_case(str(path), {"time.end": 1e-5}).time.end == 1e-5
    assert rodsim.load_case(BOW, {"time.end": np.int64(2)}).time.end == 2.0


@pytest.mark.parametrize(
    ("case", "overrides", "error", "words"),
    [
        ({"fluid": {"viscosity": -2.0}}, (), CaseError, "case: fluid.viscosity = -2.0"),
        (BOW, {"time.ende": 3}, CaseError, "--set: time.ende: unknown key: did you mean 'end'?"),
        (BOW, {"time.end": np.nan}, CaseError, "--set: time.end = NaN"),
        (BOW, {"time.end": {1, 2}}, UsageError, "overrides: time.end: Object of type set is not"),
        (BOW, {3: 4}, UsageError, "the keys of a case are texts, not 3"),
        ({**BOW, 3: 4}, (), UsageError, "the keys of a case are texts, not 3"),
        (BOW, "time.end=3", UsageError, 'overrides must be texts in a list, such as ["time.end'),
        (BOW, [3], UsageError, 'or a dict, such as {"time.end": 0.01}'),
        (7, (), UsageError, "load_case takes the path of a file or a dict, not int"),
    ],
)
def test_what_is_no_case_is_said(case, overrides, error, words):
    with pytest.raises(error) as caught:
        rodsim.load_case(case, overrides)
    assert words in str(caught.value)


def test_a_case_is_no_file_of_one():
    with pytest.raises(UsageError, match=r"not Case; of a case: case\.resolved\(\)"):
        rodsim.load_case(rodsim.load_case(BOW))


def test_names_are_reached_by_the_package_alone():
    """Without an import of their own; Numba only by who computes."""
    code = (
        "import sys, rodsim; rodsim.analysis.writhe; rodsim.plotting; rodsim.Case;"
        "rodsim.open_trajectory; rodsim.load_case;"
        "assert not {'numba', 'matplotlib', 'xarray', 'pandas'} & set(sys.modules);"
        "assert set(rodsim.__all__) <= set(dir(rodsim));"
        "[getattr(rodsim, name) for name in rodsim.__all__]"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert (Path(rodsim.__file__).parent / "py.typed").is_file()


def test_all_that_is_public_is_documented():
    for name in rodsim.__all__[1:]:
        assert len(getattr(rodsim, name).__doc__) > 20, name


# Progress ---------------------------------------------------------------------------------------


@pytest.fixture
def notebook(monkeypatch):
    """IPython as it is in the kernel of a notebook; what a cell shows, in order."""
    shown = []

    class Handle:
        def update(self, data, raw):
            shown.append(("update", data["text/plain"]))

    def display(data, raw, display_id):
        shown.append(("display", data["text/plain"]))
        return Handle()

    ipython = types.ModuleType("IPython")
    ipython.get_ipython = lambda: types.SimpleNamespace(kernel="a kernel")
    ipython.display = types.ModuleType("IPython.display")
    ipython.display.display = display
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    monkeypatch.setitem(sys.modules, "IPython.display", ipython.display)
    return shown


def test_progress_in_a_notebook_is_one_line(notebook, monkeypatch):
    now = iter([10.0, 10.0, 10.1, 11.0, 11.0, 11.1, 11.1])
    monkeypatch.setattr("rodsim.progress.monotonic", lambda: next(now))
    listener = Functions(progress=True, label="a ring")
    for fraction in (0.125, 0.25, 0.5, 1.0):
        listener.update(fraction, f"t = {fraction}")
    listener.ended(None)
    assert notebook == [
        ("display", "a ring:  12.5% t = 0.125"),
        ("update", "a ring:  50.0% t = 0.5"),
        ("update", "a ring: 100.0% t = 1.0"),
    ]


def test_a_display_begins_with_the_first_step_and_ends_with_the_run(monkeypatch):
    seen = []

    class Display:
        def __enter__(self):
            seen.append("begin")

        def __exit__(self, *error):
            seen.append("end")

        def update(self, fraction, note):
            seen.append(fraction)

    monkeypatch.setattr("rodsim.run.listener.make_progress", lambda label, quiet: Display())
    listener = Functions(progress=True)
    listener.ended(None)  # a run that failed before its first step
    for fraction in (0.3, 0.7):
        listener.update(fraction, "")
    listener.ended(None)
    assert seen == ["begin", 0.3, 0.7, "end"]
    silent = Functions(progress=Display())  # of the caller's: it begins and ends there
    silent.update(0.5, "")
    silent.ended(None)
    assert seen[4:] == [0.5]


def test_a_terminal_of_ipython_is_no_notebook(notebook, monkeypatch):
    monkeypatch.setattr(sys.modules["IPython"], "get_ipython", lambda: None)
    assert not isinstance(make_progress("a ring", quiet=False), Notebook)


def test_no_progress_unless_it_is_wanted(capsys, notebook):
    Functions().update(0.5, "t = 1")
    Functions(progress=False).update(0.5, "t = 1")
    assert notebook == []
    assert capsys.readouterr() == ("", "")
