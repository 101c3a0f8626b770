"""A study of the points of bodies."""

import csv

import numpy as np
import pytest
from calls import command

CASE = """
fluid: {viscosity: 1.3e-6, epsilon: 0.25}
bodies:
  ball:
    shape: {kind: sphere, radius: 0.7, points: 40}
    force: [1.1e-6, 0, -2.3e-6]
rods:
  tail:
    shape: {kind: straight, points: 5, spacing: 0.3, origin: [0, 0, 0.7]}
    moduli: {bending: 3.5e-3, twisting: 3.3e-3, shear: 0.8, stretch: 0.9}
    start: {hold: clamped, to: ball}
time: {end: 0.05, tolerance: 1.0e-3}
"""


@pytest.mark.long
def test_errors_fall_with_the_points_of_bodies(tmp_path):
    (tmp_path / "case.yaml").write_text(CASE)
    report = tmp_path / "report"
    done = command("converge", tmp_path / "case.yaml", "--in", "body_points", "-q", "-o", report)
    assert "error of the surfaces" in done.stdout
    assert "160 points of bodies, held against 80" in done.stdout
    with open(f"{report}.csv", encoding="utf-8") as stream:
        rows = {int(float(row["value"])): row for row in csv.DictReader(stream)}
    assert sorted(rows) == [20, 40, 80, 160]
    errors = [float(rows[n]["position_error"]) for n in (20, 40, 80)]
    assert errors[0] > errors[2] > 0.0
    # 40 points of a sphere err by half a per cent at most; it sinks by some tenths of its radius
    assert float(rows[40]["speed_error"]) < 0.006
    assert rows[160]["position_error"] == ""


@pytest.mark.parametrize("bodies", ["", "points: 40"])
def test_what_has_no_such_points_is_refused(tmp_path, bodies):
    text = CASE.replace("points: 40", "points: 2000")
    if not bodies:
        text = text.replace(", to: ball", "")
        text = text[: text.index("bodies:")] + text[text.index("rods:") :]
        words = "there are no bodies"
    else:
        text = text.replace("kind: sphere, radius: 0.7, points: 2000", "kind: file, path: x.csv")
        words = "comes from a file"
        directions = np.random.default_rng(5).standard_normal((24, 3))
        skin = 0.7 * directions / np.linalg.norm(directions, axis=1, keepdims=True)
        rows = "\n".join(",".join(f"{x:.9f}" for x in point) for point in skin)
        (tmp_path / "x.csv").write_text("x,y,z\n" + rows)
    (tmp_path / "case.yaml").write_text(text)
    options = "--in", "body_points", "-q", "-o", tmp_path / "report"
    done = command("converge", tmp_path / "case.yaml", *options, code=2)
    assert words in done.stderr
