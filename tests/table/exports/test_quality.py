import json

import pytest

from calib.errors import ExchangeError
from calib.table.exports.quality import read_quality


@pytest.fixture
def summary(tmp_path):
    def write(**changes):
        logs = [{"log": "stop", "role": "hold-out", "verdict": "passed"}]
        document = {"schema": 1, "table": "sedan@1", "verdict": "passed", "logs": logs, **changes}
        path = tmp_path / "summary.json"
        path.write_text(json.dumps(document))
        return path

    return write


@pytest.mark.parametrize(
    ("verdict", "state"), [("passed", "checked"), ("failed", "prelimCalibrated")]
)
def test_the_verdict_decides_the_state(summary, verdict, state):
    found = read_quality(summary(verdict=verdict), "sedan@1")
    assert (found.state, found.verdict) == (state, verdict)
    assert found.words == f"{verdict} on 1 hold-out log: stop passed"


def test_logs_of_the_fit_prove_nothing(summary):
    logs = [{"log": "ramp", "role": "calibration", "verdict": "passed"}]
    found = read_quality(summary(logs=logs), "sedan@1")
    assert (found.state, found.verdict) == ("calibrated", None)
    assert "proves nothing" in found.words


def test_another_table_is_refused(summary):
    with pytest.raises(ExchangeError, match=r"validation of sedan@1; expected one of sedan@2"):
        read_quality(summary(), "sedan@2")


@pytest.mark.parametrize("content", ["", "[]", "{}", '{"logs": [1]}', '{"logs": 3}'])
def test_what_is_no_summary_is_refused(tmp_path, content):
    path = tmp_path / "summary.json"
    path.write_text(content)
    with pytest.raises(ExchangeError, match="no summary of a validation"):
        read_quality(path, "sedan@1")
    with pytest.raises(ExchangeError, match="cannot be read"):
        read_quality(tmp_path / "none.json", "sedan@1")


def test_another_verdict_is_refused(summary):
    with pytest.raises(ExchangeError, match="verdict: 'perhaps'; expected 'passed' or 'failed'"):
        read_quality(summary(verdict="perhaps"), "sedan@1")
