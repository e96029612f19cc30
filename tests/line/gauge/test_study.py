"""Gauge studies on made readings of known scatter, and the metrics of a simulated ramp."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.errors import InputError, LimitsError
from calib.estimation.limits import Limit
from calib.fitting.fit import fit
from calib.line.gauge.study import METRICS, GaugeReading, metrics_of, read_gauge_limits, study
from tests.support.reference_car import CAR, REAL, noisy, ramp, with_pads


def readings(cars=10, stations=2, repeats=3, sd=(1.0, 0.05, 0.05), seed=4):
    """Made-up figures of known scatter: car, station, repeat."""
    rng = np.random.default_rng(seed)
    of_car, of_station = sd[0] * rng.normal(size=cars), sd[1] * rng.normal(size=stations)
    return tuple(
        GaugeReading(
            f"{i}-{j}-{k}",
            f"car {i}",
            f"line {j}" if stations > 1 else "",
            {"x": 5.0 + of_car[i] + of_station[j] + sd[2] * rng.normal(), "same": 2.0},
        )
        for i in range(cars)
        for j in range(stations)
        for k in range(repeats)
    )


def test_figures_of_a_ramp():
    log = noisy(ramp(with_pads(REAL, 0.36, 0.36)), 1)
    table = fit(CAR, [log])
    result = metrics_of(table, log)
    assert set(result) == set(METRICS)
    assert result["pad_friction_f"] == pytest.approx(0.36, rel=0.02)
    assert result["pad_scale"] == pytest.approx(0.36 / 0.38, rel=0.02)
    assert result["eta_zero"] == pytest.approx(1.0 / 1.0008 - 1.0, abs=1e-4)  # the plant's radii
    assert result["slip_stiffness"] == pytest.approx(25.0, rel=0.15)


def test_a_good_gauge_and_what_does_not_scatter():
    result = study(readings())
    by_name = {result.name: result for result in result.results}
    assert result.passed
    assert by_name["x"].verdict == "good"
    assert by_name["x"].gauge.components["car"].sd == pytest.approx(1.0, rel=0.6)
    assert by_name["same"].verdict == "not judged"
    assert result.cars[0] == "car 0"
    assert result.stations == ("line 0", "line 1")


def of_pads(ramps):
    return tuple(replace(r, figures={"pad_scale": r.figures["x"]}) for r in ramps)


def test_cars_that_do_not_differ_show_nothing_of_a_gauge():
    """Then %GRR is near 100 % for any gauge: only a tolerance can judge it."""
    alike = of_pads(readings(sd=(0.0, 0.0, 0.05)))
    result = study(alike)
    assert not result.passed
    assert result.results[0].verdict == "the cars do not differ"
    assert all(j.value is None for j in result.results[0].judgements if j.figure != "x")
    wide, narrow = (study(alike, (Limit("pad_scale", -w, w),)) for w in (2.0, 0.2))
    assert wide.passed
    assert wide.results[0].verdict == "good"  # 6 * 0.05 / 4
    assert narrow.results[0].verdict == "bad"  # 6 * 0.05 / 0.4


def test_the_limits_of_the_design_are_told():
    """Two stations; one; no repeats; stations that share no car."""
    nested = tuple(replace(r, station=f"line {int(r.car[-1]) % 2}") for r in readings(6, 1, 2))
    designs = (readings(), readings(stations=1), readings(repeats=1), nested)
    assert [len(study(design).notes) for design in designs] == [0, 1, 1, 1]
    assert "reproducibility" not in study(designs[1]).results[0].gauge.components


@pytest.mark.parametrize(
    "ramps",
    [
        readings(cars=1),
        readings(stations=1, repeats=1),
        readings(cars=2, stations=2, repeats=1)[:3],
    ],
)
def test_an_insufficient_design_is_refused(ramps):
    with pytest.raises(InputError):
        study(ramps)


@pytest.mark.parametrize("ends", ["min = 0.8", "max = 1.2", "min = 1.0, max = 1.0"])
def test_a_tolerance_has_two_ends(tmp_path, ends):
    path = tmp_path / "gauge.toml"
    path.write_text(f"schema = 1\n[limits]\npad_scale = {{ {ends} }}\n")
    with pytest.raises(LimitsError):
        read_gauge_limits(path)
