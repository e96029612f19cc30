"""Each belief is a row with its source, some module reads it, and wrong rows are refused."""

import ast
from pathlib import Path

import numpy as np
import pytest

import calib
from calib.base.plain import rows
from calib.car import beliefs
from calib.car.beliefs import Belief, Car, Log, Sensor, Stop, beliefs_of

TABLE = rows("beliefs.csv", "calib.car")
GROUPS = {"car": Car, "sensor": Sensor, "log": Log, "stop": Stop}


def test_each_row_says_where_it_is_from():
    assert {row["group"] for row in TABLE} == set(GROUPS)
    assert all(row["source"] for row in TABLE)
    for values in (getattr(beliefs, group.upper()) for group in GROUPS):
        for prior in values:
            assert np.all(np.asarray(prior.sigma) >= 0.0)
            assert isinstance(prior, Belief) or np.sum(prior.share) == pytest.approx(1.0)


def read_by(tree: ast.Module, group: str) -> set[str]:
    """Names that a module takes from a group, as an attribute or by ``getattr``."""
    fields, by_text = set(), False
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and ast.unparse(node.value) == group:
            fields.add(node.attr)
        by_text |= isinstance(node, ast.Call) and ast.unparse(node).startswith(f"getattr({group},")
    sources = {n.value for n in ast.walk(tree) if isinstance(n, ast.Constant)}
    return fields | (sources if by_text else set())


def test_every_field_is_read():
    sources = [file.read_text() for file in Path(calib.__file__).parent.rglob("*.py")]
    trees = [ast.parse(text) for text in sources if "from calib.car.beliefs import" in text]
    for group, prior in GROUPS.items():
        assert {*prior._fields} <= set().union(*(read_by(tree, group.upper()) for tree in trees))


def changed_row(**changed: str) -> dict[str, str]:
    """The row of the pads' ratio, but for what is changed."""
    return next(r for r in TABLE if r["quantity"] == "log_pad_ratio") | changed


@pytest.mark.parametrize(
    ("word", "table"),
    [
        ("log_colour", [*TABLE, changed_row(quantity="log_colour")]),  # nobody reads it
        ("log_pad_ratio", [*TABLE, changed_row()]),  # twice
        ("peak", [row for row in TABLE if row["quantity"] != "peak"]),
        ("log_pad_ratio", [*TABLE, changed_row(group="log", unit="dB")]),  # two units
        ("worn", [*TABLE, changed_row(case="worn")]),  # of a quantity that has no cases
        ("wide", [row | {"sigma": "wide"} for row in TABLE]),
    ],
    ids=["unread", "twice", "missing", "two units", "a case", "no number"],
)
def test_what_cannot_be_read_in_one_way_is_refused(word, table):
    with pytest.raises(ValueError, match=word):
        beliefs_of(Car, table)
