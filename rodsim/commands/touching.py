"""What `info` says of contact: how thick rods are, whether they have passed through themselves."""

from __future__ import annotations

MOST_POINTS = 600  # of a rod whose linking number is told: it takes all pairs


def describe_contact(scene, contact, length_unit: str) -> str:
    """Return the line on contact: how thick rods are to each other, and how well that is resolved.

    Points in a diameter, of the coarsest rod, tell how much strands feel each other's points.
    """
    apart, spacing = scene.parts.apart, scene.rods.spacing.max()
    reach = ", ".join(map(str, sorted(set(apart.excluded.tolist()))))
    who = "all rods and themselves" if apart.itself else "different rods"
    who += " and bodies" if scene.bodies else ""
    epsilons, spacings = apart.diameter / scene.epsilon, apart.diameter / spacing
    return (
        f"contact: {who}, diameter {apart.diameter:.6g} {length_unit} "
        f"= {epsilons:.4g} epsilon = {spacings:.3g} spacings, "
        f"strength {contact.strength:g}; points within {reach} segments of a rod ignore each other"
    )


def describe_links(run) -> list[str]:
    """Return how often each closed rod winds around itself, first and last: it can never change.

    Where it has, the rod has passed through itself.
    """
    if run.frames == 0 or "director" not in run.fields:
        return []
    from rodsim.analysis.topology import link

    lines = []
    for rod in run.rods:
        if not rod.closed or rod.count > MOST_POINTS:
            continue
        shapes = (
            (run.read("position", k)[rod.nodes], run.read("director", k)[rod.nodes])
            for k in (0, -1)
        )
        first, last = (round(link(X, D)) for X, D in shapes)
        passed = "" if first == last else ": it has passed through itself"
        lines.append(f"rod {rod.name}: linking number {first} at first, {last} at last{passed}")
    return lines
