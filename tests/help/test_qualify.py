import hashlib
import json
import math
import platform
from dataclasses import replace

import numpy as np
import pytest

from calib import __version__
from calib.help.checks import SUITE
from calib.help.qualify import Check, Outcome, facts, qualify, to_dict
from calib.help.samples import sample_logs
from calib.show.html import page_of
from cli.console import plain
from tests.support.documents import missing_and_unknown

DATE = "2025-03-31T12:00:00+00:00"
CHECKS = SUITE[:9]
"""Those that need no table."""


@pytest.fixture(scope="module")
def found():
    return qualify(CHECKS)


def with_first(found, value, error=""):
    first, *others = found.outcomes
    return replace(found, outcomes=(replace(first, value=value, error=error), *others))


@pytest.mark.parametrize(
    ("value", "held", "rounded"),
    [
        *[(0.4, True, 0), (0.4099, True, 1), (0.3901, True, -1), (0.4101, False, 1)],
        *[(0.45, False, 5), (math.nan, False, None), (math.inf, False, None), (None, False, None)],
    ],
)
def test_a_check_holds_within_its_tolerance(value, held, rounded):
    outcome = Outcome(Check("pads", "pads", "1", 0.4, 0.01, "a plant", lambda m: 0.4), value)
    assert (outcome.held, outcome.rounded) == (held, rounded)


def test_an_error_fails_its_own_check_and_no_other_one():
    def broken(material):
        raise ZeroDivisionError("by nought")

    found = qualify([replace(CHECKS[0], measure=broken), CHECKS[0]])
    one, other = found.outcomes
    assert (one.held, one.value, one.error) == (False, None, "ZeroDivisionError: by nought")
    assert other.held
    assert (found.verdict, found.failed) == ("failed", (one,))


def test_the_digest_is_that_of_results_rounded_to_their_tolerance(found):
    first = found.outcomes[0]
    expected, tolerance = first.check.expected, first.check.tolerance
    near = with_first(found, expected + 0.3 * tolerance)
    far = with_first(found, expected + 0.8 * tolerance)
    assert qualify(CHECKS).digest == near.digest == found.digest != far.digest


def test_the_document_says_with_what_it_was_computed(found):
    told = json.loads(json.dumps(plain(to_dict(found, DATE)), allow_nan=False))
    assert missing_and_unknown("qualification-json", told) == []
    assert (told["schema"], told["tool"], told["version"]) == (1, "brake-cal", __version__)
    assert (told["date"], told["verdict"], told["digest"]) == (DATE, "passed", found.digest)
    assert told["environment"]["interpreter"].endswith(platform.python_version())
    assert told["packages"]["numpy"] == np.__version__
    assert "pytest" not in told["packages"]
    assert [check["name"] for check in told["checks"]] == [one.name for one in CHECKS]
    assert all(check["truth"] and check["held"] for check in told["checks"])
    for name, digest in told["files"].items():
        assert hashlib.sha256((sample_logs() / name).read_bytes()).hexdigest() == digest


def test_the_page_shows_the_failure_escapes_it_and_fetches_nothing(found):
    broken = with_first(found, None, "ValueError: <b>no</b>")
    text = page_of(facts(broken, to_dict(broken, DATE)))
    assert '<header class="failed">' in text
    assert "ValueError: &lt;b&gt;no&lt;/b&gt;" in text
    assert not any(word in text for word in ("<b>", "http", "<script"))
    assert facts(found, to_dict(found, DATE)).verdict == "passed"
