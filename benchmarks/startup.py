"""Wall time and peak memory of whole commands, warm and with nothing compiled."""

import itertools
import os
import tempfile
from pathlib import Path

import numpy as np
from child import ENVIRONMENT, FLOOR, run_python
from common import CONFIGS, benchmark, interleaved
from tables import Spread, Table

COMMANDS = {
    "python -c pass": ("-c", "pass"),
    'python -c "import numpy, numba, h5py"': FLOOR,
    "the same, and one function from Numba's cache": ("-c", f"{FLOOR[1]}; import cached"),
    "rodsim --help": ("-m", "rodsim", "--help"),
    "rodsim validate closed_ring.yaml": ("-m", "rodsim", "validate", CONFIGS / "closed_ring.yaml"),
    "rodsim run closed_ring.yaml": (
        *("-m", "rodsim", "run", CONFIGS / "closed_ring.yaml"),
        *("-o", "out.h5", "--overwrite", "-q"),
    ),
}
WARM, COLD = "rodsim run closed_ring.yaml", "rodsim run, with an empty cache"
ONE_FUNCTION = """from numba import njit
@njit("float64(float64)", cache=True)
def square(x):
    return x * x
"""
LARGE = """
from rodsim.compiled.settings import prepare
prepare()
from rodsim.case import load_case
from rodsim.run.machine import Machine
from rodsim.output.writer import TrajectoryWriter
from rodsim.run.recorder import Recorder, plan_output
from rodsim.scene.build import build_scene
from rodsim.run.snapshot import capture
changes = "rods.ring.shape.points=100000", "output.interval=0.1"
case = load_case({config!r}, changes)
scene = build_scene(case)
machine = Machine(case, scene, force=True)
snapshot = capture(machine, Recorder(machine, 0.0, 0.0), scene.initial)
with machine.threads(None), TrajectoryWriter.create("large.h5", plan_output(case, scene, snapshot)):
    system = machine.system
    system.velocities(0.0, scene.initial, system.zeros(), system.zeros())
"""
LARGE_NAME = "100 000 points: start, output file, one evaluation (one repeat)"
COLUMNS = {
    "command": "command",
    "seconds": "wall time, s",
    "above": "above the imports, s",
    "peak": "peak memory, kB",
    "peak_above": "above the imports, kB",
}


@benchmark(full=9, short=2)
def main(quick, repeats):
    """Measure whole commands, from starting the process to its end.

    The imports of numpy, numba and h5py are the floor of any run; Numba then starts its compiler
    for the first function, even one from its cache. The warm run finds its compiled
    code in a cache filled before; the cold one gets an empty cache every time. All run in a
    temporary folder. The last line, not with --quick, is a large scene: the sum over 10^10 pairs
    takes half a minute.
    """
    ENVIRONMENT.pop("NUMBA_CACHE_DIR", None)  # it would win over the caches given here
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        children = {name: _Command(arguments, work) for name, arguments in COMMANDS.items()}
        (work / "cached.py").write_text(ONE_FUNCTION)
        for child in children.values():  # fills the cache
            child()
        children[COLD] = _Command(COMMANDS[WARM], work, cold=True)
        results = interleaved(children, repeats, "commands")
        if not quick:
            code = LARGE.format(config=str(CONFIGS / "closed_ring.yaml"))
            results[LARGE_NAME] = [_Command(("-c", code), work)()]
    table = Table("Whole commands", COLUMNS, rows(results))
    return [table], lambda *axes: draw(table.rows, *axes)


class _Command:
    """Call it to run a command in a folder, with the cache in it or with a new one."""

    def __init__(self, arguments, folder, cold=False):
        self.arguments, self.folder, self.cold = arguments, folder, cold
        self.number = itertools.count()

    def __call__(self):
        name = f"cold{next(self.number)}" if self.cold else "warm"
        cache = os.fspath(self.folder / name)
        return run_python(self.arguments, self.folder, XDG_CACHE_HOME=cache)


def rows(results):
    """Return the rows of the table; differences from the floor are taken round by round."""
    floor = np.array([(child.seconds, child.peak_kb) for child in results[list(COMMANDS)[1]]])
    table = []
    for name, children in results.items():
        values = np.array([(child.seconds, child.peak_kb) for child in children])
        row = {
            "command": name,
            "seconds": Spread.of(values[:, 0]),
            "peak": Spread.of(values[:, 1]),
        }
        if name.startswith(("the same", "rodsim run", "100 000")):
            above = values - floor
            row |= {"above": Spread.of(above[:, 0]), "peak_above": Spread.of(above[:, 1])}
        table.append(row)
    return table


def draw(rows, left, right):
    """Left: wall times; right: peak memory."""
    names = [row["command"] for row in rows]
    for axes, key, scale in ((left, "seconds", 1.0), (right, "peak", 1e-3)):
        errors = scale * np.array([row[key].error for row in rows]).T
        axes.barh(names, [scale * row[key].median for row in rows], xerr=errors, capsize=3)
        axes.invert_yaxis()
    left.set(xlabel="wall time, s")
    right.set(xlabel="peak memory, MB")
    right.set_yticklabels([])


if __name__ == "__main__":
    main()
