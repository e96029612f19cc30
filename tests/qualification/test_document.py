import json
import platform
from dataclasses import replace

import numpy as np
import pytest

from calib import __version__
from calib.qualification import closed_forms, reading
from calib.qualification.document import digest, surroundings, to_dict
from calib.qualification.report import headline, report_html
from calib.qualification.suite import qualify
from calib.qualification.use_cases import USE_CASES
from cli.console import plain
from tests.support.documents import missing_and_unknown

DATE = "2025-03-31T12:00:00+00:00"


@pytest.fixture(scope="module")
def found():
    return qualify((*closed_forms.CHECKS, *reading.CHECKS))


def with_first(found, value, error=""):
    first, *others = found.outcomes
    return replace(found, outcomes=(replace(first, value=value, error=error), *others))


def test_two_runs_have_one_digest(found):
    again = qualify((*closed_forms.CHECKS, *reading.CHECKS))
    assert digest(again.outcomes) == digest(found.outcomes)


def test_the_digest_is_that_of_results_rounded_to_their_tolerance(found):
    first = found.outcomes[0]
    expected, tolerance = first.check.expected, first.check.tolerance
    near = with_first(found, expected + 0.3 * tolerance)
    far = with_first(found, expected + 0.8 * tolerance)
    assert digest(near.outcomes) == digest(found.outcomes) != digest(far.outcomes)


def test_the_document_says_with_what_it_was_computed(found):
    told = json.loads(json.dumps(plain(to_dict(found, surroundings(DATE))), allow_nan=False))
    assert missing_and_unknown("qualification-json", told) == []
    assert (told["schema"], told["tool"], told["version"]) == (1, "brake-cal", __version__)
    assert (told["date"], told["verdict"]) == (DATE, "passed")
    assert told["environment"]["interpreter"].endswith(platform.python_version())
    assert told["packages"]["numpy"] == np.__version__
    assert "pytest" not in told["packages"]
    assert [case["name"] for case in told["use_cases"]] == [case.name for case in USE_CASES]
    assert [check["name"] for check in told["checks"]] == [o.check.name for o in found.outcomes]
    assert all(check["truth"] and check["held"] for check in told["checks"])


def test_a_failed_check_fails_the_whole(found):
    broken = with_first(found, None, "ValueError: <b>no</b>")
    told = to_dict(broken, surroundings(DATE))
    assert told["verdict"] == "failed"
    assert told["checks"][0]["held"] is False
    assert headline(broken) == f"1 of {len(found.outcomes)} checks does not hold: unit_psi."


def test_the_page_shows_the_failure_escapes_it_and_fetches_nothing(found):
    broken = with_first(found, None, "ValueError: <b>no</b>")
    text = report_html(broken, surroundings(DATE))
    assert '<header class="failed">' in text
    assert "What does not hold" in text
    assert "ValueError: &lt;b&gt;no&lt;/b&gt;" in text
    assert "<b>" not in text
    assert "http" not in text
    assert "<script" not in text
    good = report_html(found, surroundings(DATE))
    assert "What does not hold" not in good
    assert "unit_psi holds" in good
