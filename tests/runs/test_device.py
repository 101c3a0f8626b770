"""``--device``: refused where there is no card, recorded, resumed; on Numba's simulator."""

import json

import numpy as np
import pytest
from calls import call
from card import simulated

import rodsim
from rodsim.convergence.side_by_side import Runs
from rodsim.errors import CaseError, UsageError
from rodsim.flows.card import device as devices
from rodsim.scene.device import on_device

pytest.importorskip("numba.cuda", reason="this Numba has no CUDA: pip install numba-cuda")
CASE = """
fluid: {viscosity: 1.3e-6, epsilon: 0.3}
rods:
  tail:
    shape: {kind: helix, radius: 0.4, pitch: 1.1, points: 6, length: 1.4}
    moduli: {bending: 3.5e-3, twisting: 2.5e-3, shear: 0.7, stretch: 0.9}
    strain_twist: [1.3, 0, 0.6]
tracers: {markers: [[0.7, 0.2, 0.3]]}
time: {end: 3.0e-6, integrator: euler, step: 5.0e-7}
output: {interval: 1.5e-6}
"""
RUNS = """
import json, shutil
import numpy as np
import rodsim
from rodsim.errors import StoppedError, UsageError
from rodsim.flows.card import device as devices

case = rodsim.load_case("case.yaml")
told = []
rodsim.simulate(case, "cpu.h5")
rodsim.simulate(case, "whole.h5", device="gpu")

def stopped(path, device):
    steps = []
    stop = lambda: "the test" if steps.append(0) or len(steps) == 4 else ""
    try:
        rodsim.simulate(case, path, stop=stop, device=device)
    except StoppedError:
        pass

stopped("left.h5", "gpu")
for name in ("same.h5", "to_cpu.h5", "other.h5"):
    shutil.copy("left.h5", name)
rodsim.resume("same.h5", notify=told.append)
assert told == [], told
rodsim.resume("to_cpu.h5", device="cpu", notify=told.append)
stopped("to_gpu.h5", "cpu")
rodsim.resume("to_gpu.h5", device="gpu", notify=told.append)
from rodsim.analysis.replay import Replay
with rodsim.open_trajectory("whole.h5") as run:
    points = np.array([[0.7, 0.2, 0.3], [0.1, 0.9, -0.4]])
    on_card, on_cpu = (Replay(run, device).sources(1) for device in ("gpu", "cpu"))
    assert on_card.scene.device == "gpu"
    pairs = [on_card.velocity(points), on_cpu.velocity(points)]
    pairs += [on_card.pressure(points), on_cpu.pressure(points)]
wall = [rodsim.velocity(points, points + 1, points, points, 0.3, 0.7, wall=-0.6, device=device)
        for device in ("gpu", "cpu")]
pairs += [wall[0][0], wall[1][0], wall[0][1], wall[1][1]]
np.savez("pairs.npz", *pairs)
devices.card = lambda: {"device": "another card"}
for device in (None, "gpu"):
    try:
        rodsim.resume("other.h5", device=device, notify=told.append)
    except UsageError as error:
        told.append(str(error))
print(json.dumps(told))
"""


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """A folder of runs on the simulator, and what was told of them."""
    folder = tmp_path_factory.mktemp("device")
    (folder / "case.yaml").write_text(CASE)
    return folder, json.loads(simulated(RUNS, folder))


def test_a_run_on_a_card_is_that_of_the_cpu(runs):
    folder, _ = runs
    whole, cpu = (rodsim.open_trajectory(folder / f"{name}.h5") for name in ("whole", "cpu"))
    assert abs(cpu.position[-1] - cpu.position[0]).max() > 1e-5
    # 6 steps of sums that differ in last bits
    np.testing.assert_allclose(whole.position, cpu.position, rtol=0, atol=1e-13)
    np.testing.assert_allclose(whole.tracers, cpu.tracers, rtol=0, atol=1e-13)


def test_a_run_goes_on_on_its_card_with_the_same_bits(runs):
    folder, _ = runs
    whole, same = (rodsim.open_trajectory(folder / f"{name}.h5") for name in ("whole", "same"))
    assert same.resumes
    assert same.status == "finished"
    assert np.array_equal(whole.position, same.position)
    assert np.array_equal(whole.director, same.director)


def test_the_file_names_the_device_and_the_cpu_leaves_no_trace(runs):
    folder, _ = runs
    found = {}
    for name in ("whole", "same", "cpu", "to_cpu", "to_gpu"):
        with rodsim.open_trajectory(folder / f"{name}.h5") as run:
            found[name] = run.runtime.get("device")
    on = "simulator"
    expected = {"whole": on, "same": on, "cpu": None, "to_cpu": "cpu", "to_gpu": on}
    assert found == expected
    shown = call("info", folder / "whole.h5").output
    assert "device: simulator" in shown


def test_what_goes_on_elsewhere_is_said(runs):
    folder, (to_cpu, to_gpu, refused, other) = runs
    assert "with device simulator, this is device cpu: last digits can differ" in to_cpu
    assert "with device cpu, this is device simulator: last digits can differ" in to_gpu
    assert "its sums were computed on simulator, here is another card: go on" in refused
    assert "--device cpu" in refused
    assert "with device simulator, this is device another card" in other
    with rodsim.open_trajectory(folder / "to_gpu.h5") as run:
        assert "--device gpu (simulator)" in run.resumes[-1]


def test_flow_and_the_library_ask_the_card(runs):
    folder, _ = runs
    pairs = list(np.load(folder / "pairs.npz").values())
    for on_card, on_cpu in zip(pairs[::2], pairs[1::2], strict=True):
        assert abs(on_cpu).max() > 1e-5
        np.testing.assert_allclose(on_card, on_cpu, rtol=1e-12, atol=1e-14 * abs(on_cpu).max())


@pytest.fixture
def no_card(monkeypatch):
    """A machine with numba-cuda and no card, even where there is one."""

    def none():
        raise OSError("no driver\nto be found.")

    monkeypatch.setattr("numba.cuda.get_current_device", none)
    monkeypatch.setattr(devices, "version", lambda name: "0.30")
    devices.card.cache_clear()
    yield
    devices.card.cache_clear()


@pytest.mark.parametrize("command", ["run", "run --dry-run", "converge", "flow", "resume"])
def test_without_a_card_the_command_says_what_to_do(runs, no_card, tmp_path, command):
    folder, _ = runs
    name, *more = command.split()
    given = folder / ("left.h5" if name in ("flow", "resume") else "case.yaml")
    output = [] if name == "resume" else ["-o", str(tmp_path / "out.png")]
    device = [] if name == "resume" else ["--device", "gpu"]
    done = call(name, given, *output, *device, *more)
    assert done.exit_code == 2, done.output
    assert "no GPU: no driver to be found; it takes an NVIDIA card" in done.output
    assert "pip install 'rodsim[gpu]'" in done.output
    if name == "resume":
        assert "sums were computed on simulator" in done.output
        assert "--device cpu" in done.output
    assert list(tmp_path.iterdir()) == []


def test_without_numba_cuda_too(monkeypatch):
    def missing(name):
        raise devices.PackageNotFoundError(name)

    monkeypatch.setattr(devices, "version", missing)
    devices.card.cache_clear()
    with pytest.raises(UsageError, match=r"numba-cuda is not installed.*rodsim\[gpu\]"):
        rodsim.velocity([[0, 0, 0]], [[1, 0, 0]], [[1, 2, 3]], [[3, 2, 1]], 0.3, 0.7, device="gpu")
    devices.card.cache_clear()


def test_runs_of_a_study_share_no_card(tmp_path, monkeypatch):
    monkeypatch.setattr("rodsim.convergence.side_by_side.usable_cores", lambda: 3)
    (tmp_path / "case.yaml").write_text(CASE)
    found = []
    for device in ("cpu", "gpu"):
        runs = Runs(None)
        for end in (2e-6, 3e-6):
            other = rodsim.load_case(tmp_path / "case.yaml", {"time.end": end})
            runs.ask("run", other.on(device), 1e12)
        found.append(runs.side_by_side)
    assert found == [2, 1]


def test_fast_sums_are_for_the_cpu(tmp_path):
    (tmp_path / "case.yaml").write_text(CASE.replace("0.3}", "0.3, sums: {accuracy: 1.0e-5}}"))
    case = rodsim.load_case(tmp_path / "case.yaml")
    with pytest.raises(CaseError, match=r"case.yaml:2: fluid.sums.*on a GPU sums are exact"):
        on_device(case, "gpu")
    with pytest.raises(UsageError, match="fast sums are for the CPU"):
        rodsim.velocity(*4 * [[[0, 1, 2]]], 0.3, 0.7, accuracy=1e-3, device="gpu")
    with pytest.raises(UsageError, match="must be one of cpu, gpu"):
        on_device(case, "tpu")
