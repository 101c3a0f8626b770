"""Which observables a scene has beyond those of every scene."""

from rodsim.compiled.parts import FORCE
from rodsim.output import layout
from rodsim.scene.bodies import nodes_series
from rodsim.scene.neighbours import any_pair_counts
from rodsim.scene.state import Scene


def row_labels(scene: Scene) -> dict[str, tuple[str, ...]]:
    """Return whose the rows of observables and of bodies' series are, by name of the series."""
    found = {name: labels for part in scene.parts for name, labels in part.labels.items()}
    names = tuple(body.name for body in scene.bodies)
    return found | {f"body_{name}": names for name in layout.OF_BODIES if names}


def extra_series(scene: Scene) -> tuple:
    """Return the observables that not every scene has: (name, shape, dimension) of each."""
    series = [entry for part in scene.parts for entry in part.series]
    series += nodes_series(scene)
    if any_pair_counts(scene):
        series.append(("gap", (), layout.LENGTH))
    if any(part.external for part in scene.parts.of(FORCE)):
        series += [("external_force", (3,), layout.FORCE), ("external_torque", (3,), layout.ENERGY)]
    if scene.parts.external:
        names = [*(f"{name}_work" for name in scene.parts.working), "external_work", "dissipated"]
        series += [(name, (), layout.ENERGY) for name in names]
        series += [(g.name, g.shape, g.dimension) for g in scene.parts.gauges if g.shown]
    return tuple(series)
