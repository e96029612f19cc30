"""Ramps with one axle only part pads and tyres that differ; the curves stay those of both axles."""

import math
from dataclasses import replace

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.fitting.fit import fit
from calib.table.invariants import violations
from tests.support.reference_car import (
    CAR,
    REAL,
    cut,
    noisy,
    one_axle,
    ramp,
    swapped,
    with_ratio,
    without,
)
from tests.support.refusals import refusal

UNLIKE = with_ratio(replace(REAL, rear_stiffness=1.12), 1.1)
"""Front pads 10 % better than the rear ones, rear tyres 12 % stiffer: the file knows neither."""

TRUE = {"log_pad_ratio": math.log(1.1), "log_tyre_ratio": math.log(1.12)}
PADS = {"pad_friction_f": 0.38 * math.sqrt(1.1), "pad_friction_r": 0.38 / math.sqrt(1.1)}
PRESSURES = [f"p_{a}{s}" for a in "fr" for s in "lr"]


@pytest.fixture(scope="module")
def clean():
    return {"n": ramp(UNLIKE), "f": one_axle(UNLIKE, "f"), "r": one_axle(UNLIKE, "r")}


@pytest.fixture(scope="module")
def tables(clean):
    """By the ramps that were driven."""
    logs = {kind: noisy(log, 100 * "nfr".index(kind)) for kind, log in clean.items()}
    return {kinds: fit(CAR, [logs[k] for k in kinds]) for kinds in ("n", "nf", "nr", "nfr")}


def drawn(table, name):
    """Draws of ln of the pads' ratio, or of the stiffness of the rear tyres over the front ones."""
    draws = table.draws
    tyres = np.log(draws.compliance_f / draws.compliance_r)
    return {"log_pad_ratio": draws.log_pad_ratio, "log_tyre_ratio": tyres}[name]


def sigma(table, name):
    return np.std(drawn(table, name))


def test_a_normal_ramp_alone_leaves_the_ratios_open(tables):
    assert sigma(tables["n"], "log_pad_ratio") > 0.06
    assert sigma(tables["n"], "log_tyre_ratio") > 0.05


@pytest.mark.parametrize(
    ("kinds", "pads", "tyres"), [("nf", 0.85, 1.05), ("nr", 0.6, 0.9), ("nfr", 0.45, 0.8)]
)
def test_a_ramp_with_one_axle_narrows_both(tables, kinds, pads, tyres):
    table, alone = tables[kinds], tables["n"]
    assert sigma(table, "log_pad_ratio") < pads * sigma(alone, "log_pad_ratio")
    assert sigma(table, "log_tyre_ratio") < tyres * sigma(alone, "log_tyre_ratio")
    assert table.calibration.pad_friction_r.sigma < alone.calibration.pad_friction_r.sigma


@pytest.mark.parametrize("kinds", ["nf", "nr", "nfr"])
def test_and_the_truth_is_in_the_narrower_interval(tables, kinds):
    table = tables[kinds]
    off = [(np.mean(drawn(table, k)) - v) / sigma(table, k) for k, v in TRUE.items()]
    for name, true in PADS.items():
        value = getattr(table.calibration, name)
        off.append((value.value - true) / value.sigma)
    assert np.max(np.abs(off)) < 3.0
    assert np.sqrt(np.mean(np.square(off))) < 1.3


def test_it_is_a_sound_table_of_ramps(tables):
    table = tables["nfr"]
    assert violations(table) == ()
    assert {log.role for log in table.provenance.logs} == {"ramp"}
    assert table.quality["runs"] == 3.0


def test_curves_end_where_the_ramp_with_both_axles_ends(clean):
    """The front axle alone reaches 0.43 g; this normal ramp 0.36 g."""
    short = noisy(cut(clean["n"], 0.0, 6.5), 0)
    alone = fit(CAR, [short])
    table = fit(CAR, [short, noisy(clean["f"], 100)])
    assert table.quality["deceleration_max"] == alone.quality["deceleration_max"] < 0.40
    assert table.paper.z[-1] < 0.40
    assert np.sum(table.tyre.count) < 1.3 * np.sum(alone.tyre.count)


def test_level_of_the_pads_is_that_of_the_normal_ramp(clean):
    """A rear ramp with pads that come 5 % stronger moves the ratio, the level by its share only."""
    warm = with_ratio(replace(UNLIKE), 1.1 / 1.05**2)
    table = fit(CAR, [noisy(clean["n"], 0), noisy(one_axle(warm, "r"), 200)])
    front = table.calibration.pad_friction_f
    assert abs(front.value - PADS["pad_friction_f"]) < 3.0 * front.sigma


# What is refused, and why.


def refused(*logs):
    return refusal(fit, CAR, list(logs), kind=LogError)


def test_a_ramp_with_both_axles_is_needed(clean):
    message = refused(noisy(clean["f"], 0), noisy(clean["r"], 1))
    assert "at least one ramp with both axles" in message


def test_swapped_axles_are_seen_on_one_axle_too(clean):
    normal = noisy(clean["n"], 0)
    for axle in "fr":
        assert "(eta_falls)" in refused(normal, swapped(noisy(clean[axle], 1)))


def test_a_rear_ramp_without_its_pressures_is_refused(clean):
    alone = without(noisy(clean["r"], 1), *PRESSURES)
    assert "(ramp_span)" in refused(noisy(clean["n"], 0), alone)
