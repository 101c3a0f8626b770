"""The exact sums on a GPU: kernels, copies, errors, and a run of 10 000 points against the CPU's.

For a machine with a card; some 3 minutes, most of them compiling. From the repository's root:

    python3 benchmarks/gpu.py            # all
    python3 benchmarks/gpu.py --check    # errors and bits alone
    python3 benchmarks/gpu.py --tune     # also: other shares of the sources
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

import click
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))
EPSILON, VISCOSITY, WALL = 0.3, 0.7, -1.0
SIZES, CHECKED = (200, 1000, 3000, 10_000, 30_000, 100_000, 300_000), (37, 200, 1000, 10_000)
KINDS = ("spatial", "planar", "flow", "wall_spatial", "wall_planar", "wall_flow")
SAMPLES = 100  # targets at which the CPU's sum is computed
SECONDS = 0.5  # of one measurement, at least
LIMIT = 1e-12
RUN = """
fluid: {viscosity: 1.3e-6, epsilon: 0.35}
parameters: {n: 1000}
rods:
  fibre:
    repeat: 10
    shape: {kind: helix, radius: 0.8, pitch: 3.0, points: n, length: 0.07*n, origin: [0, 2.9*i, 0]}
    moduli: {bending: 3.5e-3, twisting: 2.5e-3, shear: 0.7, stretch: 0.9}
    strain_twist: ["0.6 + 0.2*sin(0.3*s)", 0, 0.3]
time: {end: 1.5e-3}
output: {interval: 5.0e-4}
"""


@click.command()
@click.option("--check", is_flag=True, help="Errors and bits alone.")
@click.option("--tune", is_flag=True, help="Also the kernels with other shares of the sources.")
@click.option("--points", default=1000, show_default=True, help="Of each of the run's ten rods.")
def main(check, tune, points):
    """Measure the sums on the card that is here."""
    from rodsim.compiled.settings import prepare

    prepare()
    begin = perf_counter()
    from rodsim.flows.card.device import card

    print(", ".join(f"{key} {value}" for key, value in {**card(), **versions()}.items()))
    from rodsim.flows.card import sums

    add(sums.spatial_7, *scene(200, "spatial"))
    print(f"import, context and first kernel: {perf_counter() - begin:.1f} s")
    worst = max(print_error(kind, blob, m) for m in CHECKED for kind in KINDS for blob in (7, 9))
    print(f"largest error {worst:.2g}, limit {LIMIT:g}: {'good' if worst < LIMIT else 'WRONG'}")
    if not check:
        print_table([("spatial", m) for m in SIZES])
        print_table([(kind, 10_000) for kind in KINDS])
        if tune:
            print_shares()
        print_run(points)
    print(f"{perf_counter() - begin:.0f} s in all")
    sys.exit(not worst < LIMIT)


def versions():
    """Return what compiles, and the cores of the CPU."""
    import numba
    from numba import cuda

    found = {"numba": numba.__version__, "cores": len(os.sched_getaffinity(0))}
    try:
        return {"CUDA": ".".join(map(str, cuda.runtime.get_version())), **found}
    except Exception as error:  # not of all versions
        return {"CUDA": f"unknown ({type(error).__name__})", **found}


def scene(m, kind):
    """Return targets, sources, loads: random loads along a helix; u alone at points beside it."""
    s = 0.07 * np.arange(m)
    x = np.ascontiguousarray([np.cos(s), np.sin(s), 0.2 * s])
    loads = np.random.default_rng(m).normal(size=(6, m))
    if "planar" in kind:
        x[0], loads[[0, 4, 5]] = 0.4, 0.0
    return (x + 0.1 if "flow" in kind else x), x, loads


def add(one, targets, sources, loads, rows=6):
    """Return a sum by what adds it: on the card, or by address."""
    out = np.zeros((rows, targets.shape[1]))
    one(targets, sources, loads, EPSILON, VISCOSITY, WALL, out)
    return out


def print_error(kind, blob, m):
    """Print and return the largest error of a sum over its largest value; bits must not vary."""
    from rodsim.flows.by_threads import velocity_kernel
    from rodsim.flows.card import sums

    targets, sources, loads = scene(m, kind)
    rows = 3 if "flow" in kind else 6
    one = getattr(sums, f"{kind}_{blob}").add
    found = add(one, targets, sources, loads, rows)
    same = all(np.array_equal(found, add(one, targets, sources, loads, rows)) for _ in range(3))
    some = np.linspace(0, m - 1, min(m, SAMPLES)).astype(int)
    kernel = velocity_kernel(blob, "planar" in kind, rows == 6, "wall" in kind)
    exact, sample = np.zeros((rows, some.size)), np.ascontiguousarray(targets[:, some])
    kernel(sample, sources, loads, EPSILON, VISCOSITY, WALL, exact)
    parts = [slice(0, 3), slice(3, 6)][: rows // 3]
    errors = [abs(found[p][:, some] - exact[p]).max() / abs(exact[p]).max() for p in parts]
    print(
        f"{kind}_{blob} {m}: {' '.join(f'{e:.1e}' for e in errors)}{'' if same else ' BITS VARY'}"
    )
    return max(errors) if same else np.inf


def print_table(rows):
    """Print what kernels and whole sums take."""
    columns = "sum", "M", "shares", "kernels, ms", "ns/pair", "with copies, ms", "by address, ms"
    print(f"| {' | '.join(columns)} | copies and calls |")
    print("|---|---|---|---|---|---|---|---|")
    for kind, m in rows:
        kernels, whole, called, shares = seconds_of(kind, m)
        print(
            f"| {kind} | {m} | {shares} | {1e3 * kernels:.4g} | {1e9 * kernels / m**2:.3g} "
            f"| {1e3 * whole:.4g} | {1e3 * called:.4g} | {1 - kernels / called:.0%} |",
            flush=True,
        )


def seconds_of(kind, m):
    """Return the seconds of the kernels, of the sum from Python, by address; and the shares."""
    from numba import cuda

    from rodsim.compiled.flags import call_sum, kernel
    from rodsim.flows.card import sums

    @kernel
    def by_address(address, targets, sources, loads, out):
        call_sum(address, 0, targets, sources, loads, EPSILON, VISCOSITY, WALL, out)

    one, arrays = getattr(sums, f"{kind}_7"), scene(m, kind)
    out = np.zeros((3 if "flow" in kind else 6, m))
    one.add(*arrays, EPSILON, VISCOSITY, WALL, out)
    room = sums.room_of(one.choice, m, m)
    there = room.bring(*arrays)

    def launch():
        room.start(there, EPSILON, VISCOSITY, WALL)
        cuda.synchronize()

    address = one.address
    whole = fastest(lambda: one.add(*arrays, EPSILON, VISCOSITY, WALL, out))
    called = fastest(lambda: by_address(address, *arrays, out))
    return fastest(launch), whole, called, room.grid[1]


def fastest(function):
    """Return the least seconds that a call takes."""
    function()
    samples, begin = [], perf_counter()
    while len(samples) < 3 or perf_counter() - begin < SECONDS:
        start = perf_counter()
        function()
        samples.append(perf_counter() - start)
    return min(samples)


def print_shares():
    """Print the kernels with other least shares of sources, and other numbers of blocks."""
    from rodsim.flows.card import kernels, sums

    before = kernels.BLOCKS, kernels.LEAST
    for blocks in (512, 1024, 2048, 4096):
        for least in (16, 32, 64, 128):
            kernels.BLOCKS, kernels.LEAST = blocks, least
            sums.room_of.cache_clear()
            found = [(m, *seconds_of("spatial", m)) for m in (200, 1000, 3000, 10_000)]
            text = ", ".join(f"{m}: {1e3 * each[0]:.4f} ms ({each[3]})" for m, *each in found)
            print(f"blocks {blocks}, least {least}: {text}", flush=True)
    kernels.BLOCKS, kernels.LEAST = before
    sums.room_of.cache_clear()


def print_run(points):
    """Print what a run takes by ``rodsim run`` on the card and on the CPU, and how they differ."""
    import rodsim

    with tempfile.TemporaryDirectory() as folder:
        case, made = Path(folder) / "case.yaml", {}
        case.write_text(RUN)
        for device in ("gpu", "cpu", "gpu"):  # the first one compiles
            path = Path(folder) / f"{device}.h5"
            words = [
                case,
                "-o",
                path,
                "--overwrite",
                "--device",
                device,
                "--set",
                f"parameters.n={points}",
            ]
            begin = perf_counter()
            command = [sys.executable, "-m", "rodsim", "run", *map(str, words), "-q"]
            done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
            if done.returncode:
                print(f"rodsim run --device {device} failed: {done.stderr[-2000:]}")
                return
            made[device] = path, perf_counter() - begin
        gpu, cpu = (rodsim.open_trajectory(made[device][0]) for device in ("gpu", "cpu"))
        for name, run in (("gpu", gpu), ("cpu", cpu)):
            print_cost(name, run, made[name][1])
        size = np.ptp(cpu.position[0], axis=0).max()
        moved = abs(cpu.position[-1] - cpu.position[0]).max()
        apart = abs(gpu.position - cpu.position).max()
        print(
            f"trajectories: {apart:.2g} apart, {apart / size:.2g} of {size:.3g}; moved {moved:.3g}"
        )
        print_resume(case, points, Path(folder), gpu)


def print_cost(name, run, wall):
    """Print the parts of a run's time."""
    cost = run.runtime
    each = 1e3 * (cost["sum_seconds"] + cost["elasticity_seconds"]) / cost["evaluations"]
    rest = cost["solve_seconds"] - cost["sum_seconds"] - cost["elasticity_seconds"]
    print(
        f"{name}: {wall:.1f} s in all, {cost['solve_seconds']:.2f} s of steps: sums "
        f"{cost['sum_seconds']:.2f}, elasticity {cost['elasticity_seconds']:.2f}, rest {rest:.2f}; "
        f"output {cost['output_seconds']:.2f}; {cost['evaluations']} evaluations of {each:.3g} ms, "
        f"{cost['steps_accepted']} steps, {cost['threads']} threads; on {cost.get('device', 'cpu')}"
    )


def print_resume(case, points, folder, whole):
    """Print whether a run that is stopped and resumed on the card has the bits of the whole one."""
    import rodsim
    from rodsim.errors import StoppedError

    path, steps = folder / "stopped.h5", []

    def stop():
        steps.append(1)
        return "the benchmark" if len(steps) == whole.runtime["steps_accepted"] // 2 else ""

    loaded = rodsim.load_case(case, [f"parameters.n={points}"])
    try:
        rodsim.simulate(loaded, path, device="gpu", stop=stop)
        print("resume: not stopped")
        return
    except StoppedError as error:
        print(error)
    rodsim.resume(path)
    with rodsim.open_trajectory(path) as run:
        same = np.array_equal(run.position, whole.position)
        print(
            f"resumed on {run.runtime.get('device')}: {'the same bits' if same else 'OTHER BITS'}"
        )


if __name__ == "__main__":
    main()
