"""diagnosis.json and the page that explains it."""

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

from calib.diagnosis.undecided import Alike, Confusion, Pair, ShowingDrive, Size
from calib.diagnosis.written import text_of, to_dict
from calib.show.diagnosis import KINDS
from tests.support.documents import missing_and_unknown
from tests.support.written_diagnosis import MARKUP, named_drag

PAGE = Path(__file__).parents[2] / "calib" / "manual" / "diagnosis.md"


@pytest.fixture(scope="module")
def named():
    return named_drag()


def test_the_gap_is_told_by_log_and_channel(named):
    log = to_dict(named)["gap"]["by_log"][MARKUP]
    assert (log["before"], log["after"]) == named.gap.of(MARKUP)
    assert log["by_channel"]["v"] == {
        "before": 0.25, "after": 0.5, "noise": 0.0625, "closed": -1.0, "unit": "m/s"
    }  # fmt: skip


def test_confusion_and_drives_are_told_with_units(named):
    assert to_dict(named)["confusion"] is None
    assert to_dict(named)["would_show"] == []
    alike = Confusion(
        (Alike(("road_grade",), 1.0, 0.0), Alike(("mass_error",), 1.25, 0.25)),
        (Pair((0, 1), 3.0, "coast", 48.0),),
    )
    usual = {"drag_area": Size(0.65, "m^2"), "load_share": Size(0.5, "1")}
    unseen = (ShowingDrive("aerodynamic_drag", usual, "coast", 48.0, clear=True),)
    told = to_dict(replace(named, confusion=alike, drives=unseen))
    assert told["confusion"]["explanations"][1] == {
        "effects": ["mass_error"], "innovation": 1.25, "behind": 0.25
    }  # fmt: skip
    assert told["confusion"]["pairs"] == [{
        "between": [0, 1], "apart_in_logs": 3.0, "drive": "coast", "apart_in_drive": 48.0,
        "unit": "sigma",
    }]  # fmt: skip
    assert told["not_resolved"] == ["aerodynamic_drag"]
    assert told["would_show"] == [{
        "effect": "aerodynamic_drag",
        "usual_size": {
            "drag_area": {"value": 0.65, "unit": "m^2"}, "load_share": {"value": 0.5, "unit": "1"}
        },
        "drive": "coast", "sigma": 48.0, "clear": True,
    }]  # fmt: skip


def test_the_manual_has_every_headline_and_names_keys_that_exist(named):
    text = PAGE.read_text()
    for kind, _ in KINDS.values():
        assert kind in text, kind
    told = to_dict(named)
    keys = re.findall(r"((?:`\w+`(?:, | and )?)+)\s+in\s+`diagnosis\.json`", text)
    names = {name for group in keys for name in re.findall(r"\w+", group.replace(" and ", " "))}
    assert len(names) >= 7
    assert names <= set(told)


def test_it_has_the_keys_of_the_page_of_documents(named):
    document = json.loads(text_of(named))
    assert missing_and_unknown("diagnose-json", document) == []
