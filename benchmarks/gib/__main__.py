"""Run a case by the gIB method: python benchmarks/gib CASE.yaml -o OUT.h5 (Numba, scipy; FFTW)."""

import sys
from pathlib import Path

import click

sys.path[0] = str(Path(__file__).parent.parent)  # the folder of the package, not the package

from rodsim.compiled.settings import prepare  # noqa: E402


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("case_path", metavar="CASE.yaml", type=click.Path(path_type=Path))
@click.option("-o", "--output", default="gib.h5", show_default=True, help="Output file.")
@click.option("--set", "overrides", multiple=True, metavar="KEY=VALUE", help="Change the case.")
@click.option("--points", default=64, show_default=True, help="Grid points a side.")
@click.option("--box", type=float, help="Side of the box; default: so that h = 2 ds.")
@click.option("--step", default=1e-6, show_default=True, help="Time step.")
@click.option("--threads", default=1, show_default=True, help="Threads of transforms and loops.")
def main(case_path, output, overrides, points, box, step, threads):
    """Run a case of rodsim by the generalized immersed boundary method."""
    prepare()
    import numba

    from gib.march import Setup, simulate
    from rodsim import load_case
    from rodsim.progress import make_progress

    numba.set_num_threads(threads)
    setup = Setup(points, box, step, threads)
    with make_progress(f"gIB: {case_path.name}", quiet=False) as progress:
        simulate(load_case(case_path, overrides), output, setup, progress=progress)


if __name__ == "__main__":
    main()
