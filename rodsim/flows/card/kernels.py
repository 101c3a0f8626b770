"""The sums of ``free.py`` and ``wall.py`` as CUDA kernels, by the very functions of one pair.

A block of threads has as many targets, one each. It walks over its share of the sources, a tile at
a time: each thread brings one source into the memory that the block shares, then all read all of
them. Where few targets would leave most of the card idle, several blocks share out the sources of
a target: each writes its part of the sum, and a second kernel adds the parts in their order. So
the bits of a sum depend on the numbers of targets and sources, not on the card's size or load.

Constants of the factories (numbers, no functions) choose what is compiled, as on the CPU, and let
compiled kernels be found in Numba's cache again.
"""

from functools import lru_cache

import numpy as np
from numba import cuda, float64

from rodsim.flows import free, images
from rodsim.flows.blobs import inverse_distance

THREADS = 128  # of a block
BLOCKS = 1024  # what fills a card: where there are fewer, sources are shared out
LEAST = 64  # sources of a share
NOTHING = (0.0,) * 9


def shares_of(targets: int, sources: int) -> int:
    """Return among how many blocks the sources of each target are shared out."""
    blocks = -(-targets // THREADS)
    return max(1, min(-(-BLOCKS // blocks), sources // LEAST))


@cuda.jit(device=True)
def add_source(at_wall, blob, planar, angular, x, y, z, tile, k, wall, e2, sums):
    """Return ``sums`` (u, w, v of ``images.py``) at a target and what source k of a tile adds."""
    g, m = (tile[3, k], tile[4, k], tile[5, k]), (tile[6, k], tile[7, k], tile[8, k])
    if at_wall:
        z, h = z - wall, tile[2, k] - wall
        r = x - tile[0, k], y - tile[1, k], z - h
        both = images.inverse_distances(r, z * h, e2)
        return images.add_pair(blob, planar, angular, r, z, h, g, m, both, e2, sums)
    r = x - tile[0, k], y - tile[1, k], z - tile[2, k]
    inverse, six = inverse_distance(free.squared(planar, r), e2), sums[:6]
    ux, uy, uz, wx, wy, wz = free.add_pair(blob, planar, angular, r, g, m, inverse, e2, six)
    return ux, uy, uz, wx, wy, wz, 0.0, 0.0, 0.0


@cuda.jit(device=True)
def closed(at_wall, z, wall, sums):
    """Return u and w from ``sums``."""
    if at_wall:
        return images.with_v(z - wall, sums)
    return sums[:6]


@lru_cache
def share_kernel(at_wall, blob, planar, angular):
    """Compile the kernel that writes the parts (P, 6, T) of a sum, or (P, 3, T) without w.

    targets (3, T), or more rows; sources (9, N): X, g, m. The grid is (blocks of targets, P).
    """

    @cuda.jit(cache=True)
    def add_shares(targets, sources, epsilon, wall, parts):
        tile = cuda.shared.array((9, THREADS), float64)
        own, p, count = cuda.threadIdx.x, cuda.blockIdx.y, sources.shape[1]
        i = cuda.blockIdx.x * THREADS + own
        at = min(i, targets.shape[1] - 1)  # who has no target helps to bring sources
        x, y, z = targets[0, at], targets[1, at], targets[2, at]
        e2, sums = epsilon * epsilon, NOTHING
        begin, end = p * count // parts.shape[0], (p + 1) * count // parts.shape[0]
        for first in range(begin, end, THREADS):
            if first + own < end:
                for c in range(9):
                    tile[c, own] = sources[c, first + own]
            cuda.syncthreads()
            for k in range(np.uint32(min(THREADS, end - first))):
                sums = add_source(at_wall, blob, planar, angular, x, y, z, tile, k, wall, e2, sums)
            cuda.syncthreads()
        if i < targets.shape[1]:
            ux, uy, uz, wx, wy, wz = closed(at_wall, z, wall, sums)
            parts[p, 0, i], parts[p, 1, i], parts[p, 2, i] = ux, uy, uz
            if angular:
                parts[p, 3, i], parts[p, 4, i], parts[p, 5, i] = wx, wy, wz

    return add_shares


@cuda.jit(cache=True)
def add_parts(parts, factor, out):
    """Set out (rows, T) to the sum of parts (P, rows, T), in their order, times a factor."""
    i = cuda.grid(1)
    if i < out.shape[1]:
        for c in range(out.shape[0]):
            total = parts[0, c, i]
            for p in range(1, parts.shape[0]):
                total += parts[p, c, i]
            out[c, i] = factor * total
