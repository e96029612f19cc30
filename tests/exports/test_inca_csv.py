import csv

import pytest

from calib.exports.build import build
from calib.exports.plain import write_inca_csv
from tests.exports.conftest import bits


def blocks(content):
    """Rows of each object by its label, as the csv module splits them."""
    text = content.decode()
    found = {}
    for part in text.split("\r\n\r\n"):
        lines = [line for line in part.split("\r\n") if line and not line.startswith("*")]
        rows = list(csv.reader(lines, delimiter=";"))
        if rows and rows[0][0] == "" and len(rows[0]) == 2:
            found[rows[0][1]] = rows[1:]
    return found


@pytest.mark.parametrize("points", [None, 16])
def test_blocks_hold_the_table_to_the_last_bit(real, truth, points):
    data = build(real, points)
    found = blocks(write_inca_csv(data))
    for name in ("f1", "f2", "D", "g"):
        head, axis, values, _ = found[f"{data.prefix}_{name}"]
        assert (head[0], axis[:2], values[:2]) == ("CURVE", ["X_AXIS_PTS", "[1]"], ["", "[1]"])
        x = [float(v) for v in axis[2:]]
        assert bits(x, values[2:]) == truth(real).at(x)[name]
    assert found[f"{data.prefix}_f1"][0][1] == f"{data.prefix}_eta"
    shared = found[f"{data.prefix}_eta"][0]
    assert shared[0] == "AXIS_PTS"
    assert shared[2:] == found[f"{data.prefix}_f1"][1][2:]


def test_head_and_scalars(stored):
    content = write_inca_csv(build(stored))
    assert content.startswith(b'CALIBRATION VALUES V2.1;.;*;""\r\n')
    assert f"* digest: {stored.digest}\r\n".encode() in content
    assert blocks(content)["sedan_mass"][0] == ["VALUE", "[kg]", "1744.0"]
