"""What `validate --out` leaves: the contract of the columns, whole or not at all."""

from types import SimpleNamespace

import numpy as np
import pyarrow.parquet as pq

from calib.estimation.results import fill
from tests.estimation.test_metrics import N, made_estimate

SEEN = ("z", "eta", "normalised_force_f", "normalised_force_r")
PADS = ("friction_f", "friction_r", "change_f", "change_r", "level", "ratio")
TORQUES = [f"brake_torque_{x}" for x in ("fl", "fr", "rl", "rr", "sum")]
BOUNDED = {f"pad_{x}": "1" for x in PADS} | dict.fromkeys(TORQUES, "N*m")
OUT = {"valid": "1"} | {
    f"{name}{end}": unit for name, unit in BOUNDED.items() for end in ("", "_lower", "_upper")
}
CONTRACT = (
    {"time": "s"}
    | dict.fromkeys(SEEN, "1")
    | OUT
    | {f"ecu_{name}": unit for name, unit in OUT.items()}
    | {"ecu_reason": "1"}
)
"""As the brief has them, and what was added after them: others read these files."""


def write(estimate, folder):
    fill([SimpleNamespace(log="a", estimate=estimate)], {}, folder)


def test_columns_are_those_of_the_contract(tmp_path):
    write(made_estimate(), tmp_path)
    schema = pq.read_schema(tmp_path / "a.parquet")
    assert set(schema.names) == set(CONTRACT)
    assert schema.names[:5] == ["time", *SEEN]
    assert {f.name: f.metadata[b"unit"].decode() for f in schema} == CONTRACT
    kinds = {f.name: str(f.type) for f in schema}
    assert [kinds.pop(name) for name in ("valid", "ecu_valid")] == ["bool", "bool"]
    assert kinds.pop("ecu_reason") == "int64"
    assert set(kinds.values()) == {"double"}


def test_a_frame_has_the_columns_of_the_file_and_their_units(tmp_path):
    e = made_estimate(0.41, 0.35, valid=np.arange(N) % 3 == 0)
    write(e, tmp_path)
    frame = e.to_frame()
    assert list(frame.columns) == pq.read_schema(tmp_path / "a.parquet").names
    assert frame.attrs["units"] == CONTRACT
    read = pq.read_table(tmp_path / "a.parquet")
    for name in CONTRACT:
        assert np.array_equal(frame[name], read[name], equal_nan=name != "valid")
