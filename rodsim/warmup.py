"""Compiles the kernels of a scene ahead of its run, in a process of its own.

Code that Numba has just compiled and the same code read from its cache can differ in the last bit
of a sum (the parallel part is optimised once more when it is linked). A run must not depend on
whether it was the first, so the command never runs what it compiles: it reads it from the cache.
"""

import os
import subprocess
import sys
from pathlib import Path
from time import perf_counter


def ensure_compiled(case, say) -> float:
    """Compile what ``case`` needs if this installation has not yet; return the seconds it took.

    Call after ``settings.prepare``. ``say`` is called with a line for the user before the wait.
    """
    if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
        return 0.0
    variant = (case.fluid.blob, str(int(case.plane is not None)), str(int(bool(case.tracers))))
    from rodsim.settings import fingerprint

    # A folder that the user has set can be shared by several versions and installations.
    name = "-".join(("compiled", fingerprint(), *variant))
    marker = Path(os.environ["NUMBA_CACHE_DIR"]) / name
    if marker.exists():
        return 0.0
    say("compiling for this kind of scene, once; some seconds")
    start = perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "rodsim.warmup", *variant], capture_output=True, check=False
    )
    if done.returncode == 0:
        marker.parent.mkdir(parents=True, exist_ok=True)
        marker.touch()
    return perf_counter() - start


def main(blob: str, planar: str, tracers: str) -> None:
    """Fill the cache with the kernels of one kind of scene."""
    from rodsim.settings import prepare

    prepare()
    import numpy as np

    import rodsim.machine  # noqa: F401  (importing it compiles everything but the sums)
    from rodsim.fluid import BLOBS, velocity_kernel
    from rodsim.stages import stage_loop

    stage_loop(BLOBS[blob], planar == "1", tracers == "1")
    points, loads, out = np.zeros((3, 2)), np.zeros((6, 2)), np.zeros((6, 2))
    velocity_kernel(BLOBS[blob], planar == "1")(points, points, loads, 1.0, 1.0, out)


if __name__ == "__main__":
    main(*sys.argv[1:])
