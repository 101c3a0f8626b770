"""Pictures one after another: .gif by Pillow, .mp4 by the ffmpeg that comes with imageio-ffmpeg."""

from __future__ import annotations

from contextlib import closing

import numpy as np

from rodsim.files import replacing
from rodsim.plotting import style
from rodsim.plotting.shapes import FRAME, TITLE, Shapes, annotate, set_stage

DPI = 110
LONGEST, HIGHEST = 6.4, 5.4  # inches


def write_movie(path, shapes: Shapes, camera, fps, title, progress) -> None:
    """Write one picture for each frame of ``shapes``; the file appears when it is whole.

    ``progress``: an object with ``update(fraction, note)``. Raises FileError.
    """
    pictures = _pictures(shapes, camera, title, progress)
    with replacing(path) as temporary, style.drawing(path):
        if temporary.suffix == ".gif":
            _write_gif(temporary, pictures, fps)
        else:
            _write_mp4(temporary, pictures, fps)


def _pictures(shapes, camera, title, progress):
    """Yield each frame as an array (height, width, 3) of bytes, with even sides, as mp4 needs."""
    with style.matplotlib_needed():
        from matplotlib.backends.backend_agg import FigureCanvasAgg
    bounds = shapes.bounds(camera)
    aspect = max((bounds[1, 1] - bounds[0, 1]) / (bounds[1, 0] - bounds[0, 0]), 0.05)
    width = min(LONGEST, HIGHEST / aspect)
    count = len(shapes.time)
    for frame in range(count):
        figure = style.new_figure(max(width, 3.0) + 0.7, width * aspect + TITLE + FRAME + 0.4)
        canvas = FigureCanvasAgg(figure)
        figure.set_dpi(DPI)
        axis = figure.add_subplot()
        set_stage(axis, camera, bounds)
        shapes.draw(axis, camera, frame)
        annotate(figure, axis, camera, bounds, shapes.units["length"])
        if title:
            figure.suptitle(title, fontsize=11)
        axis.set_title(shapes.stamp(frame), fontsize=10, loc="left", pad=3)
        canvas.draw()
        picture = np.asarray(canvas.buffer_rgba())[..., :3]
        height, width_px = (side - side % 2 for side in picture.shape[:2])
        yield np.ascontiguousarray(picture[:height, :width_px])
        progress.update((frame + 1) / count, f"frame {frame + 1} of {count}")


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
