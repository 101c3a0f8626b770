"""What makes an output a file of H5MD 1.1, so that its readers open it: attributes, no numbers.

Source: de Buyl, Colberg & Höfling, Comput. Phys. Commun. 185 (2014) 1546, and the specification at
nongnu.org/h5md. Elements are stored in its way already: ``value``, ``step`` and ``time``.
"""

from __future__ import annotations

import h5py
import numpy as np

VERSION = (1, 1)
AUTHOR = "not given"  # required, and a case does not say whose it is
BOUNDARY = b"none"  # along each axis: the fluid goes on for ever, or to a wall


def describe(file: h5py.File) -> None:
    """Add ``/h5md``, and to each group of particles a ``box`` without edges."""
    root = file.create_group("h5md")
    root.attrs["version"] = np.array(VERSION, dtype=np.int32)
    root.create_group("author").attrs["name"] = AUTHOR
    creator = root.create_group("creator")
    for name, source in (("name", "creator"), ("version", "version")):
        creator.attrs[name] = file.attrs[source]
    for particles in file["particles"].values():
        box = particles.create_group("box")
        box.attrs["dimension"] = np.int32(3)
        box.attrs["boundary"] = np.array([BOUNDARY] * 3)
