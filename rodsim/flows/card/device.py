"""Which card there is, and why there is none. Numba's CUDA is imported only when asked."""

from __future__ import annotations

import warnings
from functools import cache
from importlib.metadata import PackageNotFoundError, version

from rodsim.errors import UsageError

SIMULATOR = "simulator"  # Numba's, for tests: NUMBA_ENABLE_CUDASIM=1
NEEDS = "it takes an NVIDIA card with its driver, and pip install 'rodsim[gpu]'"


@cache
def card() -> dict[str, str]:
    """Return what the last bits of sums on the card depend on: its name, and what compiles for it.

    Raises UsageError where there is no card, no driver or no numba-cuda, or they do not agree.
    """
    from numba import config

    if config.ENABLE_CUDASIM:
        return {"device": SIMULATOR}
    try:
        found = {"numba_cuda": version("numba-cuda")}
    except PackageNotFoundError:
        raise UsageError(f"no GPU: numba-cuda is not installed; {NEEDS}") from None
    from numba import cuda

    try:
        name = cuda.get_current_device().name
        _try()
    except Exception as error:  # of the driver, of what loads it: of many kinds
        reason = " ".join(str(error).split()) or type(error).__name__
        raise UsageError(f"no GPU: {reason.rstrip(' .:')}; {NEEDS}") from error
    return {"device": name if isinstance(name, str) else name.decode(), **found}


def add_on_card(at_wall: bool, blob: str, angular: bool, *arguments) -> None:
    """Call a sum on the card from Python: with (targets, ..., out), see ``CardSum.add``.

    Raises UsageError where there is no card, or it fails.
    """
    card()
    from rodsim.flows.card import sums

    which = "spatial" if angular else "flow"
    name = f"{'wall_' if at_wall else ''}{which}_{blob.removeprefix('algebraic')}"
    getattr(sums, name).add(*arguments)
    sums.failed()


def _try():
    """Start the smaller kernel: what does not work is seen before anything depends on it."""
    import numpy as np

    from rodsim.flows.card.kernels import add_parts

    with warnings.catch_warnings():  # that so small a one is a waste
        warnings.simplefilter("ignore")
        add_parts[1, 1](np.ones((2, 1, 1)), 0.7, found := np.zeros((1, 1)))
    if found != 0.7 * 2.0:
        raise ArithmeticError(f"0.7 (1 + 1) is {found.item()} there")
