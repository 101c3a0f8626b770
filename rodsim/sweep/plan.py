"""From ``--set`` lists and a table to runs, each with its folder and its own case file."""

from __future__ import annotations

import itertools
import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import yaml

from rodsim.case import load_case
from rodsim.case.inputs import input_entries
from rodsim.case.scalars import plain_scalar
from rodsim.case.words import shown
from rodsim.case.yaml_text import parse
from rodsim.errors import CaseError, FileError, UsageError
from rodsim.files import replacing
from rodsim.scene.inputs import digests
from rodsim.sweep.names import folder_name, value_text
from rodsim.sweep.table import read_table

MOST_RUNS = 10_000
OPTION = "--set"


@dataclass(frozen=True)
class Run:
    """One run: ``values`` are what the sweep sets, ``data`` is the whole resolved case.

    ``inputs`` : digests of the files that the case names. ``verb``, ``options`` : the command
    that does it.
    """

    folder: Path
    values: dict[str, Any]
    data: dict[str, Any]
    inputs: dict[str, dict[str, str]]
    verb: str = "run"
    options: tuple[str, ...] = ()

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

    @property
    def lock(self) -> Path:
        """The lock of whoever does this run."""
        return self.folder / "run.lock"

    def prepare(self) -> None:
        """Make the folder and its case file; raises FileError."""
        set_here = ", ".join(f"{key} = {value_text(v)}" for key, v in self.values.items())
        head = f"# One run of a sweep: {set_here or 'nothing set'}.\n"
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise FileError(f"{self.case}: cannot be written: {error.strerror}") from error
        with replacing(self.case) as temporary:
            temporary.write_text(head + _yaml(self.data), encoding="utf-8")


@dataclass(frozen=True)
class Plan:
    """All runs of a sweep, and the unit of each key they set (``""`` where it has none)."""

    runs: list[Run]
    key_units: dict[str, str]


def make_plan(case_path, settings, table, folder, numbered=False) -> Plan:
    """Return the runs that ``--set`` options and a table ask for; writes nothing.

    numbered : folders begin with the number of their run, and the same values may come again.
    Every row of the table meets every combination of the lists. Raises CaseError with all problems
    of all runs, UsageError for a sweep without runs, with too many, or with the same one twice.
    """
    fixed, axes = _axes(settings)
    rows = read_table(table) if table else [("", {})]
    in_table = {key for _, row in rows for key in row}
    if twice := sorted((set(axes) | _keys(fixed)) & in_table):
        raise UsageError(f"{twice[0]}: is set by --set and by {table}")
    if twice := sorted(set(axes) & _keys(fixed)):
        raise UsageError(f"--set {twice[0]}: has a value and a list of values")
    count = len(rows)
    for values in axes.values():
        count *= len(values)
    if not 0 < count <= MOST_RUNS:
        raise UsageError(f"the sweep would have {count} runs: must be 1 to {MOST_RUNS}")
    choices = [
        (where, row | dict(zip(axes, chosen, strict=True)))
        for (where, row), *chosen in itertools.product(rows, *axes.values())
    ]
    return _load(case_path, fixed, axes, choices, Path(folder).absolute(), numbered)


def _load(case_path, fixed, axes, choices, folder, numbered):
    """Load the case of every choice, all problems at once."""
    runs, units, problems, known = {}, {}, [], {}
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
        name, data = folder_name(values), _self_contained(case)
        name = f"{len(runs):03d}_{name}" if numbered else name
        if name in runs:
            raise UsageError(f"the sweep has the run {name} twice")
        runs[name] = Run(folder / name, values, data, digests(data, folder, known))
    if problems:
        raise CaseError(list(dict.fromkeys(problems)))
    return Plan(list(runs.values()), units)


def _keys(settings):
    return {text.partition("=")[0].strip() for text in settings}


def _at_row(problem, where, values):
    """Return a problem of an override at the row of the table it came from."""
    from_row = where and problem.where == OPTION and problem.key.startswith(tuple(values))
    return replace(problem, where=where) if from_row else problem


def _one_bracket(problem, axes):
    """Return a problem that tells of the second bracket, where a list's entries became runs."""
    values = axes.get(problem.key)
    wants_a_list = problem.reason.startswith("must be") and "a list of" in problem.reason
    if values is None or problem.where != OPTION or not wants_a_list:
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


def _self_contained(case):
    """Return the resolved case with files named so that they are found from any folder."""
    data = case.resolved()
    here = Path(case.source.path).parent
    for _, entry, name in list(input_entries(data)):
        entry[name] = str((here / entry[name]).resolve())
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
