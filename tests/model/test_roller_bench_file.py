"""The file of a roller brake tester: what it says in SI, and every slip it must not let through."""

import hashlib

import pytest

from calib.base.errors import BenchError
from calib.model.roller_bench_file import read_roller_bench
from tests.support.refusals import refusal

TEXT = """schema = 1
tolerance = "1.5 %"
[front]
p_mc = ["10 bar", "20 bar", "3 MPa"]
brake_force = ["1.75 kN", "353 daN", "5310 N"]
[rear]
p_mc = ["10 bar", "20 bar", "30 bar"]
brake_force = ["622 N", "1284 N", "1942 N"]
"""


def write(tmp_path, *changes):
    text = TEXT
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    path = tmp_path / "rollers.toml"
    path.write_text(text)
    return path


def test_a_file_is_read_in_si(tmp_path):
    path = write(tmp_path)
    bench = read_roller_bench(path)
    assert (bench.name, bench.source, bench.tolerance) == ("rollers", str(path), 0.015)
    assert bench.digest == hashlib.sha256(path.read_bytes()).hexdigest()
    assert bench.front.pressure == pytest.approx((10e5, 20e5, 30e5))
    assert bench.front.force == pytest.approx((1750.0, 3530.0, 5310.0))
    assert bench.rear.force == pytest.approx((622.0, 1284.0, 1942.0))


@pytest.mark.parametrize(
    ("old", "new", "where"),
    [
        ('"20 bar"', '"20"', "front.p_mc[1]"),  # no unit
        ('"20 bar"', "20", "front.p_mc[1]"),
        ('"1.75 kN"', '"1.75 kp"', "front.brake_force[0]"),  # unknown
        ('"1.75 kN"', '"1.75 kg"', "front.brake_force[0]"),  # of another quantity
        ('"1.75 kN"', '"-1.75 kN"', "front.brake_force[0]"),
        ('"1.75 kN"', '"0 N"', "front.brake_force[0]"),
        ('"10 bar"', '"1 bar"', "front"),  # below the bite
        ('"10 bar"', '"20 bar"', "front"),  # two pressures
        (', "5310 N"', "", "front"),  # a force too few
        ("brake_force", "brake_force_left", "front"),
        (TEXT[TEXT.index("[rear]") :], "", "'rear'"),  # one axle
        ("[rear]", "[axle_2]", "axle_2"),
        ("schema = 1", "schema = 2", "schema"),
        ('"1.5 %"', '"150 %"', "tolerance"),
    ],
)
def test_wrong_entries_are_named(tmp_path, old, new, where):
    path = write(tmp_path, (old, new))
    assert where in refusal(read_roller_bench, path, kind=BenchError, names=path)
