"""diagnosis.json and the page that explains it."""

import re
from pathlib import Path

import pytest

from calib.diagnosis.diagnosis import to_dict
from calib.show.diagnosis import KINDS
from tests.support.documents import missing_and_unknown
from tests.support.written_diagnosis import named_drag

PAGE = Path(__file__).parents[2] / "calib" / "manual" / "diagnosis.md"


@pytest.fixture(scope="module")
def named():
    return named_drag()


def test_the_gap_is_written_by_channel(named):
    gap = to_dict(named)["gap"]
    assert (gap["before"], gap["after"]) == named.gap.rms()
    assert gap["by_channel"]["v"] == {
        "before": 0.25, "after": 0.5, "noise": 0.0625, "closed": -1.0, "unit": "m/s"
    }  # fmt: skip


def test_the_manual_has_every_headline_and_names_keys_that_exist(named):
    text = PAGE.read_text()
    for kind, _ in KINDS.values():
        assert kind in text, kind
    keys = re.findall(r"((?:`\w+`(?:, | and )?)+)\s+in\s+`diagnosis\.json`", text)
    names = {name for group in keys for name in re.findall(r"\w+", group.replace(" and ", " "))}
    assert len(names) >= 5
    assert names <= set(to_dict(named))


def test_it_has_the_keys_of_the_page_of_documents(named):
    assert missing_and_unknown("diagnose-json", to_dict(named)) == []
