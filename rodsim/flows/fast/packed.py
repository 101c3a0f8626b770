"""All tables of a fast sum as one array of numbers, as a part takes them (``Part.fixed``).

First the numbers epsilon, viscosity, what a force and a torque add at their own point, the height
of the wall, the addresses of the exact sum and its runs, then where each table begins and how many
entries it has, then the tables. Those of integers have two in the room of one float64.
"""

import numpy as np

from rodsim.compiled.flags import unsigned

EPSILON, VISCOSITY, OWN_FORCE, OWN_TORQUE, WALL, SUM, RUN, HEAD = range(8)
(
    NODES, SLOTS, WEIGHTS, CHUNKS, TOPS,  # the arcs, see Arcs
    FAR_BEGINS, FAR, NEAR_BEGINS, NEAR,  # who is far from, or near to, each arc or group of targets
    FAR_WORK, FAR_SHARES, NEAR_WORK, NEAR_SHARES,  # arcs or groups, and runs of about equal work
    SAMPLE, SAMPLE_FAR, _, SAMPLE_NEAR, _,  # where the error is measured, and what that needs
    TARGETS, GROUPS,  # targets that are no sources: in their order, and where each group begins
    HELD,  # points at which the sums are exact
    TABLES,
) = range(22)  # fmt: skip


def pack(numbers, tables: dict) -> np.ndarray:
    """Return numbers and tables as one array; a table that is not given is empty."""
    head = np.zeros(HEAD + 2 * TABLES)
    head[: len(numbers)] = numbers
    blocks, begin = [head], head.size
    for which in range(TABLES):
        table = np.ravel(tables.get(which, ()))
        block = table if which == WEIGHTS else _as_floats(table)
        head[HEAD + 2 * which :][:2] = begin, table.size
        blocks.append(block)
        begin += block.size
    return np.concatenate(blocks)


def _as_floats(table):
    even = np.zeros(table.size + table.size % 2, dtype=np.int32)
    even[: table.size] = table
    return even.view(np.float64)


@unsigned
def integers(fixed, which):
    """Return a table of integers."""
    begin, count = int(fixed[HEAD + 2 * which]), int(fixed[HEAD + 2 * which + 1])
    return fixed[begin : begin + (count + 1) // 2].view(np.int32)[:count]


@unsigned
def rows(fixed, which, width):
    """Return a table of integers in rows."""
    table = integers(fixed, which)
    return table.reshape((table.size // width, width))


@unsigned
def floats(fixed, which):
    """Return a table of floats."""
    begin, count = int(fixed[HEAD + 2 * which]), int(fixed[HEAD + 2 * which + 1])
    return fixed[begin : begin + count]


@unsigned
def work(fixed, which):
    """Return the arcs or groups to work on, and where the share of each turn begins."""
    return integers(fixed, which), integers(fixed, which + 1)
