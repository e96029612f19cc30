"""What an advice promises on the reference car is what the advised fit gives."""

import math
import re
from dataclasses import replace

import pytest

from calib.base.intervals import Z95
from calib.car.tyre_file import read_tyres
from calib.estimation.estimator import estimate
from calib.estimation.metrics import budget
from calib.fitting.fit import fit
from calib.model.roller_bench_file import read_roller_bench
from calib.table.budget import RAMP, STOP, advice_lines
from tests.support.manual import BENCH
from tests.support.reference_car import CAR, REAL, WET, noisy, one_axle, ramp, stop
from tests.support.tyre_files import written

UNWEIGHED = replace(CAR, mass_tolerance=0.03)
_GAIN = re.compile(r"(front|rear) ±(\d+) % -> ±(\d+) %")


@pytest.fixture(scope="module")
def log():
    return noisy(ramp(REAL), 1)


@pytest.fixture(scope="module")
def plain(log):
    return fit(UNWEIGHED, [log])


@pytest.fixture(scope="module")
def advised(log, tmp_path_factory):
    folder = tmp_path_factory.mktemp("files")
    bench, tyre = folder / "bench.toml", folder / "tyre.tir"
    bench.write_text(BENCH)
    written(tyre)
    axles = [noisy(one_axle(REAL, axle), i) for i, axle in enumerate("fr")]
    return {
        "--mass": fit(UNWEIGHED, [log], mass=CAR.mass),
        "--bench": fit(UNWEIGHED, [log], bench=read_roller_bench(bench)),
        "each axle": fit(UNWEIGHED, [log, *axles]),
        "--tyre": fit(UNWEIGHED, [log], tyre=read_tyres([tyre])),
    }


def widths(axles):
    return {
        axle: 100.0 * Z95 * math.hypot(*parts.values())
        for axle, parts in zip(("front", "rear"), axles, strict=True)
    }


def promised(axles, on, word):
    """Return by axle the widths before and after [%]; an axle that gains nothing keeps its own."""
    (line,) = (line for line in advice_lines(axles, on) if word in line)
    gains = {axle: (float(a), float(b)) for axle, a, b in _GAIN.findall(line)}
    return {axle: gains.get(axle, (x, x)) for axle, x in widths(axles).items()}


@pytest.mark.parametrize("advice", ["--mass", "--bench", "each axle", "--tyre"])
def test_an_advice_on_a_fit_and_on_a_stop_keeps_its_promise(plain, advised, advice):
    tables, log = (plain, advised[advice]), noisy(stop(WET), 3)
    by_fit = [table.budget.axles for table in tables]
    by_stop = [budget(estimate(table, log)) for table in tables]
    for on, (before, after) in ((RAMP, by_fit), (STOP, by_stop)):
        for axle, (now, then) in promised(before, on, advice).items():
            assert now == pytest.approx(widths(before)[axle], abs=0.51)
            assert then == pytest.approx(widths(after)[axle], abs=1.0)
