"""The tree of errors: exit codes and messages."""

import pytest

from calib.base import errors
from calib.base.errors import BrakeCalError

CLASSES = {n: c for n, c in vars(errors).items() if isinstance(c, type)}

CODES = {
    2: "BatchError RevisionError TableNotFound UsageError",
    3: "LogError VehicleError ChannelMapError LimitsError ModelError SettingsError ExchangeError "
    "NotFiniteError ProgramError KeyFileError BenchError TyreError",
    4: "StoreError DamagedTable SignatureRefused",
    5: "AnswerError",
    6: "ProgramFailure",
}


@pytest.mark.parametrize(("code", "names"), CODES.items())
def test_exit_codes(code, names):
    assert {CLASSES[name]("x").exit_code for name in names.split()} == {code}


def test_a_message_is_one_line_whatever_is_put_into_it():
    error = BrakeCalError("not\r\n\tTOML", where="a\n\x1b[2J.csv", expected="b\nc", do="\u202ed")
    assert str(error) == "a\\n\\x1b[2J.csv: not TOML; expected b c; \\u202ed"
