import numpy as np
import pytest

from calib.base.errors import ExchangeError
from calib.estimation.lookup import difference, paper
from calib.exports.build import build


def test_ends_are_clamped_as_the_look_up_does(stored):
    """What every file says of the ends is what `calib.estimation.lookup` does."""
    z, eta = np.full(2, 0.1), np.array([0.9, 1.1])
    curves = {c.label: c.values for c in build(stored).curves}
    read = paper(stored.table, z, eta, z)
    assert (read.F_f - z).tolist() == pytest.approx(curves["sedan_f1"][[0, -1]].tolist())
    assert (read.F_r - z).tolist() == pytest.approx(curves["sedan_f2"][[0, -1]].tolist())
    assert not read.inside.any()
    D = difference(stored.table, z, eta, z)
    assert (D.F_f - D.F_r).tolist() == pytest.approx(curves["sedan_D"][[0, -1]].tolist())


def test_18_holds_on_the_breakpoints_too(real):
    """F_zf f1 + F_zr f2 = 0 at each row's own z, from the wheelbase."""
    data, car, p = build(real, 12), real.table.vehicle, real.table.paper
    f1, f2 = (next(c for c in data.curves if c.label.endswith(n)).values for n in ("_f1", "_f2"))
    eta = data.axis(f"{data.prefix}_eta").values
    z = np.array([p.z[np.flatnonzero(p.eta == x)[0]] for x in eta])
    front = car.cg_to_rear_axle + z * car.cg_height
    rear = car.cg_to_front_axle - z * car.cg_height
    assert np.abs(front * f1 + rear * f2).max() < 1e-9


def test_labels_are_unique(real):
    data = build(real)
    labels = [x.label for part in (data.axes, data.curves, data.scalars) for x in part]
    assert len(labels) == len(set(labels))


@pytest.mark.parametrize("points", [-1, 0, 1, 22])
def test_points_that_cannot_be_had_are_refused(stored, points):
    with pytest.raises(ExchangeError, match=f"{points} breakpoints; expected 2 to 21"):
        build(stored, points)


def test_the_checksum_sees_the_last_bit(stored):
    from dataclasses import replace

    content = build(stored).content()
    mass = content.scalars["sedan_mass"]
    other = replace(content, scalars={**content.scalars, "sedan_mass": np.nextafter(mass, 0)})
    assert other.checksum != content.checksum
