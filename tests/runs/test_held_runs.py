"""Runs with bodies, motors, hooks and anchors: files, resume, and what other commands do."""

import shutil

import numpy as np
import pytest
from calls import command
from contents import differences

from rodsim import load_case, open_trajectory, resume, simulate
from rodsim.blocks.hull import triangles as triangles_of
from rodsim.blocks.surface import surface_of
from rodsim.blocks.words import Spherocylinder
from rodsim.output.verify import verify
from rodsim.scene.build import build_scene
from rodsim.scene.quaternions import to_matrix

MODULI = "moduli: {bending: 3.5e-3, twisting: 3.3e-3, shear: 0.8, stretch: 0.9}"
END = "time: {end: 1.1e-3, tolerance: 1.0e-4}\noutput: {interval: 2.5e-4}\n"
SWIMMER = f"""
fluid: {{viscosity: 1.3e-6, epsilon: 0.25}}
bodies:
  cargo:
    shape: {{kind: file, path: cargo.csv, origin: [0.1, 0.2, 0.3]}}
    force: [0, "2.0e-6*sin(700*t)", -1.2e-6]
rods:
  tail:
    shape:
      {{kind: straight, points: 7, spacing: 0.22, origin: [0.1, 0.2, 1.35], perturbation: 0.01}}
    {MODULI}
    start:
      hold: clamped
      to: cargo
      motor: {{rate: "2*pi*90*min(t/4e-4, 1)"}}
      hook: {{bending: 3.0e-4, twisting: 2.0e-4}}
tracers:
  here: [[0.9, 1.4, 0.5]]
{END}"""
TOWED = f"""
fluid: {{viscosity: 1.3e-6, epsilon: 0.25}}
bodies:
  cell:
    shape: {{kind: spheroid, length: 2.2, radius: 0.6, points: 20, origin: [0.1, 0.2, 0.3]}}
    motion: {{velocity: [0, "2700*t", 0], turn: [0, 0, "300*t"]}}
rods:
  flag:
    shape: {{kind: straight, points: 7, spacing: 0.23, origin: [0.1, 0.2, 1.4]}}
    {MODULI}
    start: {{hold: clamped, to: cell, motor: {{torque: 7.0e-4, free_rate: 900}}}}
{END}"""
CILIUM = f"""
fluid: {{viscosity: 1.3e-6, epsilon: 0.25}}
rods:
  cilium:
    shape: {{kind: straight, points: 7, spacing: 0.21, origin: [-2.5, 0, 0]}}
    {MODULI}
    start:
      hold: clamped
      move: {{displace: [0.002, "0.003*cos(900*t)", 0], turn: ["0.01 + 0.2*sin(900*t)", 0, 0]}}
{END}"""
BRIDGE = f"""
fluid: {{viscosity: 1.3e-6, epsilon: 0.25, wall: {{z: -0.6}}}}
rods:
  bridge:
    shape: {{kind: straight, points: 7, spacing: 0.21, rotate: {{axis: [1, 0, 0], degrees: 90}}}}
    {MODULI}
    start: {{hold: clamped, move: {{displace: [0, 0, "0.02*sin(900*t)"]}}}}
    end: {{hold: hinged}}
{END}"""
TOGETHER = f"""
fluid: {{viscosity: 1.3e-6, epsilon: 0.25}}
bodies:
  cargo:
    shape: {{kind: file, path: cargo.csv, origin: [0.1, 0.2, 0.3]}}
rods:
  tail:
    shape: {{kind: straight, points: 7, spacing: 0.22, origin: [0.1, 0.2, 1.35]}}
    {MODULI}
    start: {{hold: clamped, to: cargo, gap: true, motor: {{torque: 7.0e-4, free_rate: 900}}}}
  cilium:
    shape: {{kind: straight, points: 7, spacing: 0.21, origin: [2.5, 0, 0]}}
    {MODULI}
    start: {{hold: clamped, move: {{turn: ["0.1*sin(900*t)", 0, 0]}}}}
{END}"""
SCENES = {"swimmer": SWIMMER, "towed": TOWED, "cilium": CILIUM, "bridge": BRIDGE,
          "together": TOGETHER}  # fmt: skip


def make(folder, text, overrides=()):
    cargo = Spherocylinder(kind="spherocylinder", length=1.9, radius=0.5, points=24)
    points = surface_of(cargo, "algebraic7").skin.T
    np.savetxt(folder / "cargo.csv", points, delimiter=",", header="x,y,z", comments="")
    (folder / "case.yaml").write_text(text)
    return load_case(folder / "case.yaml", overrides)


@pytest.fixture(scope="module", params=SCENES)
def whole(request, tmp_path_factory):
    """An unbroken run, and copies of its file after every step; the table it read is gone."""
    folder = tmp_path_factory.mktemp("whole")
    path, kept = folder / "out.h5", []

    def stop():
        kept.append(shutil.copy(path, folder / f"{len(kept)}.h5"))
        return ""

    simulate(make(folder, SCENES[request.param]), path, stop=stop)
    (folder / "cargo.csv").unlink()
    return path, kept


def test_what_is_held_goes_on_with_the_same_bits(whole, tmp_path):
    path, kept = whole
    assert len(kept) > 10
    for number in (0, len(kept) // 2, len(kept) - 2):
        copy = shutil.copy(kept[number], tmp_path)
        resume(copy)
        assert differences(copy, path) == []


def test_a_later_end_and_more_fields_keep_what_is_there(whole, tmp_path):
    path, _ = whole
    copy = shutil.copy(path, tmp_path)
    with open_trajectory(path) as run:
        before = {name: run.observable(name) for name in run.observables}
        bodies = run.bodies and run.of_bodies("position")
        rotors, frames = run.of_rotors(), run.frames
    more = "output.fields=[position, director, velocity, force]"
    resume(copy, overrides=["time.end=1.4e-3", more])
    with open_trajectory(copy) as run:
        assert run.time[-1] == pytest.approx(1.4e-3)
        assert verify(run) == []
        assert abs(run.read("force", frames - 1)).max() > 0.0
        for name, values in before.items():
            assert np.array_equal(run.observable(name)[:frames], values)
        assert np.array_equal(run.of_rotors()[:frames], rotors)
        if run.bodies:
            assert np.array_equal(run.of_bodies("position")[:frames], bodies)
            assert len(run.of_bodies("orientation")) == run.frames


def test_the_commands_read_it(whole, tmp_path):
    path, _ = whole
    for arguments in (["info", path, "--check"], ["energy", path],
                      ["export", path, "-o", tmp_path / "out.csv"],
                      ["export", path, "-o", tmp_path / "out.npz"]):  # fmt: skip
        command(*arguments)


def test_a_rod_starts_from_such_an_output(whole, tmp_path):
    path, _ = whole
    with open_trajectory(path) as run:
        rod, nodes = run.rods[0].name, run.rods[0].nodes
        end, triads = run.position[-1, nodes], run.director[-1, nodes]
    text = f"""
fluid: {{viscosity: 1.3e-6, epsilon: 0.25}}
rods:
  again:
    shape: {{kind: file, path: {path}, rod: {rod}}}
    {MODULI}
    start: {{hold: clamped, motor: {{rate: 300}}}}
time: {{end: 1.0e-4}}
"""
    scene = build_scene(make(tmp_path, text))
    assert np.array_equal(scene.initial.position.T, end)
    assert np.array_equal(scene.initial.director.transpose(2, 0, 1), triads)


@pytest.fixture(scope="module")
def towed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("towed")
    simulate(make(folder, TOWED), folder / "out.h5")
    return folder / "out.h5"


def test_surfaces_move_with_their_body(towed):
    with open_trajectory(towed) as run:
        surfaces, triangles = run.surfaces(), run.triangles
        places, turns = (run.of_bodies(name)[:, 0] for name in ("position", "orientation"))
        skin = run.body("cell")["skin"]
    for points, place, q in zip(surfaces, places, turns, strict=True):
        assert points == pytest.approx(place + skin @ to_matrix(q).T, abs=1e-12)
    level = (skin[:, :2] ** 2).sum(axis=1) / 0.6**2 + skin[:, 2] ** 2 / 1.1**2
    assert level == pytest.approx(np.ones(20), abs=1e-5)  # its area is interpolated
    assert 0.1 < 2.0 * np.arccos(abs(turns[-1, 0])) < 0.5  # it turns by 0.3 rad in all
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    there, back = ({tuple(e) for e in pairs} for pairs in (edges, edges[:, ::-1]))
    assert there == back  # closed: each edge once in each direction
    assert len(there) == len(edges)
    assert len(triangles) == 2 * len(skin) - 4
    volume = np.linalg.det(skin[triangles]).sum() / 6.0  # positive: seen from outside
    exact = 4.0 / 3.0 * np.pi * 1.1 * 0.6**2
    assert 0.7 * exact < volume < exact  # of 20 points; the hull lies inside


def test_the_hull_of_a_body_of_the_default_points_is_nearly_all_of_it():
    shape = Spherocylinder(kind="spherocylinder", length=2.4, radius=0.5)
    surface = surface_of(shape, "algebraic7")
    corners = surface.skin.T[triangles_of(surface)]
    exact = np.pi * 0.25 * 1.4 + 4.0 / 3.0 * np.pi * 0.125
    assert 0.9 * exact < np.linalg.det(corners).sum() / 6.0 < exact


def test_paraview_sees_the_surface(towed, tmp_path):
    pytest.importorskip("vtkmodules.vtkIOHDF")
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOHDF import vtkHDFReader

    exported = tmp_path / "out.vtkhdf"
    command("export", towed, "-o", exported)
    with open_trajectory(towed) as run:
        position, surfaces, triangles = run.position, run.surfaces(), run.triangles
    for path in (towed, exported):
        reader = vtkHDFReader()
        reader.SetFileName(str(path))
        reader.UpdateInformation()
        assert reader.GetNumberOfSteps() == len(position)
        for step in range(len(position)):
            reader.SetStep(step)
            reader.Update()
            data = reader.GetOutputDataObject(0)
            seen = vtk_to_numpy(data.GetPoints().GetData())
            assert np.array_equal(seen, np.vstack([position[step], surfaces[step]]))
            corners = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
            assert np.array_equal(corners, triangles + len(position[step]))
            first = vtk_to_numpy(data.GetPointData().GetArray("D1"))
            assert np.isfinite(first[: position.shape[1]]).all()
            assert np.isnan(first[position.shape[1] :]).all()


@pytest.mark.parametrize("kind", ["tube", "line"])
def test_bodies_are_drawn_where_they_are(towed, kind):
    pytest.importorskip("matplotlib")
    from rodsim.plotting import style
    from rodsim.plotting.look import Look
    from rodsim.plotting.surround import set_stage

    with open_trajectory(towed) as run:
        camera, shapes, _ = Look("yz", kind, "time").of(run, [0, run.frames - 1])
        surface = run.surfaces(run.frames - 1)
    axis = style.new_figure(3.0, 3.0).add_subplot()
    set_stage(axis, camera, shapes.bounds(camera))
    shapes.draw(axis, camera, 1)
    paths = [c.get_paths() for c in axis.collections]
    corners = np.concatenate([p.vertices for several in paths for p in several])
    seen = camera.project(surface)[:, :2]
    assert corners.min(axis=0) == pytest.approx(seen.min(axis=0), abs=0.3)
    drawn = {tuple(corner) for corner in corners.round(9)}
    assert sum(tuple(corner) in drawn for corner in seen.round(9)) > len(seen) / 3  # those in front
    low, high = shapes.bounds(camera)
    assert (low < seen.min(axis=0)).all()
    assert (high > seen.max(axis=0)).all()


@pytest.mark.long
def test_movies_and_flow_pictures_of_bodies_are_written(towed, tmp_path):
    pytest.importorskip("matplotlib")
    grid = "0.1,-1:2:9,-1:3:9"
    for words in (["plot", towed, "-n", "2", "-o", tmp_path / "shapes.gif"],
                  ["flow", towed, "--grid", grid, "-o", tmp_path / "flow.png"]):  # fmt: skip
        command(*words)
