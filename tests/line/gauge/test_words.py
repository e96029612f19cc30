"""The closing line of a gauge study."""

from dataclasses import replace

from calib.line.gauge.study import study
from calib.line.gauge.words import conclusion
from tests.line.gauge.test_study import of_pads, readings


def test_a_study_that_passes():
    # x is good, and repeats of the other metric do not scatter
    assert conclusion(study(readings())) == "passed: 1 of 1 metrics within the limits"


def test_a_study_that_fails_names_what_does_not_hold():
    bad = study(readings(sd=(1.0, 0.05, 0.7)))
    assert conclusion(bad) == "failed: 0 of 1 metrics within the limits; bad: x"
    alike = study(of_pads(readings(sd=(0.0, 0.0, 0.05))))
    assert conclusion(alike).endswith("; the cars do not differ: pad_scale")


def test_a_study_in_which_nothing_can_be_judged():
    found = study(readings())
    none = replace(found, results=tuple(r for r in found.results if r.gauge is None))
    assert conclusion(none).startswith("none of the metrics could be judged")
