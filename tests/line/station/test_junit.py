"""JUnit XML, counted by the standard library's parser."""

import re
from xml.etree import ElementTree

from calib.line.station.files import junit_xml

ALLOWED = {
    "testsuites": ({"name", "time", "tests", "failures", "errors"}, {"testsuite"}),
    "testsuite": (
        {
            *("name", "tests", "failures", "errors", "group", "time", "skipped", "timestamp"),
            *("hostname", "id", "package", "file", "log", "url"),
        },
        {"testsuite", "properties", "testcase", "system-out", "system-err"},
    ),
    "properties": (set(), {"property"}),
    "property": ({"name", "value"}, set()),
    "testcase": (
        {"name", "time", "classname", "group"},
        {"skipped", "error", "failure", "system-out", "system-err"},
    ),
    "failure": ({"type", "message"}, set()),
    "skipped": ({"type", "message"}, set()),
    "system-out": (set(), set()),
}
"""Attributes and children of each element by junit-10.xsd of Jenkins' xUnit plugin, as rules: see
https://github.com/jenkinsci/xunit-plugin, org/jenkinsci/plugins/xunit/types/model/xsd."""

REQUIRED = {
    "testsuite": {"name", "tests", "failures", "errors"},
    "testcase": {"name"},
    "property": {"name", "value"},
}


def test_jenkins_takes_it(outcome, stored):
    root = ElementTree.fromstring(junit_xml(outcome, stored))
    assert root.tag == "testsuites"
    assert "\N{REPLACEMENT CHARACTER}" not in junit_xml(outcome, stored).decode()
    assert {element.tag for element in root.iter()} >= {"failure", "skipped", "property"}
    for element in root.iter():
        attributes, children = ALLOWED[element.tag]
        assert set(element.attrib) <= attributes, element.tag
        assert set(element.attrib) >= REQUIRED.get(element.tag, set())
        assert {child.tag for child in element} <= children, element.tag
        assert re.fullmatch(r"[0-9]*(\.[0-9]*)?", element.get("time", ""))


def test_counts_are_those_of_the_cases(outcome, stored):
    root = ElementTree.fromstring(junit_xml(outcome, stored))
    (suite,) = root
    cases = suite.findall("testcase")
    assert len(cases) == int(suite.get("tests")) == len(outcome.checks)
    for tag, total, word in (
        ("failure", "failures", "failed"),
        ("skipped", "skipped", "not known"),
    ):
        n = sum(case.find(tag) is not None for case in cases)
        assert n == int(suite.get(total)) == outcome.counts[word]
    assert int(root.get("failures")) == int(suite.get("failures"))
    assert int(suite.get("failures")) >= 2  # wet pads do not agree with dry ones
