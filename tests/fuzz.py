"""Damage for texts and files: each is made from a seed, so that a failure can be seen again."""

import random
import re

NASTY = (
    "0", "-0", "-1", "1", "2", "3", "0.5", "-1e-300", "1e-300", "1e300", "-1e300", "1e308", "1e400",
    ".inf", "-.inf", ".nan", "1e12", "1000000000000", "9007199254740993", "1e-12", "0x10", "010",
    "1_000", "12e", "1e-3", "null", "~", "true", "no", "''", '"x"', "[]", "{}", "[1]", "[1, 2, 3]",
    "{a: 1}", "[[0, 0, 1]]", "*a", "&a 1", "!!float 1", "<<", "../x", "'../x'", "/etc/passwd",
    "'\\0'", '"\\0"', '"\\x1b[31m"', "\u202e", "écoute", "\U0001f40d", "s", "t", "sin(s)",
    "exp(9999*s)", "1/(s-s)", "log(t)", "where(s < 2, 1, 0)", "9**9**9", "open", "ring", "straight",
    "helix", "sine", "file", "euler", "rk4", "rkc", "yz", "algebraic9", "{spacings: 3}", "- 1",
    "k", "2*pi/k", "i", "k*i - sigma", "period", "3*period", "left", "right", "{like: left}",
    "{like: right, repeat: 3}", "{phi: pi}", "{i: 2}", "{k: k}", "{period: sigma, sigma: period}",
    "{radius: 0.1}", "{young: 1e3, radius: 0.2}", "{force: pN}", "{force: pN, mass: g}", "Å",
    "2*points", "600/3", "where(i < 2, 3, 4)", "arctan2(1, 2)", "(" * 200, "1" + "+1" * 300, "i*d",
    "{table: x.csv, columns: [s, t, k1, k2, k3]}", "{table: x.csv, period: 1}",
    "{kind: file, path: x.vertex, rod: 2, spacing: 0.1}", "curve", "natural",
    "natural_1", "{table: x.csv}", "{kind: curve, path: x.csv}",
    ": :", "# x", "|", ">",
)  # fmt: skip
_TOKEN = re.compile(r"[\w.+\-]+|\S")


def mutated(text, seed):
    """Return the text with one to four mutations."""
    rng = random.Random(seed)
    for _ in range(rng.choice((1, 1, 1, 2, 3, 4))):
        text = rng.choice(_MUTATIONS)(text, rng)
    return text


def _span(text, rng, pattern=_TOKEN):
    found = [match.span() for match in pattern.finditer(text)]
    return rng.choice(found) if found else (0, 0)


def _another_value(text, rng):
    """Put something nasty after a colon, or in a list: most of these parse as YAML."""
    begin, end = _span(text, rng, re.compile(r"(?<=[:,\[] )[\w.+\-]+"))
    return text[:begin] + rng.choice(NASTY) + text[end:]


def _another_token(text, rng):
    begin, end = _span(text, rng)
    return text[:begin] + rng.choice(NASTY) + text[end:]


def _another_number(text, rng):
    begin, end = _span(text, rng, re.compile(r"(?<![\w.])\d[\d.]*(?:e-?\d+)?"))
    number = rng.choice((-1, 1, 1, 1)) * 10 ** rng.uniform(-9, 9)
    written = f"{number:.3g}" if rng.random() < 0.5 else str(round(number))
    return text[:begin] + written + text[end:]


def _flip(text, rng):
    at = rng.randrange(len(text) + 1)
    return text[:at] + chr(rng.choice((rng.randrange(128), rng.randrange(0x300)))) + text[at + 1 :]


def _lines(text, rng):
    """Remove, repeat, move or indent a line."""
    lines = text.splitlines(keepends=True)
    if not lines:
        return text
    line = lines.pop(rng.randrange(len(lines)))
    where = rng.randrange(len(lines) + 1)
    kind = rng.randrange(4)
    if kind:
        lines.insert(where, ("", line, "  " + line, line * 2)[kind])
    return "".join(lines)


def _splice(text, rng):
    begin, other = sorted(rng.randrange(len(text) + 1) for _ in range(2))
    return text[:begin] + text[other:] if rng.random() < 0.5 else text[:other] + text[begin:]


_MUTATIONS = (
    (_another_value,) * 4 + (_another_number,) * 4 + (_another_token, _flip, _lines, _splice)
)


_BLOCKS = re.compile(rb"\x89HDF|TREE|SNOD|HEAP|GCOL|\x01\x00.\x00\x01\x00\x00\x00", re.DOTALL)


def damaged(data, seed):
    """Return bytes with damage of one kind: flips, noise, zeros, a part lost, moved or cut off."""
    rng, data = random.Random(seed), bytearray(data)
    kind = rng.randrange(7)
    size = rng.choice((1, 2, 8, 64, 512, 4096))
    # half of the damage goes where the structure is: near the words HDF5 marks its blocks with
    marks = [
        m.start()
        for m in re.finditer(rb"\x89HDF|TREE|SNOD|HEAP|GCOL|\x01\x00.\x00\x01\x00\x00\x00", data)
    ]
    at = rng.randrange(len(data))
    if rng.random() < 0.6:
        at = min(len(data) - 1, rng.choice(marks) + int(rng.expovariate(1 / 60)))
    if kind <= 1:
        for _ in range(rng.choice((1, 1, 3, 30))):
            spot = min(len(data) - 1, at + rng.randrange(size))
            data[spot] ^= 1 << rng.randrange(8)
    elif kind == 2:
        data[at : at + size] = rng.randbytes(min(size, len(data) - at))
    elif kind == 3:
        data[at : at + size] = rng.choice((b"\x00", b"\xff")) * min(size, len(data) - at)
    elif kind == 4:
        del data[at : at + size]
    elif kind == 5:
        other = rng.randrange(len(data))
        data[at : at + size] = data[other : other + min(size, len(data) - at)]
    else:
        del data[at:]
    return bytes(data)
