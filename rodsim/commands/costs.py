"""What ``rodsim info`` and ``run --dry-run`` say of the cost of a run, before it."""

from __future__ import annotations

from rodsim.integrators.ahead import evaluations_of
from rodsim.output.build import size

SPANS = (("days", 86400.0), ("hours", 3600.0), ("minutes", 60.0), ("s", 1.0), ("ms", 1e-3))


def describe_costs(machine, threads: int | None = None) -> list[str]:
    """Return lines on time, memory, disk, and what sets the fastest rate; makes the first steps."""
    from rodsim.run.forecast import forecast
    from rodsim.run.stiffest import stiffest

    scene, rate = machine.system.scene, machine.limits.rate
    cost = forecast(machine, threads)
    with machine.threads(threads):
        found = stiffest(scene, rate)
    if cost is None:
        return ["run: its first steps fail", *_stiffness(found, rate, "")]
    several = f"{cost.threads} thread{'s' * (cost.threads > 1)}"
    lines = [
        f"run: about {span(cost.seconds)} on {several}, mostly within a factor of 2; before that, "
        "a second or two to start",
        f"{rounded(cost.evaluations)} evaluations of {span(cost.each)}, {cost.frames} frames; "
        f"memory about {size(cost.memory)}, output {size(cost.disk)}",
    ]
    return [*lines, *_stiffness(found, rate, _saving(machine, cost, found.rate))]


def span(seconds: float) -> str:
    """Return a time as it is read, with two digits: 18 minutes, 0.34 ms."""
    name, unit = next((s for s in SPANS if seconds >= 1.5 * s[1]), SPANS[-1])
    return f"{float(f'{seconds / unit:.2g}'):g} {name}"


def rounded(count: float) -> str:
    """Return a number of evaluations with three digits."""
    return f"{count:.3g}" if count >= 1e6 else f"{float(f'{count:.3g}'):.0f}"


def _stiffness(found, rate, saving):
    """Return the line on the moduli that set the fastest rate."""
    if not found.names:
        return ["no modulus sets the fastest rate: softer rods would not run faster"]
    verb, them = ("set", "them") if len(found.names) > 1 else ("sets", "it")
    left = f"{' and '.join(found.names)} {verb} the fastest rate: a quarter of {them} would leave "
    return [f"{left}{found.rate / rate:.2g} of it{saving}"]


def _saving(machine, cost, rate):
    """Return what a lower fastest rate would save."""
    method, now = machine.integrator.method, machine.limits.rate
    if not method.adaptive:
        return f", and the longest stable step be {now / rate:.2g} times as long"
    steps = cost.made + cost.ahead
    share = evaluations_of(steps, method, rate) / evaluations_of(steps, method, now)
    return f", and {rounded(share * cost.evaluations)} evaluations"
