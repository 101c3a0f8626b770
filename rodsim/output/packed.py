"""Packed datasets of a file that may come from anywhere: what they unpack to is known before."""

from __future__ import annotations

import math
import zlib

OWN_FILTERS = {1, 2, 3, 4, 5, 6, 32000}  # deflate ... scale-offset, and LZF, which h5py brings
DEFLATE = 1
# Deflate packs a thousandfold at best: a dataset larger than that has no contents in this file,
# and reading it would only fill the memory.
PACKING = 2000
LARGEST_CHUNK = 2**26  # bytes; HDF5 and h5py make chunks of 1 MB
PIECE = 2**20


def what_is_wrong(data) -> str:
    """Return why a dataset (h5py) cannot be unpacked in the room that it claims, or nothing.

    HDF5 unpacks a chunk whole, however large that comes out: 2 MB of zeros deflate to 2 kB. So a
    chunk must be no larger than it says, which is tried for those that could fill a memory.
    """
    if data.chunks is None:
        return ""
    filters = _filters(data)
    if not filters <= OWN_FILTERS:
        return "is packed in a way that only a plug-in can read"
    size = math.prod(data.chunks) * data.dtype.itemsize
    if size > max(LARGEST_CHUNK, data.nbytes):
        return f"has chunks of {size} bytes for {data.nbytes}"
    return _too_large(data, filters, size)


def _filters(data):
    properties = data.id.get_create_plist()
    return {properties.get_filter(i)[0] for i in range(properties.get_nfilters())}


def _too_large(data, filters, size):
    """Look at every chunk: what is stored of it, and if need be what that unpacks to."""
    found = []

    def look(chunk):
        if chunk.size > 2 * size + PIECE:  # no filter makes it so much larger
            found.append("has chunks that are larger than they say")
        large = DEFLATE in filters and chunk.size * PACKING > LARGEST_CHUNK
        if large and _unpacks_to_more(data, chunk.chunk_offset, size):
            found.append("has chunks that unpack to more than they say")
        return bool(found) or None  # ends the iteration

    data.id.chunk_iter(look)
    return found[0] if found else ""


def _unpacks_to_more(data, offset, size):
    """Tell whether a deflated chunk holds more than its size and a checksum."""
    packed = data.id.read_direct_chunk(offset)[1]
    stream, count = zlib.decompressobj(), 0
    try:
        while packed and count <= size + PIECE:
            count += len(stream.decompress(packed, PIECE))
            packed = stream.unconsumed_tail
    except zlib.error:
        return False  # deflate is not the outermost, or it is damaged: HDF5 says so
    return count > size + PIECE
