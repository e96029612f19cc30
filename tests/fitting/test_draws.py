"""The draws that a table keeps are an ensemble again."""

import numpy as np

from calib.fitting.draws import draws_of, ensemble_of
from tests.support.tables import VEHICLE, made_draws, made_table


def test_the_draws_of_an_ensemble_give_it_back():
    kept = made_draws(400)
    again = draws_of(VEHICLE, ensemble_of(VEHICLE, kept), made_table().calibration)
    for name in vars(kept).keys() - {"log_pad_level", "weight"}:
        np.testing.assert_allclose(getattr(again, name), getattr(kept, name), rtol=1e-12)
