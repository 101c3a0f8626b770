"""Pictures one after another: .gif by Pillow, .mp4 by the ffmpeg that comes with imageio-ffmpeg."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass

import numpy as np

from rodsim.errors import UsageError
from rodsim.files import replacing
from rodsim.plotting import style
from rodsim.plotting.shapes import Shapes
from rodsim.plotting.surround import FRAME, annotate, draw_compass, draw_key, set_stage

DPI = 200
SIZE = {".mp4": (9.6, 5.4), ".gif": (4.8, 2.7)}  # inches: 1920 x 1080, and a quarter of it


@dataclass(frozen=True)
class Film:
    """fps : frames a second. turn : degrees by which the scene turns until the end."""

    fps: float = 20.0
    turn: float = 0.0


def write_movie(path, shapes: Shapes, camera, key, film: Film, title, sheet, progress) -> None:
    """Write one picture for each frame of ``shapes``; the file appears when it is whole.

    ``key``: what colours mean, see ``draw_panels``. ``progress``: an object with
    ``update(fraction, note)``. Raises FileError, and UsageError for a plane that is to turn.
    """
    if film.turn and camera.flat:
        raise UsageError(f"a view straight at {camera.flat} cannot turn: --view 3d")
    count = len(shapes.time)
    cameras = [camera] * count
    if film.turn:
        cameras = [camera.turned(film.turn * k / max(1, count - 1)) for k in range(count)]
    pictures = _pictures(shapes, cameras, key, title, (sheet, path.suffix), progress)
    with replacing(path) as temporary, style.drawing(path):
        if temporary.suffix == ".gif":
            _write_gif(temporary, pictures, film.fps)
        else:
            _write_mp4(temporary, pictures, film.fps)


def _pictures(shapes, cameras, key, title, made, progress):
    """Yield each frame as an array (height, width, 3) of bytes, with even sides, as mp4 needs."""
    seen = [shapes.bounds(camera, k) for k, camera in enumerate(cameras)]
    bounds = np.array([np.min(seen, axis=0)[0], np.max(seen, axis=0)[1]])
    figure, axis, compass = _screen(shapes, cameras[0], bounds, key, title, made)
    count, still = len(cameras), {*axis.get_children()}
    for frame, camera in enumerate(cameras):
        for drawn in {*axis.get_children()} - still:
            drawn.remove()
        shapes.draw(axis, camera, frame)
        axis.set_title(shapes.stamp(frame), loc="left", pad=3)
        if compass and frame:
            compass.remove()
            compass = draw_compass(figure, camera)
        if not frame:
            style.settle(figure)
            figure.set_layout_engine("none")  # nothing moves from one picture to the next
        figure.canvas.draw()
        picture = np.asarray(figure.canvas.buffer_rgba())[..., :3]
        height, width = (side - side % 2 for side in picture.shape[:2])
        yield np.ascontiguousarray(picture[:height, :width])
        progress.update((frame + 1) / count, f"frame {frame + 1} of {count}")


def _screen(shapes, camera, bounds, key, title, made):
    """Return the figure of all frames with its axis and its compass, all but the shapes drawn."""
    with style.matplotlib_needed():
        from matplotlib.backends.backend_agg import FigureCanvasAgg
    sheet, suffix = made
    figure = sheet.figure(*SIZE[suffix], title)
    FigureCanvasAgg(figure)
    figure.set_dpi(sheet.dpi or DPI)
    axis = figure.add_subplot()
    size = figure.get_size_inches() - FRAME
    set_stage(axis, camera, bounds, size)
    compass = annotate(np.array([[axis]]), camera, bounds, shapes.units["length"], key)
    draw_key(figure, [axis], camera, key)
    return figure, axis, compass


def _write_gif(path, pictures, fps):
    with style.matplotlib_needed():
        from PIL import Image
    images = (
        Image.fromarray(picture).quantize(96, dither=Image.Dither.NONE) for picture in pictures
    )
    first = next(images)
    first.save(path, save_all=True, append_images=images, duration=round(1000 / fps), loop=0)


def _write_mp4(path, pictures, fps):
    with style.matplotlib_needed():
        import imageio_ffmpeg
    first = next(pictures)
    size = first.shape[1], first.shape[0]
    writer = imageio_ffmpeg.write_frames(
        str(path), size, fps=fps, codec="libx264", quality=8, macro_block_size=2
    )
    with closing(writer):
        writer.send(None)
        writer.send(first)
        for picture in pictures:
            writer.send(picture)
