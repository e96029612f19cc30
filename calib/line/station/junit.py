"""JUnit XML of a car, for the line's systems: one test case per check, classes by scope.

A check with a warning passes, with a text in `system-out`; a metric that is not known is skipped.
It is valid by the schema junit-10 of Jenkins' xUnit plugin.
"""

from xml.etree import ElementTree

from calib.estimation.limits import FAILED, NOT_KNOWN, WARNING
from calib.line.station.limits_file import action
from calib.line.station.station import StationCheck, StationOutcome
from calib.store.version import Stored


def junit_xml(found: StationOutcome, stored: Stored) -> bytes:
    """The document. All times are zero, so that the same car gives the same bytes."""
    n = found.counts()
    totals = {
        "tests": str(len(found.checks)),
        "failures": str(n[FAILED]),
        "errors": "0",
        "skipped": str(n[NOT_KNOWN]),
        "time": "0",
    }
    known = {name: total for name, total in totals.items() if name != "skipped"}
    root = ElementTree.Element("testsuites", known)  # Jenkins allows `skipped` on a suite only
    suite = ElementTree.SubElement(root, "testsuite", {"name": "brake-cal station", **totals})
    properties = ElementTree.SubElement(suite, "properties")
    stated = {
        "verdict": found.verdict,
        "table": stored.id,
        "digest": stored.digest,
        "state": stored.state.word,
        **found.identity.given(),
    }
    for name, value in stated.items():
        ElementTree.SubElement(properties, "property", {"name": name, "value": _clean(value)})
    for check in found.checks:
        _case(suite, check)
    if found.warnings:
        output = ElementTree.SubElement(suite, "system-out")
        output.text = "\n".join(f"warning: {_clean(str(one))}" for one in found.warnings)
    ElementTree.indent(root)
    text: bytes = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)
    return text + b"\n"


def _case(suite: ElementTree.Element, check: StationCheck) -> None:
    names = {"classname": _clean(check.scope), "name": check.figure, "time": "0"}
    case = ElementTree.SubElement(suite, "testcase", names)
    if check.verdict == FAILED:
        failure = ElementTree.SubElement(case, "failure", {"message": _clean(check.text)})
        failure.text = action(check.figure)
    elif check.verdict == NOT_KNOWN:
        ElementTree.SubElement(case, "skipped", {"message": "the logs cannot give this metric"})
    elif check.verdict == WARNING:
        output = ElementTree.SubElement(case, "system-out")
        output.text = f"warning: {_clean(check.text)}. {action(check.figure)}"


def _clean(text: str) -> str:
    """``text`` without characters that XML 1.0 cannot hold; a log's name may have any bytes."""
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text)
