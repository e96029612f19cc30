import numpy as np

from calib.fitting.fit import fit
from calib.run.run import Run
from calib.show.ramp import measure
from tests.support.reference_car import CAR, REAL, ramp


def test_points_of_a_clean_ramp_with_drag_lie_on_the_curves():
    """The plant has 0.66 m^2 of drag and 0.011 of rolling, which would move points by up to 5 %."""
    log = ramp(REAL)
    table = fit(CAR, [log])
    measured = measure(table, log)
    z = Run(log, CAR).blocks.z
    is_inside = measured.braked & (z > 0.08) & (z < 0.95 * table.paper.z[-1])
    assert is_inside.sum() > 50
    D = np.interp(measured.eta, table.difference.eta, table.difference.D)[is_inside]
    # on the curve within 2 % of D, a tenth of its band
    assert np.max(np.abs((measured.f1 - measured.f2)[is_inside] / D - 1.0)) < 0.02
