from calib.line.fleet.edges import possible


def test_the_results_of_a_fit_cannot_be_negative():
    assert possible("pad_friction_f_sigma") == possible("deceleration_max") == (0.0, float("inf"))
    assert possible("eta_peak_is_real") == (0.0, 1.0)
    assert possible("a column of somebody else") == (-float("inf"), float("inf"))
