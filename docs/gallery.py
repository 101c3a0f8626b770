"""Runs every shipped config and writes docs/gallery.md: ``python docs/gallery.py [NAME...]``.

A sentence from the config's header, a number measured in the run, CPU time, a picture. With names:
only those, the others stay as they are. Needs rodsim[plot,rest].
"""

from __future__ import annotations

import re
import sys
import tempfile
import time
from pathlib import Path

from rodsim.compiled.settings import prepare

prepare()  # threads and cache as the command has them; before Numba is imported

import numpy as np  # noqa: E402

import rodsim  # noqa: E402
from rodsim.analysis.swimming import swimming_velocity  # noqa: E402
from rodsim.analysis.topology import writhe  # noqa: E402
from rodsim.cli import main  # noqa: E402
from rodsim.plotting.style import pretty_unit  # noqa: E402

DOCS = Path(__file__).parent
CONFIGS, PAGE, PICTURES = DOCS.parent / "configs", DOCS / "gallery.md", DOCS / "images/gallery"
SIZE, COLOURS = (760, 620), 96  # of a picture at most, pixels and palette
HEAD = """# Gallery

<!-- Made by docs/gallery.py, which runs all configs, each to its end. Do not edit. -->

The scenes that come with rodsim. Numbers were measured in the runs that the pictures show; none
of them was shortened. CPU seconds are those of the command, all threads together, without compiling
and without the start of Python. They were measured on two cores that had much other work, which
makes them larger than they are alone; the headers of the configs have times on two quiet cores.
Energies are elastic.
"""


def energy(run):
    """Elastic energy at first and at last."""
    parts = ("bending", "twisting", "shear", "stretch")
    total = sum(run.observable(f"{part}_energy") for part in parts).sum(axis=1)
    unit = pretty_unit(run.unit("bending_energy"))
    return f"energy {total[0]:.3g} → {total[-1]:.3g} {unit}"


def swims(axis, frequency):
    """Swimming velocity along an axis, after the first period of a wave."""

    def number(run):
        period = 2.0 * np.pi / frequency
        speed = swimming_velocity(run.time, run.position, period)["xyz".index(axis)]
        return f"moves along {axis} at {speed:.3g} µm/s"

    return number


def mean_rate(run, name, begin, end):
    """Mean over a time of what an observable is the integral of."""
    first, last = (abs(run.time - time).argmin() for time in (begin, end))
    values = run.observable(name)
    return (values[last] - values[first]) / (run.time[last] - run.time[first])


def winds(run):
    """Writhe of the first rod at last, and the energies."""
    return f"writhe {writhe(run[run.rods[0].name].position[-1]):.3g}, {energy(run)}"


def sinks(run):
    """Height of the ends over the middle, and the speed at last."""
    height = run.position[..., 2]
    speed = (height[-2] - height[-1]).mean() / (run.time[-1] - run.time[-2])
    bow = height[-1, [0, -1]].mean() - height[-1, height.shape[1] // 2]
    return f"its ends come to lie {bow:.3g} µm above its middle; it sinks at {speed:.3g} µm/s"


def settles(run):
    """Height of the middle over the wall, and the tilt, at last."""
    x, _, z = run.position[-1].T
    tilt = np.degrees(np.arctan2(z[-1] - z[0], x[-1] - x[0]))
    return f"at last {z.mean():.3g} µm above the wall, tilted by {tilt:.2g}°"


def tumbles(run):
    """Smallest distance of the ends of a rod."""
    apart = np.linalg.norm(run.position[:, -1] - run.position[:, 0], axis=1)
    return f"its ends come within {apart.min():.3g} µm at {1e3 * run.time[apart.argmin()]:.2g} ms"


def pulls_ends(run):
    """Length of the rope between two rods, at first and at last."""
    rope = np.linalg.norm(run["left"].position[:, -1] - run["right"].position[:, -1], axis=1)
    return f"the ropes shorten from {rope[0]:.3g} to {rope[-1]:.4g} µm"


def touches(run):
    """Smallest distance of the rods at last."""
    return f"{run.observable('gap')[-1]:.4g} µm apart at last"


def bodies_swim(run):
    """Speed of bodies along z over the second and third of three periods."""
    place, third = run.of_bodies("position"), (run.frames - 1) // 3
    speed = (place[-1] - place[third]) / (run.time[-1] - run.time[third])
    return f"both along +z at {speed[:, 2].mean():.3g} µm/s"


def bacterium(run):
    """Speed along the axis of the cell, and the torque of the motor."""
    frames = slice(abs(run.time - 0.02).argmin(), None)
    w, x, y, z = run.of_bodies("orientation", frames)[:, 0].T
    axis = np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]).T
    steps = np.diff(run.of_bodies("position", frames)[:, 0], axis=0)
    speed = (steps * axis[:-1]).sum() / (run.time[-1] - run.time[frames][0])
    return f"swims at {speed:.3g} µm/s along its axis"


def helix_pulls(run):
    """Thrust of a turned helix, over mu omega R^2."""
    thrust = -mean_rate(run, "anchor_impulse", 0.2, 0.3)[0, 2] / (97 * 0.5 * 6.3**2)
    return f"thrust {thrust:.3g} µωR² (measured in the experiment: 9.57)"


def cilium(run):
    """Mean force of what holds the cilium, over a beat."""
    force = 1e3 * mean_rate(run, "anchor_impulse", 0.1, 0.15)[0]
    return f"pushes the fluid with {force[1]:.3g} pN along the wall"


def aligns(run):
    """Mean of t_x t_z of the chords, at first and at last."""
    ends = run.position.reshape(run.frames, len(run.rods), -1, 3)[[0, -1]][:, :, [0, -1]]
    along = ends[:, :, 1] - ends[:, :, 0]
    along /= np.linalg.norm(along, axis=2, keepdims=True)
    first, last = (along[..., 0] * along[..., 2]).mean(axis=1)
    return f"mean t_x t_z of the chords {first:.3f} → {last:.3f}"


def grows(run):
    """Number of growing modes of what is at rest."""
    return f"at rest as a circle, of which {run.observable('growing_modes')[-1]:.0f} modes grow"


# By config: its number, and options of rodsim plot
SHOWN = {
    "open_rod": (energy, "-n 4"),
    "open_rod_half_twist": (energy, "-n 4"),
    "closed_ring": (energy, "-n 4"),
    "closed_ring_low_twist": (energy, "-n 4"),
    "michell_ring": (grows, "-n 1 --view 3d"),
    "plasmid": (winds, "-n 4"),
    "plectoneme": (winds, "-n 4"),
    "trefoil": (winds, "-n 2 --view 3d"),
    "two_rods_crossing": (touches, "-n 3 --view 3d"),
    "traced_filament": (energy, "-n 4"),
    "tethered_pair": (pulls_ends, "-n 4"),
    "sedimenting_fibre": (sinks, "-n 4"),
    "fibre_in_shear": (tumbles, "-n 6"),
    "fibre_settling_on_wall": (settles, "-n 4"),
    "flagellum": (swims("z", 400.0), "-n 4"),
    "tapered_flagellum": (swims("z", 300.0), "-n 4"),
    "two_flagella": (swims("z", 400.0), "-n 4"),
    "carpet": (swims("x", 400.0), "-n 2 --view 3d"),
    "swimmer_at_wall": (swims("y", 400.0), "-n 4"),
    "cilium": (cilium, "-n 6"),
    "bacterium": (bacterium, "-n 3 --view 3d"),
    "two_swimmers": (bodies_swim, "-n 3 --view 3d"),
    "rotating_helix": (helix_pulls, "-n 2 --view 3d"),
    "suspension": (aligns, "-n 2 --view 3d"),
    "long_coil": (energy, "-n 2 --view 3d --style line"),
}
COMMAND = {"michell_ring": "rest --saddle", "trefoil": "rest"}  # instead of run


def sentence(name: str) -> str:
    """Return the first sentence of a config's header."""
    lines = (CONFIGS / f"{name}.yaml").read_text(encoding="utf-8").splitlines()
    text = " ".join(line.lstrip("# ") for line in lines[1:] if line.startswith("#"))
    return re.match(r".*?\.(?= |$)", text)[0]


def execute(*arguments) -> float:
    """Run a command of rodsim; return the CPU seconds it took: what it compiles is apart."""
    begin = time.process_time()
    if main.main([str(argument) for argument in arguments], standalone_mode=False):
        raise SystemExit(f"rodsim {' '.join(map(str, arguments))} failed")
    return time.process_time() - begin


def show(name: str, folder: Path) -> str:
    """Run a config, twice where it had to compile; write its picture, return its section."""
    from PIL import Image

    output, picture = folder / f"{name}.h5", folder / f"{name}.png"
    command = COMMAND.get(name, "run")
    run = *command.split(), CONFIGS / f"{name}.yaml", "--overwrite", "-o", output
    seconds = execute(*run)
    number, options = SHOWN[name]
    execute("plot", output, "-q", "-o", picture, *options.split())
    with Image.open(picture) as image:
        small = image.convert("RGB")
        small.thumbnail(SIZE, Image.Resampling.LANCZOS)
        # By coverage, or few pixels of a colour of their own, as those of names, take another.
        coverage = Image.Quantize.MAXCOVERAGE
        small = small.quantize(COLOURS, method=coverage, kmeans=2, dither=Image.Dither.NONE)
    small.save(PICTURES / f"{name}.png", optimize=True)
    with rodsim.open_trajectory(output) as stored:
        measured = number(stored)
    told = f"{measured[0].upper()}{measured[1:]} · `rodsim {command}`, {seconds:.1f} CPU s"
    return (
        f"## {name}\n\n{sentence(name)}\n\n{told} · [{name}.yaml](../configs/{name}.yaml)\n\n"
        f"![{name}](images/gallery/{name}.png)\n"
    )


def stored_sections() -> dict[str, str]:
    """Return the sections of the page as it is, by name."""
    text = PAGE.read_text(encoding="utf-8") if PAGE.exists() else ""
    parts = re.split(r"^(?=## )", text, flags=re.M)[1:]
    return {part.split()[1]: part.rstrip() + "\n" for part in parts}


def make(names) -> None:
    """Show some configs, or all; write the page."""
    if missing := {path.stem for path in CONFIGS.glob("*.yaml")} ^ SHOWN.keys():
        raise SystemExit(f"SHOWN lacks, or has too many: {', '.join(sorted(missing))}")
    PICTURES.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        for name in names or SHOWN:
            shown = show(name, Path(folder))
            sections = stored_sections() | {name: shown}  # as it is now: two may run side by side
            kept = [sections[key] for key in SHOWN if key in sections]
            PAGE.write_text("\n".join([HEAD, *kept]), encoding="utf-8")


if __name__ == "__main__":
    make(sys.argv[1:])
