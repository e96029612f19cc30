"""The C code as compilers and sanitizers see it: no remark, whatever the sensors read."""

from pathlib import Path

import numpy as np
import pytest

from calib.ecu.native import SOURCE, samples_of
from calib.ecu.width import Width
from calib.help.samples import sample_logs
from calib.logs.read import read_log
from calib.store.store import Store
from calib.table.exported import Precision
from tests.support.compilers import BOTH, links
from tests.support.ecu_code import STRICT, Code, called
from tests.support.failing_sensors import WAYS, failing

ROOT = Path(__file__).parents[2]
WIDTHS = {"double": Width(64, Precision()), "int16": Width(32, Precision(12, 16))}
SANITIZERS = {
    "gcc": "address,undefined,float-divide-by-zero,float-cast-overflow",
    "clang": "address,undefined,float-divide-by-zero,integer",
}


@pytest.fixture(scope="module")
def log():
    return read_log(sample_logs() / "sedan" / "dry_asphalt_stop.csv")


@pytest.fixture(scope="module", params=WIDTHS)
def code(request, log, tmp_path_factory):
    table = Store(ROOT / "tables").load("sedan-2up").table
    return Code.of(table, log.sample_time, WIDTHS[request.param], tmp_path_factory.mktemp("code"))


@pytest.mark.parametrize("cc", BOTH)
@pytest.mark.parametrize("standard", ["c99", "c11", "c17"])
def test_compilers_remark_nothing(code, cc, standard):
    command = (cc, f"-std={standard}", "-O1", *STRICT, *code.include, "-c")
    called(*command, *code.sources, folder=code.folder)


@pytest.mark.parametrize("cc", BOTH)
def test_it_is_cpp_too(code, cc):
    header = code.folder / "both.cpp"
    header.write_text('#include "bte_run.h"\nint main() { return sizeof(bte_state) == 0U; }\n')
    command = (cc, "-x", "c++", "-O1", *STRICT, *code.include, "-c")
    called(*command, SOURCE / "bte.c", header, folder=code.folder)


@pytest.mark.parametrize("cc", BOTH)
def test_sanitizers_find_nothing_and_answers_stay_finite(code, log, cc):
    checks = (f"-fsanitize={SANITIZERS[cc]}", "-fno-sanitize-recover=all")
    if not links(cc, *checks):
        pytest.skip(f"missing here: the sanitizers of {cc}")
    program, samples = code.program(cc, "-O1", *checks), samples_of(log)
    with np.errstate(over="ignore"):
        given = [samples, *(failing(samples, seed) for seed in range(2 * len(WAYS)))]
    for one in given:
        told = code.answers(program, one)
        assert len(told) == len(samples)
        assert np.isfinite(told).all()
