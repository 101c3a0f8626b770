"""Runs with loads, tethers, a flow and tracers: stopped anywhere, any threads, looked at after."""

import shutil

import h5py
import numpy as np
import pytest
from calls import command
from contents import differences
from interrupted import make, run_with_copies

from rodsim import load_case, open_trajectory, resume, simulate
from rodsim.analysis.energy import energy_table
from rodsim.analysis.flow import flow_at, tracer_paths
from rodsim.analysis.grid import make_grid
from rodsim.analysis.replay import Replay

MODULI = "moduli: {bending: 3.5e-3, twisting: 2.5e-3, shear: 0.7, stretch: 0.9}"
SCENE = f"""
fluid: {{viscosity: 1.3e-6, epsilon: 0.3, flow: ["90*z*cos(700*t)", "40*x", 0.3]}}
rods:
  tail:
    shape: {{kind: straight, points: 12, spacing: 0.11}}
    {MODULI}
    strain_twist: ["1.3*sin(3*s + 900*t)", 0, 0.4]
    loads:
      weight: {{along: all, force: [0, "2e-5*s", -3.0e-5]}}
      tip: {{at: end, force: [0, 2.0e-5, "-3e-5*cos(500*t)"], frame: triad}}
  ring:
    shape: {{kind: ring, radius: 0.4, points: 14, origin: [0.2, 1.1, 0.3]}}
    {MODULI}
    strain_twist: [1.2, 0, 0.6]
tethers:
  link: {{from: {{rod: tail, at: end}}, to: {{rod: ring, s: 0.7}}, stiffness: 3.0e-4, length: 0.3}}
  trap: {{from: [0, 0, 0], to: {{rod: tail, at: start}}, stiffness: 2.0e-4, only: pull}}
tracers:
  here: [[0.3, 0.4, 0.5], [0.7, 0.2, 0.1]]
time: {{end: 4.3e-3, tolerance: 1.0e-5}}
output: {{interval: 5.0e-4, fields: [position, director, velocity, force, torque]}}
"""
FIXED = ("time.integrator=rk4", "output.interval=1e-5", "time.end=4e-5", "time.step=1e-6")


@pytest.fixture(params=["rkc", "rk4"], scope="module")
def unbroken(request, tmp_path_factory):
    """A run, and copies of its file after every step."""
    folder = tmp_path_factory.mktemp("unbroken")
    case = make(folder, SCENE, FIXED if request.param == "rk4" else ())
    return run_with_copies(case, folder)[:2]


def test_a_killed_run_goes_on_with_the_same_bits_on_any_threads(unbroken, tmp_path):
    path, killed = unbroken
    assert len(killed) > 20
    for i, number in enumerate(range(0, len(killed), len(killed) // 6)):
        copy = shutil.copy(killed[number], tmp_path)
        resume(copy, threads=1 + i % 2)
        assert differences(copy, path) == []


def test_the_file_has_what_acted_and_its_ledger(unbroken):
    path, _ = unbroken
    with open_trajectory(path) as run:
        frames = run.frames
        shapes = {name: run.observable(name).shape for name in run.observables}
        assert shapes["external_force"] == shapes["external_torque"] == (frames, 3)
        assert shapes["tether_energy"] == (frames, 2)
        for name in ("loads_work", "flow_work", "external_work", "dissipated"):
            assert shapes[name] == (frames,)
        assert run.unit("tether_energy") == run.unit("dissipated") == "g um^2 s^-2"
        assert run.unit("external_force") == "g um s^-2"
        work = run.observable("loads_work") + run.observable("flow_work")
        assert run.observable("external_work") == pytest.approx(work, rel=1e-12)
        assert run.observable("dissipated")[0] == 0.0
        assert (np.diff(run.observable("dissipated")) > 0).all()


def test_the_energy_table_has_tethers_and_the_ledger(tmp_path):
    """With a strain twist that does not change: one that is driven does work that nobody counts."""
    (tmp_path / "case.yaml").write_text(SCENE.replace('"1.3*sin(3*s + 900*t)"', "1.3"))
    simulate(load_case(tmp_path / "case.yaml"), tmp_path / "out.h5")
    table = energy_table(tmp_path / "out.h5")
    assert table.columns == (
        "time", "bending", "twisting", "shear", "stretch", "tether", "total", "work", "dissipated"
    )  # fmt: skip
    rows = dict(zip(table.columns, table.rows.T, strict=True))
    assert rows["total"] == pytest.approx(sum(table.rows.T[1:6]), rel=1e-14)
    kept = rows["total"] + rows["dissipated"] - rows["work"]
    # Few points, and the energies of stiff modes at frames inside long steps.
    assert kept == pytest.approx(np.full(len(kept), kept[0]), abs=0.02 * rows["dissipated"][-1])


def test_info_lists_what_acts(tmp_path):
    (tmp_path / "case.yaml").write_text(SCENE)
    result = command("info", tmp_path / "case.yaml")
    acting = "acting: elastic (driven), loads (driven), tethers, fluid, flow (driven)\n"
    assert acting in result.stdout


def test_a_scene_without_them_stores_no_more_than_before(tmp_path):
    (tmp_path / "case.yaml").write_text(f"""
fluid: {{viscosity: 1.3e-6, epsilon: 0.3}}
rods:
  tail:
    shape: {{kind: straight, points: 8, spacing: 0.11}}
    {MODULI}
time: {{end: 1.0e-6}}
""")
    case = load_case(tmp_path / "case.yaml")
    assert not {"tethers", "loads", "flow"} & {
        *case.resolved(), *case.resolved()["fluid"], *case.resolved()["rods"]["tail"]
    }  # fmt: skip
    simulate(case, tmp_path / "out.h5")
    with h5py.File(tmp_path / "out.h5") as file:
        assert set(file["observables"]) == {
            "bending_energy", "twisting_energy", "shear_energy", "stretch_energy", "power",
            "length", "net_force", "net_torque", "gap",
        }  # fmt: skip


def test_the_fluid_afterwards_has_the_background_in_it(unbroken):
    """At frame 0, where nothing is interpolated: the rods' own points move as the run says."""
    with open_trajectory(unbroken[0]) as run:
        replay = Replay(run)
        sources = replay.sources(0)
        found, stored = sources.velocity(run.position[0]), run.read("velocity", 0)
        assert found == pytest.approx(stored, abs=1e-10 * abs(stored).max())
        far = "9e4,0:2:2,1.7"
        flow = flow_at(replay, 0, make_grid(far, run.position[0]), raw=True)
        background = [90 * 1.7, 40 * 9e4, 0.3]
        assert flow.velocity == pytest.approx(np.array([background] * 2), rel=1e-4)


@pytest.mark.compiled
def test_tracers_of_the_run_and_of_the_flow_command_go_the_same_way(tmp_path):
    """After the first transient, see test_flow_of_a_run; of order 2 in the interval of frames."""
    (tmp_path / "case.yaml").write_text(SCENE)
    case = load_case(
        tmp_path / "case.yaml",
        ["time.tolerance=1e-7", "time.end=2e-3", "output.interval=2e-5"],
    )
    simulate(case, tmp_path / "out.h5")
    with open_trajectory(tmp_path / "out.h5") as run:
        carried = run.tracers
        paths = tracer_paths(Replay(run), carried[20], 20, 100)
    moved = np.linalg.norm(carried[100] - carried[20], axis=1).max()
    assert moved > 0.04
    assert paths.position[-1] == pytest.approx(carried[-1], abs=0.02 * moved)


def test_the_flow_of_a_later_frame_and_its_tracers_by_the_command(unbroken, tmp_path):
    """Of frames inside long steps the rods settle first, ledger and all."""
    for options in (["-o", "flow.png"], ["--tracers", "-o", "paths.csv"]):
        folder = ["-o", tmp_path / options[options.index("-o") + 1]]
        options = [o for o in options if o not in ("-o", "flow.png", "paths.csv")]
        command("flow", unbroken[0], *options, *folder)


def test_the_flow_command_says_where_a_pressure_is_left_out(tmp_path):
    text = SCENE.replace("90*z*cos(700*t)", "90*sin(z)")
    (tmp_path / "case.yaml").write_text(text)
    simulate(load_case(tmp_path / "case.yaml", ["time.end=1e-6"]), tmp_path / "out.h5")
    said = command("flow", tmp_path / "out.h5", "--at", 0, "--grid", "0,-1:1:3,-1:1:3",
                   "-o", tmp_path / "flow.csv").stderr  # fmt: skip
    assert "pressure: without that of fluid.flow" in said
