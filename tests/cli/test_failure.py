"""Errors as JSON on stdout, where --json asks for it."""

import json

import jsonschema
import pytest

from calib.base.errors import BrakeCalError, InputError, StoreError
from calib.base.record import ErrorFile, json_schema
from calib.store.store import Store

SEVERAL = InputError("2 errors", where="car.toml", lines=("mass: missing", "h: is text"))


def error_of(ran):
    document = json.loads(ran.out)
    jsonschema.validate(document, json_schema(ErrorFile))
    error = document["error"]
    assert ran.code == error["exit_code"]
    return error


@pytest.mark.parametrize(
    ("error", "kind", "code"),
    [
        (BrakeCalError("w"), "brake_cal", 1),
        (SEVERAL, "input", 3),
        (StoreError("w", do="mend"), "store", 4),
    ],
)
def test_an_error_of_the_library(brake_cal, monkeypatch, error, kind, code):
    def fail(self):
        raise error

    monkeypatch.setattr(Store, "list", fail)
    ran = brake_cal("tables", "list", "--json")
    told = error_of(ran)
    assert (told["kind"], ran.code, told["message"]) == (kind, code, str(error))
    assert told["lines"] == list(error.lines)
    assert ran.err == f"error: {error}\n"


@pytest.mark.parametrize(
    ("words", "says", "where"),
    [
        (("tabels", "--json"), "Did you mean 'tables'", ""),
        (("tables", "show", "--json"), "Missing argument", ""),
        (("fit", "--vehicel", "x", "--json"), "No such option", ""),
        (("tables", "list", "--state", "relaesed", "--json"), "did you mean", "--state"),
    ],
)
def test_a_wrong_command_line(brake_cal, words, says, where):
    ran = brake_cal(*words)
    told = error_of(ran)
    assert (ran.code, told["kind"], told["where"]) == (2, "usage", where)
    assert says in told["message"]
    assert says in ran.err


def test_a_log_of_that_name_asks_for_nothing(brake_cal):
    assert brake_cal("fit", "--vehicel", "x", "--", "--json").out == ""


def test_a_result_that_was_printed_stays_the_only_document(brake_cal, tmp_path):
    """`check` tells of the log that it cannot read in the document of its result."""
    ran = brake_cal("check", tmp_path / "none.csv", "--json")
    assert ran.code == 3
    assert "unreadable" in json.loads(ran.out)
