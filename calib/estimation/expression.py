"""An equation written once; its value and its gradient follow as one list of operations.

A function of numbers is called once with an `Expression` for each of them, and what it does to
them is noted. The gradient is that list gone through backwards with the chain rule (reverse
accumulation: Griewank and Walther, Evaluating Derivatives, ch. 3), and is a list of the same kind:

    equation --trace--> operations --chain rule--> operations of value and gradient --> program

The list has no loop, no branch and no memory, so that every run does the same steps in the same
time. `python` writes it as Python; each of its lines is as well a line of C.
"""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple


class _Operation(NamedTuple):
    """One step: what is done, with the results of which earlier steps.

    ``kind`` one of ``+ - * / ** exp log``, or ``number`` or ``input``, whose ``text`` is what
    stands in the program.
    """

    kind: str
    parts: tuple[int, ...]
    text: str = ""


class Trace:
    """Operations in the order in which they were done; the same operation stands there once."""

    def __init__(self) -> None:
        self.operations: list[_Operation] = []
        self._places: dict[_Operation, int] = {}

    def input(self, name: str) -> "Expression":
        """Return a number that is known only when the program runs."""
        return self._note(_Operation("input", (), name))

    def number(self, value: "Expression | float") -> "Expression":
        """Return a constant; an expression comes back as it is."""
        if isinstance(value, Expression):
            return value
        return self._note(_Operation("number", (), repr(float(value))))

    def apply(self, kind: str, *values: "Expression | float") -> "Expression":
        """Return the result of an operation, shortened where a part is a constant."""
        parts = [self.number(value) for value in values]
        short = _shortened(kind, parts)
        if short is not None:
            return short
        places = tuple(part.place for part in parts)
        return self._note(_Operation(kind, tuple(sorted(places)) if kind in "+*" else places))

    def gradient(self, of: "Expression", over: Iterable["Expression"]) -> tuple["Expression", ...]:
        """Return the partial derivatives of an expression over inputs."""
        zero = self.number(0.0)
        slopes = {of.place: self.number(1.0)}
        for place in range(of.place, -1, -1):
            if place in slopes:
                operation = self.operations[place]
                parts = [Expression(self, part) for part in operation.parts]
                handed = _chain_rule(operation.kind, Expression(self, place), parts, slopes[place])
                for part, slope in zip(parts, handed, strict=True):
                    slopes[part.place] = slopes.get(part.place, zero) + slope
        return tuple(slopes.get(one.place, zero) for one in over)

    def _note(self, operation: _Operation) -> "Expression":
        if operation not in self._places:
            self._places[operation] = len(self.operations)
            self.operations.append(operation)
        return Expression(self, self._places[operation])


@dataclass(frozen=True)
class Expression:
    """The result of one operation of a trace: it is used as a number is."""

    trace: Trace
    place: int

    @property
    def value(self) -> float | None:
        """The number, if it is a constant."""
        operation = self.trace.operations[self.place]
        return float(operation.text) if operation.kind == "number" else None

    def __add__(self, other: "Expression | float") -> "Expression":
        return self.trace.apply("+", self, other)

    def __sub__(self, other: "Expression | float") -> "Expression":
        return self.trace.apply("-", self, other)

    def __mul__(self, other: "Expression | float") -> "Expression":
        return self.trace.apply("*", self, other)

    def __truediv__(self, other: "Expression | float") -> "Expression":
        return self.trace.apply("/", self, other)

    def __pow__(self, other: "Expression | float") -> "Expression":
        """A power of a base above zero: its slopes are by the logarithm."""
        return self.trace.apply("**", self, other)

    def __rsub__(self, other: float) -> "Expression":
        return self.trace.apply("-", other, self)

    def __neg__(self) -> "Expression":
        return self.trace.apply("-", 0.0, self)

    __radd__ = __add__
    __rmul__ = __mul__


def exp(x: Expression) -> Expression:
    """Exponential function."""
    return x.trace.apply("exp", x)


def log(x: Expression) -> Expression:
    """Natural logarithm."""
    return x.trace.apply("log", x)


_FOLDED: Mapping[str, Callable[..., float]] = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": lambda a, b: a / b,
    "**": lambda a, b: a**b,
    "exp": math.exp,
    "log": math.log,
}
"""What each kind of operation does to numbers."""


def _shortened(kind: str, parts: Sequence[Expression]) -> Expression | None:
    """The result where no operation is needed: of constants, and with 0 or 1; else None."""
    trace, values = parts[0].trace, [part.value for part in parts]
    if None not in values:
        return trace.number(_FOLDED[kind](*values))
    if len(parts) == 1:
        return None
    (a, b), (first, second) = parts, values
    if kind == "*" and 0.0 in values:
        return trace.number(0.0)
    if kind == "/" and first == 0.0:
        return trace.number(0.0)
    if (kind == "+" and first == 0.0) or (kind == "*" and first == 1.0):
        return b
    if (minus := _negated(b)) is not None and kind in "+-":
        return trace.apply("-" if kind == "+" else "+", a, minus)
    if (minus := _negated(a)) is not None and kind == "+":
        return trace.apply("-", b, minus)
    if (kind in "+-" and second == 0.0) or (kind in ("*", "/", "**") and second == 1.0):
        return a
    return None


def _negated(x: Expression) -> Expression | None:
    """The y of x = -y; None where x is nothing of the kind."""
    operation = x.trace.operations[x.place]
    if operation.kind != "-" or Expression(x.trace, operation.parts[0]).value != 0.0:
        return None
    return Expression(x.trace, operation.parts[1])


def _chain_rule(
    kind: str, result: Expression, parts: Sequence[Expression], slope: Expression
) -> tuple[Expression, ...]:
    """What ``slope``, that of the result, is for each part."""
    if kind in ("input", "number"):
        return ()
    if kind == "exp":
        return (slope * result,)
    a = parts[0]
    if kind == "log":
        return (slope / a,)
    b = parts[1]
    if kind == "+":
        return slope, slope
    if kind == "-":
        return slope, -slope
    if kind == "*":
        return slope * b, slope * a
    if kind == "/":
        over = slope / b
        return over, -(over * result)
    grown = slope * result
    return grown * b / a, grown * log(a)  # a**b


def python(
    trace: Trace, inputs: Mapping[str, Sequence[str]], outputs: Sequence[Sequence[Expression]]
) -> str:
    """Return a Python function ``program(*inputs)`` that returns each group of outputs as a tuple.

    ``inputs`` the arguments by name, each with the names of the numbers that it holds.
    """
    uses = Counter(output.place for group in outputs for output in group)
    needed = set(uses)
    for place in range(len(trace.operations) - 1, -1, -1):
        if place in needed:
            parts = trace.operations[place].parts
            uses.update(parts)
            needed.update(parts)
    lines = [f"def program({', '.join(inputs)}):"]
    lines += [f"    {', '.join(names)}, = {argument}" for argument, names in inputs.items()]
    texts: dict[int, str] = {}
    for place in sorted(needed):
        operation = trace.operations[place]
        text = _text(operation, [texts[part] for part in operation.parts])
        if operation.parts and uses[place] > 1:  # what is used once stands where it is used
            lines.append(f"    t{place} = {text}")
            text = f"t{place}"
        texts[place] = text
    results = [f"({', '.join(texts[output.place] for output in group)},)" for group in outputs]
    lines.append(f"    return {', '.join(results)},")
    return "\n".join(lines)


def _text(operation: _Operation, parts: Sequence[str]) -> str:
    if not operation.parts:
        return operation.text
    if len(parts) == 1:
        return f"{operation.kind}({parts[0]})"
    if operation.kind == "-" and parts[0] == "0.0":
        return f"(-{parts[1]})"
    return f"({parts[0]} {operation.kind} {parts[1]})"


def compiled(source: str) -> Callable[..., Any]:
    """Return the function that `python` wrote."""
    names: dict[str, Any] = {"exp": math.exp, "log": math.log}
    exec(compile(source, "<equations>", "exec"), names)
    program: Callable[..., Any] = names["program"]
    return program
