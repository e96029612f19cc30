"""What is said of the pressure and of force without it."""

from statistics import NormalDist
from types import SimpleNamespace

import numpy as np
import pytest

from calib.base.names import WHEELS
from calib.plausibility.channels import pressure_sides, zero_of_pressure
from calib.plausibility.evidence import Evidence
from calib.plausibility.forces import brakes, force_step
from calib.run.brake_response import BrakeResponse, _ForceStep
from calib.run.run import Run
from tests.support.reference_car import REAL, noisy, stop
from tests.support.refusals import broken


def evidence(measured, odds=0.1):
    """Return evidence on a car whose pedal commands a motor with these prior odds."""
    return Evidence(SimpleNamespace(vehicle=SimpleNamespace(motor_odds=odds)), response=measured)


def response(delay=0.0, share=0.0, sigma=0.01, **others):
    return BrakeResponse(1.0, delay, sigma, share, sigma, **others)


@pytest.mark.parametrize(
    ("measured", "codes"),
    [
        (response(), []),
        (response(share=0.06), ["unexplained_braking_force"]),
        (response(share=0.05, sigma=0.03), []),
        (response(fading=0.09, fading_sigma=0.02), ["unexplained_braking_force"]),
        (response(fading=0.09, fading_sigma=0.06), []),
        (response(share=0.04, fading=0.06, fading_sigma=0.02), ["unexplained_braking_force"]),
        (response(fading=-0.09, fading_sigma=0.02), []),
        (response(share=-0.08), ["braking_force_missing"]),
        (response(delay=-0.15), ["pressure_lag"]),
        (response(delay=0.15), []),
        (response(delay=0.25, sigma=0.1), []),
    ],
)
def test_only_large_and_certain_errors_are_named(measured, codes):
    assert [warning.code for warning in broken([brakes], evidence(measured))] == codes


def is_named(measured, odds):
    """Whether a motor is likely, however small its force."""
    return "unexplained_braking_force" in [x.code for x in brakes(evidence(measured, odds))]


def chance_by_counting(share, sigma, fading, fading_sigma, odds):
    """Chance of a motor, by weighing a fine grid of shares: early, fading, or both."""
    grid = np.linspace(0.0, 0.8, 8001)
    prior = 2.0 * NormalDist(0.0, 0.1).pdf(0.0) * np.exp(-0.5 * (grid / 0.1) ** 2) * grid[1]
    prior[0] *= 0.5

    def likelihood(true, measured, sigma):
        return np.exp(-0.5 * ((measured - true) / sigma) ** 2)

    by_share, no_share = (likelihood(x, share, np.hypot(sigma, 0.015)) for x in (grid, 0.0))
    by_fade, no_fade = (likelihood(x, fading, np.hypot(fading_sigma, 0.02)) for x in (grid, 0.0))
    early, late = prior @ by_share, prior @ by_fade
    motor = odds * (early * no_fade + no_share * late + early * late) / 3.0
    return motor / (motor + no_share * no_fade)


@pytest.mark.parametrize("odds", [1.0, 0.1, 0.01])
@pytest.mark.parametrize("sigma", [(0.01, 0.02), (0.03, 1.3), (0.02, 0.05)])
@pytest.mark.parametrize("fading", [-0.05, 0.05, 0.15])
def test_a_motor_is_named_by_its_chance_as_by_counting_all_shares(odds, sigma, fading):
    """Odds of 0.67 are a chance of 0.4, from which on a motor is named."""
    tried = np.linspace(-0.02, 0.15, 18)
    chance = [chance_by_counting(share, sigma[0], fading, sigma[1], odds) for share in tried]
    named = [
        is_named(response(share=x, sigma=sigma[0], fading=fading, fading_sigma=sigma[1]), odds)
        for x in tried
    ]
    clear = [abs(x - 0.4) > 0.01 for x in chance]
    assert np.array_equal(np.array(named)[clear], np.array(chance)[clear] > 0.4)


@pytest.mark.parametrize("zero", [-3e5, -1e5, 1e5])
def test_the_zero_of_the_pressure_is_measured(zero):
    log = noisy(stop(REAL), 1)
    log.channels["p_mc"] = log["p_mc"] + zero
    (warning,) = broken([zero_of_pressure], Evidence(Run(log)))
    assert warning.code == "pressure_zero"
    assert warning.measured == pytest.approx(zero / 1e5, abs=0.1)


@pytest.mark.parametrize(("scale", "zero", "codes"), [
    (1.0, 0.0, []), (1.05, 1e5, []), (0.8, 0.0, ["pressure_sides"]), (0.0, 0.0, ["pressure_sides"]),
])  # fmt: skip
def test_wheel_pressures_of_an_axle_are_alike(scale, zero, codes):
    log = noisy(stop(REAL), 1)
    rear = {"rl": scale * log["p_mc"] + zero, "rr": log["p_mc"]}
    log.channels.update({f"p_{wheel}": rear.get(wheel, 0.7 * log["p_mc"]) for wheel in WHEELS})
    warnings = broken([pressure_sides], Evidence(Run(log)))
    assert [warning.code for warning in warnings] == codes
    for warning in warnings:
        assert warning.measured == pytest.approx(scale - 1.0, abs=0.02)


@pytest.mark.parametrize(
    ("step", "scatter", "noise", "codes"),
    [
        (-0.08, 0.01, 0.0, ["force_step"]),
        (0.08, 0.02, 0.0, []),
        (0.02, 0.001, 0.0, []),
        (0.08, 0.01, 0.002, []),  # 3.2 * 0.002 / 0.3 is 0.021
    ],
)
def test_a_step_of_the_force_stands_out_of_its_scatter_and_the_noise(step, scatter, noise, codes):
    blocks = SimpleNamespace(p_f=np.full(9, 2e6), p_r=np.zeros(9), speed=np.full(9, 20.0))
    blocks.z = np.full(9, 0.3)
    run = SimpleNamespace(vehicle=True, blocks=blocks, lead_in_noise=SimpleNamespace(z=noise))
    stepped = response(force_step=_ForceStep(4.0, step, scatter))
    warnings = broken([force_step], Evidence(run, response=stepped))
    assert [warning.code for warning in warnings] == codes
