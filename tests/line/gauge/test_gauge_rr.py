import numpy as np
import pytest
from scipy.stats import chi2

from calib.line.gauge.anova import CAR, INTERACTION, REPEATABILITY, STATION, anova
from calib.line.gauge.gauge_rr import DRAWS, GAUGE, REPRODUCIBILITY, TOTAL, gauge_rr
from tests.line.gauge.test_anova import aiag, crossed, drawn


def test_the_published_study():
    # AIAG MSA, 4th ed.: EV 0.199933, AV 0.226838, GRR 0.302373, PV 1.042327; 18.4, 20.9, 27.9 %;
    # ndc 1.41 * 1.042327 / 0.302373 = 4.861, cut to 4
    found = gauge_rr(anova(*aiag(), terms=(CAR, STATION, REPEATABILITY)))
    sd = {name: c.sd for name, c in found.components.items()}
    assert sd[REPEATABILITY] == pytest.approx(0.199933, abs=2e-6)
    assert sd[REPRODUCIBILITY] == pytest.approx(0.226838, abs=2e-6)
    assert sd[GAUGE] == pytest.approx(0.302373, abs=2e-6)
    assert sd[CAR] == pytest.approx(1.042327, abs=2e-6)
    assert found.grr == pytest.approx(0.279, abs=5e-4)
    assert found.ndc == pytest.approx(4.861, abs=1e-3)
    assert found.categories == 4


def test_the_tolerance_is_compared_with_six_standard_deviations():
    # AIAG MSA, 4th ed.: 6 GRR/(USL - LSL), GRR 0.302373 as published
    design = anova(*aiag(), terms=(CAR, STATION, REPEATABILITY))
    found = gauge_rr(design, tolerance=8.0)
    assert found.tolerance == pytest.approx(6.0 * 0.302373 / 8.0, rel=1e-5)
    low, high = found.tolerance95
    assert low < found.tolerance < high
    assert found.cars_differ
    assert gauge_rr(design).tolerance is None


def test_a_negative_variance_is_nought_and_told():
    found = gauge_rr(anova(*aiag()))
    both = found.components[INTERACTION]
    # (0.01994 - 0.04598)/3
    assert both.raw == pytest.approx(-0.00868, abs=1e-5)
    assert both.variance == 0.0
    assert both.low == 0.0
    assert found.negative == (INTERACTION,)
    parts = [found.components[name].variance for name in (REPEATABILITY, STATION, CAR)]
    assert found.components[TOTAL].variance == pytest.approx(sum(parts))


def test_the_interval_of_the_repeatability_is_the_exact_one():
    found = gauge_rr(anova(*aiag())).components[REPEATABILITY]
    exact = 2.7589 / chi2.ppf([0.975, 0.025], 60)
    assert (found.low, found.high) == pytest.approx(tuple(exact), rel=0.02)
    assert DRAWS >= 10_000


def test_the_same_numbers_give_the_same_interval():
    assert gauge_rr(anova(*aiag())) == gauge_rr(anova(*aiag()))


def test_what_does_not_scatter_is_refused():
    car, station = crossed(3, 2, 2)
    with pytest.raises(ValueError, match="nothing scatters"):
        gauge_rr(anova(np.ones(12), car, station))


@pytest.mark.parametrize("missing", [False, True])
def test_intervals_hold_the_truth_as_often_as_they_say(missing):
    """Ten cars, four stations, two repeats; with 300 studies 90 % is 4 sigma below 95 %."""
    rng = np.random.default_rng(11)
    car, station = crossed(10, 4, 2)
    keep = rng.random(car.size) > (0.2 if missing else -1.0)
    sd = (1.0, 0.3, 0.15, 0.2)
    grr = np.sqrt(1.0 - 1.0 / np.sum(np.square(sd)))
    held = np.zeros(3)
    for _ in range(300):
        y = drawn(rng, car, station, sd)[keep]
        found = gauge_rr(anova(y, car[keep], station[keep]))
        c = found.components
        held += [
            c[CAR].low <= sd[0] ** 2 <= c[CAR].high,
            c[REPEATABILITY].low <= sd[3] ** 2 <= c[REPEATABILITY].high,
            found.grr95[0] <= grr <= found.grr95[1],
        ]
    assert np.all(held / 300 > 0.90)
