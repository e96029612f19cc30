import json

import pytest

from calib.base.errors import ExchangeError
from calib.store.quality import read_quality


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
def test_the_verdict_decides_the_state(summary, stored, verdict, state):
    found = read_quality(summary(verdict=verdict), stored)
    assert (found.state, found.verdict) == (state, verdict)
    assert found.words == f"{verdict} on 1 hold-out log: stop passed"


def test_logs_of_the_fit_prove_nothing(summary, stored):
    logs = [{"log": "ramp", "role": "calibration", "verdict": "passed"}]
    found = read_quality(summary(logs=logs), stored)
    assert (found.state, found.verdict) == ("calibrated", None)
    assert "proves nothing" in found.words


@pytest.mark.parametrize(
    ("other", "says"),
    [
        ({"table": "sedan@2"}, r"validation of sedan@2; expected one of sedan@1, digest [0-9a-f]"),
        ({"digest": "0" * 64}, r"validation of sedan@1, digest 000000000000; expected one of"),
    ],
)
def test_another_table_is_refused(summary, stored, other, says):
    with pytest.raises(ExchangeError, match=says):
        read_quality(summary(**other), stored)


@pytest.mark.parametrize("content", ["", "[]", "{}", '{"logs": [1]}', '{"logs": 3}'])
def test_what_is_no_summary_is_refused(tmp_path, stored, content):
    path = tmp_path / "summary.json"
    path.write_text(content)
    with pytest.raises(ExchangeError, match="no summary of a validation"):
        read_quality(path, stored)
    with pytest.raises(ExchangeError, match="cannot be read"):
        read_quality(tmp_path / "none.json", stored)


def test_another_verdict_is_refused(summary, stored):
    with pytest.raises(ExchangeError, match="verdict: 'perhaps'; expected 'passed' or 'failed'"):
        read_quality(summary(verdict="perhaps"), stored)
