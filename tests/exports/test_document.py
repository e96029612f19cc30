import json

import pytest

from calib.exports.build import build
from calib.exports.plain import write_json
from tests.exports.conftest import bits


@pytest.mark.parametrize("points", [None, 16])
def test_json_holds_the_table_to_the_last_bit(real, truth, points):
    data = build(real, points)
    document = json.loads(write_json(data, real))
    axes = {a["label"]: a for a in document["axes"]}
    for curve in document["curves"]:
        axis = axes[curve["axis"]]
        name = curve["label"].removeprefix(f"{data.prefix}_")
        assert bits(axis["values"], curve["values"]) == truth(real).at(set(axis["values"]))[name]
        assert len(axis["values"]) == (points or axis["rows"])


def test_it_says_what_it_is_and_what_the_table_rests_on(stored):
    document = json.loads(write_json(build(stored), stored))
    assert (document["table"], document["version"]) == ("sedan@1", 1)
    assert document["digest"] == stored.digest
    assert document["record"] == stored.table.content()[0]
    assert "clamped" in document["ends"]
