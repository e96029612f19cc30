import hashlib
import json
import math
import platform
from dataclasses import replace

import numpy as np
import pytest

from calib import __version__
from calib.help.checks import SUITE
from calib.help.qualify import Check, facts, qualify
from calib.help.samples import sample_logs
from calib.show.html import page_of
from cli.console import plain
from tests.support.documents import missing_and_unknown

DATE = "2025-03-31T12:00:00+00:00"
CHECKS = SUITE[:9]
"""Those that need no table."""


@pytest.fixture(scope="module")
def found():
    return qualify(CHECKS, DATE)


@pytest.mark.parametrize(
    ("value", "held"),
    [(0.4, True), (0.4099, True), (0.3901, True), (0.4101, False), (math.nan, False)],
)
def test_a_check_holds_within_its_tolerance(value, held):
    check = Check("pads", "pads", "1", 0.4, 0.01, "a plant", lambda material: value)
    (row,) = qualify([check])["checks"]
    assert row["held"] == held


def test_an_error_fails_its_own_check_and_no_other_one():
    def broken(material):
        raise ZeroDivisionError("<b>by nought</b>")

    document = qualify([replace(CHECKS[0], measure=broken), CHECKS[0]])
    one, other = document["checks"]
    assert (one["held"], one["value"], other["held"]) == (False, None, True)
    assert (one["error"], document["verdict"]) == ("ZeroDivisionError: <b>by nought</b>", "failed")
    text = page_of(facts(document))
    assert '<header class="failed">' in text
    assert not any(word in text for word in ("<b>", "http", "<script"))


def test_the_digest_is_that_of_results_rounded_to_their_tolerance(found):
    def of(share):
        value = CHECKS[0].expected + share * CHECKS[0].tolerance
        first = replace(CHECKS[0], measure=lambda material: value)
        return qualify([first, *CHECKS[1:]])["digest"]

    assert of(0.3) == found["digest"] != of(0.8)


def test_the_document_says_with_what_it_was_computed(found):
    told = json.loads(json.dumps(plain(found), allow_nan=False))
    assert missing_and_unknown("qualification-json", told) == []
    assert (told["schema"], told["tool"], told["version"]) == (1, "brake-cal", __version__)
    assert (told["date"], told["verdict"]) == (DATE, "passed")
    assert told["environment"]["interpreter"].endswith(platform.python_version())
    assert told["packages"]["numpy"] == np.__version__
    assert "pytest" not in told["packages"]
    assert [check["name"] for check in told["checks"]] == [one.name for one in CHECKS]
    assert all(check["truth"] and check["held"] for check in told["checks"])
    for name, digest in told["files"].items():
        assert hashlib.sha256((sample_logs() / name).read_bytes()).hexdigest() == digest
