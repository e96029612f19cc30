"""Variance components against a published table, designs done by hand, and known components."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.line.gauge.gauge_rr import (
    CAR,
    GAUGE,
    INTERACTION,
    REPEATABILITY,
    REPRODUCIBILITY,
    STATION,
    TOTAL,
    anova,
    causes_of,
    gauge_rr,
)

# AIAG, Measurement Systems Analysis, 4th ed.: 3 appraisers with 3 trials each, of 10 parts.
AIAG = """
0.29 -0.56 1.34 0.47 -0.80 0.02 0.59 -0.31 2.26 -1.36
0.41 -0.68 1.17 0.50 -0.92 -0.11 0.75 -0.20 1.99 -1.25
0.64 -0.58 1.27 0.64 -0.84 -0.21 0.66 -0.17 2.01 -1.31
0.08 -0.47 1.19 0.01 -0.56 -0.20 0.47 -0.63 1.80 -1.68
0.25 -1.22 0.94 1.03 -1.20 0.22 0.55 0.08 2.12 -1.62
0.07 -0.68 1.34 0.20 -1.28 0.06 0.83 -0.34 2.19 -1.50
0.04 -1.38 0.88 0.14 -1.46 -0.29 0.02 -0.46 1.77 -1.49
-0.11 -1.13 1.09 0.20 -1.07 -0.67 0.01 -0.56 1.45 -1.77
-0.15 -0.96 0.67 0.11 -1.45 -0.49 0.21 -0.49 1.87 -2.16
"""


def aiag():
    readings = np.array(AIAG.split(), dtype=float)
    station, _, car = np.indices((3, 3, 10))
    return readings, car.ravel(), station.ravel()


def crossed(cars, stations, repeats):
    car, station, _ = np.indices((cars, stations, repeats))
    return car.ravel(), station.ravel()


def drawn(rng, car, station, sd):
    """A figure with standard deviations ``sd`` of car, station, both and repeat."""
    effects = [rng.normal(0.0, s, (60, 60)) for s in sd[:3]]
    y = effects[0][car, 0] + effects[1][station, 0] + effects[2][car, station]
    return y + rng.normal(0.0, sd[3], car.size)


def test_the_published_table():
    result = {source.source: source for source in anova(*aiag()).sources}
    published = {  # degrees of freedom, sum of squares, mean square
        CAR: (9, 88.3619, 9.81799),
        STATION: (2, 3.1673, 1.58363),
        INTERACTION: (18, 0.3590, 0.01994),
        REPEATABILITY: (60, 2.7589, 0.04598),
    }
    for name, (df, ss, ms) in published.items():
        assert result[name].df == df
        assert result[name].ss == pytest.approx(ss, abs=6e-5)
        assert result[name].ms == pytest.approx(ms, abs=6e-6)


def test_one_way_with_unequal_numbers_by_hand():
    # n = 1, 2, 3: n0 = (6 - 14/6)/2 = 11/6 (Searle, Casella, McCulloch, Variance Components).
    car = np.array([0, 1, 1, 2, 2, 2])
    y = np.array([4.0, 1.0, 3.0, 7.0, 8.0, 9.0])
    result = anova(y, car, np.zeros(6, dtype=int))
    assert result.expected_mean_squares[0, 0] == pytest.approx(11.0 / 6.0)
    within = 2.0 + 2.0
    between = 4.0**2 + 2 * 2.0**2 + 3 * 8.0**2 - 6 * (32.0 / 6.0) ** 2
    assert result.variances[REPEATABILITY] == pytest.approx(within / 3.0)
    assert result.variances[CAR] == pytest.approx((between / 2.0 - within / 3.0) / (11.0 / 6.0))


@given(st.integers(0, 2**32 - 1))
def test_the_parts_add_up_and_only_scatter_counts(seed):
    rng = np.random.default_rng(seed)
    car, station = rng.integers(0, 4, 30), rng.integers(0, 3, 30)
    y = rng.normal(size=30)
    result, moved = anova(y, car, station), anova(3.0 * y + 5.0, car, station)
    assert sum(s.ss for s in result.sources) == pytest.approx(np.sum((y - y.mean()) ** 2))
    assert sum(s.df for s in result.sources) == 29
    for name, variance in result.variances.items():
        assert moved.variances[name] == pytest.approx(9.0 * variance, abs=1e-9)


def test_what_a_design_can_tell():
    assert causes_of(*crossed(4, 3, 2)) == (CAR, STATION, INTERACTION, REPEATABILITY)
    assert causes_of(*crossed(4, 3, 1)) == (CAR, STATION, REPEATABILITY)
    assert causes_of(*crossed(4, 1, 3)) == (CAR, REPEATABILITY)
    nested = np.repeat(np.arange(4), 3)
    assert causes_of(nested, nested // 2) == (CAR, REPEATABILITY)


def test_the_published_study():
    # AIAG MSA, 4th ed.: EV 0.199933, AV 0.226838, GRR 0.302373, PV 1.042327; 18.4, 20.9, 27.9 %;
    # ndc 1.41 * 1.042327 / 0.302373 = 4.861, cut to 4
    result = gauge_rr(anova(*aiag(), causes=(CAR, STATION, REPEATABILITY)))
    sd = {name: c.sd for name, c in result.components.items()}
    assert sd[REPEATABILITY] == pytest.approx(0.199933, abs=2e-6)
    assert sd[REPRODUCIBILITY] == pytest.approx(0.226838, abs=2e-6)
    assert sd[GAUGE] == pytest.approx(0.302373, abs=2e-6)
    assert sd[CAR] == pytest.approx(1.042327, abs=2e-6)
    assert result.grr.value == pytest.approx(0.279, abs=5e-4)
    assert result.ndc.value == 4


def test_the_tolerance_is_compared_with_six_standard_deviations():
    # AIAG MSA, 4th ed.: 6 GRR/(USL - LSL), GRR 0.302373 as published
    design = anova(*aiag(), causes=(CAR, STATION, REPEATABILITY))
    result = gauge_rr(design, tolerance=8.0)
    assert result.grr_of_tolerance.value == pytest.approx(6.0 * 0.302373 / 8.0, rel=1e-5)
    low, high = result.grr_of_tolerance.ci95
    assert low < result.grr_of_tolerance.value < high
    assert result.cars_differ
    assert gauge_rr(design).grr_of_tolerance is None


def test_a_negative_variance_is_nought():
    result = gauge_rr(anova(*aiag()))
    interaction = result.components[INTERACTION]
    assert (interaction.sd, interaction.ci95[0]) == (0.0, 0.0)
    parts = [result.components[name].sd ** 2 for name in (REPEATABILITY, STATION, CAR)]
    assert result.components[TOTAL].sd ** 2 == pytest.approx(sum(parts))


def test_intervals_hold_the_truth_as_often_as_they_say():
    """Ten cars, four stations, two repeats, some missing; of 60, 86 % is 3 sigma below 95 %."""
    rng = np.random.default_rng(11)
    car, station = crossed(10, 4, 2)
    keep = rng.random(car.size) > 0.2
    sd = (1.0, 0.3, 0.15, 0.2)
    grr = np.sqrt(1.0 - 1.0 / np.sum(np.square(sd)))
    covered = np.zeros(3)
    for _ in range(60):
        y = drawn(rng, car, station, sd)[keep]
        result = gauge_rr(anova(y, car[keep], station[keep]))
        c = result.components
        covered += [
            low <= truth <= high
            for truth, (low, high) in (
                (sd[0], c[CAR].ci95),
                (sd[3], c[REPEATABILITY].ci95),
                (grr, result.grr.ci95),
            )
        ]
    assert np.all(covered / 60 > 0.86)
