"""The sums on a GPU against those of the CPU, on Numba's simulator: no card is needed."""

import numpy as np
import pytest
from card import simulated

from rodsim.compiled.flags import MAT, call_sum, kernel
from rodsim.compiled.kernels import jit_is_off
from rodsim.flows.by_threads import velocity_kernel

pytest.importorskip("numba.cuda", reason="this Numba has no CUDA: pip install numba-cuda")
EPSILON, VISCOSITY, WALL = 0.37, 0.73, -0.41
KINDS = [f"{at}{kind}" for at in ("", "wall_") for kind in ("spatial", "planar", "flow")]
SIZES = ((4, 10), (7, 7))  # targets and sources: nothing is a multiple of 3, or of the shares

SUMS = """
import sys
import numpy as np
from rodsim.flows.card import sums
given, found = dict(np.load("given.npz")), {}
for name in {name.rpartition(".")[0] for name in given} - {"fluid"}:
    kind = name.split("-")[0]
    arrays = [given[f"{name}.{part}"] for part in ("targets", "sources", "loads")]
    if arrays[0].shape == arrays[1].shape:
        arrays[0] = arrays[1]  # once, as the points of rods are
    for again in ("", "again "):
        found[again + name] = given[f"{name}.out"].copy()
        getattr(sums, kind)(0, *arrays, *given["fluid.numbers"], found[again + name])
    sums.failed()
np.savez("found.npz", **found)
"""


def arrays(kind, targets, sources):
    rng = np.random.default_rng([targets, sources, KINDS.index(kind)])
    x, y = rng.normal(size=(3, sources)), rng.normal(size=(3, targets))
    loads = rng.normal(size=(6, sources))
    x[2], y[2] = abs(x[2]), abs(y[2])
    if "planar" in kind:
        x[0] = y[0] = 0.2
        loads[[0, 4, 5]] = 0.0
    out = rng.normal(size=(3 if "flow" in kind else 6, targets))
    return {"targets": x if targets == sources else y, "sources": x, "loads": loads, "out": out}


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """Sums of all kinds, blobs and sizes on the simulator."""
    folder = tmp_path_factory.mktemp("card")
    given = {"fluid.numbers": np.array([EPSILON, VISCOSITY, WALL])}
    for kind in KINDS:
        for blob in (7, 9):
            for size in SIZES:
                name = f"{kind}_{blob}-{size[0]}-{size[1]}"
                given |= {f"{name}.{part}": a for part, a in arrays(kind, *size).items()}
    np.savez(folder / "given.npz", **given)
    simulated(SUMS, folder)
    return dict(np.load(folder / "found.npz"))


@pytest.mark.parametrize("blob", [7, 9])
@pytest.mark.parametrize("kind", KINDS)
def test_sums_on_a_card_are_those_of_the_cpu(found, kind, blob):
    """To rounding: at most 10 terms are added in another order; 20 and more last bits of each."""
    add = velocity_kernel(blob, "planar" in kind, "flow" not in kind, "wall" in kind)
    for size in SIZES:
        given = arrays(kind, *size)
        exact = given["out"].copy()
        add(*list(given.values())[:3], EPSILON, VISCOSITY, WALL, exact)
        assert abs(exact - given["out"]).max() > 1e-3  # something was added
        name = f"{kind}_{blob}-{size[0]}-{size[1]}"
        np.testing.assert_allclose(found[name], exact, rtol=1e-12, atol=1e-13 * abs(exact).max())


def test_bits_do_not_vary(found):
    names = [name for name in found if not name.startswith("again ")]
    assert len(names) == 2 * len(KINDS) * len(SIZES)
    assert all(np.array_equal(found[name], found[f"again {name}"]) for name in names)


@pytest.mark.skipif(jit_is_off(), reason="addresses are those of compiled code")
def test_compiled_code_calls_a_sum_of_python_by_its_address():
    """The nine numbers of an array arrive as they are; so does what is raised."""
    from rodsim.errors import UsageError
    from rodsim.flows.card.sums import CardSum, failed

    class Noted(CardSum):
        def add(self, *arguments):
            self.given = [np.copy(a) for a in arguments[:6]]
            arguments[-1][:] += 0.7
            if arguments[0].shape[1] == 2:
                raise OSError("the card is lost")

    @kernel(f"void(int64, {MAT}, {MAT}, {MAT}, {MAT})")
    def call(address, targets, sources, loads, out):
        call_sum(address, 0, targets, sources, loads, 0.3, 0.4, 0.6, out)

    noted, given = Noted(False, 7), arrays("spatial", 5, 13)
    targets, sources, loads = list(given.values())[:3]
    out = np.full((6, 5), 0.2)
    call(noted.address, targets, sources, loads, out)
    for got, sent in zip(noted.given, (targets, sources, loads, 0.3, 0.4, 0.6), strict=True):
        np.testing.assert_array_equal(got, sent)
    np.testing.assert_array_equal(out, 0.2 + 0.7)
    failed()
    out = np.zeros((6, 2))
    call(noted.address, targets[:, :2].copy(), sources, loads, out)
    assert np.isnan(out).all()
    with pytest.raises(UsageError, match=r"the card is lost.*rodsim resume"):
        failed()
    failed()  # told once
