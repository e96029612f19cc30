"""The C code as compilers, sanitizers and a bare Cortex-M4F see it."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from calib.ecu.channels import samples_of
from calib.ecu.native import Native
from calib.help.samples import sample_logs
from calib.logs.read import read_log
from calib.store.store import Store
from calib.table.exported import Precision
from tests.support.compilers import BOTH, links, needs, needs_m4f
from tests.support.ecu_code import ARGUED, STRICT, Code, called
from tests.support.failing_sensors import WAYS, failing

ROOT = Path(__file__).parents[2]
WIDTHS = {
    "double": Precision(),
    "single": Precision(single=True),
    "int16": Precision(12, 16),
}
SANITIZERS = {
    "gcc": "address,undefined,float-divide-by-zero,float-cast-overflow",
    "clang": "address,undefined,float-divide-by-zero,integer",
}
FLASH, RAM, MEAN, WORST = 12_288, 4_096, 3_000.0, 15_000.0
"""What a small brake ECU can spare: code and RAM [bytes], instructions of a sample."""


@pytest.fixture(scope="module")
def log():
    return read_log(sample_logs() / "sedan" / "dry_asphalt_stop.csv")


@pytest.fixture(scope="module")
def code(request, log, tmp_path_factory):
    table = Store(ROOT / "tables").load("sedan-2up").table
    return Code.of(table, log.sample_time, WIDTHS[request.param], tmp_path_factory.mktemp("code"))


def of(*widths):
    """The code in some of the precisions."""
    return pytest.mark.parametrize("code", widths, indirect=True)


@of("double", "int16")
@pytest.mark.parametrize("cc", BOTH)
def test_compilers_remark_nothing(code, cc):
    for language in ("c -std=c99", "c -std=c11", "c -std=c17", "c++"):
        files = code.sources[:1] if language == "c++" else code.sources  # bte_car.c is C
        called(cc, "-x", *language.split(), "-O1", *STRICT, "-c", *files, folder=code.folder)


@of("single")
@needs("cppcheck")
def test_what_cppcheck_says_of_misra_is_argued(code):
    assert code.remarks().keys() == ARGUED.keys()


@of("double", "int16")
@pytest.mark.parametrize("cc", BOTH)
def test_sanitizers_find_nothing_and_answers_stay_finite(code, log, cc):
    checks = (f"-fsanitize={SANITIZERS[cc]}", "-fno-sanitize-recover=all")
    if not links(cc, *checks):
        pytest.skip(f"missing here: the sanitizers of {cc}")
    program, samples = code.program(cc, "-O1", *checks), samples_of(log)
    with np.errstate(over="ignore"):
        given = [samples, *(failing(samples, seed) for seed in range(2 * len(WAYS)))]
        for one in given:
            told = code.answers(one, program)
            assert len(told) == len(samples)
            assert np.isfinite(told).all()


@of("single", "int16")
@needs_m4f
def test_a_small_ecu_has_the_bits_of_every_compiler_and_room_for_it(code, log):
    samples, table = samples_of(log), Store(ROOT / "tables").load("sedan-2up").table
    on_target = code.on_target(samples)
    bits = on_target.answers.tobytes()
    assert np.any(on_target.answers[:, 0] == 0.0)
    told = Native(table, log.sample_time, code.how).run(samples)
    assert told.astype(np.float32).tobytes() == bits
    for cc in filter(shutil.which, ("gcc", "clang")):
        for level in ("-O0", "-O2", "-O3"):
            assert code.answers(samples, code.program(cc, level)).tobytes() == bits
    assert 4_096 < on_target.code <= FLASH
    assert 300 < on_target.state < on_target.state + on_target.stack <= RAM
    assert 500.0 < on_target.mean <= MEAN
    assert on_target.mean < on_target.worst <= WORST
