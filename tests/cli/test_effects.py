"""`brake-cal effects`: every card, in words and as a document."""

import json
import shlex

import pytest
from cli.effects import EPILOG

from calib.car.effects.catalogue import CATALOGUE


def test_every_effect_has_its_line_in_the_order_of_the_catalogue(brake_cal):
    head, *lines = brake_cal("effects").out.splitlines()
    assert head.split() == ["effect", "cause"]
    assert [line.split()[0] for line in lines] == list(CATALOGUE)


@pytest.mark.parametrize("name", CATALOGUE)
def test_a_card_is_printed_whole(brake_cal, name):
    card = CATALOGUE[name].card
    out = brake_cal("effects", name).out
    for text in (card.name, card.cause, card.equation, card.source, card.looks_like):
        assert text in out
    for p in card.parameters:
        line = next(line for line in out.splitlines() if line.startswith(f"{p.name} "))
        assert f"from {p.low:g} to {p.high:g}" in line


def test_json_holds_the_cards_in_si(brake_cal):
    document = json.loads(brake_cal("effects", "--json").out)
    assert [card["name"] for card in document["effects"]] == list(CATALOGUE)
    one = json.loads(brake_cal("effects", "rear_proportioning", "--json").out)["effects"]
    assert len(one) == 1
    assert one[0]["neutral"] == 1.0
    assert {p["name"]: p["unit"] for p in one[0]["parameters"]} == {"knee_slope": "1", "knee": "Pa"}


def test_a_misspelt_name_is_a_usage_error_with_a_hint(brake_cal):
    ran = brake_cal("effects", "hydraulic_lags")
    assert ran.code == 2
    assert "did you mean 'hydraulic_lag'?" in ran.err
    assert ran.out == ""


def test_the_examples_work_as_printed(brake_cal):
    commands = [line.split() for line in EPILOG.splitlines() if "brake-cal" in line]
    for _, *words in commands:
        assert brake_cal(*shlex.split(" ".join(words))).code == 0
