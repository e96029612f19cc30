"""The folder that an ECU project takes in, as compilers, tools and a bare Cortex-M4F see it."""

import json
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from calib.base.errors import ProgramError
from calib.ecu.car_data import numbers_of
from calib.ecu.code import files_of, write_code
from calib.ecu.native import Native
from calib.estimation.constants import Constants
from calib.estimation.online import ANSWERS, CHANNELS, answered, rows_of, samples_of
from calib.exports.compare import difference
from calib.exports.read import read_back
from calib.help.samples import sample_logs
from calib.logs.read import read_log
from calib.store.store import Store
from calib.table.exported import Precision
from tests.exports.test_a2l import a2ltool, needs_a2ltool
from tests.studies.ecu_target import ARGUED, remarks
from tests.support import ecu_code
from tests.support.a2l import decoded, objects, read_a2l, without_epk
from tests.support.ecu_code import (
    BOTH,
    M4F,
    QEMU,
    RUN,
    SAME_BITS,
    SEDAN,
    STRICT,
    called,
    failing,
    program,
)
from tests.support.programs import memory_of, needs

HOW = {  # with the time from call to call [s]
    "double": (Precision(), 0.02),
    "single": (Precision(single=True), 0.005),
    "int16": (Precision(12, 16), 0.005),
}
SANITIZE = "-O1 -fno-sanitize-recover=all -fsanitize=address,undefined,float-divide-by-zero"
BUILDS = [
    pytest.param(cc, width, options, marks=needs(cc))
    for cc, width, options in (
        ("gcc", "double", f"{SANITIZE},float-cast-overflow"),
        ("gcc", "single", "-O3"),
        ("gcc", "int16", f"{SANITIZE},float-cast-overflow"),
        ("clang", "double", "-O3"),
        ("clang", "single", f"{SANITIZE},integer"),
        ("clang", "int16", "-O0"),
    )
]
"""Each precision with sanitizers by one compiler, and without them by the other compiler."""
OWN = '#include "bte.h"\nextern bte_state bte_estimator;\nbte_state bte_estimator;\n'
DATA = "bte_car_sedan_2up.c"
FLASH, RAM, MEAN, WORST = 8_192, 1_350, 2.2e3, 11e3  # code, RAM [bytes]; instructions of a sample


@pytest.fixture(scope="module")
def codes(tmp_path_factory):
    """Return folders by the name of their precision."""
    home = tmp_path_factory.mktemp("ecu")
    for width, how in HOW.items():
        write_code(SEDAN, home / width, "ecu", *how)
    return {width: home / width for width in HOW}


@pytest.fixture(scope="module")
def native():
    """Return samples by precision, also of failing sensors, each with the answers of `Native`."""
    x, runs = samples_of(read_log(sample_logs() / "sedan" / "dry_asphalt_stop.csv")), {}
    for width, (how, step) in HOW.items():
        code, real = Native(SEDAN.table, step, how), f"f{how.floating // 8}"
        with np.errstate(over="ignore"):
            inputs = [x.astype(real), *(failing(x, seed).astype(real) for seed in range(3))]
        runs[width] = [(samples, code.run(samples).astype(real)) for samples in inputs]
    return runs


@pytest.mark.parametrize("width", HOW)
@pytest.mark.parametrize("cc", BOTH)
def test_it_compiles_without_a_remark_and_its_vectors_agree(codes, width, cc):
    standard = "c99" if cc == "gcc" else "c17"
    called(codes[width], program(codes[width], f"{cc} -std={standard} -O2 {STRICT}"))
    if width != "single":  # what differs by precision was compiled
        return
    called(codes[width], cc, STRICT, "-c -x c++ bte.c")  # the data are C
    called(codes[width], cc, STRICT, "-DBTE_CAL=volatile -c bte.c", DATA)
    called(codes[width], cc, STRICT, "-std=c99 -fsyntax-only bte_vectors.h")


@needs("cc")
@needs_a2ltool
@pytest.mark.parametrize("width", HOW)
def test_another_program_finds_the_addresses_of_the_a2l(codes, width, tmp_path):
    code = codes[width]
    (code / "own.c").write_text(OWN)
    elf = program(code, "cc -std=c99 -g -gdwarf-4 -no-pie own.c")
    update = ("--elffile", elf, "--update", "FULL", "--update-mode", "STRICT")
    file = code / "bte_car_sedan_2up.a2l"
    theirs = without_epk(a2ltool(tmp_path, file.read_bytes(), *update))
    write_code(SEDAN, code, "ecu", *HOW[width], elf=elf)
    assert without_epk(a2ltool(tmp_path, file.read_bytes())) == theirs
    module = read_a2l(file.read_bytes()).only("MODULE")
    memory, numbers = memory_of(elf), decoded(module, memory_of(elf))
    epk = module.only("MOD_PAR")
    text = memory(int(epk.after("ADDR_EPK")[0], 0), 64).decode()
    assert text == epk.after("EPK")[0].strip('"') == SEDAN.digest
    begin, size = (int(x, 0) for x in epk.only("MEMORY_SEGMENT").words[5:7])
    assert all(begin <= x[0] < begin + size for x in objects(module).values())
    car = SEDAN.table.vehicle
    for name, value in {
        "version": SEDAN.version, "c_track_width": car.track_width,
        "c_rolling_radius_r": car.rear.rolling_radius, "c_high_omega_rr": 110.0 / 0.322,
        "c_sample_time": HOW[width][1], "c_moving": Constants.moving,
    }.items():  # fmt: skip
        assert numbers[f"sedan_2up_{name}"] == pytest.approx([value], rel=1e-7)
    kinds = [x.words[0].removeprefix("sedan_2up_") for x in module.all("MEASUREMENT")]
    ends = ("", "_lower", "_upper")
    assert {*CHANNELS, *(f"{x}{end}" for x in ANSWERS for end in ends), "reason"} <= {*kinds}
    assert {"diagnosis", "lasted_a_x", "often_p_mc", "often_far"} <= {*kinds}
    assert {"state_demand_value", "state_lag_variance", "state_speed_cov_offset_scale"} <= {*kinds}
    contents = {path: path.read_bytes() for path in code.iterdir()}
    with pytest.raises(ProgramError):  # it has no labels of that name
        write_code(SEDAN, code, "ecu", *HOW[width], "other", elf=elf)
    assert contents == {path: path.read_bytes() for path in code.iterdir()}


@needs("cc", "cmake")
def test_cmake_builds_it_and_runs_the_vectors(codes, tmp_path):
    called(tmp_path, "cmake -B . -S", codes["single"])
    called(tmp_path, "cmake --build .")
    assert "100% tests passed" in called(tmp_path, "ctest")


@needs("arm-none-eabi-gcc", "qemu-system-arm", "cc")
def test_two_cars_in_one_image_each_answer_as_alone(codes, native, tmp_path):
    other, how = Store(SEDAN.path.parents[1]).load("escort"), HOW["single"]
    write_code(other, tmp_path / "two", "ecu", *how)
    first, second = "bte_car_sedan_2up", "bte_car_escort"
    for name in ("bte.h", "bte.c"):
        assert (tmp_path / "two" / name).read_bytes() == (codes["single"] / name).read_bytes()
    shutil.copy(codes["single"] / f"{first}.c", tmp_path / "two")
    samples, alone = (x[:700] for x in native["single"][0])
    expected = np.vstack([alone, Native(other.table, how[1], how[0]).run(samples)])
    assert not np.array_equal(*np.split(expected, 2))
    section = Path('-DBTE_CAL_DATA=__attribute__((section(".cal")))')
    cars = f"-I. -DSECOND={second} bte.c {first}.c {second}.c"
    link = "--specs=rdimon.specs -Wl,--section-start=.vectors=0 -lm -o ecu.elf"
    for make, run in (
        (f"cc -std=c99 -O2 {SAME_BITS} {STRICT} {cars}", "./two"),
        (f"{M4F} {SAME_BITS} {cars}", QEMU),
    ):
        output = ("-lm -o two",) if run == "./two" else (link,)
        called(tmp_path / "two", make, section, RUN, *output)
        answers = ecu_code.answers(tmp_path / "two", samples, run)
        assert answers.tobytes() == expected.astype(np.float32).tobytes()
    (size,) = re.findall(r"^\.cal +(\d+)", called(tmp_path / "two", "size -A two"), re.MULTILINE)
    numbers = sum(len(numbers_of(x, how[1])) for x in (SEDAN, other))
    assert int(size) > 4 * numbers + 2 * 65


@needs("cc")
@pytest.mark.parametrize(
    ("width", "form"), [("double", "dcm"), ("single", "cdfx"), ("int16", "dcm")]
)
def test_compare_reads_the_files_of_the_folder_and_says_what_is_not_in_them(codes, width, form):
    returned = read_back(codes[width] / f"bte_car_sedan_2up.{form}")
    result = difference(returned, SEDAN)
    assert (result.wrong, "sedan_2up_D" in result.missing) == ([], True)
    assert not {"sedan_2up_version", "sedan_2up_level"} & {*result.missing}
    levels, (axes, cells) = dict(returned.content.grids), returned.content.grids["sedan_2up_level"]
    levels["sedan_2up_level"] = axes, (cells[0] + 0.01, *cells[1:])
    changed = replace(returned, content=replace(returned.content, grids=levels))
    assert difference(changed, SEDAN).wrong


@needs("cc")
def test_a_stop_that_the_log_command_writes_runs_in_c_as_in_python(codes, brake_cal, tmp_path):
    stop, si, code = sample_logs() / "sedan" / "dry_asphalt_stop.csv", tmp_path / "si.csv", codes
    lines = stop.read_text().splitlines(keepends=True)
    gap, half = tmp_path / "gap.csv", tmp_path / "half.csv"
    gap.write_text("".join(lines[:600] + lines[640:1200]))
    half.write_text("".join(lines[:1] + lines[1:1200:2]))
    executable = program(code["single"], "cc -std=c99 -O2")
    assert brake_cal("log", gap, "--si", "--out", si).code == 0
    ran = subprocess.run([executable, si], capture_output=True, text=True, check=True)
    names, *rows = ran.stdout.splitlines()
    answers = np.array([row.split(",") for row in rows], float)
    log = read_log(gap)
    expected = answered(SEDAN.table, 0.005, samples_of(log))[rows_of(log)]
    assert names.split(",")[:4] == ["time", "reason", "pad_level", "pad_level_lower"]
    np.testing.assert_allclose(answers[:, 0], log.time)
    assert np.array_equal(answers[:, 1], expected[:, 0])
    np.testing.assert_allclose(answers[:, 2:], expected[:, 1:], rtol=1e-4)
    assert brake_cal("log", half, "--si", "--out", si, "--force").code == 0
    for wrong in (si, gap, tmp_path / "none.csv"):  # another rate, pressures in bar, no file
        assert subprocess.run([executable, wrong], capture_output=True).returncode == 2


@needs("cppcheck")
def test_what_cppcheck_says_of_misra_is_argued(codes):
    assert remarks(codes["single"]).keys() == ARGUED.keys()


@pytest.mark.parametrize(("cc", "width", "options"), BUILDS)
def test_whatever_the_sensors_read_bits_are_the_same_and_sanitizers_find_nothing(
    codes, native, cc, width, options
):
    if not ecu_code.links(f"{cc} {options}"):
        pytest.skip(f"missing here: the sanitizers of {cc}")
    executable = program(codes[width], f"{cc} -std=c99 {options}", ecu_code.RUN)
    for samples, expected in native[width]:
        assert np.isfinite(expected).all()
        assert ecu_code.answers(codes[width], samples, executable).tobytes() == expected.tobytes()


@needs("arm-none-eabi-gcc", "qemu-system-arm", "cc")
@pytest.mark.parametrize("width", ["single", "int16"])
def test_a_small_ecu_has_the_same_bits_and_room_for_it(codes, native, width):
    samples, expected = native[width][0]
    answered, (code, _, state, stack), instructions = ecu_code.on_target(codes[width], samples)
    assert answered.tobytes() == expected.tobytes()
    assert np.any(expected[:, 0] == 0.0)
    assert 4_096 < code <= FLASH
    assert 300 < state <= 700
    assert state + stack <= RAM
    assert len(instructions) == len(samples)
    assert 500.0 < np.mean(instructions) <= MEAN
    assert np.mean(instructions) < np.max(instructions) <= WORST


@needs("cc")
def test_the_command_writes_the_code_and_nothing_over_foreign_files(brake_cal, tmp_path):
    words = ("tables", "export", SEDAN.id, "--store", SEDAN.path.parent.parent, "--format")
    code, other = tmp_path / "code", tmp_path / "own"
    foreign = {"bte_own.c": "/* our task, around brake-cal */\n", "notes.txt": "ours\n"}
    step = ("--sample-time", "0.005")
    for prefix in ("math", "9a-b", "9a-b"):
        how = (*step, "--out", code, "--prefix", prefix)
        ran = brake_cal(*words, "ECU", *how, "--json")
        document = json.loads(ran.out)
        assert (ran.code, document["format"], document["float"]) == (0, "ecu", 32)
        assert set(document["files"]) == set(files_of(SEDAN, prefix))
        for name, text in foreign.items():
            (code / name).write_text(text)
    written = {name for prefix in ("math", "9a-b") for name in files_of(SEDAN, prefix)}
    assert {path.name for path in code.iterdir()} == {*written, *foreign}
    called(code, program(code, f"cc -std=c99 {STRICT}", car="t_9a_b"))
    (code / "README.md").write_text("The estimator of brake-cal, of another version.\n")
    assert brake_cal(*words, "ecu", *step, "--out", code).code == 2
    other.mkdir()
    (other / "CMakeLists.txt").write_text("project(own)\n")
    new = ("ecu", "--out", other / "code")
    for more in (
        *((*new, "--sample-time", time) for time in (0.0, 1.0)),
        (*new, *step, "--double", "--float"),
        ("ecu", *step, "--out", other),
        ("fmu3", *step, "--out", other / "CMakeLists.txt"),
        ("car-fmu2", *step, "--out", other / "car.fmu", "--prefix", "x"),
        ("dcm", "--out", other / "car.dcm", "--sample-time", 0.01),
    ):
        assert brake_cal(*words, *more).code == 2
    assert [path.read_text() for path in other.iterdir()] == ["project(own)\n"]
    for form in ("car-fmu2", "FMU3"):
        ran = brake_cal(*words, form, *step, "--out", other / "car.fmu", "--json")
        assert json.loads(ran.out)["format"] == form.lower()


def test_the_sample_time_is_that_of_the_logs_and_no_part_of_the_digest(brake_cal, fitted, tmp_path):
    origin = fitted.provenance
    unknown = (replace(log, sample_time=None) for log in origin.logs)
    older = replace(fitted, provenance=replace(origin, logs=tuple(unknown)))
    assert older.digest == fitted.digest
    for table, code in ((older, 2), (fitted, 0)):
        store = Store(tmp_path / f"{code}")
        assert store.save(table).table.provenance == table.provenance
        assert store.load(table.name).table.provenance == table.provenance
        words = ("--store", tmp_path / f"{code}", "--unreleased", "--format", "fmu3")
        ran = brake_cal("tables", "export", table.name, *words, "--out", tmp_path / "x", "--json")
        assert ran.code == code
    assert json.loads(ran.out)["sample_time"] == pytest.approx(0.005)
