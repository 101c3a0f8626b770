"""The device on which the sums of a scene are computed: chosen by who runs it, not by its file."""

from __future__ import annotations

from rodsim.compiled.constants import CPU, DEVICES, GPU
from rodsim.errors import CaseError, UsageError


def on_device(case, device: str | None):
    """Return a case whose sums are computed on a device, ``cpu`` or ``gpu``; None leaves it.

    Raises UsageError for a device that is not there, CaseError for fast sums on a card.
    """
    if device is None:
        return case
    if device not in DEVICES:
        raise UsageError(f"device must be one of {', '.join(DEVICES)}, not {device!r}")
    if device == CPU:
        return case.on(CPU)
    if case.fluid.sums is not None:
        reason = (
            "fast sums are for the CPU, and on a GPU sums are exact: run without --device gpu, or "
            "leave sums out"
        )
        raise CaseError([case.source.problem(("fluid", "sums"), reason)])
    from rodsim.flows.card.device import card

    card()
    return case.on(GPU)


def machine_of(case) -> dict[str, str]:
    """Return what an output records of the device; nothing of the CPU, which it knows already."""
    if case.device == CPU:
        return {}
    from rodsim.flows.card.device import card

    return card()
