"""What `check` says a log is good for is what fit, validate and diagnose say of it.

More logs: `python -m tests.support.spoiled 300`.
"""

import numpy as np
import pytest

from calib.base.warning import REFUSE, RULES, UNITS, VOID
from calib.plausibility import rules
from calib.plausibility.check import check
from tests.support.made_runs import changed
from tests.support.plant import as_log, drive
from tests.support.reference_car import REAL, misread, noisy, ramp, stop, swapped
from tests.support.refusals import why_not
from tests.support.spoiled import disagreements, findings, spoiled

COAST = as_log(drive(REAL, lambda t: 0.0, 33.0, duration=8.0), "coast")
LOGS = {"ramp": noisy(ramp(REAL), 1), "stop": noisy(stop(REAL), 2), "coast": noisy(COAST, 3)}


def scaled(log, factor, *wheels):
    return changed(log, **{f"omega_{w}": factor * log[f"omega_{w}"] for w in wheels})


NAMED = {
    "good": ("ramp", lambda log: log, set()),
    "good stop": ("stop", lambda log: log, set()),
    "swapped axles": ("ramp", swapped, {"eta_falls"}),
    "a_x times 1.2": ("ramp", lambda log: misread(log, 1.2), {"v_scale"}),
    "a_x times 1.2 in a stop": ("stop", lambda log: misread(log, 1.2), {"v_scale"}),
    "a wheel 10 % off": ("ramp", lambda log: scaled(log, 1.1, "fl"), {"sides_f"}),
    "wheels of an axle in other units": (
        "stop", lambda log: scaled(log, 0.5, "rl", "rr"), {"eta_zero"},
    ),
    "v of wheels": (
        "ramp", lambda log: changed(log, v=0.322 * log["omega_rl"]), {"v_of_wheels"},
    ),
}  # fmt: skip


@pytest.mark.parametrize("mistake", NAMED)
def test_check_names_a_mistake_as_its_uses_do(mistake, fitted):
    kind, make, codes = NAMED[mistake]
    log = make(LOGS[kind])
    assert codes <= {*why_not(log, "fit"), *why_not(log, "validate")}
    if not codes:
        assert check(log).verdicts[1].usable
    assert disagreements(log, fitted) == []


@pytest.mark.parametrize("seed", range(3))
def test_spoiled_logs(seed, fitted):
    """No traceback either, and no number that is not finite."""
    for number, kind in enumerate(LOGS):
        mistakes, text = spoiled(LOGS[kind], np.random.default_rng([20 + seed, number]))
        assert findings(text, fitted, kind == "ramp") == [], mistakes


def test_a_fit_warns_of_what_check_warns_of(fitted):
    """A wheel that is 3 % off moves the radius of its axle by half of that."""
    log = scaled(LOGS["ramp"], 1.03, "fl")
    assert why_not(log, "fit") == []
    assert "sides_f" in {warning.code for warning in check(log).warnings}
    evidence = rules.Evidence(rules.Run(log))
    assert "sides_f" in {warning.code for warning in rules.warnings_on(evidence, "fit")}


def test_every_rule_has_a_figure_and_every_refusal_says_what_to_do():
    outside = {"changes", "exchanged", "mistakes", "pads", "priors", "resistance", "vehicle"}
    named = (*rules._LOG_FIGURES, *rules._MOTION_FIGURES, *rules._SIGNAL_FIGURES)
    figures = {figure.__name__ for figure in named}
    assert {rule.figure for rule in RULES} == figures | outside
    for rule in RULES:
        if rule.consequence in (REFUSE, VOID):
            assert rule.do, rule.code
            assert (rule.low, rule.high) != (-np.inf, np.inf), rule.code
        assert set(rule.purposes) <= {*rules.PURPOSES, "check", "vehicle", "station"}, rule.code
    assert len(UNITS) > 90
