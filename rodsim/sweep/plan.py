"""From ``--set`` lists and a table to runs, each with its folder and its own case file."""

from __future__ import annotations

import csv
import hashlib
import itertools
import json
import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import yaml

from rodsim.case import load_case
from rodsim.case.scalars import plain_scalar
from rodsim.case.words import shown
from rodsim.case.yaml_text import parse
from rodsim.errors import CaseError, FileError, Problem, UsageError

MOST_RUNS = 10_000
LONGEST_NAME = 120  # of a folder
OPTION = "--set"


@dataclass(frozen=True)
class Run:
    """One run: ``values`` are what the sweep sets, ``data`` is the whole resolved case."""

    folder: Path
    values: dict[str, Any]
    data: dict[str, Any]

    @property
    def name(self) -> str:
        """Name of the folder, made of the values."""
        return self.folder.name

    @property
    def case(self) -> Path:
        """The case file of this run alone."""
        return self.folder / "case.yaml"

    @property
    def output(self) -> Path:
        """The output file."""
        return self.folder / "out.h5"

    @property
    def log(self) -> Path:
        """What the command has said."""
        return self.folder / "run.log"

    def prepare(self) -> None:
        """Make the folder and its case file; raises FileError."""
        set_here = ", ".join(f"{key} = {_text(value)}" for key, value in self.values.items())
        head = f"# One run of a sweep: {set_here or 'nothing set'}.\n"
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            self.case.write_text(head + _yaml(self.data), encoding="utf-8")
        except OSError as error:
            raise FileError(f"{self.case}: cannot be written: {error.strerror}") from error


@dataclass(frozen=True)
class Plan:
    """All runs of a sweep, and the unit of each key they set (``""`` where it has none)."""

    runs: list[Run]
    key_units: dict[str, str]


def make_plan(case_path, settings, table, folder) -> Plan:
    """Return the runs that ``--set`` options and a table ask for; writes nothing.

    Every row of the table meets every combination of the lists. Raises CaseError with all problems
    of all runs, UsageError for a sweep without runs, with too many, or with the same one twice.
    """
    fixed, axes = _axes(settings)
    rows = _read_table(table) if table else [("", {})]
    if twice := sorted(set(axes) & {key for _, row in rows for key in row}):
        raise UsageError(f"{twice[0]}: is set by --set and by {table}")
    count = len(rows)
    for values in axes.values():
        count *= len(values)
    if not 0 < count <= MOST_RUNS:
        raise UsageError(f"the sweep would have {count} runs: must be 1 to {MOST_RUNS}")
    choices = [
        (where, row | dict(zip(axes, chosen, strict=True)))
        for (where, row), *chosen in itertools.product(rows, *axes.values())
    ]
    return _load(case_path, fixed, axes, choices, Path(folder).absolute())


def _load(case_path, fixed, axes, choices, folder):
    """Load the case of every choice, all problems at once."""
    runs, units, problems = {}, {}, []
    for where, values in choices:
        settings = [f"{key}={json.dumps(value)}" for key, value in values.items()]
        try:
            case = load_case(case_path, [*fixed, *settings])
        except CaseError as error:
            found = [_one_bracket(problem, axes) for problem in error.problems]
            problems += [_at_row(problem, where, values) for problem in found]
            continue
        units |= {key: case.source.unit(tuple(key.split("."))) for key in values}
        values = {key: case.source.number(key, value) for key, value in values.items()}
        name = _name(values)
        if name in runs:
            raise UsageError(f"the sweep has the run {name} twice")
        runs[name] = Run(folder / name, values, _self_contained(case))
    if problems:
        raise CaseError(list(dict.fromkeys(problems)))
    return Plan(list(runs.values()), units)


def _at_row(problem, where, values):
    """Return a problem of an override at the row of the table it came from."""
    from_row = where and problem.where == OPTION and problem.key.startswith(tuple(values))
    return replace(problem, where=where) if from_row else problem


def _one_bracket(problem, axes):
    """Return a problem that tells of the second bracket, where a list's entries became runs."""
    values = axes.get(problem.key)
    if values is None or problem.where != OPTION or not problem.reason.startswith("must be a list"):
        return problem
    advice = f"one run for each entry, and none is a list: write [{shown(values)}] for one value"
    return replace(problem, value=shown(values), reason=f"{advice} that is this list")


def _axes(settings):
    """Split ``--set`` options into those with one value and those with a list of them."""
    fixed, axes = [], {}
    for text in settings:
        key, _, value = text.partition("=")
        data = parse(value, lambda line: OPTION, (key.strip(),))[0] if value.strip() else None
        if not isinstance(data, list):
            fixed.append(text)
        elif key.strip() in axes:
            raise UsageError(f"--set {key.strip()}: has two lists of values")
        else:
            axes[key.strip()] = data
    return fixed, axes


def _read_table(path):
    """Return (file:line, values) of every row of a CSV file; an empty cell sets nothing."""
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "not UTF-8 text"
        raise CaseError([Problem(str(path), "", None, f"cannot read: {reason}")]) from None
    lines = [
        (f"{path}:{number}", next(csv.reader([line])))
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.startswith("#")
    ]
    if len(lines) < 2:
        raise UsageError(f"{path}: needs a line of keys and at least one of values")
    keys = [key.strip() for key in lines[0][1]]
    rows = []
    for where, cells in lines[1:]:
        if len(cells) != len(keys):
            reason = f"has {len(cells)} cells where the first line has {len(keys)} keys"
            raise CaseError([Problem(where, "", None, reason)])
        given = {key: cell for key, cell in zip(keys, cells, strict=True) if cell.strip()}
        parsed = {k: parse(c, lambda line, at=where: at, (k,))[0] for k, c in given.items()}
        rows.append((where, parsed))
    return rows


def _name(values):
    """Return the folder's name: ``b=0.5_sigma=400``, as readable as the values allow."""
    last = [key.rpartition(".")[2] for key in values]
    words = [
        f"{short if last.count(short) == 1 else key}={_text(value)}"
        for short, (key, value) in zip(last, values.items(), strict=True)
    ]
    name = "_".join(words) or "run"
    safe = re.sub(r"[^A-Za-z0-9.,=+_-]+", "-", name)[:LONGEST_NAME]
    if safe == name:
        return name
    return f"{safe}-{hashlib.sha256(name.encode()).hexdigest()[:8]}"


def _text(value):
    if isinstance(value, list):
        return ",".join(map(_text, value))
    return value if isinstance(value, str) else json.dumps(value)


def _self_contained(case):
    """Return the resolved case with files named so that they are found from any folder."""
    data = case.resolved()
    here = Path(case.source.path).parent
    for rod in data["rods"].values():
        if "path" in rod["shape"]:
            rod["shape"]["path"] = str((here / rod["shape"]["path"]).resolve())
    return data


class _Dumper(yaml.SafeDumper):
    """Quotes the texts that our reader, of YAML 1.2, would take for something else."""


def _quoted(dumper, text):
    style = None if plain_scalar(text) == text else '"'
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style=style)


_Dumper.add_representer(str, _quoted)


def _yaml(data):
    layout = {"sort_keys": False, "default_flow_style": None, "allow_unicode": True, "width": 100}
    return yaml.dump(data, Dumper=_Dumper, **layout)
