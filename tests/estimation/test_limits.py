"""Limits: read with care, judged without."""

from hypothesis import given
from hypothesis import strategies as st

from calib.estimation.limits import Judgement, Limit, judge
from calib.estimation.limits_file import read_limits
from calib.estimation.metrics import METRICS

KNOWN = set(METRICS)


def write(tmp_path, text):
    path = tmp_path / "limits.toml"
    path.write_text(text)
    return path


def test_read_in_the_order_of_the_file(tmp_path):
    path = write(
        tmp_path,
        "schema = 1\n[limits]\nvalid_share = { min = 0.7 }\n"
        "torque_error_f = { max = 0.05 }\neta_zero = { min = -1, max = 1 }\n",
    )
    assert read_limits(path, KNOWN) == (
        Limit("valid_share", 0.7, None),
        Limit("torque_error_f", None, 0.05),
        Limit("eta_zero", -1.0, 1.0),
    )


@given(value=st.floats(-2, 2), low=st.none() | st.floats(-1, 0), high=st.none() | st.floats(0, 1))
def test_a_figure_passes_within_its_ends(value, low, high):
    (judged,) = judge((Limit("a", low, high),), {"a": value})
    outside = (low is not None and value < low) or (high is not None and value > high)
    assert judged == Judgement("a", low, high, value=value)
    assert judged.verdict == ("failed" if outside else "passed")


@given(
    value=st.floats(-3, 3) | st.none(),
    fail=st.floats(1, 2),
    warn=st.floats(0, 1),
    required=st.booleans(),
)
def test_a_wider_range_never_judges_harder(value, fail, warn, required):
    order = ["passed", "warning", "failed"]
    (narrow,) = judge((Limit("a", -fail, fail, -warn, warn, required),), {"a": value})
    (wide,) = judge((Limit("a", -fail - 1, fail + 1, -warn - 1, warn + 1, required),), {"a": value})
    if value is None:
        assert narrow.verdict == wide.verdict == ("failed" if required else "not known")
    else:
        assert order.index(wide.verdict) <= order.index(narrow.verdict)


def test_a_warning_lies_between_pass_and_fail(tmp_path):
    path = write(
        tmp_path,
        "schema = 1\n[limits]\neta_zero = { fail = [-2, 2], warn = [-1, inf] }\n"
        "valid_share = { min = 0.5, warn = [0.8, inf] }\n",
    )
    limits = read_limits(path, KNOWN)
    assert limits == (
        Limit("eta_zero", -2.0, 2.0, -1.0, None),
        Limit("valid_share", 0.5, None, 0.8, None),
    )
    verdicts = [judge(limits[:1], {"eta_zero": x})[0].verdict for x in (-3, -1.5, -1, 2, 2.1, None)]
    assert verdicts == ["failed", "warning", "passed", "passed", "failed", "not known"]
    assert judge((Limit("a", 0.0, 1.0, required=True),), {})[0].verdict == "failed"
