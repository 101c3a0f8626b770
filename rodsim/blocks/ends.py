"""Ends of rods that are held: which, where, how."""

ENDS = ("start", "end")


def held_ends(case):
    """Yield (rod, "start" or "end", End) of all held ends of a case, in order."""
    for name, rod in case.rods.items():
        for which in ENDS:
            end = getattr(rod, which)
            if end is not None and end.hold != "free":
                yield name, which, end


def winds_up(end) -> bool:
    """Tell whether a rotor turns between the holder and the hook of an end."""
    hook, motor = end.hook, end.motor
    return bool(hook and motor and motor.rate is not None and hook.twisting != "stiff")


def end_node(rod, which: str) -> int:
    """Return the node of a rod's first or last point."""
    return rod.first if which == "start" else rod.first + rod.count - 1
