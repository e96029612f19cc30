"""The code on a bare Cortex-M4F: the bits of this machine, and what it takes."""

from pathlib import Path

import numpy as np
import pytest

from calib.ecu.native import Native, samples_of
from calib.ecu.width import Width
from calib.help.samples import sample_logs
from calib.logs.read import read_log
from calib.store.store import Store
from calib.table.exported import Precision
from tests.support.compilers import BOTH, needs_m4f
from tests.support.ecu_code import Code, bits

ROOT = Path(__file__).parents[2]
LOG = "sedan/dry_asphalt_stop.csv"
HOWS = {"full": Precision(single=True), "small": Precision(12, 16)}

CODE, RAM, MEAN, WORST = 12_288, 4_096, 3_000.0, 15_000.0
"""What a small brake ECU can spare: flash and RAM [bytes], instructions of a sample."""


@pytest.fixture(scope="module")
def log():
    return read_log(sample_logs() / LOG)


@pytest.fixture(scope="module", params=HOWS)
def code(request, log, tmp_path_factory):
    table = Store(ROOT / "tables").load("sedan-2up").table
    folder = tmp_path_factory.mktemp(request.param)
    return Code.of(table, log.sample_time, Width.of(HOWS[request.param]), folder)


@pytest.fixture(scope="module")
def on_target(code, log):
    return code.on_target(samples_of(log))


@needs_m4f
@pytest.mark.parametrize("cc", BOTH)
def test_every_compiler_gives_the_bits_of_the_target(code, log, on_target, cc):
    made = {level: code.program(cc, level) for level in ("-O0", "-O2", "-O3")}
    told = {level: bits(code.answers(made[level], samples_of(log))) for level in made}
    assert told == dict.fromkeys(told, bits(on_target.answers))


@needs_m4f
def test_the_target_answers_what_the_library_answers(code, log, on_target):
    table = Store(ROOT / "tables").load("sedan-2up").table
    told = Native(table, log.sample_time, code.width).run(samples_of(log))
    assert np.array_equal(on_target.answers, told)
    assert np.any(told[:, 0] == 0.0)


@needs_m4f
def test_it_fits_into_a_small_ecu(on_target):
    assert 4_096 < on_target.code <= CODE
    assert 300 < on_target.state < on_target.ram <= RAM
    assert 500.0 < on_target.mean <= MEAN
    assert on_target.mean < on_target.worst <= WORST
