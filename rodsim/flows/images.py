"""One target above a plane wall on which the fluid does not slip, by all sources and their images.

Each source has an image below the wall (Blake 1971; regularized by Ainley et al. 2008 for
algebraic7, here for both blobs: docs/method.md). With z and h the heights of target and source
above the wall, r = x - X, r* = x - X*, X* the mirror image of X, a star on a scalar for its value
at R*^2 = R^2 + 4 z h, and g', m' for g, m with the third component reversed:

    v = E* a + P* (a.r*) r*,   a = h g' + m x e3
    mu u = (H1 - H1* - 2 z h H2*) g + (H2 - H2*) (g.r) r + 1/2 (Q - Q*) m x r
           - 2 z v - z h E1* m' x r*
    mu w = 1/2 (Q - Q*) g x r - 2 e3 x v - z h E1* r* x g' + 1/4 D1 m + 1/4 D2 (m.r) r
           + kappa [(m'.r*) r* - r*^2 m'] - 1/2 Q* m - z h E1* m' + (E* - 1/2 (z + h)^2 E1*) m_p
           + 1/2 E1* [(m.q) q + z (m.r_p) e3 - h m_3 r_p]
    p    = (Q - Q*) (g.r) + 2 (z + h) (E1* - 2 P*) (a.r*)

summed over the sources, with kappa = 1/4 (2 z h E2* - 2 P* + E1*), r_p and m_p the parts of r and m
along the wall, q = e3 x r. On the wall R* = R: every term of u is exactly 0. The mobility of two
points is symmetric. Heights below 0 give smooth, meaningless numbers: callers keep them out.

Two passes over the sources, first all distances of a target and then its sum, are faster than one
(docs/notes/performance.md).
"""

import math

from rodsim.compiled.flags import inline
from rodsim.compiled.wide import inverse_root
from rodsim.flows.blobs import dipole_scalars, image_scalars, stokeslet_scalars


@inline
def inverse_distances(r, zh, e2):
    """Return 1/R and 1/R* of one pair: one division for both."""
    rx, ry, d = r
    r2 = rx * rx + ry * ry + d * d + e2
    direct, image = math.sqrt(r2), math.sqrt(r2 + 4.0 * zh)
    both = 1.0 / (direct * image)
    return image * both, direct * both


@inline
def _all_inverse_distances(wide, x, y, z, sources, wall_height, e2, inverses):
    """Fill ``inverses`` with 1/R and 1/R* of all sources."""
    for k in range(sources.shape[1]):
        h = sources[2, k] - wall_height
        r = x - sources[0, k], y - sources[1, k], z - h
        if wide:
            rx, ry, d = r
            r2 = rx * rx + ry * ry + d * d + e2
            inverses[0, k], inverses[1, k] = inverse_root(r2), inverse_root(r2 + 4.0 * (z * h))
        else:
            inverses[0, k], inverses[1, k] = inverse_distances(r, z * h, e2)


@inline
def _force_scalars(blob, inverse, image, zh, e2):
    """Return H1 - H1* - 2 z h H2*, H2 - H2* and (Q - Q*)/2, all exactly 0 on the wall."""
    h1, h2, q = stokeslet_scalars(blob, inverse, e2)
    h1_image, h2_image, q_image = stokeslet_scalars(blob, image, e2)
    return (h1 - h1_image) - 2.0 * zh * h2_image, h2 - h2_image, q - q_image


@inline
def _torque_scalars(blob, inverse, image, zh, e2):
    """Return D1/4 - Q*/2, D2/4 and kappa = (2 z h E2* - 2 P* + E1*)/4: of w made by torques."""
    d1, d2 = dipole_scalars(blob, inverse, e2)
    _, _, q_image = stokeslet_scalars(blob, image, e2)
    p, _, e1, e_2 = image_scalars(blob, image, e2)
    return d1 - q_image, d2, 0.5 * (zh * e_2 - p) + 0.25 * e1


@inline
def add_pair(blob, planar, angular, r, z, h, g, m, inverses, e2, sums):
    """Return ``sums`` and what a source adds that has g, m, is r away and at height h, target at z.

    ``inverses`` is 1/R and 1/R*; ``sums`` is 8 pi mu (u, w) without its terms in v, and v. Of r,
    the third component is d = z - h. Constants choose what is compiled.
    """
    # Products of vectors: g.r, a.r*, and mr = e3 . (m x r).
    rx, ry, d = r
    gx, gy, gz = g
    mx, my, mz = m
    ux, uy, uz, wx, wy, wz, vx, vy, vz = sums
    s = z + h
    ay, az = h * gy - mx, -h * gz
    gr, ar, mr = gy * ry + gz * d, ay * ry + az * s, mx * ry
    if not planar:
        ax = h * gx + my
        gr, ar, mr = gr + gx * rx, ar + ax * rx, mr - my * rx
    # u, and v, which u and w share.
    zh = z * h
    inverse, image = inverses
    h1, h2, q = _force_scalars(blob, inverse, image, zh, e2)
    p, e, e1, _ = image_scalars(blob, image, e2)
    along, back, c = h2 * gr, p * ar, zh * e1
    uy += gy * h1 + along * ry - mx * (q * d - c * s)
    uz += gz * h1 + along * d + (q - c) * mr
    vy += e * ay + back * ry
    vz += e * az + back * s
    if not planar:
        ux += gx * h1 + along * rx + my * (q * d - c * s) - mz * ry * (q + c)
        uy += mz * rx * (q + c)
        vx += e * ax + back * rx
    # w but for v; s2 = r*^2, and mrho = m.r without the third component.
    if angular:
        d1, d2, kappa = _torque_scalars(blob, inverse, image, zh, e2)
        e1 *= 0.5
        s2, turn = ry * ry + d * d + 4.0 * zh, e1 * mr
        if not planar:
            s2 += rx * rx
        own = d1 - kappa * s2 - e1 * (s * s) - c + e
        wx += gy * (q * d + c * s) - gz * ry * (q - c) + turn * ry + own * mx
        if not planar:
            mrho = mx * rx + my * ry
            axial, mirrored = d2 * (mrho + mz * d), kappa * (mrho - mz * s)
            lead = axial + mirrored - e1 * (h * mz)
            wx += lead * rx
            wy += gz * rx * (q - c) - gx * (q * d + c * s) - turn * rx + own * my
            wy += lead * ry
            wz += (gx * ry - gy * rx) * (q + c) + axial * d + mirrored * s
            wz += e1 * (z * mrho) + (d1 + kappa * s2 + c) * mz
    return ux, uy, uz, wx, wy, wz, vx, vy, vz


@inline
def with_v(z, sums):
    """Return 8 pi mu (u, w) from the ``sums`` of :func:`add_pair` at a target of height z."""
    ux, uy, uz, wx, wy, wz, vx, vy, vz = sums
    ux, uy, uz = ux - 2.0 * z * vx, uy - 2.0 * z * vy, uz - 2.0 * z * vz
    return ux, uy, uz, wx + 2.0 * vy, wy - 2.0 * vx, wz


@inline
def add_up(blob, planar, angular, wide, x, y, z, sources, loads, inverses, wall_height, e2):
    """Return 8 pi mu (u, w) at one target, from all sources; constants choose the sum.

    ``wide``: 1/R by :mod:`rodsim.compiled.wide`. ``inverses`` (2, N): room.
    """
    z = z - wall_height
    _all_inverse_distances(wide, x, y, z, sources, wall_height, e2, inverses)
    sums = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for k in range(sources.shape[1]):
        h = sources[2, k] - wall_height
        ry, d = y - sources[1, k], z - h
        gy, gz, mx = loads[1, k], loads[2, k], loads[3, k]
        rx, gx, my, mz = x - sources[0, k], loads[0, k], loads[4, k], loads[5, k]
        r, g, m = (rx, ry, d), (gx, gy, gz), (mx, my, mz)
        both = inverses[0, k], inverses[1, k]
        sums = add_pair(blob, planar, angular, r, z, h, g, m, both, e2, sums)
    return with_v(z, sums)
