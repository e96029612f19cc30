from calib.plots.verdict import verdict_of
from calib.validation.limits import Limit
from calib.validation.validate import validate_one


def test_the_verdict_is_that_of_the_validation(sedan, transition, trace):
    assert trace.verdict.startswith("passed")
    strict = (Limit("interval_f", None, 0.01), Limit("valid_share", 0.5, None))
    failed = validate_one(sedan, transition, None, strict, baselines=False)
    width = failed.figures["interval_f"]
    assert verdict_of(failed).startswith(f"failed: interval front {width:.3g}, at most 0.01")
    assert "valid share" not in verdict_of(failed)


def test_a_log_of_the_fit_has_no_verdict(sedan, ramp):
    result = validate_one(sedan, ramp, None, (), baselines=False)
    assert verdict_of(result) == "no verdict: the table was fitted on this log"
