"""A list of parts as the compiled loop takes it."""

from __future__ import annotations

import numpy as np

from rodsim.compiled.kernels import address_of
from rodsim.compiled.parts import FORCE, PartList

ADDRESS, DRIVEN, ROW, ROW_END, FIXED, FIXED_END, ACCOUNT, IS_FLOW, GAUGES = range(9)  # columns


class Calls:
    """A list of parts as the compiled loop takes it: one row of ``table`` for each.

    ``numbers`` : all fixed numbers and steady rows; driven rows come by ``rows_at``.
    """

    def __init__(self, parts: PartList, counted=lambda part: part.works):
        """``counted``: tells which parts have an account of their own."""
        rows = {id(part.row): part.row for part in parts if part.row.driven}
        self._driven = list(rows.values())
        self.table = np.zeros((len(parts), 9), dtype=np.int64)
        blocks, places, self._fixed = [np.zeros(0)], _Places(), {}
        driven, given = _Places(), {}
        accounts = iter(range(len(parts)))
        for line, part in zip(self.table, parts, strict=True):
            line[ADDRESS], line[IS_FLOW] = address_of(part.kernel), part.side != FORCE
            if id(part.fixed) not in self._fixed:
                self._fixed[id(part.fixed)] = places.take(part.fixed.size)
                blocks.append(part.fixed)
            line[FIXED : FIXED_END + 1] = self._fixed[id(part.fixed)]
            line[GAUGES] = sum(gauge.count for gauge in part.gauges)
            line[DRIVEN] = part.row.driven
            if part.row.driven:
                if id(part.row) not in given:
                    given[id(part.row)] = driven.take(part.row.size)
                line[ROW : ROW_END + 1] = given[id(part.row)]
            else:
                line[ROW : ROW_END + 1] = places.take(part.row.size)
                blocks.append(part.row(0.0))
            line[ACCOUNT] = next(accounts) if counted(part) else -1
        self.numbers = np.concatenate(blocks)
        for part in parts:
            self.fixed(part)[: len(part.sums)] = [address_of(name) for name in part.sums]
        self._lasting = self.numbers
        self._prepared = [k for k, part in enumerate(parts) if part.prepare]
        self._parts = parts
        self._failed = {part.failed for part in parts if part.failed}
        self.accounts = int((self.table[:, ACCOUNT] >= 0).sum())

    def fixed(self, part) -> np.ndarray:
        """Return the fixed numbers of a part, a view: parts may leave something in theirs."""
        return self.numbers[slice(*self._fixed[id(part.fixed)])]

    @property
    def driven(self) -> bool:
        """Whether rows depend on time."""
        return bool(self._driven)

    @property
    def prepares(self) -> bool:
        """Whether any part has numbers that are made anew for each step."""
        return bool(self._prepared)

    def prepare(self, state, loads: np.ndarray) -> None:
        """Take the numbers that parts have for a step from ``state``, with its loads (6, N)."""
        blocks, begin = [self._lasting], self._lasting.size
        for k in self._prepared:
            block = self._parts[k].prepare(state, loads)
            self.table[k, FIXED : FIXED_END + 1] = begin, begin + block.size
            blocks.append(block)
            begin += block.size
        self.numbers = np.concatenate(blocks)

    def raise_failures(self) -> None:
        """Raise what has stopped a part in an evaluation: kernels cannot."""
        for failed in self._failed:
            failed()

    def rows_at(self, times: np.ndarray) -> np.ndarray:
        """Return the driven rows side by side (T, n) at the first T of the times; else (1, 0)."""
        if not self._driven:
            return NO_ROWS
        blocks = [row.at(times) for row in self._driven]
        fewest = min(map(len, blocks))
        return blocks[0] if len(blocks) == 1 else np.hstack([block[:fewest] for block in blocks])


class _Places:
    """Gives out places one after another."""

    def __init__(self):
        self.end = 0

    def take(self, count):
        begin, self.end = self.end, self.end + count
        return begin, self.end


NO_ROWS = np.zeros((1, 0))
