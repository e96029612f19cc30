"""Equations traced once: value and gradient of the program against those known by hand."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.estimation.expression import Trace, compiled, exp, log, python


def program_of(function, names):
    trace = Trace()
    inputs = [trace.input(name) for name in names]
    value = function(*inputs)
    source = python(trace, {"x": names}, [(value,), trace.gradient(value, inputs)])
    return compiled(source), source


CASES = {
    "sum": (lambda a, b: a + 2.0 + b, lambda a, b: (1.0, 1.0)),
    "difference": (lambda a, b: 1.0 - a - b, lambda a, b: (-1.0, -1.0)),
    "minus": (lambda a, b: -(a - b), lambda a, b: (-1.0, 1.0)),
    "product": (lambda a, b: 3.0 * a * b, lambda a, b: (3.0 * b, 3.0 * a)),
    "square": (lambda a, b: a * a + b, lambda a, b: (2.0 * a, 1.0)),
    "quotient": (lambda a, b: a / b, lambda a, b: (1.0 / b, -a / b**2)),
    "power": (lambda a, b: a**b, lambda a, b: (b * a ** (b - 1.0), math.log(a) * a**b)),
    "exponential": (
        lambda a, b: exp(a * b),
        lambda a, b: (b * math.exp(a * b), a * math.exp(a * b)),
    ),
    "logarithm": (lambda a, b: log(a) * b, lambda a, b: (b / a, math.log(a))),
    "of one only": (lambda a, b: a + 0.0 * b, lambda a, b: (1.0, 0.0)),
    "shared part": (
        lambda a, b: (a + b) * (a + b) / (a + b),
        lambda a, b: (1.0, 1.0),
    ),
}


@pytest.mark.parametrize("name", CASES)
@given(a=st.floats(0.3, 3.0), b=st.floats(0.3, 3.0))
def test_gradient_is_that_of_the_calculus(name, a, b):
    function, slopes = CASES[name]
    program, _ = program_of(function, ("a", "b"))
    assert program([a, b])[1] == pytest.approx(slopes(a, b), rel=1e-12, abs=1e-12)


@given(a=st.floats(0.3, 3.0), b=st.floats(0.3, 3.0))
def test_value_is_that_of_the_function(a, b):
    program, _ = program_of(lambda a, b: (a + 2.0 * b) ** 2.0 / exp(-a) + log(b), ("a", "b"))
    ((value,), _) = program([a, b])
    assert value == pytest.approx((a + 2.0 * b) ** 2 * math.exp(a) + math.log(b), rel=1e-12)


def test_the_same_operation_stands_there_once():
    _, source = program_of(lambda a, b: exp(a * b) + exp(b * a), ("a", "b"))
    assert source.count("exp(") == 1


def test_constants_are_worked_out_beforehand():
    _, source = program_of(lambda a, b: a * (2.0 + a.trace.number(3.0)) + 0.0 * b, ("a", "b"))
    assert "5.0" in source
    assert "2.0" not in source
    result = source.split("return ")[1]
    assert "b" not in result


def test_a_program_has_no_loop_and_no_branch():
    """One line after the other, as an ECU would run it."""
    _, source = program_of(lambda a, b: (a / b) ** b + log(a), ("a", "b"))
    first, *lines, last = source.split("\n")
    assert first == "def program(x):"
    assert all(" = " in line for line in lines)
    assert last.startswith("    return ")
