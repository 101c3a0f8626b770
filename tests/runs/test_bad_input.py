"""Broken case files and options: exit code 2, file:line, key and reason, and no output touched."""

import pytest
from calls import command

FLAGELLUM = """\
title: flagellum
units: {length: um, mass: g, time: s}
parameters: {k: 1.25, b: 0.5, sigma: 400}
fluid:
  viscosity: 1.3e-6
  epsilon: {spacings: 7}
  density: 1.0e-12
rods:
  tail:
    shape:
      kind: straight
      points: 60
      spacing: 0.0667
      origin: [0, 0, 0]
    moduli:
      bending: [3.5e-2, 3.6e-2]
      twisting: 3.5e-2
      shear: 0.8
      stretch: 0.9
    strain_twist: ["-k**2*b*sin(k*s + sigma*t)", 0, 0]
plane: yz
tracers:
  markers: {kind: tube, rod: tail, radius: 0.4, around: 8, along: 10}
time:
  end: 0.1
  tolerance: 1.0e-4
output:
  interval: 1.0e-3
  fields: [position]
"""
TAIL, SHAPE, TIME = "rods.tail", "rods.tail.shape", "time"
TWIST = f"{TAIL}.strain_twist"

# text to replace, its replacement, line, key and value shown, words of the reason
ONE_PROBLEM = [
    # numbers: type, range, unit
    ("viscosity: 1.3e-6", "viscosity: -1", 5, "fluid.viscosity = -1",
     "must be > 0 (g um^-1 s^-1)"),
    ("viscosity: 1.3e-6", "viscosity: 0", 5, "fluid.viscosity = 0", "must be > 0"),
    ("viscosity: 1.3e-6", "viscosity: thick", 5, "fluid.viscosity = thick", "must be a number"),
    ("viscosity: 1.3e-6", "viscosity: 1,3e-6", 5, "fluid.viscosity = 1,3e-6: a comma is only",
     "decimals have a point"),
    ("{spacings: 7}", "{spacings: 7,5}", 6, "fluid.epsilon", "is it a decimal comma?"),
    ("{spacings: 7}", "{spacings:7}", 6, "fluid.epsilon.spacings", "write 'spacings: 7'"),
    ("  end: 0.1\n", "  end:0.1\n", 26, "", "a blank must follow the colon in 'end:0.1'"),
    ("  end: 0.1\n  tolerance: 1.0e-4\n", "  end:0.1\n", 24, "time = end:0.1",
     "a blank must follow the colon: write 'end: 0.1'"),
    ("viscosity: 1.3e-6", "viscosity: 1.3e-6 g", 5, "fluid.viscosity = 1.3e-6 g", "'*'"),
    ("viscosity: 1.3e-6", "viscosity: -k", 5, "fluid.viscosity = -k (= -1.25)", "must be > 0 (g"),
    ("viscosity: 1.3e-6", "viscosity: k/0", 5, "fluid.viscosity = k/0 (= inf)", "must be finite"),
    ("viscosity: 1.3e-6", "viscosity: (-k)**b", 5, "fluid.viscosity = (-k)**b", "no number: 0/0"),
    ("viscosity: 1.3e-6", "viscosity: sgima", 5, "fluid.viscosity = sgima", "mean 'sigma'?"),
    ("viscosity: 1.3e-6", "viscosity: k*s", 5, "fluid.viscosity = k*s", "unknown name 's'"),
    ("viscosity: 1.3e-6", "viscosity: max(k, b", 5, "fluid.viscosity = max(k, b", "not closed"),
    ("sigma: 400", "sigma: k*c, c: 2*d, d: -sigma + b", 3, "parameters.sigma = k*c",
     "goes in a circle: sigma -> c -> d -> sigma"),
    ("sigma: 400", "sigma: sigma", 3, "parameters.sigma = sigma", "circle: sigma -> sigma"),
    ("sigma: 400", "sigma: 2*pi/T", 3, "parameters.sigma = 2*pi/T", "unknown name 'T'"),
    ("points: 60", "points: 4*k - 4", 12, f"{SHAPE}.points = 4*k - 4 (= 1)", "must be >= 2"),
    ("viscosity: 1.3e-6", "viscosity: yes", 5, "fluid.viscosity = yes", "must be a number"),
    ("viscosity: 1.3e-6", "viscosity: true", 5, "fluid.viscosity = true", "must be a number"),
    ("viscosity: 1.3e-6", "viscosity: .inf", 5, "fluid.viscosity = inf", "must be finite"),
    ("viscosity: 1.3e-6", "viscosity: .nan", 5, "fluid.viscosity = nan", "must be finite"),
    ("viscosity: 1.3e-6", "viscosity: 1e-320", 5, "fluid.viscosity", "between 1e-200 and 1e+200"),
    ("viscosity: 1.3e-6", "viscosity: [1]", 5, "fluid.viscosity = [1]", "must be a number"),
    ("viscosity: 1.3e-6", "viscosity:", 5, "fluid.viscosity", "missing: needs a number"),
    ("  viscosity: 1.3e-6\n", "", 4, "fluid.viscosity", "missing: needs a number"),
    ("density: 1.0e-12", "density: -2", 7, "fluid.density = -2", "must be > 0 (g um^-3)"),
    ("{spacings: 7}", "wide", 6, "fluid.epsilon = wide", "must be a number, a mapping with"),
    ("{spacings: 7}", "-0.3", 6, "fluid.epsilon = -0.3", "must be > 0 (um)"),
    ("{spacings: 7}", "{spacings: 0}", 6, "fluid.epsilon.spacings = 0", "must be > 0"),
    ("{spacings: 7}", "{}", 6, "fluid.epsilon.spacings", "missing: needs a number"),
    ("{length: um, mass: g", "{length: um2, mass: g", 2, "units.length = um2", "short name"),
    ("sigma: 400", "sigma: fast", 3, "parameters.sigma = fast", "must be a number"),
    ("title: flagellum", "title: 3", 1, "title = 3", "must be text: put it in quotes"),
    ("title: flagellum", "title: [a]", 1, "title = [a]", "must be text"),
    # shapes
    ("points: 60", "points: 1", 12, f"{SHAPE}.points = 1", "must be >= 2"),
    ("points: 60", "points: 60.0", 12, f"{SHAPE}.points = 60.0", "a whole number: write 60"),
    ("points: 60", "points: 60.5", 12, f"{SHAPE}.points = 60.5", "must be a whole number"),
    ("points: 60", "points: 20000000", 12, f"{SHAPE}.points = 20000000", "about 16 GB"),
    ("points: 60", "points: no", 12, f"{SHAPE}.points = no", "must be a whole number"),
    ("points: 60", "points: 001", 12, f"{SHAPE}.points = 1", "must be >= 2"),
    ("spacing: 0.0667", "spacing: 0", 13, f"{SHAPE}.spacing = 0", "must be > 0 (um)"),
    ("      spacing: 0.0667\n", "", 10, SHAPE, "give length or spacing"),
    ("spacing: 0.0667", "spacing: 0.0667\n      length: 4", 10, SHAPE, "not both"),
    ("origin: [0, 0, 0]", "origin: [0, 0]", 14, f"{SHAPE}.origin = [0, 0]", "list of 3 numbers"),
    ("origin: [0, 0, 0]", "origin: [0, 0, x]", 14, f"{SHAPE}.origin.2 = x", "a number (um)"),
    ("origin: [0, 0, 0]", "origin: 3", 14, f"{SHAPE}.origin = 3", "list of 3 numbers"),
    ("origin: [0, 0, 0]", "rotate: {axis: [0, 0, 0], degrees: 3}", 14,
     f"{SHAPE}.rotate.axis = [0, 0, 0]", "null vector"),
    ("origin: [0, 0, 0]", "rotate: {axis: [1, 0, 0]}", 14, f"{SHAPE}.rotate.degrees", "missing"),
    ("kind: straight", "kind: strait", 11, f"{SHAPE}.kind = strait", "did you mean 'straight'?"),
    ("kind: straight", "kind: circle", 11, f"{SHAPE}.kind = circle", "did you mean 'ring'?"),
    ("kind: straight", "kind: 3", 11, f"{SHAPE}.kind = 3",
     "must be one of straight, ring, helix, sine, file"),
    ("      kind: straight\n", "", 10, f"{SHAPE}.kind", "missing: must be one of straight"),
    # moduli
    ("twisting: 3.5e-2", "twisting: 0", 17, f"{TAIL}.moduli.twisting = 0",
     "must be > 0 (g um^3 s^-2)"),
    ("shear: 0.8", "shear: -1", 18, f"{TAIL}.moduli.shear = -1", "must be > 0 (g um s^-2)"),
    ("[3.5e-2, 3.6e-2]", "[3.5e-2]", 16, f"{TAIL}.moduli.bending", "list of 2 numbers"),
    ("[3.5e-2, 3.6e-2]", "[1, 2, 3]", 16, f"{TAIL}.moduli.bending", "list of 2 numbers"),
    ("[3.5e-2, 3.6e-2]", "[1, -2]", 16, f"{TAIL}.moduli.bending.1 = -2", "must be > 0"),
    ("[3.5e-2, 3.6e-2]", "{a1: 1}", 16, f"{TAIL}.moduli.bending = {{a1: 1}}", "must be a number"),
    ("      stretch: 0.9\n", "", 15, f"{TAIL}.moduli.stretch", "missing: needs a number"),
    # strain twist
    ("sigma*t", "sgima*t", 20, f"{TWIST}.0 =", "unknown name 'sgima': did you mean 'sigma'?"),
    ("k**2", "k^2", 20, f"{TWIST}.0 =", "use ** for powers, not ^"),
    ("sin(k", "snn(k", 20, f"{TWIST}.0 =", "unknown function 'snn'"),
    ("sin(k", "np.sin(k", 20, f"{TWIST}.0 =", "write sin(...), without 'np.'"),
    ("-k**2*b*sin(k*s + sigma*t)", "s.__class__", 20, f"{TWIST}.0 =", "attribute access"),
    ("-k**2*b*sin(k*s + sigma*t)", "__import__(s)", 20, f"{TWIST}.0 =", "unknown function"),
    ("-k**2*b*sin(k*s + sigma*t)", "lambda: 0", 20, f"{TWIST}.0 =", "not allowed"),
    ("-k**2*b*sin(k*s + sigma*t)", "[x for x in s]", 20, f"{TWIST}.0 =", "not allowed"),
    ("-k**2*b*sin(k*s + sigma*t)", "9**9**9**9", 20, f"{TWIST}.0 =", "not finite"),
    ("-k**2*b*sin(k*s + sigma*t)", "1/(t - t)", 20, f"{TWIST}.0 =", "not finite at s = 0.0333"),
    ("-k**2*b*sin(k*s + sigma*t)", "-" * 900 + "1", 20, f"{TWIST}.0 =", "nested deeper"),
    ("-k**2*b*sin(k*s + sigma*t)", "(" * 100_000, 20, f"{TWIST}.0 =", "at most 20000"),
    ("-k**2*b*sin(k*s + sigma*t)", "40*cos(s)", 20, TWIST, "no rest state"),
    (", 0, 0]\nplane", ", 0]\nplane", 20, TWIST, "or a list of 3 numbers, expressions"),
    (", 0, 0]\nplane", ", 0, true]\nplane", 20, f"{TWIST}.2 = true",
     "must be a number, an expression or a mapping with table"),
    (", 0, 0]\nplane", ", 0, 0.1]\nplane", 20, f"{TWIST}.2 = 0.1", "where plane is yz"),
    (", 0, 0]\nplane", ", '0*s', 0]\nplane", 20, f"{TWIST}.1 = 0*s", "must be the number 0"),
    # names and unknown keys
    ("viscosity:", "density: 3\n  viscosity:", 8, "fluid.density", "duplicate key"),
    ("title:", "titel:", 1, "titel", "unknown key: did you mean 'title'?"),
    ("origin:", "orgin:", 14, f"{SHAPE}.orgin", "unknown key: did you mean 'origin'?"),
    ("origin: [0, 0, 0]", "radius: 3", 14, f"{SHAPE}.radius", "unknown key: allowed are"),
    ("  tolerance:", "  tolerence:", 26, "time.tolerence", "did you mean 'tolerance'?"),
    ("sigma: 400", "sigma: 400, 1k: 3", 3, "parameters.1k", "letters, digits and _"),
    ("sigma: 400", "sigma: 400, s: 3", 3, "parameters.s", "already has a meaning"),
    ("sigma: 400", "sigma: 400, lambda: 3", 3, "parameters.lambda", "choose another name"),
    # plane, tracers
    ("plane: yz", "plane: xy", 21, "plane = xy", "must be yz"),
    ("rod: tail", "rod: tial", 23, "tracers.markers.rod = tial", "did you mean 'tail'?"),
    ("around: 8", "around: 0", 23, "tracers.markers.around = 0", "must be >= 1"),
    ("{kind: tube, rod: tail, radius: 0.4, around: 8, along: 10}", "[]", 23,
     "tracers.markers = []", "must not be empty"),
    ("{kind: tube, rod: tail, radius: 0.4, around: 8, along: 10}", "[[0, 0, 1], [0, 1]]", 23,
     "tracers.markers.1 = [0, 1]", "list of 3 numbers"),
    # time, output
    ("end: 0.1", "end: 0", 25, "time.end = 0", "must be > 0 (s)"),
    ("  end: 0.1\n", "", 24, "time.end", "missing: needs a number (s)"),
    ("tolerance: 1.0e-4", "tolerance: 1", 26, "time.tolerance = 1", "must be < 1"),
    ("tolerance: 1.0e-4", "tolerance: 1e-14", 26, "time.tolerance = 1e-14", "must be >= 1e-13"),
    ("tolerance: 1.0e-4", "integrator: rk5", 26, "time.integrator = rk5",
     "must be one of rkc, rk4, euler: did you mean 'rk"),
    ("tolerance: 1.0e-4", "integrator: euler", 24, "time.step", "missing: euler needs"),
    ("tolerance: 1.0e-4", "step: 0", 26, "time.step = 0", "must be > 0 (s)"),
    ("tolerance: 1.0e-4", "integrator: rk4\n  step: 2e-3", 29, "output.interval = 0.001",
     "whole multiple of time.step = 0.002"),
    ("interval: 1.0e-3", "interval: 0", 28, "output.interval = 0", "must be > 0 (s)"),
    ("interval: 1.0e-3", "interval: 1e-9", 28, "output.interval = 1e-09", "would write 1e+08"),
    ("[position]", "[velocity]", 29, "output.fields = [velocity]", "must include position"),
    ("[position]", "[position, position]", 29, "output.fields", "more than once"),
    ("[position]", "[position, velocty]", 29, "output.fields.1 = velocty",
     "did you mean 'velocity'?"),
    # whole sections
    ("plane: yz", "plane: yz\nextra: {a: 1}", 22, "extra", "unknown key"),
    ("title: flagellum", "title: flagellum\ntitle: again", 2, "title", "duplicate key"),
    # YAML
    ("plane: yz", "plane: *here", 21, "", "aliases (*here) are not supported"),
    ("plane: yz", "plane: &here yz", 21, "", "anchors (&here) are not supported"),
    ("plane: yz", "<<: {plane: yz}", 21, "", "merge keys"),
    ("plane: yz", "plane: !!python/name:os.system yz", 21, "", "tags"),
    ("plane: yz", "3: yz", 21, "", "the key 3 must be text"),
    ("plane: yz", "---\nplane: yz", 21, "", "a second document"),
    ("  mar", "\tmar", 23, "", "indent with spaces, not tabs"),
    ("plane: yz", "plane: y: z", 21, "", "a ':' too many"),
    ("plane: yz", "plane: '\x00'", 21, "", "U+0000"),
    ("[position]", "[" * 100_000, 29, "output.fields", "nested deeper than 30"),
]  # fmt: skip


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Run ``rodsim run bad.yaml -o out.h5`` in a folder where out.h5 is someone's earlier work."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "out.h5").write_bytes(b"earlier work")

    def invoke(case, *options):
        (tmp_path / "bad.yaml").write_bytes(case if isinstance(case, bytes) else case.encode())
        result = command("run", "bad.yaml", "-o", "out.h5", *options, code=2)
        assert "Traceback" not in result.output
        assert result.stdout == ""
        assert sorted(p.name for p in tmp_path.iterdir()) == ["bad.yaml", "out.h5"]
        assert (tmp_path / "out.h5").read_bytes() == b"earlier work"
        return result.stderr.splitlines()

    return invoke


@pytest.mark.parametrize(
    ("old", "new", "line", "subject", "words"),
    ONE_PROBLEM,
    ids=[f"{row[2]}-{row[3][:40]}-{row[4][:30]}" for row in ONE_PROBLEM],
)
def test_one_problem(run, old, new, line, subject, words):
    assert FLAGELLUM.count(old) == 1
    (message,) = run(FLAGELLUM.replace(old, new))
    assert message.startswith(f"bad.yaml:{line}: {subject}")
    assert words in message


def test_all_problems_at_once_in_the_order_of_lines(run):
    case = FLAGELLUM
    for old, new in [
        ("viscosity: 1.3e-6", "viscosity: 010x"),
        ("points: 60", "points: 1"),
        ("twisting:", "twsting:"),
        ("sigma*t", "sigma*q"),
        ("rod: tail", "rod: head"),
        ("end: 0.1", "end: -0.1"),
        ("[position]", "[director]"),
    ]:
        case = case.replace(old, new)
    places = [message.split(" ")[0:2] for message in run(case, "--set", "fluid.blob=round")]
    assert places == [
        ["--set:", "fluid.blob"],
        ["bad.yaml:5:", "fluid.viscosity"],
        ["bad.yaml:12:", "rods.tail.shape.points"],
        ["bad.yaml:15:", "rods.tail.moduli.twisting:"],
        ["bad.yaml:17:", "rods.tail.moduli.twsting:"],
        ["bad.yaml:20:", "rods.tail.strain_twist.0"],
        ["bad.yaml:23:", "tracers.markers.rod"],
        ["bad.yaml:25:", "time.end"],
        ["bad.yaml:29:", "output.fields"],
    ]


def test_a_duplicate_key_hides_nothing(run):
    case = FLAGELLUM.replace("density: 1.0e-12", "viscosity: 2e-6").replace("end: 0.1", "end: -1")
    assert run(case) == [
        "bad.yaml:7: fluid.viscosity: duplicate key: first given at bad.yaml:5",
        "bad.yaml:25: time.end = -1: must be > 0 (s)",
    ]


def test_a_blank_that_is_missing_hides_nothing(run):
    case = FLAGELLUM.replace("{spacings: 7}", "{spacings:7}").replace("end: 0.1", "end: -1")
    first, second = run(case)
    assert first.startswith("bad.yaml:6: fluid.epsilon.spacings: a blank must follow")
    assert second.startswith("bad.yaml:25: time.end = -1")


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("", "missing: the name of the rod, a line 'NAME:' between rods and shape, moduli and "
         "strain_twist"),
        ("  -\n", "must be a mapping of names, not a list: write 'NAME:' instead of each '-'"),
    ],
)  # fmt: skip
def test_a_forgotten_name_of_a_rod_is_said_once(run, name, reason):
    case = FLAGELLUM.replace("  tail:\n", name).replace("end: 0.1", "end: -1")
    line = 25 if name else 24
    assert run(case) == [
        f"bad.yaml:8: rods: {reason}", f"bad.yaml:{line}: time.end = -1: must be > 0 (s)"
    ]  # fmt: skip


def test_rods_may_be_called_as_their_own_keys(run):
    case = FLAGELLUM.replace("  tail:", "  shape:").replace("rod: tail", "rod: shape")
    assert run(case.replace("points: 60", "points: 1")) == [
        "bad.yaml:12: rods.shape.shape.points = 1: must be >= 2"
    ]


def test_a_bad_rod_does_not_hide_what_is_wrong_with_another(run):
    other = """\
  bent:
    shape: {kind: ring, radius: 2.5, points: 20}
    moduli: {bending: 1, twisting: 1, shear: 1, stretch: 1}
    strain_twist: [3, 0, 0]
"""
    case = FLAGELLUM.replace("plane: yz\n", other).replace("points: 60", "points: -60")
    first, second = run(case)
    assert first.startswith("bad.yaml:12: rods.tail.shape.points = -60")
    assert second.startswith("bad.yaml:24: rods.bent.strain_twist")
    assert "abs(Omega) ds = 2.356" in second


def test_a_rod_name_that_cannot_be_used(run):
    name, tracer = run(FLAGELLUM.replace("  tail:", "  tail-1:"))
    assert name.startswith("bad.yaml:9: rods.tail-1: a name is made of letters, digits and _")
    assert tracer.startswith("bad.yaml:23: tracers.markers.rod = tail: no such rod")


def test_end_and_interval_must_fall_on_steps(run):
    fixed = "integrator: rk4\n  step: 3e-4"
    end, interval = run(FLAGELLUM.replace("tolerance: 1.0e-4", fixed))
    words = "must be a whole multiple of time.step = 0.0003 for rk4: try"
    assert end == f"bad.yaml:25: time.end = 0.1 (s): {words} 0.0999"
    assert interval == f"bad.yaml:29: output.interval = 0.001 (s): {words} 0.0009"


def test_spacings_that_differ(run):
    other = """\
  short:
    shape: {kind: straight, points: 20, spacing: 0.05}
    moduli: {bending: 1, twisting: 1, shear: 1, stretch: 1}
"""
    (message,) = run(FLAGELLUM.replace("plane: yz\n", other))
    assert message.startswith("bad.yaml:6: fluid.epsilon = {spacings: 7}: ")
    assert "(tail 0.0667, short 0.05): give epsilon as a length" in message


def test_a_bad_parameter_is_reported_once(run):
    (message,) = run(FLAGELLUM.replace("sigma: 400", "sigma: x"))
    assert message.startswith("bad.yaml:3: parameters.sigma = x")


@pytest.mark.parametrize(
    ("case", "start", "words"),
    [
        (b"", "bad.yaml: ", "the file is empty"),
        (b"# nothing yet\n", "bad.yaml: ", "the file is empty"),
        (b"just text", "bad.yaml:1: ", "has no keys"),
        (b"- a\n- b", "bad.yaml:1: ", "has no keys"),
        (b"title: x\nfluid: \xff\n", "bad.yaml:2: ", "not UTF-8"),
        (b"\x89HDF\r\n\x1a\n", "bad.yaml: ",
         "is an output, not a case: go on with rodsim resume bad.yaml, or see rodsim info bad"),
        (b"#" * 1_000_001, "bad.yaml: ", "larger than 1000000 bytes"),
        (b"[" * 900_000, "bad.yaml:1: ", "nested deeper"),
        (b"a: [" + b"*a, " * 100, "bad.yaml:1: ", "aliases"),
    ],
)  # fmt: skip
def test_not_a_case_at_all(run, case, start, words):
    message = run(case)[0]
    assert message.startswith(start)
    assert words in message


def test_missing_sections(run):
    messages = run("title: x\n")
    assert [message.split(":")[2].strip() for message in messages] == ["fluid", "rods", "time"]
    assert all(message.startswith("bad.yaml:1: ") for message in messages)


def test_no_rods(run):
    case = FLAGELLUM[: FLAGELLUM.index("  tail:")] + "  {}\ntime: {end: 1}\n"
    (message,) = run(case)
    assert message == "bad.yaml:8: rods = {}: must not be empty"


def test_thousands_of_problems_are_cut_short(run):
    many = "".join(f"  m{i}: 1\n" for i in range(5000))
    messages = run(FLAGELLUM.replace("tracers:\n", "tracers:\n" + many))
    assert len(messages) <= 101
    assert messages[0].startswith("bad.yaml:23: tracers.m0 = 1: must be")


@pytest.mark.parametrize(
    ("options", "start", "words"),
    [
        (["--set", "time.end=x"], "--set: time.end = x: ", "must be a number (s)"),
        (["--set", "time.edn=1"], "--set: time.edn: ", "did you mean 'end'?"),
        (["--set", "time.end"], "--set: time.end: ", "key=value"),
        (["--set", "rods.tial.shape.points=3"], "--set: rods.tial", "did you mean 'tail'?"),
        (["--set", "rods.tail.shape.points=1"], "--set: rods.tail.shape.points = 1: ", ">= 2"),
        (["--set", "rods.new={}"], "--set: rods.new: ", "rods has no 'new'"),
        (["--set", "rods.tail.strain_twist.7=1"], "--set: rods.tail", "entries 0 to 2"),
        (["--set", "rods.tail.strain_twist.0=exec(s)"], "--set: rods.tail", "unknown function"),
        (["--set", "time.end=[1"], "--set: time.end: ", "not valid YAML"),
        (["--set", "fluid=null"], "--set: fluid: ", "missing"),
        (["--set", "end=1"], "--set: end: ", "did you mean 'rods.tail.end' or 'time.end'?"),
        (["--set", "shape.points=9"], "--set: shape.points: ", "'rods.tail.shape.points'?"),
        (
            ["--set", "time.end=[1, 2]"],
            "--set: time.end = [1, 2]: ",
            "rodsim sweep runs over a list",
        ),
    ],
)
def test_bad_overrides(run, options, start, words):
    message = run(FLAGELLUM, *options)[0]
    assert message.startswith(start)
    assert words in message


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--threads", "0"], "--threads"),
        (["--threads", "-2"], "--threads"),
        (["--threads", "x"], "--threads"),
        (["--threads", "1.5"], "--threads"),
        (["--colour"], "No such option"),
        (["--set"], "requires an argument"),
        (["-o"], "requires an argument"),
        (["-o", "."], "directory"),
        (["other.yaml"], "unexpected extra argument"),
    ],
)
def test_bad_options(run, options, words):
    assert words in "\n".join(run(FLAGELLUM, *options))


@pytest.mark.parametrize(
    ("name", "words"),
    [("nowhere.yaml", "cannot read: No such file"), (".", "cannot read: Is a directory")],
)
def test_unreadable_case(tmp_path, monkeypatch, name, words):
    monkeypatch.chdir(tmp_path)
    result = command("run", name, "-o", "out.h5", code=2)
    assert result.stderr == f"{name}: {words}" + result.stderr.partition(words)[2]
    assert result.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_validate_reports_every_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.yaml").write_text(FLAGELLUM.replace("end: 0.1", "end: x"))
    (tmp_path / "b.yaml").write_text(FLAGELLUM)
    (tmp_path / "c.yaml").write_text(FLAGELLUM.replace("blob", "").replace("plane: yz", "plan: yz"))
    result = command("validate", "a.yaml", "b.yaml", "c.yaml", code=2)
    assert [line.split(" ")[0] for line in result.stderr.splitlines()] == [
        "a.yaml:25:", "c.yaml:21:"
    ]  # fmt: skip
    assert result.stdout == "b.yaml: valid\n"
