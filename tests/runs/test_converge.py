"""``rodsim converge``: rows against truth of their own, the report, what interrupts it."""

import csv
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool

import numpy as np
import pytest
from calls import call
from scenes import CONFIGS, final_state, load

from rodsim.analysis.difference import position_errors, triad_angle
from rodsim.convergence import rows, side_by_side
from rodsim.convergence.report import fitted_order, text
from rodsim.convergence.study import Study
from rodsim.errors import UsageError

SMALL = ("rods.rod.shape.points=25", "time.end=4e-4", "time.tolerance=1e-4")


def study(*axes, config="open_rod", overrides=SMALL, **options):
    made = Study(lambda more: load(config, *overrides, *more), axes, **options)
    return made, list(made.run())


@pytest.fixture(scope="module")
def in_time():
    return study("tolerance", "step")


@pytest.fixture(scope="module")
def in_space():
    return study("points", "epsilon")


@pytest.mark.compiled
def test_an_error_is_the_distance_from_a_tighter_run(in_time):
    made, _ = in_time
    result = next(r for r in made.sections[0].results if r.row.value == pytest.approx(1e-3))
    exact = final_state("open_rod", *SMALL, "time.tolerance=1e-10")[0]
    loose = final_state("open_rod", *SMALL, "time.tolerance=1e-3")[0]
    largest, rms = position_errors(loose.position, exact.position)
    # Another reference, converged to 1e-3 of these errors.
    assert result.errors.position == pytest.approx(largest, rel=1e-2)
    assert result.errors.rms == pytest.approx(rms, rel=1e-2)
    angle = triad_angle(loose.director, exact.director)
    assert result.errors.angle == pytest.approx(angle, rel=1e-2)
    assert result.errors.relative == pytest.approx(largest / (24 * np.pi / 40), rel=1e-2)


@pytest.mark.compiled
def test_what_rows_will_cost_is_known_beforehand(in_time, in_space):
    """Of a rod that relaxes, and of one that a drive lets make no long steps."""
    flagellum = ("rods.tail.shape.points=40", "rods.tail.shape.spacing=1", "time.end=0.0314")
    driven = study("tolerance", config="flagellum", overrides=flagellum)
    for _, result in (*in_time[1], *in_space[1], *driven[1]):
        ratio = result.row.evaluations / result.outcome.evaluations
        assert 0.4 < ratio < 2.5, (result.row, ratio)


@pytest.mark.compiled
def test_orders_in_time_are_those_of_the_methods(in_time):
    section = in_time[0].sections[0]
    assert fitted_order(section, "euler") == pytest.approx(1.0, abs=0.1)
    assert fitted_order(section, "rkc") > 1.8  # order 3, less where steps do not resolve the start
    rk4 = [r.errors.position for r in section.results if r.row.method == "rk4"]
    euler = [r.errors.position for r in section.results if r.row.method == "euler"]
    assert max(rk4) < 1e-2 * min(euler)
    assert section.own.position < 1e-2 * min(euler)


@pytest.mark.compiled
def test_order_in_space_is_two_and_the_finest_is_the_reference(in_space):
    made = in_space[0]
    points, epsilon = made.sections
    assert [r.row.value for r in points.results] == [49, 25, 13, 7, 97]
    assert fitted_order(points, "rkc") == pytest.approx(2.0, abs=0.4)  # few and coarse points
    assert points.results[-1].errors is None
    assert points.own.position == pytest.approx(points.results[0].errors.position / 3)
    for r in points.results:  # length and epsilon stay
        assert r.outcome.scene.rods.lengths[0] == pytest.approx(24 * np.pi / 40)
        assert r.outcome.scene.epsilon == made.scene.epsilon
    # Another blob is another answer: the more so, the farther from the case's own.
    assert [r.row.value / made.scene.epsilon for r in epsilon.results] == list(rows.SENSITIVITY)
    half, near, _, _ = (r.errors.position for r in epsilon.results)
    assert half > near > 1e-3


def test_the_longest_step_is_a_round_one_that_leads_to_the_end():
    assert rows._steps(0.1, 2.7e-6) == 50_000
    assert rows._steps(0.0785, 4.7e-6) == 39_250
    five_periods = 0.07853981633974483  # no round step leads there: the fewest equal steps
    assert rows._steps(five_periods, 4.7e-6) == 16_711


def test_a_swimmer_has_a_speed_and_others_have_none():
    swimmer, _ = study("epsilon", config="flagellum", overrides=(
        "rods.tail.shape.points=12", "rods.tail.shape.spacing=0.5", "time.end=1e-3",
        "fluid.epsilon.spacings=3"))  # fmt: skip
    assert all(r.errors.speed > 0 for r in swimmer.sections[0].results)
    rod, _ = study("epsilon", overrides=("rods.rod.shape.points=5", "time.end=1e-4"))
    assert all(r.errors.speed is None for r in rod.sections[0].results)


def test_a_row_that_cannot_be_is_named(in_time):
    _, results = study("points", overrides=("rods.rod.shape.points=9", "time.end=1e-5",
                                            "rods.rod.strain_twist=[1.3, 0, 20]"))  # fmt: skip
    coarse = [r for _, r in results if r.row.value == 5]
    assert coarse[0].outcome is None
    assert coarse[0].status.startswith("refused: abs(Omega) ds = 3.1")


def test_no_points_for_a_rod_from_a_file(tmp_path):
    table = np.zeros((3, 12))
    table[:, 2] = [0, 0.5, 1.0]
    table[:, [3, 7, 11]] = 1.0
    np.savetxt(tmp_path / "rod.txt", table)
    shape = f"rods.rod.shape={{kind: file, path: {tmp_path / 'rod.txt'}, spacing: 0.5}}"
    with pytest.raises(UsageError, match="rod 'rod' comes from a file"):
        study("points", overrides=(shape, "fluid.epsilon=0.4", "time.end=1e-6"))


def test_tracers_count_and_have_an_error_of_their_own():
    """Where they decide the steps, their error falls with the tolerance, and the table has it."""
    tracers = "tracers={near: [[0.3, 0.2, 1.0], [0.1, -0.4, 2.0]]}"
    made, results = study(
        "tolerance", overrides=("rods.rod.shape.points=5", "time.end=1e-3", tracers)
    )
    errors = [result.errors.tracers for _, result in results]
    assert all(error is not None for error in errors)
    assert errors[-1] < 0.1 * max(errors)
    assert "tracers" in text(made)


COMMAND = ("converge", CONFIGS / "open_rod.yaml", "--set", "rods.rod.shape.points=5",
           "--set", "time.end=1e-4", "--in", "tolerance,epsilon", "-q")  # fmt: skip


def test_report_is_a_table_a_csv_and_a_picture(here):
    done = call(*COMMAND, "-o", "report")
    assert done.exit_code == 0, done.output
    assert "fastest run of each method within" in done.stdout
    assert "sensitivity to epsilon" in done.stdout
    with open("report.csv") as stream:
        table = list(csv.DictReader(stream))
    assert [row["section"] for row in table] == ["tolerance"] * 9 + ["epsilon"] * 4
    assert all(float(row["position_error"]) > 0 for row in table)
    assert all(int(row["pairs"]) == 25 for row in table)
    assert (here / "report.png").read_bytes()[:4] == b"\x89PNG"


@pytest.mark.compiled
@pytest.mark.parametrize(("size", "columns"), [((12.0, 4.0), 3), ((3.4, 8.0), 1)])
def test_the_picture_has_the_size_asked_for_and_its_panels_lie_as_it_is_wide(
    in_time, tmp_path, size, columns
):
    pytest.importorskip("matplotlib")
    from matplotlib.image import imread

    from rodsim.plotting import style
    from rodsim.plotting.convergence import plot_study

    kept = []
    sheet = style.Sheet(size, 50, "Title")
    draw = sheet.figure
    object.__setattr__(sheet, "figure", lambda *words: kept.append(draw(*words)) or kept[-1])
    plot_study(in_time[0], tmp_path / "a.png", sheet)
    assert imread(tmp_path / "a.png").shape[:2] == (50 * size[1], 50 * size[0])
    lefts = {round(axis.get_position().x0, 3) for axis in kept[0].axes}
    assert len(lefts) == columns
    with pytest.raises(UsageError, match="too small"):
        plot_study(in_time[0], tmp_path / "a.png", style.Sheet((2.0, 1.0)))


def test_earlier_reports_are_renamed(here):
    (here / "report.csv").write_text("mine")
    done = call(*COMMAND, "-o", "report", "--set", "time.tolerance=0.5", "--size", "300x90")
    assert done.exit_code == 0, done.output
    assert "the earlier report.csv is now report.1.csv" in done.stderr
    assert (here / "report.1.csv").read_text() == "mine"


def test_interrupted_it_keeps_what_it_has(here, monkeypatch):
    plain = Study._outcome

    def interrupted(self, row, **options):
        if row.axis == "epsilon":
            raise KeyboardInterrupt
        return plain(self, row, **options)

    monkeypatch.setattr(Study, "_outcome", interrupted)
    done = call(*COMMAND, "-o", "report")
    assert done.exit_code == 75
    assert "reference: rkc at tolerance 1e-09" in done.stdout
    assert "sensitivity" not in done.stdout
    assert len((here / "report.csv").read_text().splitlines()) == 10


def test_unknown_axis_is_refused(here):
    done = call("converge", CONFIGS / "open_rod.yaml", "--in", "step,mesh")
    assert done.exit_code == 2
    assert (
        "'mesh' is none of tolerance, step, points, body_points, epsilon, accuracy" in done.stderr
    )


@pytest.mark.compiled
@pytest.mark.parametrize(("end", "amplified"), [(0.02, False), (0.75, True)])
def test_where_rounding_decides_the_end_no_bound_is_claimed(end, amplified):
    """A ring beyond Michell's twist, started without any disturbance: rounding grows e^(57 t)."""
    ring = ("rods.ring.shape={kind: ring, radius: 2.5, points: 40}", f"time.end={end}",
            "rods.ring.strain_twist=[0, 0, 1.0]", "time.tolerance=1e-3",
            "rods.ring.moduli.shear=0.08", "rods.ring.moduli.stretch=0.08")  # fmt: skip
    made, _ = study("tolerance", config="closed_ring", overrides=ring)
    section = made.sections[0]
    assert section.amplified == amplified
    assert ("no bound: rounding is amplified" in text(made)) == amplified
    assert section.floor == max(section.own.position, section.rounding)
    assert (section.rounding > 1e-11) == amplified


@pytest.mark.compiled
def test_the_twin_in_space_has_the_points_of_the_case(in_space):
    section = in_space[0].sections[0]
    assert 0.0 < section.rounding < 1e-12
    assert not section.amplified


STIFF = ("rods.rod.shape.points=9", "time.end=6e-5", "time.tolerance=1e-2", "fluid.epsilon=0.05")


@pytest.mark.compiled
def test_costly_rows_are_run_over_a_stretch_and_come_to_what_they_would_at_the_end():
    """Half of euler's step has half its error, up to the next order: 3 per cent in this scene."""
    made, short = study("step", overrides=STIFF)
    _, whole = study("step", overrides=STIFF, whole=True)
    rows = [{(r.row.method, r.row.value): r for _, r in results} for results in (short, whole)]
    assert rows[0].keys() == rows[1].keys()
    assert [r.row.part for _, r in short] == [1.0, 0.05, 0.05]
    assert [r.row.part for _, r in whole] == [1.0, 1.0, 1.0]
    for one, all_of_it in zip(rows[0].values(), rows[1].values(), strict=True):
        assert one.outcome.evaluations == all_of_it.outcome.evaluations
        assert one.outcome.steps == all_of_it.outcome.steps
    longest, half, rk4 = (r.errors for r in rows[0].values())
    measured = [r.errors for r in rows[1].values()]
    assert longest == measured[0]
    for name in ("position", "rms", "angle"):
        assert getattr(half, name) == pytest.approx(getattr(measured[1], name), rel=0.05)
    assert rk4.position < 0.05 * longest.position  # another order: its size alone
    assert text(made).count("  *") == 2
    assert "*: only the first 5% was run" in text(made)


FEW = ("rods.rod.shape.points=9", "time.end=1e-4", "time.tolerance=1e-4")


def numbers(results):
    return [(r.row.value, r.outcome.evaluations, vars(r.errors)) for _, r in results if r.errors]


@pytest.mark.compiled
def test_rows_side_by_side_are_those_one_after_another(monkeypatch):
    _, alone = study("tolerance", "epsilon", overrides=FEW)
    monkeypatch.setattr(side_by_side, "WORTHWHILE", 0.0)
    monkeypatch.setattr(side_by_side, "usable_cores", lambda: 2)
    heard = Heard()
    made, beside = study("tolerance", "epsilon", overrides=FEW, progress=heard)
    assert made.side_by_side == 2
    assert numbers(beside) == numbers(alone)
    assert heard.fractions == sorted(heard.fractions)
    assert made._runs._pool
    assert "on 1 of the cores, 2 rows at once" in text(made)


class Heard:
    """A display of the progress."""

    def __init__(self):
        self.fractions = []

    def update(self, fraction, note):
        self.fractions.append(fraction)


def test_a_run_that_several_rows_ask_for_is_made_once(monkeypatch):
    """The case's own points and epsilon at 1e-6 are a row of each."""
    made = []
    plain = side_by_side.attempt

    def attempt(case, threads, repeats, twin, progress):
        points, tolerance = case.rods["rod"].shape.points, case.time.tolerance
        made.append((tolerance, points, case.fluid.epsilon, twin, repeats))
        return plain(case, threads, repeats, twin, progress)

    monkeypatch.setattr(side_by_side, "attempt", attempt)
    _, results = study("tolerance", "points", "epsilon", overrides=FEW)
    assert len(set(made)) == len(made)
    at = {(r.row.axis, r.row.value): r.outcome for _, r in results}
    assert at["tolerance", 1e-6] is at["points", 9]
    own = results[0][1].outcome.scene.epsilon
    repeats = {run[0]: run[-1] for run in made if run[1:3] == (9, own)}
    timed = {r.row.value for _, r in results if r.row.axis == "tolerance"}
    assert repeats == dict.fromkeys(timed, 3) | {1e-7: 1, 1e-8: 1}  # the reference and its check
    assert {run[-1] for run in made if run[1:3] != (9, own)} == {1}
    assert [run[0] for run in made if run[3]] == [1e-7]
    assert at["points", 9].best == min(at["points", 9].seconds)
    # 9 tolerances, the reference and its check, 3 more levels of points, 4 of epsilon
    assert len(made) == 9 + 2 + 3 + 4


def test_a_process_that_is_killed_is_told_in_its_row(monkeypatch):
    broken = Future()
    broken.set_exception(BrokenProcessPool())
    monkeypatch.setattr(side_by_side, "WORTHWHILE", 0.0)
    monkeypatch.setattr(side_by_side, "usable_cores", lambda: 2)
    monkeypatch.setattr(side_by_side.Runs, "_start", lambda self: None)
    runs = side_by_side.Runs(None)
    for k in range(2):
        runs.ask("", load("open_rod", *FEW, f"time.tolerance=1e-{k + 3}"), 100.0)
    runs._pool, runs._futures = True, {id(run): broken for run in runs._asked.values()}
    assert "was killed" in runs.outcome(load("open_rod", *FEW, "time.tolerance=1e-3"))


@pytest.mark.parametrize(
    ("low", "high", "numbers"),
    [
        (0.13, 2.4, ["0.2", "0.5", "1", "2"]),
        (3e-7, 3e-5, ["5×10⁻⁷", "10⁻⁶", "2×10⁻⁶", "5×10⁻⁶", "10⁻⁵", "2×10⁻⁵"]),
        (3e-4, 2e5, ["0.001", "0.01", "0.1", "1", "10", "100", "1000", "10000", "10⁵"]),
    ],
)  # fmt: skip
def test_both_sides_of_the_picture_have_numbers_that_can_be_read(low, high, numbers):
    pytest.importorskip("matplotlib")
    from rodsim.plotting import style
    from rodsim.plotting.convergence import _readable

    axis = style.new_figure(5, 4).subplots()
    axis.loglog([low, high], [low, high])
    axis.set_xlim(low, high)
    _readable(axis.xaxis, low, high)
    ticks = zip(axis.get_xticks(), axis.xaxis.get_major_formatter().format_ticks(axis.get_xticks()),
                strict=True)  # fmt: skip
    assert [text for tick, text in ticks if low <= tick <= high] == numbers
