"""All checks hold, and a break is seen by the checks that are meant for it."""

import json
import platform
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from calib import __version__
from calib.car.vehicle import Axle
from calib.estimation import validate
from calib.help import qualify as room
from calib.help.qualify import SUITE, qualification_facts, qualify
from calib.help.samples import sample_logs
from calib.show.html import page_of
from cli.console import plain
from tests.support.documents import missing_and_unknown


@pytest.mark.smoke
def test_every_check_holds_and_the_document_names_the_machine():
    document = json.loads(json.dumps(plain(qualify(SUITE, "2025-03-31")), allow_nan=False))
    assert [check for check in document["checks"] if not check["held"]] == []
    assert missing_and_unknown("qualification-json", document) == []
    assert (document["version"], document["date"]) == (__version__, "2025-03-31")
    assert document["verdict"] == "passed"
    assert document["environment"]["interpreter"].endswith(platform.python_version())
    assert document["packages"]["numpy"] == np.__version__


def test_the_expected_drag_area_is_that_of_the_answer():
    answer = json.loads((sample_logs() / "hidden/case_0/answer.json").read_text())
    hidden = next(check for check in [*SUITE.values()][-1] if check["name"] == "drag_size")
    assert answer["settings"]["cda"] == hidden["expected"]


def test_an_error_fails_its_own_check_and_no_other_one():
    def broken():
        raise ZeroDivisionError("<b>by nought</b>")

    formulas = next(iter(SUITE))
    document = qualify({broken: SUITE[formulas], formulas: SUITE[formulas]})
    broken_check, _, *others = document["checks"]
    assert (broken_check["held"], broken_check["value"]) == (False, None)
    assert all(other["held"] for other in others)
    assert document["verdict"] == "failed"
    assert broken_check["error"] == "ZeroDivisionError: <b>by nought</b>"
    text = page_of(qualification_facts(document))
    assert '<header class="failed">' in text
    assert not any(word in text for word in ("<b>", "http:", "https:", "<script src"))


def wrong_gain(monkeypatch):
    right = Axle.torque_gain.fget
    monkeypatch.setattr(Axle, "torque_gain", property(lambda axle: 1.05 * right(axle)))


def wrong_pads(monkeypatch):
    right = validate.estimate_run

    def wrong(*arguments, **options):
        estimate = right(*arguments, **options)
        pads = estimate.best.pads_f._replace(value=1.1 * estimate.best.pads_f.value)
        return replace(estimate, best=replace(estimate.best, pads_f=pads))

    monkeypatch.setattr(validate, "estimate_run", wrong)


def diagnosis_without_a_name(monkeypatch):
    nothing = SimpleNamespace(verdict="unknown", effects=())
    monkeypatch.setattr(room, "diagnose", lambda *logs: nothing)


@pytest.mark.parametrize(
    ("break_it", "group", "fails"),
    [
        (wrong_gain, 0, "brake_torque"),
        (wrong_pads, 2, "stop_pads_f"),
        (diagnosis_without_a_name, 3, "drag_named drag_size"),
    ],
)
def test_a_break_is_seen_by_the_checks_that_are_meant_for_it(monkeypatch, break_it, group, fails):
    break_it(monkeypatch)
    measure = list(SUITE)[group]
    checks = qualify({measure: SUITE[measure]})["checks"]
    assert {check["name"] for check in checks if not check["held"]} == set(fails.split())
