import numpy as np

from calib.fitting.fit import fit
from calib.run.run import Run
from calib.show.ramp import measure
from tests.support.reference_car import CAR, REAL, ramp


def test_points_of_a_clean_ramp_with_drag_lie_on_the_curves():
    """The plant has 0.66 m^2 of drag and 0.011 of rolling resistance; the table has neither.

    With them a point would be up to 5 % off.
    """
    log = ramp(REAL)
    table = fit(CAR, [log])
    found = measure(table, log)
    z = Run(log, CAR).blocks.z
    inside = found.braked & (z > 0.08) & (z < 0.95 * table.paper.z[-1])
    assert inside.sum() > 50
    D = np.interp(found.eta, table.difference.eta, table.difference.D)[inside]
    # on the curve within 2 % of D, a tenth of its band
    assert np.max(np.abs((found.f1 - found.f2)[inside] / D - 1.0)) < 0.02
