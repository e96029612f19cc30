"""Each belief is a row with its source, and some module reads it."""

import ast
from pathlib import Path

import numpy as np
import pytest

import calib
from calib.base.plain import rows
from calib.car import beliefs
from calib.car.beliefs import Belief, Car, Log, Sensor, Stop

TABLE = rows("beliefs.csv", "calib.car")
GROUPS = {"car": Car, "sensor": Sensor, "log": Log, "stop": Stop}


def test_each_row_is_a_field_and_says_where_it_is_from():
    fields = {(name, field) for name, group in GROUPS.items() for field in group._fields}
    assert {(row["group"], row["quantity"]) for row in TABLE} == fields
    assert len({(row["group"], row["quantity"], row["case"]) for row in TABLE}) == len(TABLE)
    units = {(row["quantity"], row["unit"]) for row in TABLE}
    assert len(units) == len({quantity for quantity, _ in units})
    assert all(row["source"] for row in TABLE)
    assert all((row["group"] == "stop") == bool(row["case"]) for row in TABLE)
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
    constants = {n.value for n in ast.walk(tree) if isinstance(n, ast.Constant)}
    return fields | (constants if by_text else set())


def test_every_field_is_read():
    sources = [file.read_text() for file in Path(calib.__file__).parent.rglob("*.py")]
    trees = [ast.parse(text) for text in sources if "from calib.car.beliefs import" in text]
    for group, prior in GROUPS.items():
        assert {*prior._fields} <= set().union(*(read_by(tree, group.upper()) for tree in trees))
