"""The blobs (12), (13) and the scalars of their regularized Stokeslets, rotlets, dipoles, images.

With r the distance, R^2 = r^2 + eps^2 and p = eps^2/R^2, everything below is without 1/(8 pi):

    algebraic7, psi = 15 eps^4 / (8 pi R^7)                    (12); scalars (63)-(68)
    algebraic9, psi = 15 eps^6 (5 - 2 r^2/eps^2) / (16 pi R^9) (13); scalars derived here

from H1 = B'/r - G, H2 = (B'/r)'/r, Q = G'/r, D1 = psi - Q, D2 = -Q'/r. Written in p, both blobs
share their leading terms (the singular solution) and differ in powers of p only. For r >> eps:
H1 -> 1/r, H2 -> 1/r^3, Q -> 2/r^3, D1 -> -2/r^3, D2 -> 6/r^5.

A plane wall (``wall.py``) needs four more, all from H2: P = H2'/r, E = -(3 H2 + r H2'),
E1 = E'/r, E2 = E1'/r. Since div u = 0, E is also H1'/r + H2 = 2 H2 - Q: it is 0 for a point force,
so E, E1, E2 fall off faster by (eps/r)^2 (algebraic7) or (eps/r)^4 (algebraic9).
"""

import math

from rodsim.compiled.flags import inline

ALGEBRAIC7 = 7
ALGEBRAIC9 = 9
BLOBS = {"algebraic7": ALGEBRAIC7, "algebraic9": ALGEBRAIC9}


@inline
def inverse_distance(r2, e2):
    """Return 1/R: one square root and one division a pair, from which all scalars follow."""
    return 1.0 / math.sqrt(r2 + e2)


@inline
def stokeslet_scalars(blob, inverse, e2):
    """Return (H1, H2, Q/2) times 8 pi at 1/R = ``inverse``, squared blob size e2.

    As they stand in (61): factors of 2 that are left to the sums are operations there.
    """
    inverse2 = inverse * inverse
    inverse3 = inverse * inverse2
    p = e2 * inverse2
    if blob == ALGEBRAIC7:
        return inverse + inverse * p, inverse3, inverse3 * (1.0 + 1.5 * p)
    return (
        inverse + inverse * (p * (0.5 + 1.5 * p)),
        inverse3 * (1.0 + 1.5 * p),
        inverse3 * (1.0 + p * (1.5 + 3.75 * p)),
    )


@inline
def dipole_scalars(blob, inverse, e2):
    """Return (D1/4, D2/4), as they stand in (66), times 8 pi at 1/R = ``inverse``."""
    inverse2 = inverse * inverse
    inverse3 = inverse * inverse2
    p = e2 * inverse2
    if blob == ALGEBRAIC7:
        return (
            inverse3 * (-0.5 + p * (-0.75 + 3.75 * p)),
            inverse3 * inverse2 * (2.5 * (1.0 + 1.5 * p) - 1.0),
        )
    return (
        inverse3 * (-0.5 + p * (-0.75 + p * (-5.625 + 13.125 * p))),
        inverse3 * inverse2 * (1.5 + p * (3.75 + 13.125 * p)),
    )


@inline
def image_scalars(blob, inverse, e2):
    """Return (P, E, E1, E2) times 8 pi at 1/R = ``inverse``, squared blob size e2."""
    inverse2 = inverse * inverse
    inverse3 = inverse * inverse2
    p = e2 * inverse2
    if blob == ALGEBRAIC7:
        e = -3.0 * p * inverse3
        e1 = -5.0 * inverse2 * e
        return -3.0 * inverse2 * inverse3, e, e1, -7.0 * inverse2 * e1
    e = -7.5 * p * p * inverse3
    e1 = -7.0 * inverse2 * e
    return -inverse2 * inverse3 * (3.0 + 7.5 * p), e, e1, -9.0 * inverse2 * e1
