"""Text -> the nodes of a formula, by the precedence rules of Python's arithmetic.

The words of the language are numbers, names, operators, brackets and the comma, and nothing else is
read: a case file cannot run code. One pass with two stacks (Dijkstra's shunting yard) and no
recursion, so a sum may be as long as the text; only brackets, signs and powers nest.
"""

from __future__ import annotations

import keyword
import re
from dataclasses import dataclass, field
from functools import lru_cache, reduce

import numpy as np

from rodsim.case.functions import COMPARISONS, FUNCTIONS, library_hint
from rodsim.case.graph import Graph, Node
from rodsim.case.words import clipped, did_you_mean

LONGEST = 20_000  # characters
LONGEST_NUMBER = 250  # characters; the whole number 16**248 still has a float64
DEEPEST = 100  # brackets, signs and powers within each other
_PRECEDENCE = {**dict.fromkeys(COMPARISONS, 1), "+": 2, "-": 2, "*": 3, "/": 3, "%": 3, "**": 5}
_SIGN = 4  # of a number or a bracket: weaker than a power, -s**2 is -(s**2)

_WHOLE = r"0[xX][0-9a-fA-F]+|0[oO][0-7]+|0[bB][01]+"  # in another base than ten
_NUMBER = rf"{_WHOLE}|(?:[0-9][0-9_]*\.?|\.[0-9])[0-9_]*(?:[eE][-+]?[0-9]+)?"
_TOKEN = re.compile(
    rf" *(?:(?P<number>{_NUMBER})|(?P<name>[A-Za-z_][A-Za-z0-9_]*)"
    r"|(?P<sign>\*\*|//|<<|>>|<>|<=|>=|[-+*/%<>(),.]))"
)
_ODD_CHARACTER = re.compile(r"[^A-Za-z0-9_.+\-*/%()<>, ]")
_ODD_CHARACTER_HINTS = {
    "^": "use ** for powers, not ^",
    "=": "'=' is not allowed: the comparisons are < <= > >=",
    "'": "text in quotes is not allowed",
    '"': "text in quotes is not allowed",
}
_WORDS = {
    "if": "'if ... else' is not allowed: write where(condition, a, b)",
    "else": "'if ... else' is not allowed: write where(condition, a, b)",
    "and": "'and' and 'or' are not allowed: nest where(condition, a, b)",
    "or": "'and' and 'or' are not allowed: nest where(condition, a, b)",
    "not": "'not' is not allowed: turn the comparison round",
    **{word: f"{word} is not a number" for word in ("True", "False", "None")},
}
_COMMA = "a comma is only allowed between the arguments of a function; decimals have a point"


class ExpressionError(ValueError):
    """The text is not an expression we accept; the message says why."""


@lru_cache(maxsize=1024)
def parse(text: str) -> tuple[Node, ...]:
    """Return the nodes of a formula, the last is its value; names are not looked up.

    Between words of ``text`` there is at most one space.
    """
    if not text:
        raise ExpressionError("the expression is empty")
    if len(text) > LONGEST:
        raise ExpressionError(f"{len(text)} characters long: at most {LONGEST}")
    odd = _ODD_CHARACTER.search(text.replace("<=", "<").replace(">=", ">"))
    if odd is not None:
        default = f"the character {clipped(odd[0])} is not allowed"
        raise ExpressionError(_ODD_CHARACTER_HINTS.get(odd[0], default))
    if hint := library_hint(text):
        raise ExpressionError(hint)
    reader, position = _Reader(), 0
    while match := _TOKEN.match(text, position):
        position = match.end()
        reader.take(match, text[position : position + 2])
    return reader.end()


@dataclass(frozen=True)
class _Waiting:
    """What is on the stack of operators: a sign, an operator, a bracket or a function's bracket."""

    kind: str  # "operator", "sign", "("
    word: str = ""  # the operator, or the function's name
    precedence: int = 0
    below: int = 0  # how many operands there were before the bracket


@dataclass
class _Reader:
    """The two stacks; an operand is its node and, of a comparison, the node of its right side."""

    graph: Graph = field(default_factory=Graph)
    operands: list[tuple[int, int | None]] = field(default_factory=list)
    waiting: list[_Waiting] = field(default_factory=list)
    after_operand: bool = False

    def take(self, match: re.Match, following: str) -> None:
        """Take the next word of the text; ``following`` are the two characters after it."""
        kind, word = match.lastgroup, match[match.lastgroup]
        if kind == "number":
            self._number(word, following[:1])
        elif kind == "name":
            self._name(word, following.strip()[:1] == "(")
        elif word == "(":
            self._open(_Waiting("(", below=len(self.operands)))
        elif word in ("//", "<<", ">>", "<>"):
            raise ExpressionError(f"{word} is not allowed")
        elif word == ".":
            raise ExpressionError("attribute access (a dot after a name) is not allowed")
        elif word == ")":
            self._close()
        elif word == ",":
            self._comma()
        else:
            self._operator(word)

    def end(self) -> tuple[Node, ...]:
        """Return the nodes of the whole text."""
        if not self.after_operand:
            raise ExpressionError("not an expression: something is missing at its end")
        self._reduce(0)
        if self.waiting:
            raise ExpressionError(
                "not an expression: a '(' is not closed (has it commas? then it needs quotes)"
            )
        return tuple(self.graph.nodes[: self.operands[0][0] + 1])  # a later one is in no use

    def _number(self, word: str, following: str) -> None:
        if following and following not in " +-*/%()<>,":
            hint = ": did you leave out a '*'?" if following.isalpha() else ""
            raise ExpressionError(f"{clipped(word + following)} is not a number{hint}")
        self._operand(self.graph.constant(_value(word)), word)

    def _name(self, word: str, call: bool) -> None:
        if word in _WORDS:
            raise ExpressionError(_WORDS[word])
        if keyword.iskeyword(word):
            raise ExpressionError(f"'{word}' is not allowed")
        if not call:
            self._operand(self.graph.name(word), word)
            return
        if word not in FUNCTIONS:
            hint = did_you_mean(word, FUNCTIONS) or f": the functions are {', '.join(FUNCTIONS)}"
            raise ExpressionError(f"unknown function '{clipped(word)}'{hint}")
        if self.after_operand:
            raise _missing_operator(word)
        self.waiting.append(_Waiting("call", word))

    def _operand(self, node: int, word: str) -> None:
        if self.after_operand:
            raise _missing_operator(word)
        self.operands.append((node, None))
        self.after_operand = True

    def _open(self, bracket: _Waiting) -> None:
        if self.after_operand:
            raise ExpressionError("a name must stand before '(': did you leave out a '*'?")
        if self.waiting and self.waiting[-1].kind == "call":
            bracket = _Waiting("(", self.waiting.pop().word, below=bracket.below)
        self._wait(bracket)

    def _wait(self, item: _Waiting) -> None:
        if len(self.waiting) >= DEEPEST:
            raise ExpressionError(f"nested deeper than {DEEPEST} levels")
        self.waiting.append(item)

    def _comma(self) -> None:
        if not self.after_operand:
            raise ExpressionError("not an expression: nothing stands before a comma")
        self._reduce(0)
        if not (self.waiting and self.waiting[-1].word):
            raise ExpressionError(_COMMA)
        self.after_operand = False

    def _close(self) -> None:
        """End a bracket: the arguments of a function, or what counts as one operand."""
        empty = bool(self.waiting) and self.waiting[-1].kind == "("
        empty = empty and len(self.operands) == self.waiting[-1].below
        if not self.after_operand and not (empty and self.waiting[-1].word):
            raise ExpressionError("not an expression: something is missing before a ')'")
        self._reduce(0)
        if not self.waiting:
            raise ExpressionError("not an expression: a ')' without its '('")
        bracket = self.waiting.pop()
        arguments = [node for node, _ in self.operands[bracket.below :]]
        del self.operands[bracket.below :]
        node = _call(self.graph, bracket.word, arguments) if bracket.word else arguments[0]
        self.operands.append((node, None))
        self.after_operand = True

    def _operator(self, word: str) -> None:
        if self.after_operand:
            precedence = _PRECEDENCE[word]
            self._reduce(precedence + (word == "**"))  # powers are taken from the right
            self._wait(_Waiting("operator", word, precedence))
        elif word in ("+", "-"):
            self._wait(_Waiting("sign", {"+": "pos", "-": "neg"}[word], _SIGN))
        elif word in ("*", "**") and self.waiting and self.waiting[-1].kind == "(":
            name = self.waiting[-1].word or "a bracket"
            raise ExpressionError(f"{name} takes plain arguments only")
        else:
            raise ExpressionError(f"not an expression: nothing stands before '{word}'")
        self.after_operand = False

    def _reduce(self, precedence: int) -> None:
        """Apply what waits and binds at least as strongly, back to the last bracket."""
        while self.waiting and self.waiting[-1].kind != "(":
            if self.waiting[-1].precedence < precedence:
                return
            item = self.waiting.pop()
            right, _ = self.operands.pop()
            if item.kind == "sign":
                self.operands.append((self.graph.apply(item.word, right), None))
            else:
                self.operands.append(self._applied(item.word, self.operands.pop(), right))

    def _applied(self, word: str, left: tuple[int, int | None], right: int) -> tuple:
        """Return the operand that an operator makes; a < b <= c is the product of its parts."""
        node, middle = left
        if word not in COMPARISONS:
            return self.graph.apply(word, node, right), None
        found = self.graph.apply(word, node if middle is None else middle, right)
        return (found if middle is None else self.graph.apply("*", node, found)), right


def _missing_operator(word: str) -> ExpressionError:
    reason = f"'{clipped(word)}' follows without an operator: did you leave out a '*'?"
    return ExpressionError(f"not an expression: {reason}")


def _value(word: str) -> np.float64:
    word = word.replace("_", "")
    if len(word) > LONGEST_NUMBER:
        raise ExpressionError("a number is too large: it has more digits than any float64")
    return np.float64(int(word, 0) if re.fullmatch(_WHOLE, word) else word)


def _call(graph: Graph, name: str, arguments: list[int]) -> int:
    """Return the node of a function; min and max take their arguments two at a time."""
    function, count = FUNCTIONS[name], len(arguments)
    if function.most is None:
        if count < function.fewest:
            raise ExpressionError(f"{name} takes two or more arguments, not {count}")
        return reduce(lambda a, b: graph.apply(function.operation, a, b), arguments)
    if not function.fewest <= count <= function.most:
        wanted = " or ".join(map(str, range(function.fewest, function.most + 1)))
        plural = "s" * (function.most > 1)
        raise ExpressionError(f"{name} takes {wanted} argument{plural}, not {count}")
    if name == "heaviside" and count == 1:
        arguments = [*arguments, graph.constant(0.5)]
    return graph.apply(function.operation, *arguments)
