"""The parts of the split filter's variance, against errors made on purpose and drawn noise."""

import math
from dataclasses import replace

import numpy as np
import pytest

from calib.base.names import G
from calib.car.effects.effects import Effects
from calib.estimation.filter_input import SplitInput
from calib.estimation.gates import Gates
from calib.estimation.plan import Plan
from calib.estimation.priors import Priors
from calib.estimation.split_budget import ratio_parts
from calib.estimation.split_filter import filter_pad_ratio
from calib.model.resistance import Resistance
from calib.run.blocks import Blocks
from calib.run.noise import SensorNoise
from calib.table.table import TyrePosterior
from tests.support.reference_car import CAR
from tests.support.tables import made_table
from tests.support.textbook_filter import FROM_TABLE, PLACE, first, sensed

NOISE = SensorNoise(omega=2e-3, z=5e-3, v=2e-3, omega_white=0.02)
STILL = replace(
    Priors(), ratio=1e-6, stiffness=1e-6, peak=1e-6, tyre_change=0.0, zero=0.0, elastic_sigma=0.0,
    pitch=0.0, drift_road=0.0, drift_ratio=0.0, drift_zero=0.0, ratio_odds=1e-9, wild_gate=1e9,
)  # fmt: skip
"""Nothing is open but what a test opens; the ratio is not weighed against that of the ramp."""
MEAN = dict.fromkeys(FROM_TABLE, 0.0) | {"log_compliance": math.log(0.04)}
Z = np.concatenate([np.zeros(30), np.full(100, 0.3)])
T, COUNT = 0.05, Z.size


def table_with(budget=None, **sigma):
    """A table whose posterior leaves these parameters open, each by itself."""
    variances = [sigma.get(name, 0.0) ** 2 for name in FROM_TABLE]
    rows = tuple(tuple(row) for row in np.diag(variances).tolist())
    known = TyrePosterior(tuple(FROM_TABLE), tuple(MEAN[name] for name in FROM_TABLE), rows)
    return replace(made_table(), posterior=known, budget=budget)


def plan_of(table, priors=STILL):
    known = Resistance(Effects(), ((0.0, 0.0), (0.0, 0.0)))
    return Plan(table, CAR, known, NOISE, {}, priors, Gates())


def run(rng=None, **moved):
    """Blocks and demand of a stop in which states are off by ``moved``; with noise if drawn."""
    speed = 30.0 - G * np.cumsum(Z) * T
    weight, length = CAR.mass * G, CAR.cg_to_front_axle + CAR.cg_to_rear_axle
    front = weight * (CAR.cg_to_rear_axle + Z * CAR.cg_height) / length
    still, total = np.zeros(COUNT), weight * Z
    demand = SplitInput(
        0.73 * total, 0.27 * total, np.where(Z > 0.0, 1.0, np.nan), still, still, still, still,
        still, front, weight - front, total, still, still, still, still, np.ones(COUNT),
    )  # fmt: skip
    x, *_ = first(table_with().posterior, STILL)
    for name, by in moved.items():
        x[PLACE[name]] += by
    rest = {
        "weight": weight,
        "rest_f": weight * CAR.cg_to_rear_axle / length,
        "rest_r": weight * CAR.cg_to_front_axle / length,
    }
    shown = np.array(
        [
            sensed(
                x,
                {n: v[k] for n, v in vars(demand).items()},
                {**rest, "z": Z[k], "speed": speed[k]},
            )
            for k in range(COUNT)
        ]
    )
    omega = speed / 0.322
    if rng is not None:
        axle = NOISE.omega / omega / math.sqrt(T)
        shown[:, 0] += math.sqrt(2.0) * axle * rng.standard_normal(COUNT)
        slip = np.hypot(axle, NOISE.v / speed / math.sqrt(T))
        shown[:, 1] += slip * rng.standard_normal(COUNT)
    blocks = Blocks(
        T * np.arange(1, COUNT + 1), 70e5 * Z, 70e5 * Z, still, still, Z, omega,
        omega * shown[:, 0], speed, speed, still, still, Z <= 0.0, 10, T,
    )  # fmt: skip
    return blocks, replace(demand, slip=shown[:, 1])


def answer_of(table, blocks, demand, priors=STILL):
    """The filter's answer, and the steps that it took."""
    steps = []
    return filter_pad_ratio(CAR, blocks, demand, NOISE, table.posterior, priors, steps), steps


@pytest.mark.parametrize(("block", "scattered"), [(60, False), (129, True)])
def test_parts_are_the_filter_s_own_covariance(block, scattered):
    """Of all states, against the variance that the filter reports; ratio and its change.

    With a scatter that no gain counts, too: half of what the table leaves open.
    """
    sigma = dict.fromkeys(FROM_TABLE, 0.02) | {"radius_load": 2e-3, "clock_offset": 5e-3}
    table, priors = table_with(**sigma), replace(Priors(), ratio_odds=1e-9)
    if scattered:
        half = tuple(tuple(0.5 * x for x in row) for row in table.posterior.covariance)
        table = replace(table, posterior=replace(table.posterior, scatter=half))
    blocks, demand = run(np.random.default_rng(0))
    answer, steps = answer_of(table, blocks, demand, priors)
    parts = ratio_parts(plan_of(table, priors), blocks, steps, block)
    total = sum(parts.values())
    foreign = (priors.foreign * answer.log_stiffness[block]) ** 2
    assert total[0, 0] + foreign == pytest.approx(answer.sigma[block] ** 2, rel=1e-6)
    change = np.array([1.0, -1.0])
    free = change @ total @ change + foreign
    assert free == pytest.approx(answer.change_sigma[block] ** 2, rel=1e-6)


@pytest.mark.parametrize(
    ("name", "sigma"),
    [
        ("log_tyre_ratio", 0.01),
        ("radius_load", 1e-4),
        ("load_exponent", 0.01),
        ("log_compliance", 0.01),
        ("log_pad_ratio", 0.01),
        ("clock_offset", 1e-3),
    ],
)
def test_a_state_off_by_one_sigma_moves_the_ratio_by_its_part(name, sigma):
    """One parameter of the table is open, and the ratio: the error of the answer is its part."""
    open_ratio = replace(STILL, ratio=0.03)
    table = table_with(**{name: sigma})
    errors, parts = [], {}
    for sign in (-1.0, 1.0):
        symbol = FROM_TABLE[name]
        # pads that are not what the table says are so today as on the ramp
        symbols = ("rho0", "rho") if symbol == "rho0" else (symbol,)
        blocks, demand = run(**dict.fromkeys(symbols, sign * sigma))
        answer, steps = answer_of(table, blocks, demand, open_ratio)
        true = sign * sigma if "rho" in symbols else 0.0
        errors.append(float(answer.log_pad_ratio[-1]) - true)
        parts = ratio_parts(plan_of(table, open_ratio), blocks, steps, COUNT - 1)
    assert abs(errors[1] - errors[0]) / 2.0 == pytest.approx(
        math.sqrt(parts["ramp"][0, 0]), rel=0.05, abs=1e-9
    )
