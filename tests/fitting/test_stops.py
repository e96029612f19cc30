"""Scenarios of stops have the shares and sizes of `beliefs.csv`, and show the eta of the paper."""

import math
from dataclasses import replace

import numpy as np
import pytest

from calib.base.plain import rows
from calib.car.beliefs import STOP, Stop, beliefs_of
from calib.car.mass import WEIGHED
from calib.fitting import maps as stops
from calib.fitting.ensemble import DEPART_AT
from calib.fitting.maps import predict_stops, scenarios
from tests.support.drawn_cars import one_car
from tests.support.reference_car import CAR

COUNT = 8192
TYRES = {"peak": 0.95, "compliance_r": 0.05, "radius_load": 0.002}


def cases(name):
    """Shares, means and sigmas of the cases of a name."""
    mixture = getattr(STOP, name)
    return mixture.share / mixture.share.sum(), mixture.mean, mixture.sigma


def case_of(name, case):
    """Share, mean and sigma of a case."""
    return [x[getattr(STOP, name).cases.index(case)] for x in cases(name)]


def moments(name):
    """Mean and standard deviation of a mixture of normals in closed form."""
    share, mean, sigma = cases(name)
    middle = share @ mean
    return middle, math.sqrt(share @ (sigma**2 + mean**2) - middle**2)


@pytest.fixture(scope="module")
def loose():
    return scenarios(replace(CAR, mass_tolerance=0.02), one_car(**TYRES), COUNT)


@pytest.fixture(scope="module")
def drawn():
    return scenarios(replace(CAR, mass_tolerance=WEIGHED), one_car(**TYRES), COUNT)


@pytest.mark.parametrize(
    ("name", "column"),
    [("log_pad_ratio", "change"), ("a_x_scale", "scale"), ("a_x_offset", "offset")],
)
def test_mean_and_sigma_are_those_of_the_list(drawn, name, column):
    mean, sigma = moments(name)
    x = getattr(drawn, column)
    assert np.mean(x) == pytest.approx(mean, abs=0.03 * sigma)
    assert np.std(x) == pytest.approx(sigma, rel=0.05)


def test_a_further_case_of_one_quantity_leaves_all_others_as_they_are(monkeypatch, drawn):
    """To the bit, in any order of rows; and a worn tyre comes with any pads and any load."""
    table = rows("beliefs.csv", "calib.car")
    tyre = next(r for r in table if (r["group"], r["quantity"]) == ("stop", "log_tyre"))
    worn = tyre | {"case": "worn", "share": "0.25", "sigma": "0.15"}
    monkeypatch.setattr(stops, "STOP", beliefs_of(Stop, [worn, *reversed(table)]))
    more = scenarios(replace(CAR, mass_tolerance=WEIGHED), one_car(**TYRES), COUNT)
    others = ("change", "peak", "scale", "offset", "log_mass")
    for name in others:
        assert np.array_equal(getattr(more, name), getattr(drawn, name)), name
    worn = np.abs(more.stiffer - drawn.stiffer) > 1e-9
    assert np.mean(worn, axis=1) == pytest.approx([0.2, 0.2], abs=0.01)
    for x in [*(getattr(more, name) for name in others), worn[1]]:
        far = np.abs(x - np.median(x))
        assert abs(np.corrcoef(worn[0], far)[0, 1]) < 4.0 / math.sqrt(COUNT)


def test_roads_are_the_ramp_s_or_others(drawn):
    """Another road has a peak of its own; 0.25 of its logarithm goes with the stiffness."""
    _, near, scatter = case_of("log_peak", "as on the ramp")
    share, mean, sigma = case_of("log_peak", "other road")
    far = np.abs(np.log(drawn.peak) - near) > 6.0 * scatter
    # few of the other roads are by chance as the ramp's
    assert np.mean(far) == pytest.approx(share, abs=0.1)
    log_peaks = np.log(0.95 * drawn.peak[far])
    assert np.mean(log_peaks) == pytest.approx(mean, abs=0.15 * sigma)
    assert np.std(log_peaks) == pytest.approx(sigma, rel=0.15)
    stiff = drawn.stiffer.mean(axis=0)[far]
    assert np.polyfit(log_peaks - math.log(0.9), stiff, 1)[0] == pytest.approx(0.25, abs=0.05)


def test_the_peak_of_another_road_hangs_on_no_ramp():
    low, high = (scenarios(CAR, one_car(peak=m), 2048) for m in (0.7, 1.1))
    other = np.abs(np.log(low.peak * 0.7 / (high.peak * 1.1))) < 1e-12
    same = np.abs(np.log(low.peak / high.peak)) < 1e-12
    assert np.all(other | same)
    assert np.mean(other) == pytest.approx(case_of("log_peak", "other road")[0], abs=0.02)


def test_tyres_of_the_axles_move_apart_by_the_list(drawn):
    """The road changes the tyres of both axles alike."""
    _, sigma = moments("log_tyre")
    assert np.std(drawn.stiffer[0] - drawn.stiffer[1]) == pytest.approx(
        math.sqrt(2.0) * sigma, rel=0.05
    )


def test_nobody_leaves_a_load_in_a_car_that_was_weighed(drawn, loose):
    assert np.std(drawn.log_mass) == pytest.approx(WEIGHED, rel=0.05)
    assert np.mean(drawn.log_mass) == pytest.approx(0.0, abs=0.05 * WEIGHED)
    share, mean, _ = cases("log_mass")
    tolerance = 0.02  # of the vehicle file, the sigma of the first case
    sigma = np.array([tolerance, case_of("log_mass", "load nobody stated")[2]])
    variance = share @ (sigma**2 + mean**2) - (share @ mean) ** 2
    assert np.mean(loose.log_mass) == pytest.approx(share @ mean, abs=0.001)
    assert np.std(loose.log_mass) == pytest.approx(math.sqrt(variance), rel=0.05)


def still(count=1, **other):
    """Stops like the ramp, except for ``other``."""
    usual = scenarios(CAR, one_car(**TYRES), count)
    zero, ones = np.zeros(count), np.ones(count)
    usual = replace(usual, change=zero, peak=ones, stiffer=np.zeros((2, count)), scale=zero)
    usual = replace(usual, offset=zero, log_mass=zero)
    return replace(usual, **{name: value * ones for name, value in other.items()})


def brush_slips(z, share):
    """Slips by the forward formula of the brush, bisected: tyre forces at ``z`` [1] with a front
    ``share`` of the brakes; the wheels' inertia takes a part of the brakes."""
    L, l_f, h = CAR.wheelbase, CAR.cg_to_front_axle, CAR.cg_height
    inert = [2.0 * a.wheel_inertia / a.rolling_radius**2 / CAR.mass for a in (CAR.front, CAR.rear)]
    true = z / (1.0 + sum(inert))
    loads = (L - l_f + h * true) / L, (l_f - h * true) / L
    out = []
    for part, lost, load, c in zip((share, 1.0 - share), inert, loads, (0.04, 0.05), strict=True):
        force, low, high = (part * z - lost * true) / load, 0.0, 3.0 * c * 0.95
        for _ in range(60):
            slip = 0.5 * (low + high)
            carried = 0.95 * (1.0 - (1.0 - slip / (3.0 * c * 0.95)) ** 3)
            low, high = (slip, high) if carried < force else (low, slip)
        out.append(slip)
    static = (L - l_f) / L, l_f / L
    grown = [load / at_rest - 1.0 for load, at_rest in zip(loads, static, strict=True)]
    return out, grown, loads[0]


@pytest.mark.parametrize("z", [0.1, 0.5])
def test_what_is_seen_is_eta_and_slip_of_the_paper(z):
    """(19), (20), (22) with radii that fall under load."""
    share = 28.84 * 130.9 / (28.84 * 130.9 + 11.34 * 124.0)
    (slip_f, slip_r), (grown_f, grown_r), part = brush_slips(z, share)
    front, rear = (
        (1.0 - s) * math.exp(0.002 * g) for s, g in ((slip_f, grown_f), (slip_r, grown_r))
    )
    predicted = predict_stops(CAR, still(), np.array([z]))
    assert predicted.eta_rise == pytest.approx(rear / front - 1.0, rel=1e-4)
    assert predicted.slip == pytest.approx(1.0 - part * front - (1.0 - part) * rear, rel=1e-6)
    assert still().log_level(z) == pytest.approx(0.0)
    assert predicted.rolls.all()


def test_a_tyre_departs_in_a_stop_as_on_the_ramp():
    """Relative, linear between the decelerations at which it is kept: here 0.1 z and -0.2 z."""
    usual = still()
    along = replace(
        usual,
        cars=replace(
            usual.cars, depart_eta=0.1 * DEPART_AT[None], depart_slip=-0.2 * DEPART_AT[None]
        ),
    )
    for z in (0.1, 0.33, 0.6):
        plain, changed = (predict_stops(CAR, x, np.array([z])) for x in (usual, along))
        assert changed.eta_rise / plain.eta_rise == pytest.approx(1.0 + 0.1 * z)
        assert changed.slip / plain.slip == pytest.approx(1.0 - 0.2 * z)
