"""Two channels with one signal; wheels of another size, of no car, or that lose pulses."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.names import WHEEL_SPEEDS
from calib.base.warning import REFUSE, RULES
from calib.plausibility.channels import (
    copied,
    delay_of_v,
    held_values,
    pressure_sides,
    zero_of_pressure,
)
from calib.plausibility.check import check
from calib.plausibility.evidence import Evidence
from calib.plausibility.rules import FIT, unusable
from calib.plausibility.wheels import car_wheels, slip_of_v
from calib.run.run import Run
from tests.support.made_runs import changed
from tests.support.plant import WHEELS, brush, dugoff
from tests.support.reference_car import CAR, REAL, WET, noisy, ramp, stop
from tests.support.refusals import broken, why_not


@pytest.fixture(scope="module")
def clean():
    return stop(REAL)


def codes_and_causes(log):
    warnings = warnings_on(log, car_wheels, slip_of_v)
    return [(warning.code, warning.causes[0]) for warning in warnings]


def codes_of(warnings):
    return {warning.code for warning in warnings}


def warnings_on(log, *further):
    figures = copied, held_values, delay_of_v, zero_of_pressure, pressure_sides
    return broken((*figures, *further), Evidence(Run(log, CAR)))


def test_wheels_with_noise_of_their_own_are_right(clean):
    assert codes_and_causes(noisy(clean, 0)) == []


@pytest.mark.parametrize(
    ("copy", "source", "gain"),
    [("omega_rr", "omega_rl", 1.0), ("omega_fr", "omega_fl", 1.0), ("v", "omega_rl", 0.3)],
)
def test_a_copy_is_named(clean, copy, source, gain):
    log = noisy(clean, 0)
    causes = dict(codes_and_causes(changed(log, **{copy: gain * log[source]})))
    assert set(causes["same_signal"].split(" is a copy of ")) == {copy, source}


def test_a_bump_that_shakes_both_wheels_of_an_axle_alike_is_no_copy(clean):
    """Its second differences are some three hundred times those of the noise, for 0.06 s in 5 s."""
    log = noisy(clean, 0)
    inside = (log.time > 2.0) & (log.time < 2.06)
    jerk = 9.0 * np.where(inside, np.cos(2.0 * np.pi * 40.0 * log.time), 0.0)
    run = changed(log, omega_fl=log["omega_fl"] + jerk, omega_fr=log["omega_fr"] + jerk)
    assert codes_and_causes(run) == []
    raw = [np.diff(run[f"omega_{wheel}"], 2) for wheel in ("fl", "fr")]
    assert np.corrcoef(*raw)[0, 1] > 0.99


@pytest.mark.parametrize("factor", [0.975, 1.025])
def test_a_wrong_speed_shows_as_another_radius(clean, factor):
    log = noisy(clean, 0)
    codes = [code for code, _ in codes_and_causes(changed(log, v=factor * log["v"]))]
    assert codes == ["rolling_radius_f", "rolling_radius_r"]


@pytest.mark.parametrize(("every", "is_held"), [(1, False), (8, False), (20, True), (40, True)])
def test_a_speed_that_is_held_is_named_and_not_used(clean, every, is_held):
    """At 200 Hz: a new value every 5, 40, 100, 200 ms."""
    log = noisy(clean, 0)
    stale = log["v"][np.arange(log.time.size) // every * every]
    run = changed(log, v=stale)
    assert ("v_held" in [code for code, _ in codes_and_causes(run)]) == is_held
    assert (Run(run, CAR).signals.v is None) == is_held


def sent_at(log, hertz, *channels):
    """Channels that a bus sends at a rate of its own, as a faster logger keeps them."""
    sent = {}
    for shift, name in enumerate(channels):
        ticks = np.arange(log.time[0] - 0.003 * shift, log.time[-1], 1.0 / hertz)
        last_tick = np.searchsorted(ticks, log.time, side="right") - 1
        first = np.clip(np.searchsorted(log.time, ticks), 0, log.time.size - 1)
        sent[name] = log[name][first[np.clip(last_tick, 0, None)]]
    return changed(log, **sent)


@pytest.mark.parametrize(("hertz", "times"), [(20.0, [0.05]), (50.0, [])])
def test_wheel_speeds_that_are_held_are_no_copies(clean, hertz, times):
    warnings = warnings_on(sent_at(noisy(clean, 3), hertz, *WHEEL_SPEEDS))
    assert [warning.code for warning in warnings] == ["wheels_held"] * len(times)
    assert [warning.measured for warning in warnings] == pytest.approx(times, rel=0.1)


def test_missing_samples_are_no_copies(clean):
    """Over a gap every wheel makes the same step."""
    log = noisy(clean, 0)
    part = np.r_[0:500, 800 : log.time.size]
    gapped = changed(log, **{name: x[part] for name, x in log.channels.items()})
    assert codes_and_causes(gapped) == []


def test_rounding_is_no_noise(clean):
    rounded = {name: np.round(x, 4) for name, x in clean.channels.items() if name != "time"}
    assert codes_and_causes(changed(clean, **rounded)) == []


@pytest.mark.parametrize(("wheels", "filtered"), [("fl fr", True), ("fl fr rl rr", False)])
def test_a_v_of_wheels_is_named_also_behind_a_filter(clean, wheels, filtered):
    log = noisy(clean, 1)
    v = CAR.front.rolling_radius * np.mean([log[f"omega_{w}"] for w in wheels.split()], axis=0)
    if filtered:
        v = np.round(v / 0.02) * 0.02
    (warning,) = broken((slip_of_v,), Evidence(Run(changed(log, v=v))))
    assert warning.measured < warning.expected[0]
    assert why_not(changed(log, v=v), "validate") == ["v_of_wheels"]


def test_a_v_that_is_off_by_a_factor_is_measured(clean):
    log = noisy(clean, 2)
    assert broken((slip_of_v,), Evidence(Run(changed(log, v=1.03 * log["v"])))) == []


RAMP = noisy(ramp(REAL), 3)


def refused(log, car=None):
    return unusable(Run(log, car), FIT, (REFUSE,))


STOP = noisy(stop(REAL), 3)


@pytest.mark.parametrize(
    ("log", "offset", "wheels"),
    [
        (RAMP, 59.6, WHEELS),
        (RAMP, -30.0, WHEELS),
        (RAMP, -7.0, WHEELS),
        (STOP, 5.0, WHEELS),
        (STOP, -3.0, WHEELS),
        (STOP, 6.0, WHEELS[:2]),
        (STOP, -5.0, WHEELS[2:]),
    ],
)
def test_an_offset_of_the_wheel_speeds_is_named_with_its_size(log, offset, wheels):
    log = changed(log, **{f"omega_{w}": log[f"omega_{w}"] + offset for w in wheels})
    first = refused(log, CAR)[0]
    assert first.code == "wheel_offset"
    assert first.measured == pytest.approx(offset, rel=0.1, abs=1.0)
    # an offset of v, the second cause, would show on both axles
    assert len(first.causes) == len(wheels) // 2


def test_an_offset_of_v_is_one_of_all_wheels():
    first = refused(changed(STOP, v=STOP["v"] + 4.0 / 3.6), CAR)[0]
    assert first.code == "wheel_offset"
    assert float(first.causes[1].split()[-2]) == pytest.approx(4.0, abs=1.0)


@pytest.mark.parametrize(
    "log",
    [
        changed(RAMP, **{f"omega_{w}": 1.05 * RAMP[f"omega_{w}"] for w in WHEELS}),
        noisy(stop(REAL, pressure=120e5), 5),  # its wheels lock
        noisy(ramp(replace(WET, tyre=dugoff(20.0, 0.5))), 3),
        noisy(ramp(replace(REAL, tyre=brush(10.0, 0.38)), 2.7e5), 3),  # near the peak, it is soft
    ],
)
def test_neither_another_radius_nor_deep_slip_is_an_offset_or_a_clock(log):
    for car in (None, CAR):
        assert not {"wheel_offset", "v_clock"} & codes_of(refused(log, car))


@pytest.mark.parametrize(("log", "factor"), [(RAMP, 1.08), (STOP, 0.97), (STOP, 1.05)])
def test_a_wrong_clock_of_v_is_named_with_its_size(log, factor):
    v = np.interp(log.time / factor, log.time, log["v"])
    first = refused(changed(log, v=v), CAR)[0]
    assert first.code == "v_clock"
    assert first.measured == pytest.approx(factor - 1.0, abs=0.015)


def test_wheels_that_count_backwards_are_the_only_reason():
    log = changed(RAMP, **{f"omega_{w}": -RAMP[f"omega_{w}"] for w in ("fr", "rr")})
    assert [warning.code for warning in refused(log)] == ["wheel_sign"]
    assert not {"abs", "locked_wheels", "sides_f", "sides_r"} & codes_of(check(log).warnings)


@pytest.mark.parametrize("zero", [1.7e5, 2.5e5, 5e5])
def test_the_zero_of_the_pressure_comes_before_what_it_hides(zero):
    codes = [warning.code for warning in refused(changed(RAMP, p_mc=RAMP["p_mc"] + zero), CAR)]
    assert codes[0] in ("pressure_low", "pressure_zero")
    assert "lead_in" not in codes


@pytest.mark.parametrize(("shift", "zero", "first"), [(0.0, 4e5, "zero"), (1.0, 0.0, "late")])
def test_a_cut_zero_is_distinguished_from_a_late_clock(shift, zero, first):
    late = np.interp(RAMP.time - shift, RAMP.time, RAMP["p_mc"]) - zero
    reasons = {x.code: x for x in refused(changed(RAMP, p_mc=np.maximum(late, 0.0)))}
    assert first in reasons["pressure_late"].causes[0]


def test_a_bend_hides_no_abs():
    wheels = {"omega_fr": 1.02 * RAMP["omega_fr"], "omega_fl": RAMP["omega_fl"].copy()}
    dips = (RAMP["p_mc"] > 0.7 * RAMP["p_mc"].max()) * np.maximum(np.sin(31.0 * RAMP.time), 0.0)
    wheels["omega_fl"] *= 1.0 - 0.2 * dips
    assert {"sides_f", "abs"} <= codes_of(check(changed(RAMP, **wheels)).warnings)


def test_a_rule_entails_only_later_rules():
    places = {rule.code: place for place, rule in reversed([*enumerate(RULES)])}
    for rule in RULES:
        assert all(places[code] > places[rule.code] for code in rule.entails), rule.code


@pytest.mark.parametrize("factor", [1.609, 3.6, 1.0 / 3.6])
def test_v_in_another_unit_is_refused_for_its_unit(factor):
    first = refused(changed(RAMP, v=factor * RAMP["v"]))[0]
    assert first.code in ("v_unit", "v_unit_by_a_x", "v_beyond_cars")


@pytest.mark.parametrize("log", [RAMP, replace(stop(REAL), truth={})])
def test_a_right_v_has_no_offset_and_no_other_unit(log):
    assert not {"wheel_offset", "v_unit", "v_unit_by_a_x"} & codes_of(refused(log))
