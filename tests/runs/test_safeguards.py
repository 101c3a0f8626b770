"""What a user would lose without being asked, and what ends by name and not in a traceback."""

import errno

import h5py
import numpy as np
import pytest
from calls import call
from interrupted import DRIVEN, PLANAR, after, make

from rodsim import open_trajectory, resume, simulate
from rodsim.analysis.replay import Replay
from rodsim.errors import FileError, StoppedError, UsageError

REST = """
fluid: {viscosity: 1.3e-6, epsilon: 0.3}
rods:
  tail:
    shape: {kind: straight, points: 9, length: 0.9}
    moduli: {bending: 3.5e-3, twisting: 2.5e-3, shear: 0.7, stretch: 0.9}
time: {end: 1.0e-3}
"""


@pytest.fixture
def out(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    simulate(make(tmp_path, REST), tmp_path / "out.h5")
    return tmp_path / "out.h5"


@pytest.mark.compiled
@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (("energy", "out.h5", "--csv", "out.h5"), 2),
        (("energy", "out.h5", "--csv", "case.yaml"), 2),
        (("energy", "out.h5", "--plot", "out.h5"), 2),
        (("export", "run.npz", "-o", "run.npz"), 4),
        (("flow", "run.csv", "--grid", "0,0,0:1:3", "-o", "run.csv"), 4),
        (("run", "case.yaml", "-o", "case.yaml", "--overwrite"), 4),
        (("run", "case.yaml", "-o", "case.yaml"), 4),
        (("run", "case.yaml", "-o", "notes.txt", "--overwrite"), 4),
    ],
)
def test_no_run_and_no_case_is_written_over(out, tmp_path, arguments, code):
    for name in ("run.npz", "run.csv"):
        (tmp_path / name).write_bytes(out.read_bytes())
    (tmp_path / "notes.txt").write_text("important")
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    done = call(*arguments)
    assert done.exit_code == code, done.stderr
    assert any(
        word in done.stderr.splitlines()[-1] for word in ("not", "must end in", "give another")
    )
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


@pytest.mark.compiled
def test_frames_of_fixed_steps_are_those_of_their_times(tmp_path):
    """Multiples need to hold to 1e-9 only; the frame is still that of the step which ends there."""
    case = make(tmp_path, REST, [
        "time.integrator=euler", "time.step=1.666666666e-6", "output.interval=1e-5",
        "time.end=1e-4",
    ])  # fmt: skip
    simulate(case, tmp_path / "out.h5")
    with h5py.File(tmp_path / "out.h5") as file:
        steps = file["particles/trajectory/position/step"][:]
    assert steps.tolist() == list(range(0, 61, 6))


@pytest.mark.compiled
def test_the_flow_of_a_run_that_did_not_end_is_there(tmp_path):
    with pytest.raises(StoppedError):
        simulate(make(tmp_path, PLANAR.replace("[position]", "[position, director]")),
                 tmp_path / "out.h5", stop=after(6))  # fmt: skip
    with h5py.File(tmp_path / "out.h5", "r+") as file:
        file["runtime"].attrs["spectral_radius"] = np.nan  # as after a kill
        file.attrs["status"] = np.bytes_("running")
    with open_trajectory(tmp_path / "out.h5") as run:
        replay = Replay(run)
        assert replay.rough
        assert np.isfinite(replay.settled_velocity(run.frames - 1)).all()


@pytest.mark.compiled
def test_a_checkpoint_that_is_ahead_of_the_frames_is_left(tmp_path):
    """As a power cut can leave it, where the disk has the later of two writes alone."""
    path = tmp_path / "out.h5"
    older = newer = 0
    for steps in range(60, 90):  # until the last step was one with a frame
        if older == newer:
            with pytest.raises(StoppedError):
                simulate(make(tmp_path, DRIVEN), path, overwrite=True, stop=after(steps))
            with h5py.File(path) as file:
                older, newer = sorted(int(file[f"checkpoint/{slot}/frames"][()]) for slot in "ab")
    with h5py.File(path, "r+") as file:
        file["committed"][()] = older
    with open_trajectory(path) as run:
        assert run.checkpoint()["frames"] == older < newer
    with h5py.File(path, "r+") as file:
        file["committed"][()] = 0
    with pytest.raises(FileError, match="neither of its checkpoints is whole"):
        resume(path)


@pytest.mark.compiled
@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        (("fluid.viscosity=1e-200", "rods.tail.moduli.shear=1e200"), "fastest rate of this scene"),
        (("fluid.viscosity=1e200", "rods.tail.moduli={bending: 1e-200, twisting: 1e-200, "
          "shear: 1e-200, stretch: 1e-200}"), "fastest rate of this scene"),
        (("time.integrator=euler", "time.step=1e-4"), "above the largest stable step"),
    ],
)  # fmt: skip
def test_a_dry_run_says_what_a_run_would_refuse(out, overrides, words):
    settings = [word for text in overrides for word in ("--set", text)]
    for more in (("--dry-run",), ("-q",)):
        refused = call("run", "case.yaml", *settings, *more)
        assert refused.exit_code == 2
        assert words in refused.stderr


@pytest.mark.compiled
def test_a_rod_at_rest_converges_and_is_drawn_end_on(out):
    pytest.importorskip("matplotlib")
    assert call("converge", "case.yaml", "--in", "tolerance", "-q").exit_code == 0
    assert call("plot", "out.h5", "--view", "xy").exit_code == 0
    assert call("flow", "out.h5", "--grid", "box", "--resolution", "20000").exit_code == 2


@pytest.mark.compiled
def test_python_names_what_it_cannot_use(out, tmp_path):
    from rodsim import load_case

    with pytest.raises(UsageError, match="overrides must be texts in a list"):
        load_case("case.yaml", "time.end=3")
    with pytest.raises(UsageError, match="simulate takes a case"):
        simulate("case.yaml", "x.h5")
    with pytest.raises(UsageError, match="threads must be 1 or more"):
        simulate(load_case("case.yaml"), "x.h5", threads=0)


@pytest.mark.compiled
def test_a_full_disk_behind_the_results_is_said_in_one_line(out, monkeypatch):
    import rodsim.cli as cli

    left = []
    monkeypatch.setattr(cli.os, "_exit", lambda code: left.append(code))

    def full(*text, **more):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("rodsim.analysis.energy.EnergyTable.text", full)
    done = call("energy", "out.h5")
    assert left == [4]
    assert done.stderr == "the result could not be written: No space left on device\n"


@pytest.mark.compiled
def test_rods_drawn_on_an_axis_of_ones_own_are_in_sight(out):
    pytest.importorskip("matplotlib")
    from matplotlib.figure import Figure

    from rodsim.plotting.camera import make_camera
    from rodsim.plotting.rod import draw_rods

    with open_trajectory(out) as run:
        axis, position = Figure().add_subplot(), run.position[-1]
        camera = make_camera("zy", position)
        draw_rods(axis, camera, run.rods, position, None, 0.1, [(0.0, 0.0, 0.0, 1.0)], kind="line")
    axis.autoscale()
    low, high = sorted(axis.get_xlim())
    assert low <= 0.0
    assert high >= 0.9
