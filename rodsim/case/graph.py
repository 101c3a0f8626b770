"""A formula as a list of operations, each after those it needs; nothing here is recursive.

Equal operations are the same node, so a term that is written twice is computed once. Operations on
constants are worked out when they are added: what parameters say costs nothing later.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from rodsim.case.functions import OPERATIONS


@dataclass(frozen=True)
class Node:
    """An operation on earlier nodes, a constant (``value``) or a name: one of these three."""

    operation: str = ""
    arguments: tuple[int, ...] = ()
    name: str = ""
    value: np.float64 | None = None


@dataclass
class Graph:
    """Nodes in an order in which they can be computed."""

    nodes: list[Node] = field(default_factory=list)
    _known: dict[tuple, int] = field(default_factory=dict)

    def constant(self, value: float) -> int:
        """Return the node of a number."""
        value = np.float64(value)
        return self._add(("constant", value.tobytes()), Node(value=value))

    def name(self, name: str) -> int:
        """Return the node of a variable."""
        return self._add(("name", name), Node(name=name))

    def apply(self, operation: str, *arguments: int) -> int:
        """Return the node of an operation; a constant where all its arguments are constants."""
        values = [self.nodes[argument].value for argument in arguments]
        if all(value is not None for value in values):
            with np.errstate(all="ignore"):
                return self.constant(OPERATIONS[operation](*values))
        return self._add((operation, *arguments), Node(operation, arguments))

    def value(self, node: int) -> np.float64 | None:
        """Return the number a node stands for, or None where it depends on a variable."""
        return self.nodes[node].value

    def absorb(self, other: Graph, root: int) -> int:
        """Return the node that stands here for one of another graph, with all that it needs."""
        new = {}
        for index in needed(other.nodes, root):
            node = other.nodes[index]
            if node.value is not None:
                new[index] = self.constant(node.value)
            elif node.operation:
                new[index] = self.apply(node.operation, *(new[a] for a in node.arguments))
            else:
                new[index] = self.name(node.name)
        return new[root]

    def copy(self) -> Graph:
        """Return a graph of its own with the same nodes."""
        return Graph(list(self.nodes), dict(self._known))

    def _add(self, key: tuple, node: Node) -> int:
        if key not in self._known:
            self._known[key] = len(self.nodes)
            self.nodes.append(node)
        return self._known[key]


def needed(nodes: list[Node], root: int) -> list[int]:
    """Return the nodes that ``root`` depends on, itself the last, in an order to compute them."""
    wanted = {root}
    for index in range(root, -1, -1):
        if index in wanted:
            wanted.update(nodes[index].arguments)
    return sorted(wanted)


class Program:
    """One node of a graph made ready to be computed for arrays of its variables."""

    def __init__(self, graph: Graph, root: int):
        order = needed(graph.nodes, root)
        place = {index: position for position, index in enumerate(order)}
        chosen = [graph.nodes[index] for index in order]
        last_use = {a: place[i] for i in order for a in graph.nodes[i].arguments}
        self.names = [(place[i], node.name) for i, node in zip(order, chosen, strict=True)
                      if node.name]  # fmt: skip
        self._constants = [node.value for node in chosen]
        self._steps = [
            (place[i], OPERATIONS[node.operation], tuple(place[a] for a in node.arguments),
             [place[a] for a in dict.fromkeys(node.arguments)
              if last_use[a] == place[i] and graph.nodes[a].value is None])
            for i, node in zip(order, chosen, strict=True) if node.operation
        ]  # fmt: skip

    def __call__(self, values: Mapping[str, np.ndarray]) -> np.ndarray | np.float64:
        """Return the value at arrays of the variables; inf and nan without a warning.

        An intermediate array is given back as soon as its last use is done.
        """
        work = list(self._constants)
        for place, name in self.names:
            work[place] = values[name]
        with np.errstate(all="ignore"):
            for place, compute, arguments, done in self._steps:
                work[place] = compute(*[work[argument] for argument in arguments])
                for argument in done:
                    work[argument] = None
        return work[-1]


def bound(nodes: Iterable[Node], values: Mapping[str, float]) -> tuple[Graph, int]:
    """Return the graph of some nodes, and its last one, with numbers in place of some names."""
    graph, new = Graph(), []
    for node in nodes:
        if node.value is not None:
            new.append(graph.constant(node.value))
        elif node.operation:
            new.append(graph.apply(node.operation, *(new[a] for a in node.arguments)))
        elif node.name in values:
            new.append(graph.constant(values[node.name]))
        else:
            new.append(graph.name(node.name))
    return graph, new[-1]
