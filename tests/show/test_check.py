"""A check in one line, for runs that were made so."""

import pytest

from calib.plausibility.check import check
from calib.show.check import line
from tests.support.made_runs import changed, made_run, ramp, stop


def standing_still(t):
    return 0.0 * t


@pytest.mark.parametrize(
    ("log", "says"),
    [
        (made_run(ramp()), "usable for fit, validate, diagnose"),
        (made_run(stop()), "usable for validate, diagnose"),
        (made_run(standing_still), "usable for fit as a coast log, diagnose"),
        (changed(made_run(ramp()), v=None), "usable for fit, validate"),
        (changed(made_run(standing_still), v=None), "usable for fit as a coast log"),
        (changed(made_run(), p_mc=None), "not usable"),
    ],
    ids=["ramp", "stop", "coast", "ramp without v", "coast without v", "no pressure"],
)
def test_the_verdict_comes_first(log, says):
    findings = check(log)
    assert line(findings).startswith(f"{says}: {log.source}")
    assert "\n" not in line(findings)
