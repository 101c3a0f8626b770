"""The sums as they are with vectors of 512 bits, run here with narrower ones."""

import os
import subprocess
import sys

import numba
import numpy as np
import pytest

from rodsim.compiled.wide import inverse_root

pytestmark = pytest.mark.compiled
EPSILON, VISCOSITY, COUNTS = 0.37, 2.3, (3, 8, 21)

CODE = """
import sys
import numpy as np
import rodsim.compiled.wide as wide
wide.WIDE = True
from rodsim.flows.by_threads import velocity_kernel
given, answer = np.load(sys.argv[1]), {{}}
for count in {counts}:
    places, loads = given[f"places_{{count}}"], given[f"loads_{{count}}"]
    for power in (0, -90, 70):  # of the unit of length
        unit = 2.0**power
        out = np.zeros((3 if {rest[2]} is False else 6, count))
        kernel = velocity_kernel(*{rest})
        arguments = places * unit, places * unit, loads * unit ** np.repeat([0, 1], 3)[:, None]
        kernel(*arguments, {epsilon} * unit, {viscosity}, {height} * unit, out)
        out[:3] *= unit
        out[3:] *= unit**2
        answer[f"{{count}} {{power}}"] = out
np.savez(sys.argv[2], **answer)
"""


def test_the_inverse_root_is_good_to_the_last_bits():
    @numba.njit(error_model="numpy")
    def roots(x, out):
        for i in range(x.size):
            out[i] = inverse_root(x[i])

    some = np.random.default_rng(5).uniform(1.0, 4.0, 30000)
    x = np.concatenate([np.geomspace(0.25, 1e37, 30000), some])
    found, exact = np.empty_like(x), 1.0 / np.sqrt(x.astype(np.longdouble))
    roots(x, found)
    assert np.abs(found / exact - 1.0).max() < 2.5e-16  # rounding of one multiplication and sum
    odd = np.array([np.nan, np.inf])
    roots(odd, odd)
    assert np.isnan(odd[0])
    assert not odd[1] > 0.0


def scenes(spatial):
    """Return places and loads at random; in a plane of constant x if not ``spatial``."""
    random, found = np.random.default_rng(3), {}
    for count in COUNTS:
        places, loads = random.standard_normal((3, count)), random.standard_normal((6, count))
        if not spatial:
            places[0], loads[[0, 4, 5]] = 0.0, 0.0
        found |= {f"places_{count}": places, f"loads_{count}": loads}
    return found


def wide_sums(folder, given, rest, height=0.0):
    """Return the sums of a process of its own, by number of points and unit of length."""
    np.savez(folder / "given.npz", **given)
    code = CODE.format(
        rest=rest, height=height, counts=COUNTS, epsilon=EPSILON, viscosity=VISCOSITY
    )
    files = [str(folder / name) for name in ("given.npz", "found.npz")]
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(folder), "NUMBA_NUM_THREADS": "1"}
    subprocess.run([sys.executable, "-c", code, *files], env=environment, check=True)
    return np.load(files[1])


def exact_sum(places, loads):
    """Return (61), (66) with (63)-(68) of algebraic7, in numbers of 80 bits."""
    places, e2 = places.astype(np.longdouble), np.longdouble(EPSILON) ** 2
    out, (g, m) = np.zeros_like(loads, np.longdouble), (loads[:3], loads[3:])
    for i in range(places.shape[1]):
        r = places[:, i : i + 1] - places
        r2 = (r * r).sum(0)
        size = np.sqrt(r2 + e2)
        h1, h2, q = (2 * e2 + r2) / size**3, size**-3, (5 * e2 + 2 * r2) / size**5
        d1 = (10 * e2**2 - 7 * e2 * r2 - 2 * r2**2) / size**7
        d2 = (21 * e2 + 6 * r2) / size**7
        m_r, g_r = np.cross(m, r, axis=0), np.cross(g, r, axis=0)
        out[:3, i] = (g * h1 + (g * r).sum(0) * r * h2 + m_r * q / 2).sum(1)
        out[3:, i] = (g_r * q / 2 + m * d1 / 4 + (m * r).sum(0) * r * d2 / 4).sum(1)
    return out / (8 * np.pi * VISCOSITY)


def check(found, count, exact):
    """Compare with the exact sum, to the rounding of sums of 21; other units give the same bits."""
    out = found[f"{count} 0"]
    assert np.abs(out - exact).max() < 1e-14 * np.abs(exact).max()
    for power in (-90, 70):
        assert np.array_equal(found[f"{count} {power}"], out)


def test_sums_in_whole_vectors_of_sources_are_the_exact_ones(tmp_path):
    given = scenes(spatial=False)
    found = wide_sums(tmp_path, given, (7, True, True))
    for count in COUNTS:
        check(found, count, exact_sum(given[f"places_{count}"], given[f"loads_{count}"]))


@pytest.mark.long
def test_so_are_those_at_a_wall(tmp_path):
    """The narrow sums at a wall have tests of their own: here they are the truth."""
    from rodsim import velocity

    given, height = scenes(spatial=True), -4.6
    found = wide_sums(tmp_path, given, (7, False, True, True), height)
    for count in COUNTS:
        points, loads = given[f"places_{count}"].T, given[f"loads_{count}"]
        fluid = EPSILON, VISCOSITY
        exact = velocity(points, points, loads[:3].T, loads[3:].T, *fluid, wall=height)
        check(found, count, np.concatenate(exact, axis=1).T)
