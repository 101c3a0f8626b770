"""One reader for the tables people have: the same numbers out of every way of writing them."""

import warnings
from contextlib import suppress

import numpy as np
import pytest
from fuzz import mutated

from rodsim.errors import FileError
from rodsim.scene.data.functions import close_period, read_samples
from rodsim.scene.data.points import read_points
from rodsim.scene.data.triads import orthonormal

XYZ = np.array([[0.5, -2.0, 3.25], [1.5e-3, 7.0, -4.0], [9.0, 0.125, 6e4]])


def written(rows, sign):
    return "\n".join(sign.join(repr(float(x)) for x in row) for row in rows) + "\n"


PLAIN = written(XYZ, " ")
WAYS = {
    "blanks": PLAIN,
    "commas": written(XYZ, ","),
    "commas and blanks": written(XYZ, " , "),
    "semicolons": written(XYZ, ";"),
    "tabs": written(XYZ, "\t"),
    "decimal commas": written(XYZ, ";").replace(".", ","),
    "decimal commas and blanks": PLAIN.replace(".", ","),
    "header": "x;y;z\n" + written(XYZ, ";"),
    "two headers": "x,y,z\num,um,um\n" + written(XYZ, ","),
    "quoted header": '"x","y","z"\n' + written(XYZ, ","),
    "units": "x (um),y [um],z (um)\n" + written(XYZ, ","),
    "comments": "# a trace\n% of today\n" + PLAIN.replace("\n", "  # seen\n"),
    "blank lines around": "\n\n" + PLAIN + "\n\n",
    "windows": PLAIN.replace("\n", "\r\n"),
    "old mac": PLAIN.replace("\n", "\r"),
    "byte order mark": "\ufeff" + PLAIN,
    "fortran": PLAIN.replace("e", "D").replace("0.5", "5.0D-01"),
    "fortran, small d": PLAIN.replace("e", "d"),
    "minus sign": PLAIN.replace("-2.0", "\N{MINUS SIGN}2.0"),
    "comma at the end": written(XYZ, ",").replace("\n", ",\n"),
    "other columns": "point,z,y,x\n" + written(np.c_[[1, 2, 3], XYZ[:, ::-1]], ","),
    "capitals": "X Y Z\n" + PLAIN,
    "names in a comment": "# x y z\n" + PLAIN,
}


@pytest.mark.parametrize("way", WAYS)
def test_every_way_of_writing_a_table(tmp_path, way):
    path = tmp_path / "table.csv"
    path.write_bytes(WAYS[way].encode())
    points = read_points(path, triads=False)
    assert np.array_equal(points.position, XYZ)
    assert points.unit == ("um" if way == "units" else None)
    assert not points.breaks


def test_utf16_and_latin1(tmp_path):
    path = tmp_path / "table.csv"
    text = "x (µm)\ty (µm)\tz (µm)\n" + written(XYZ, "\t")
    for encoding in ("utf-16", "latin-1"):
        path.write_bytes(text.encode(encoding))
        points = read_points(path, triads=False)
        assert np.array_equal(points.position, XYZ)
        assert points.unit == "µm"


@pytest.mark.parametrize("columns", [["x_um", "y_um"], [3, 4], ["x_um", 4]])
def test_columns_by_name_or_number_and_two_of_them(tmp_path, columns):
    path = tmp_path / "trace.csv"
    path.write_text("frame,point,x_um,y_um\n0,0,0.5,0.25\n0,1,0.75,-3\n")
    points = read_points(path, triads=False, columns=columns)
    assert points.position.tolist() == [[0.5, 0.25, 0.0], [0.75, -3.0, 0.0]]


@pytest.mark.parametrize(
    ("text", "columns", "words"),
    [
        ("x,y,z\n1,2,3\n4,nan,6\n", None, "table.csv:3: y is nan: must be finite"),
        ("1 2 3\n4 5 6\n7 8 -inf\n", None, "table.csv:3: column 3 is -inf: must be finite"),
        ("x,y,z\n1,2,3\n4,,6\n", None, "table.csv:3: y is missing"),
        ("x,y,z\n1,2,3\n4,5o,6\n", None, "table.csv:3: y is '5o', not a number"),
        ("1,2,3\n4,5\n7,8,9\n", None, "table.csv:2: has 2 cells, the last row 3"),
        ("0,5;1,5;2,5\n1,5;2.5,0;3,5\n", None, "'2.5.0', not a number"),
        ("x,y\n0 5,1\n0.5,2\n", None, "write decimals with a point"),
        (
            "a,b,c,d\n1,2,3,4\n1,2,3,5\n",
            None,
            "which of its columns are x, y, z? it has a, b, c and d",
        ),
        ("1 2 3 4\n1 2 3 5\n", None, "it has 4 without names: write columns: [2, 3, 4]"),
        ("a,b,c\n1,2,3\n1,2,3\n", ["a", "b", "d"], "has no column 'd'"),
        ("a,b,a\n1,2,3\n1,2,3\n", ["a", "b"], "has 2 columns 'a': give their numbers"),
        ("a,b\n1,2\n1,3\n", [1, 3], "has the columns 1 to 2, no 3"),
        ("# nothing\n\n", None, "has no numbers"),
        ("1_0 2 3\n", None, "column 1 is '1_0', not a number"),
        ("frame,x,y,z\n4,1,2,3\n5,1,2,3\n", None, None),
    ],
)
def test_what_is_wrong_is_named_by_line_and_column(tmp_path, text, columns, words):
    path = tmp_path / "table.csv"
    path.write_text(text)
    if words is None:
        assert len(read_points(path, False, columns).position) == 1
        return
    with pytest.raises(FileError) as error:
        read_points(path, False, columns)
    assert words in str(error.value)
    assert "usecols" not in str(error.value)


def test_frames_and_rods_of_a_table_are_chosen(tmp_path):
    path = tmp_path / "t.csv"
    path.write_text("frame,rod,x,y,z\n" + "".join(
        f"{f},{r},{f},{k},{ord(r)}\n" for f in (0, 10) for r in "ab" for k in range(3)
    ))  # fmt: skip
    assert read_points(path, False, rod="b").position[:, [0, 2]].tolist() == [[10, 98]] * 3
    assert read_points(path, False, rod="a", frame=0).position[2].tolist() == [0, 2, 97]
    assert read_points(path, False, rod="a", frame=-2).position[2].tolist() == [0, 2, 97]
    for choice, words in [({}, "'rod' must be a or b"), ({"rod": "a", "frame": 3}, "no frame 3")]:
        with pytest.raises(FileError, match=words):
            read_points(path, False, **choice)


def test_xyz_files(tmp_path):
    path = tmp_path / "mini.xyz"
    frame = "3\na comment\n" + "".join(f"P {x} {y} {z} 7\n" for x, y, z in XYZ)
    path.write_text("3\n0 0 0\nC 1 2 3\nC 1 2 3\nC 1 2 3\n" + frame)
    assert np.array_equal(read_points(path, False).position, XYZ)
    assert read_points(path, False, frame=0).position.tolist() == [[1, 2, 3]] * 3
    path.write_text(frame.replace("3\na", "5\na", 1))
    with pytest.raises(FileError, match="says 5 atoms and has 3"):
        read_points(path, False)


def test_ibamr_files(tmp_path):
    triads = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3, 3)))[0]
    (tmp_path / "r.vertex").write_text("3\n" + PLAIN)
    (tmp_path / "r.director").write_text("3\n" + written(triads.reshape(9, 3), " "))
    for name in ("r.vertex", "r.director"):
        points = read_points(tmp_path / name, triads=True)
        assert np.array_equal(points.position, XYZ)
        assert np.array_equal(points.director, triads)
    (tmp_path / "r.vertex").write_text("4\n" + PLAIN)
    with pytest.raises(FileError, match="says 4, so needs 4 rows; has 3"):
        read_points(tmp_path / "r.vertex", triads=False)
    (tmp_path / "r.vertex").write_text("2\n1 2 3\n4 5 6\n")
    with pytest.raises(FileError, match="2 points have 3 triads"):
        read_points(tmp_path / "r.vertex", triads=True)


@pytest.fixture
def two_in_one(tmp_path):
    """Three points and two, in one .vertex; returns what writes a file of segments beside it."""
    rng = np.random.default_rng(5)
    position = rng.normal(size=(5, 3))
    triads = np.linalg.qr(rng.normal(size=(5, 3, 3)))[0]
    (tmp_path / "r.vertex").write_text("5\n" + written(position, " "))
    (tmp_path / "r.director").write_text("5\n" + written(triads.reshape(15, 3), " "))

    def join(*pairs, suffix=".rod"):
        rows = "".join(f"{a} {b} 0.3 7 7\n" for a, b in pairs)
        (tmp_path / f"r{suffix}").write_text(f"{len(pairs)} # segments\n{rows}")

    return tmp_path / "r.vertex", position, triads, join


@pytest.mark.parametrize("suffix", [".rod", ".spring"])
def test_of_several_ibamr_rods_one_is_chosen_by_its_number(two_in_one, suffix):
    path, position, triads, join = two_in_one
    assert np.array_equal(read_points(path, False).position, position)  # nothing says otherwise
    join((0, 1), (1, 2), (2, 0), (4, 3), suffix=suffix)
    for rod, points in ((1, slice(0, 3)), ("2", slice(3, 5))):
        found = read_points(path, True, rod=rod)
        assert np.array_equal(found.position, position[points])
        assert np.array_equal(found.director, triads[points])
        assert found.name(1).startswith(f"point 1 (line {points.start + 3})")
    for rod in (None, 0, 3, "tail"):
        with pytest.raises(
            FileError, match=r"has 2 rods: .* \(1: points 0 to 2, 2: points 3 to 4\)"
        ):
            read_points(path, True, rod=rod)


@pytest.mark.parametrize(
    ("pairs", "words"),
    [
        ([(0, 1), (1, 2), (2, 4)], "joins points 2 and 4 of two rods"),
        ([(0, 1), (1, 5)], r"r\.rod:3: a segment begins with two numbers from 0 to 4"),
        ([(0, "x")], r"r\.rod:2: a segment begins"),
    ],
)
def test_segments_that_cannot_be_are_refused(two_in_one, pairs, words):
    path, _, _, join = two_in_one
    join(*pairs)
    with pytest.raises(FileError, match=words):
        read_points(path, False, rod=1)


def test_one_ibamr_curve_has_no_second_rod(two_in_one):
    with pytest.raises(
        FileError, match=r"is one curve, so there is no rod '2': .* r\.rod or r\.spr"
    ):
        read_points(two_in_one[0], False, rod=2)
    with pytest.raises(FileError, match="has no frames"):
        read_points(two_in_one[0], False, frame=1)


def test_of_blocks_one_is_chosen_by_its_number(tmp_path):
    path = tmp_path / "t.txt"
    path.write_text(f"x y z\n{PLAIN}\n\n7 8 9\n1 2 4\n")
    assert read_points(path, False).breaks == [3]
    for rod, wanted in ((1, XYZ), (2, [[7, 8, 9], [1, 2, 4]])):
        found = read_points(path, False, rod=rod)
        assert np.array_equal(found.position, wanted)
        assert found.breaks == []
    with pytest.raises(FileError, match="has no block 3: rod is 1 to 2"):
        read_points(path, False, rod=3)


def test_triads_with_few_digits_are_made_orthonormal(tmp_path):
    rng = np.random.default_rng(4)
    triads = np.linalg.qr(rng.normal(size=(5, 3, 3)))[0]
    triads *= np.sign(np.linalg.det(triads))[:, None, None]
    path = tmp_path / "t.txt"
    for digits, note in ((16, False), (6, False), (3, True)):
        rows = np.c_[rng.normal(size=(5, 3)), triads.reshape(5, 9)]
        np.savetxt(path, rows, fmt=f"%.{digits}f")
        found, words = orthonormal(read_points(path, triads=True))
        assert abs(found @ found.transpose(0, 2, 1) - np.eye(3)).max() < 1e-14
        assert abs(found - triads).max() < 10.0 ** -min(digits, 14)
        assert (words is not None) == note


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda D: D[1].__imul__(1.1), "not an orthonormal triad: products of D1 D2 D3 are off"),
        (lambda D: D[1, 2].__imul__(-1), "D1 D2 D3 is left-handed"),
    ],
)
def test_which_triad_is_wrong_is_said(tmp_path, change, words):
    triads = np.repeat(np.eye(3)[None], 4, axis=0)
    change(triads)
    np.savetxt(tmp_path / "t.txt", np.c_[np.zeros((4, 3)), triads.reshape(4, 9)], header="rod")
    with pytest.raises(FileError, match=rf"point 1 \(line 3\): {words}"):
        orthonormal(read_points(tmp_path / "t.txt", triads=True))


@pytest.mark.parametrize("corner", ["s/t", "", "0"])
@pytest.mark.parametrize("sign", [",", "\t", " "])
def test_functions_of_s_and_t(tmp_path, corner, sign):
    path = tmp_path / "k.csv"
    rows = [[0.5, 1.0, 2.0, 3.0], [1.5, 4.0, 5.0, 6.0]]
    head = sign.join([corner, "0.0", "0.1", "0.25"])
    path.write_text(head + "\n" + written(rows, sign))
    samples = read_samples(path)
    assert samples.s.tolist() == [0.5, 1.5]
    assert samples.t.tolist() == [0.0, 0.1, 0.25]
    assert samples.values.tolist() == [[1, 2, 3], [4, 5, 6]]


def test_functions_of_s(tmp_path):
    path = tmp_path / "k.csv"
    path.write_text("s,kappa\n0,1\n0.5,2\n")
    assert read_samples(path).values.tolist() == [1, 2]
    path.write_text("s,k1,k2\n0,1,3\n0.5,2,4\n")
    assert read_samples(path, ["s", "k2"]).values.tolist() == [3, 4]
    for text, words in [
        ("s,k1,k2\n0,1,3\n0.5,2,4\n", "over s it has two"),
        ("s,k\n0,1\n0,2\n", "k.csv:3: s must increase"),
        ("0,0.2,0.1\n0,1,2\n1,2,3\n", "times in its first row must increase"),
    ]:
        path.write_text(text)
        with pytest.raises(FileError, match=words):
            read_samples(path)


def test_a_period_is_closed_once(tmp_path):
    path = tmp_path / "k.csv"
    path.write_text("0,0,0.1,0.2\n0,1,2,1\n1,3,4,3\n")
    samples = read_samples(path)
    assert close_period(samples, 0.2, path).t.tolist() == [0.0, 0.1]
    assert close_period(samples, 0.3, path).t.tolist() == [0.0, 0.1, 0.2]
    with pytest.raises(FileError, match=r"1\.33333 periods"):
        close_period(samples, 0.15, path)
    path.write_text("0,0,0.1,0.2\n0,1,2,1.5\n1,3,4,3\n")
    with pytest.raises(FileError, match=r"after one period of 0\.2 its values differ by 0.5 of 4"):
        close_period(read_samples(path), 0.2, path)


S, T = np.array([0.2, 0.5, 1.1]), np.array([0.0, 0.3])
THREE = np.array([[1.5, -0.2, 0.7], [1.3, 0.4, 0.9], [-2.0, 0.6, 0.8]])  # over s


def test_all_three_components_from_one_table_over_s(tmp_path):
    path = tmp_path / "k.csv"
    path.write_text("s,k1,k2,tau\n" + written(np.c_[S, THREE], ","))
    for i in range(3):
        samples = read_samples(path, component=i)
        assert samples.t is None
        assert np.array_equal(samples.s, S)
        assert np.array_equal(samples.values, THREE[:, i])
    assert np.array_equal(read_samples(path, ["s", "tau", "k1", "k2"], 0).values, THREE[:, 2])
    path.write_text(written(np.c_[S, S, THREE, S], ","))
    with pytest.raises(FileError, match="has 6 columns: all three components are four"):
        read_samples(path, component=0)
    assert np.array_equal(read_samples(path, [1, 3, 4, 5], 2).values, THREE[:, 2])


def test_all_three_components_from_one_table_over_s_and_t(tmp_path):
    """A row for each pair, in any order, blank lines between blocks or not."""
    path = tmp_path / "k.txt"
    rows = [[s, t, *(three * (1 + 2 * t))] for t in T for s, three in zip(S, THREE, strict=True)]
    path.write_text(written(rows[:3], " ") + "\n\n" + written(rows[3:][::-1], " "))
    for i in range(3):
        samples = read_samples(path, component=i)
        assert np.array_equal(samples.s, S)
        assert np.array_equal(samples.t, T)
        assert np.allclose(samples.values, THREE[:, i, None] * (1 + 2 * T), rtol=1e-15, atol=0)
    one = read_samples(path, [1, 2, 4])
    assert np.array_equal(one.values, read_samples(path, component=1).values)
    path.write_text(written(rows[:5], " "))
    with pytest.raises(FileError, match=r"has no row for s = 1\.1, t = 0\.3"):
        read_samples(path, component=0)
    path.write_text(written([*rows, rows[1]], " "))
    with pytest.raises(FileError, match=r"k\.txt:2: s = 0\.5, t = 0 is there 2 times"):
        read_samples(path, component=0)
    path.write_text(written(rows[:3], " "))
    with pytest.raises(FileError, match="has 3 s and 1 times"):
        read_samples(path, component=0)


READERS = (
    lambda path: read_points(path, False),
    lambda path: read_points(path, True),
    read_samples,
)


@pytest.mark.parametrize("seed", range(150))
def test_damaged_tables_are_read_or_refused(tmp_path, seed):
    """Any other error than a FileError, and any warning, is a failure."""
    text = mutated(list(WAYS.values())[seed % len(WAYS)], seed)
    for name in ("t.csv", "t.xyz", "t.vertex"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8", errors="surrogatepass")
        for read in READERS:
            with suppress(FileError), warnings.catch_warnings():
                warnings.simplefilter("error")
                read(path)


def test_large_files_take_memory_of_their_size(tmp_path):
    import tracemalloc

    path = tmp_path / "large.csv"
    with path.open("w") as stream:
        stream.writelines(f"{k * 0.001},{k * 0.5},{-k * 0.25}\n" for k in range(20_000))
    size = path.stat().st_size
    tracemalloc.start()
    points = read_points(path, triads=False)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(points.position) == 20_000
    assert peak < 20 * size  # rows as texts: about 90 bytes each beside their 25 of file
