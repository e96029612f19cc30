"""JUnit XML, counted by the standard library's parser."""

from dataclasses import replace
from xml.etree import ElementTree

from calib.station.junit import junit_xml
from tests.support.station_run import MARKUP


def test_counts_are_those_of_the_cases(found, kept):
    root = ElementTree.fromstring(junit_xml(found, kept))
    (suite,) = root
    cases = suite.findall("testcase")
    assert len(cases) == int(suite.get("tests")) == len(found.checks)
    for tag, total, word in (
        ("failure", "failures", "failed"),
        ("skipped", "skipped", "not known"),
    ):
        n = sum(case.find(tag) is not None for case in cases)
        assert n == int(suite.get(total)) == int(root.get(total)) == found.counts()[word]
    assert int(suite.get("failures")) >= 2  # wet pads do not agree with dry ones


def test_a_failure_says_value_limit_and_what_to_do(found, kept):
    suite = ElementTree.fromstring(junit_xml(found, kept))[0]
    case = next(c for c in suite.iter("testcase") if c.get("name") == "repeatability_f")
    assert "the limit is at most 0.15" in case.find("failure").get("message")
    assert "Drive two stops again" in case.find("failure").text


def test_names_and_identifiers_survive(found, kept):
    suite = ElementTree.fromstring(junit_xml(found, kept))[0]
    told = {p.get("name"): p.get("value") for p in suite.iter("property")}
    assert told["serial"] == MARKUP
    assert told["vin"] == "WVWZZZ1JZXW000001"
    assert MARKUP in {case.get("classname") for case in suite.iter("testcase")}


def test_what_xml_cannot_hold_is_replaced(found, kept):
    checks = (replace(found.checks[0], stop="a\x01b\ud800"),)
    suite = ElementTree.fromstring(junit_xml(replace(found, checks=checks), kept))[0]
    assert suite.find("testcase").get("classname") == "a\ufffdb\ufffd"
