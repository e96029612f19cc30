"""The folder that an ECU project takes in, as compilers, tools and a bare Cortex-M4F see it."""

import json

import numpy as np
import pytest

from calib.base.errors import ProgramError
from calib.ecu.code import files_of, write_code
from calib.ecu.native import Native
from calib.estimation.online import samples_of
from calib.help.samples import sample_logs
from calib.logs.read import read_log
from calib.table.exported import Precision
from tests.exports.test_a2l import a2ltool, needs_a2ltool
from tests.studies.ecu_target import ARGUED, remarks
from tests.support import ecu_code
from tests.support.ecu_code import BOTH, SEDAN, STRICT, called, failing, program
from tests.support.programs import needs

HOW = {  # with the time from call to call [s]
    "double": (Precision(), 0.02),
    "single": (Precision(single=True), 0.005),
    "int16": (Precision(12, 16), 0.005),
}
CHECKED = {
    "gcc": "-fsanitize=address,undefined,float-divide-by-zero,float-cast-overflow",
    "clang": "-fsanitize=address,undefined,float-divide-by-zero,integer",
}
FLASH, RAM, MEAN, WORST = 12_288, 4_096, 3e3, 15e3  # code, RAM [bytes]; instructions of a sample


@pytest.fixture(scope="module")
def codes(tmp_path_factory):
    """Folders by the name of their precision."""
    home = tmp_path_factory.mktemp("ecu")
    for width, how in HOW.items():
        write_code(SEDAN, home / width, "ecu", *how)
    return {width: home / width for width in HOW}


@pytest.fixture(scope="module")
def native():
    """Samples by precision, those of sensors that fail, too, each with what `Native` answers."""
    x, runs = samples_of(read_log(sample_logs() / "sedan" / "dry_asphalt_stop.csv")), {}
    for width, (how, step) in HOW.items():
        code, real = Native(SEDAN.table, step, how), f"f{how.floating // 8}"
        with np.errstate(over="ignore"):
            given = [one.astype(real) for one in (x, *(failing(x, seed) for seed in range(3)))]
        runs[width] = [(one, code.run(one).astype(real)) for one in given]
    return runs


@pytest.mark.parametrize("width", HOW)
@pytest.mark.parametrize("cc", BOTH)
def test_it_compiles_without_a_remark_and_its_vectors_agree(codes, width, cc):
    for standard in ("c99", "c17"):
        called(codes[width], program(codes[width], f"{cc} -std={standard} -O2 {STRICT}"))
    called(codes[width], cc, STRICT, "-c -x c++ bte.c")  # bte_car.c is C
    called(codes[width], cc, STRICT, "-DBTE_FIND=own -DBTE_CAL=volatile -c bte.c bte_car.c")


@needs("cc")
@needs_a2ltool
@pytest.mark.parametrize("width", HOW)
def test_another_program_finds_the_addresses_of_the_a2l(codes, width, tmp_path):
    code = codes[width]
    made = program(code, "cc -std=c99 -g -gdwarf-4 -no-pie")
    update = ("--elffile", made, "--update", "FULL", "--update-mode", "STRICT")
    theirs = a2ltool(tmp_path, (code / "bte.a2l").read_bytes(), *update)
    write_code(SEDAN, code, "ecu", *HOW[width], elf=made)
    assert a2ltool(tmp_path, (code / "bte.a2l").read_bytes()) == theirs
    assert theirs.count("/begin CHARACTERISTIC") == 12  # eight maps, three levels, the version
    before = {path: path.read_bytes() for path in code.iterdir()}
    with pytest.raises(ProgramError):  # it has no labels of that name
        write_code(SEDAN, code, "ecu", *HOW[width], "take", elf=made)
    assert before == {path: path.read_bytes() for path in code.iterdir()}


@needs("cc", "cmake")
def test_cmake_builds_it_and_runs_the_vectors(codes, tmp_path):
    called(tmp_path, "cmake -B . -S", codes["single"])
    called(tmp_path, "cmake --build .")
    assert "100% tests passed" in called(tmp_path, "ctest")


@needs("cppcheck")
def test_what_cppcheck_says_of_misra_is_argued(codes):
    assert remarks(codes["single"]).keys() == ARGUED.keys()


@pytest.mark.parametrize("width", HOW)
@pytest.mark.parametrize("cc", BOTH)
def test_whatever_the_sensors_read_bits_are_the_same_and_sanitizers_find_nothing(
    codes, native, width, cc
):
    checked = f"-O1 {CHECKED[cc]} -fno-sanitize-recover=all"
    if not ecu_code.links(f"{cc} {checked}"):
        pytest.skip(f"missing here: the sanitizers of {cc}")
    for options in ("-O0", "-O3", checked):
        made = program(codes[width], f"{cc} -std=c99 {options}", ecu_code.RUN)
        for samples, right in native[width]:
            assert np.isfinite(right).all()
            assert ecu_code.answers(codes[width], samples, made).tobytes() == right.tobytes()


@needs("arm-none-eabi-gcc", "qemu-system-arm", "cc")
@pytest.mark.parametrize("width", ["single", "int16"])
def test_a_small_ecu_has_the_same_bits_and_room_for_it(codes, native, width):
    samples, told = native[width][0]
    answered, (code, _, state, stack), instructions = ecu_code.on_target(codes[width], samples)
    assert answered.tobytes() == told.tobytes()
    assert np.any(told[:, 0] == 0.0)
    assert 4_096 < code <= FLASH
    assert 300 < state < state + stack <= RAM
    assert len(instructions) == len(samples)
    assert 500.0 < np.mean(instructions) <= MEAN
    assert np.mean(instructions) < np.max(instructions) <= WORST


@needs("cc")
def test_the_command_writes_the_code_and_nothing_over_foreign_files(brake_cal, tmp_path):
    words = ("tables", "export", SEDAN.id, "--store", SEDAN.path.parent.parent, "--format")
    code, own = tmp_path / "code", tmp_path / "own"
    foreign = {"bte_own.c": "/* our task, around brake-cal */\n", "notes.txt": "ours\n"}
    for prefix in ("bte", "take", "take"):
        ran = brake_cal(*words, "ECU", "--float", "--out", code, "--prefix", prefix, "--json")
        told = json.loads(ran.out)
        assert (ran.code, told["format"], told["float"]) == (0, "ecu", 32)
        assert set(told["files"]) == set(files_of(prefix))
        for name, text in foreign.items():
            (code / name).write_text(text)
    assert {path.name for path in code.iterdir()} == {*files_of("bte"), *files_of("take"), *foreign}
    assert not any("bte" in path.read_text().lower() for path in code.glob("take*.[ch]"))
    called(code, program(code, f"cc -std=c99 {STRICT}", prefix="take"))
    (code / "README.md").write_text("The estimator of brake-cal, of another version.\n")
    assert brake_cal(*words, "ecu", "--out", code, "--prefix", "take").code == 2
    assert set(files_of("xBTE")) >= {"xBTE.c", "xBTE.h", "xBTE_car.c", "xBTE.a2l"}
    own.mkdir()
    (own / "CMakeLists.txt").write_text("project(own)\n")
    new = ("ecu", "--out", own / "code")
    for more in (
        *((*new, "--prefix", name) for name in ("9a", "a-b", "", "math", "stddef")),
        *((*new, "--sample-time", time) for time in (0.0, 1.0)),
        ("ecu", "--out", own),
        ("fmu3", "--out", own / "CMakeLists.txt"),
        ("car-fmu2", "--out", own / "car.fmu", "--prefix", "x"),
        ("dcm", "--out", own / "car.dcm", "--sample-time", 0.01),
    ):
        assert brake_cal(*words, *more).code == 2
    assert [path.read_text() for path in own.iterdir()] == ["project(own)\n"]
    for form in ("car-fmu2", "FMU3"):
        ran = brake_cal(*words, form, "--out", own / "car.fmu", "--json")
        assert json.loads(ran.out)["format"] == form.lower()
