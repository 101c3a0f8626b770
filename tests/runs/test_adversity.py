"""What goes wrong around a run: full disks, files that vanish, hostile cases, many runs."""

import os
import subprocess
import sys

import numpy as np
import pytest
from calls import call
from contents import differences
from interrupted import DRIVEN, PLANAR, after, make

from rodsim import open_trajectory, resume, simulate
from rodsim.errors import StoppedError

HOOK = """
import errno, os, resource, signal, sys
from rodsim.compiled.settings import prepare
prepare()
from rodsim.output.rows import Rows
from rodsim.run.watch import Watch
from rodsim.__main__ import main
check, put = Watch.check, Rows.put
def at_step(self, step):
    if step.number == 20: {action}
    return check(self, step)
def full(self, *a): raise OSError(errno.ENOSPC, "No space left on device")
Watch.check = at_step
{before}
main()
"""
LIMIT = (
    "signal.signal(signal.SIGXFSZ, signal.SIG_IGN);"
    " resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, 50_000))"
)


def run_with(folder, action="pass", before=""):
    code = HOOK.format(action=action, before=before)
    return subprocess.run(
        [sys.executable, "-c", code, "run", "case.yaml"],
        cwd=folder, capture_output=True, text=True, check=False,
    )  # fmt: skip


def test_a_write_that_fails_in_the_middle_ends_with_4_and_resume_goes_on(tmp_path):
    simulate(make(tmp_path, DRIVEN), tmp_path / "whole.h5")
    done = run_with(tmp_path, action="Rows.put = full")
    assert (done.returncode, done.stdout) == (4, "")
    assert "out.h5: writing failed: [Errno 28] No space left on device; its first" in done.stderr
    assert "Traceback" not in done.stderr
    with open_trajectory(tmp_path / "out.h5") as run:
        assert run.frames >= 1
        assert np.isfinite(run.position).all()
    resume(tmp_path / "out.h5")
    assert differences(tmp_path / "out.h5", tmp_path / "whole.h5") == []


def test_a_limit_of_the_file_size_shows_before_the_run(tmp_path):
    make(tmp_path, DRIVEN)
    (tmp_path / "out.h5").write_text("precious")
    done = run_with(tmp_path, before=LIMIT)
    assert (done.returncode, done.stdout) == (4, "")
    assert done.stderr.splitlines()[-1] == "out.h5: cannot be written: File too large"
    assert (tmp_path / "out.h5").read_text() == "precious"


@pytest.mark.parametrize(
    ("action", "words"),
    [
        ("os.unlink('out.h5')", "out.h5: was removed or replaced while the run was writing it"),
        (
            "os.replace('case.yaml', 'out.h5')",
            "out.h5: was removed or replaced while the run was writing it",
        ),
        ("os.truncate('out.h5', 5000)", "out.h5: was cut short while the run was writing it"),
    ],
)
def test_a_file_that_vanishes_stops_the_run(tmp_path, action, words):
    make(tmp_path, DRIVEN)
    done = run_with(tmp_path, action=action)
    assert (done.returncode, done.stdout) == (4, "")
    assert words in done.stderr
    assert "Traceback" not in done.stderr


def test_info_tells_finished_stopped_killed_and_running(tmp_path):
    make(tmp_path, PLANAR)
    path = tmp_path / "out.h5"
    killed = run_with(tmp_path, action="os.kill(os.getpid(), signal.SIGKILL)")
    assert killed.returncode == -9
    told = call("info", path).stdout.splitlines()
    assert told[0] == f"{path}: killed; go on with: rodsim resume {path}"
    with pytest.raises(StoppedError):
        resume(path, stop=after(3))
    assert call("info", path).stdout.startswith(f"{path}: stopped; go on with: rodsim resume")

    def running():
        assert call("info", path).stdout.startswith(f"{path}: running, process {os.getpid()} on ")
        return ""

    resume(path, stop=after(2, running))
    assert call("info", path).stdout.startswith(f"{path}: finished\n17 of 17 frames")
    assert "17 frames are whole" in call("info", path, "--check").stdout


def test_check_finds_a_frame_that_is_not_right(tmp_path):
    import h5py

    path = tmp_path / "out.h5"
    simulate(make(tmp_path, DRIVEN, ["time.end=2e-3"]), path)
    with h5py.File(path, "r+") as file:
        file["particles/trajectory/director/value"][3, 5, 0, 1] += 0.1
        file["particles/trajectory/velocity/value"][2, 7, 1] = np.nan
    checked = call("info", path, "--check")
    assert checked.exit_code == 4
    assert checked.stderr.splitlines() == [
        f"{path}: damaged: director in frame 3 is damaged",
        f"{path}: damaged: velocity in frame 2 is damaged",
    ]


GOOD = """
fluid: {viscosity: 1.3e-6, epsilon: 0.3}
rods:
  tail:
    shape: {kind: straight, points: 12, spacing: 0.11}
    moduli: {bending: 3.5e-3, twisting: 2.5e-3, shear: 0.7, stretch: 0.9}
    strain_twist: [0, 0, 0]
time: {end: 0.1}
output: {interval: 1.0e-3}
"""
HOSTILE = {
    "points": ("points: 12", "points: 1000000000000", "would need about 8e+05 GB"),
    "many markers": ("time:", "tracers: {m: {kind: tube, rod: tail, radius: 1, around: 9000000,"
                     " along: 9000000}}\ntime:", "would need about"),
    "interval": ("interval: 1.0e-3", "interval: 1.0e-300", "must be between 1e-200"),
    "small interval": ("interval: 1.0e-3", "interval: 1.0e-190", "would write 1e+189 frames"),
    "end": ("end: 0.1", "end: 1.0e30", "would write 1e+33 frames"),
    "overflow": ("[0, 0, 0]", '["exp(1e9*s)", 0, 0]', "is not finite at s ="),
    "nan": ("viscosity: 1.3e-6", "viscosity: .nan", "must be finite"),
    "inf": ("epsilon: 0.3", "epsilon: .inf", "must be finite"),
    "rod name": ("  tail:", "  ../x:", "a name is made of letters, digits and _"),
    "control characters": ("  tail:", '  "ta\\u001b[31mil":', "a name is made of letters"),
    "aliases": ("time:", "a: &a [x, x]\nb: &b [*a, *a]\nc: [*b, *b, *b]\ntime:", "aliases"),
    "nesting": ("[0, 0, 0]", "[" * 50_000, "nested deeper than 30"),
    "100 MB": ("time:", "#" * 100_000_000 + "\ntime:", "larger than 1000000 bytes"),
}  # fmt: skip
MEASURED = """
import sys
from rodsim.__main__ import main
try:
    main()
finally:
    status = open("/proc/self/status").read() if sys.platform == "linux" else "VmHWM: 0"
    print(status.partition("VmHWM:")[2].split()[0])
"""


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_cases_are_refused_in_little_memory(tmp_path, name):
    old, new, words = HOSTILE[name]
    assert GOOD.count(old) == 1
    (tmp_path / "case.yaml").write_text(GOOD.replace(old, new))
    done = subprocess.run(
        [sys.executable, "-c", MEASURED, "run", "case.yaml"],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 2, done.stderr
    assert words in done.stderr
    assert done.stderr.replace("\n", "").isprintable()
    assert "Traceback" not in done.stderr
    assert os.listdir(tmp_path) == ["case.yaml"]
    if sys.platform == "linux":
        assert int(done.stdout) < 200_000  # kB


def soak(folder, count):
    """Run, stop and resume so often; return memory (kB) and open files after each round."""
    case, path, rounds = make(folder, PLANAR, ["time.end=2e-3"]), folder / "out.h5", []
    for _ in range(count):
        try:
            simulate(case, path, overwrite=True, stop=after(6))
        except StoppedError:
            resume(path)
        with open_trajectory(path) as run:
            assert run.status == "finished"
        with open("/proc/self/statm") as statm:
            memory = int(statm.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") // 1000
        rounds.append((memory, len(os.listdir("/proc/self/fd"))))
    return np.array(rounds)


def assert_flat(rounds):
    """No file stays open; after a warm-up the last quarter needs no more memory than the second."""
    assert rounds[-1, 1] == rounds[3, 1]
    quarter = len(rounds) // 4
    before, after_all = rounds[quarter : 2 * quarter, 0], rounds[-quarter:, 0]
    # allocators keep some pages: 3 MB, over thousands of rounds, is no leak of anything of a run
    assert np.median(after_all) < np.median(before) + 3000


needs_proc = pytest.mark.skipif(not os.path.exists("/proc/self/fd"), reason="needs /proc")


@pytest.mark.long
@needs_proc
def test_many_runs_in_one_process_leave_nothing_behind(tmp_path):
    assert_flat(soak(tmp_path, 20))


@needs_proc
@pytest.mark.long
def test_thousands_of_runs_in_one_process(tmp_path):
    rounds = soak(tmp_path, int(os.environ.get("RODSIM_SOAK", "5000")))
    print(f"{len(rounds)} rounds; memory {rounds[len(rounds) // 4, 0]} -> {rounds[-1, 0]} kB, "
          f"open files {rounds[3, 1]} -> {rounds[-1, 1]}")  # fmt: skip
    assert_flat(rounds)
