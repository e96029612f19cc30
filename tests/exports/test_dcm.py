"""DCM as another reader sees it. It loops on a missing END: it gets a process and a limit."""

import json
import subprocess
import sys

import pytest

from calib.exports.build import build
from calib.exports.dcm import write_dcm
from tests.exports.conftest import bits

READER = """
import json, logging, sys
from dcmReader.dcm_reader import DcmReader
logging.disable(logging.NOTSET)
d = DcmReader()
d.read(sys.argv[1])
hexed = lambda values: [float(v).hex() for v in values]
print(json.dumps({
    "axes": {a.name: [hexed(a.values), a.unit_x, a.x_dimension] for a in d.get_distributions()},
    "groups": {c.name: [hexed(c.values), hexed(c.values.values()), c.x_mapping, c.unit_x,
                        c.unit_values, c.x_dimension, c.description, c.comment]
               for c in d.get_group_characteristic_lines()},
    "lines": {c.name: [hexed(c.values), hexed(c.values.values()), c.x_dimension]
              for c in d.get_characteristic_lines()},
    "scalars": {p.name: [float(p.value).hex(), p.unit, p.description] for p in d.get_parameters()},
    "functions": [[f.name, f.version, f.description] for f in d.get_functions()],
    "head": d._file_header,
}))
"""


@pytest.fixture
def dcm_reader(tmp_path):
    """What dcmReader makes of a file, and that it complained of nothing."""

    def read(content):
        path = tmp_path / "table.dcm"
        path.write_bytes(content)
        run = subprocess.run(
            [sys.executable, "-c", READER, path],
            capture_output=True,
            text=True,
            timeout=60,
            check=True,
        )
        assert run.stderr == ""
        return json.loads(run.stdout)

    return read


@pytest.mark.parametrize("points", [None, 16])
def test_another_reader_sees_the_table_to_the_last_bit(real, truth, dcm_reader, points):
    data = build(real, points)
    seen = dcm_reader(write_dcm(data))
    p, table = data.prefix, real.table
    eta = [float.fromhex(v) for v in seen["axes"][f"{p}_eta"][0]]
    slip = [float.fromhex(v) for v in seen["lines"][f"{p}_g"][0]]
    assert len(eta) == len(slip) == (points or len(table.paper.eta))
    expected = truth(real)
    for name in ("f1", "f2", "D"):
        x, y, axis, unit_x, unit, size, *_ = seen["groups"][f"{p}_{name}"]
        assert list(zip(x, y, strict=True)) == expected.at(eta)[name]
        assert (axis, unit_x, unit, size) == (f"{p}_eta", "1", "1", len(eta))
    x, y, size = seen["lines"][f"{p}_g"]
    assert list(zip(x, y, strict=True)) == expected.at(slip)["g"]
    assert size == len(slip)


def test_scalars_have_value_unit_and_long_name(real, dcm_reader):
    seen = dcm_reader(write_dcm(build(real)))["scalars"]
    car, first = real.table.vehicle, build(real).prefix
    assert seen[f"{first}_mass"] == [car.mass.hex(), "kg", "M_v, vehicle mass"]
    gain = 2 * car.front.piston_area * car.front.effective_radius
    assert float.fromhex(seen[f"{first}_C_f"][0]) == pytest.approx(gain)
    assert seen[f"{first}_C_f"][1] == "m^3"
    drag = real.table.effects.parameters["aerodynamic_drag"]["drag_area"]
    assert seen[f"{first}_drag_area"][:2] == [drag.hex(), "m^2"]


def test_the_head_says_which_table_it_is_and_what_holds_at_the_ends(stored, dcm_reader):
    seen = dcm_reader(write_dcm(build(stored, 5)))
    assert "table: sedan@1" in seen["head"]
    assert f"digest: {stored.digest}" in seen["head"]
    assert "clamped, never extrapolated" in seen["head"]
    assert "5 of 21 rows; interpolation error at most" in seen["head"]
    assert seen["functions"] == [["sedan_brake_torque", "1", "sedan@1"]]
    assert "range 0.0 to " in seen["groups"]["sedan_f1"][7]


def test_an_axis_of_its_own_for_D_where_the_rows_differ(stored, dcm_reader):
    from dataclasses import replace

    d = stored.table.difference
    half = replace(d, **{k: v[::2] for k, v in vars(d).items()})
    other = replace(stored, table=replace(stored.table, difference=half))
    seen = dcm_reader(write_dcm(build(other)))
    assert seen["groups"]["sedan_D"][2] == "sedan_eta_D"
    x, y = seen["groups"]["sedan_D"][:2]
    assert list(zip(x, y, strict=True)) == bits(half.eta, half.D)
