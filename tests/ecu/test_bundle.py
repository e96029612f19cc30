"""The folder that an ECU project takes in: compiled as its README says, on any prefix and width."""

import json
import shutil
import subprocess

import pytest

from calib.base.errors import ExchangeError, ProgramError
from calib.ecu.bundle import names, write_bundle
from calib.ecu.native import coded, compiler
from calib.estimation.limits import DEFAULTS
from calib.estimation.validate import validate_one
from calib.store.state import StateDecision
from calib.store.store import Store
from calib.table.exported import Precision
from tests.exports.test_a2l import a2ltool, needs_a2ltool
from tests.exports.test_formats import dcm_reader
from tests.support.compilers import needs_cc
from tests.support.reference_car import WET, noisy, stop

WARNINGS = "-std=c99 -pedantic -Wall -Wextra -Wconversion -Wdouble-promotion -Wshadow -Werror"
SINGLE, SMALL = Precision(single=True), Precision(12, 16)


@pytest.fixture(scope="module")
def kept(fitted, tmp_path_factory):
    store = Store(tmp_path_factory.mktemp("store"))
    return store.save(fitted, StateDecision("released", "made for a test"))


def program(folder, prefix, *flags):
    """The program of the vectors."""
    files = [folder / f"{prefix}{end}.c" for end in ("", "_car", "_run")]
    flags = [*flags, "-ffp-contract=off", f"-D{prefix.upper()}_VECTORS"]
    made = folder / "program"
    subprocess.run([*compiler(), *flags, *files, "-o", made, "-lm"], check=True)
    return made


@needs_cc
@pytest.mark.parametrize(
    ("how", "step", "prefix"),
    [(Precision(), 0.01, "bte"), (SINGLE, 0.005, "acme_brake"), (SMALL, 0.02, "bte")],
)
def test_the_folder_compiles_without_a_remark_and_its_vectors_agree(
    kept, tmp_path, how, step, prefix
):
    made = write_bundle(kept, tmp_path / "code", how, step, prefix)
    assert {path.name for path in made} == set(names(prefix))
    vectors = program(tmp_path / "code", prefix, *WARNINGS.split(), "-O2")
    assert b"0 reasons differ" in subprocess.run(vectors, check=True, capture_output=True).stdout
    text = "".join(path.read_text() for path in made if path.suffix in (".c", ".h"))
    assert ("bte" in text) == (prefix == "bte")


@needs_cc
@needs_a2ltool
@pytest.mark.parametrize("how", [Precision(), SINGLE, Precision(6, 8)])
def test_another_program_finds_the_addresses_of_the_a2l(kept, tmp_path, how):
    code = tmp_path / "code"
    write_bundle(kept, code, how, 0.01)
    plain = (code / "bte.a2l").read_bytes()
    made = program(code, "bte", "-std=c99", "-g", "-gdwarf-4", "-no-pie")
    write_bundle(kept, code, how, 0.01, elf=made)
    update = ("--elffile", made, "--update", "FULL", "--update-mode", "STRICT")
    ours = a2ltool(tmp_path, (code / "bte.a2l").read_bytes())
    assert a2ltool(tmp_path, plain, *update) == ours
    assert ours.count("/begin CHARACTERISTIC") == 12  # eight maps, three levels, the version
    before = {path: path.read_bytes() for path in code.iterdir()}
    with pytest.raises(ProgramError):  # it has no labels of that name
        write_bundle(kept, code, how, 0.01, prefix="acme", elf=made)
    assert before == {path: path.read_bytes() for path in code.iterdir()}


def test_another_reader_finds_the_numbers_of_the_maps_in_the_dcm(kept, tmp_path):
    write_bundle(kept, tmp_path / "code", SINGLE, 0.01)
    read = dcm_reader((tmp_path / "code" / "bte.dcm").read_bytes(), tmp_path)
    level = kept.table.level_map
    assert read["curves"]["bte_level"][0] == pytest.approx(level.z, rel=1e-6)
    assert read["curves"]["bte_level"][1] == pytest.approx(level.level, rel=1e-6)
    assert read["scalars"]["bte_version"][0] == kept.version


@needs_cc
@pytest.mark.skipif(shutil.which("cmake") is None, reason="no cmake")
def test_cmake_builds_it_and_runs_the_vectors(kept, tmp_path):
    write_bundle(kept, tmp_path / "code", SINGLE, 0.01)
    for command in ("cmake -S code -B build", "cmake --build build", "ctest --test-dir build"):
        subprocess.run(command.split(), cwd=tmp_path, check=True, capture_output=True)


def test_a_name_or_a_time_that_c_does_not_take_is_refused(kept, tmp_path):
    for step, prefix in ((0.01, "9a"), (0.01, "a-b"), (0.01, ""), (0.0, "bte"), (1.0, "bte")):
        with pytest.raises(ExchangeError):
            write_bundle(kept, tmp_path / "code", Precision(), step, prefix)
    assert not (tmp_path / "code").exists()


@needs_cc
def test_the_verdict_is_that_of_the_code(fitted):
    log = noisy(stop(WET), 8)
    for how in (Precision(), Precision(8, 16)):
        own = validate_one(fitted, log, None, DEFAULTS)
        code = validate_one(fitted, log, None, DEFAULTS, coded=coded(fitted, how))
        assert code.word == own.word
        for name in ("ecu_pad_friction_f", "ecu_pad_friction_r", "ecu_valid_share"):
            near = 1e-9 if how.points is None else 0.05
            assert code.figures[name] == pytest.approx(own.figures[name], rel=near)


def test_without_a_compiler_it_is_said(fitted, monkeypatch):
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(ProgramError):
        coded(fitted, Precision())


def test_the_command_writes_the_code_and_nothing_over_foreign_files(brake_cal, kept, tmp_path):
    words = ("tables", "export", kept.id, "--store", kept.path.parent.parent, "--format")
    code, own = tmp_path / "code", tmp_path / "own"
    for prefix in ("bte", "bte", "acme"):  # what has another prefix goes
        ran = brake_cal(*words, "ECU", "--float", "--out", code, "--prefix", prefix, "--json")
        assert ran.code == 0
        told = json.loads(ran.out)
        assert (told["format"], told["float"]) == ("ecu", 32)
        files = {path.name for path in code.iterdir()}
        assert set(told["files"]) == set(names(prefix)) == files - {"bte_own.c", "notes.txt"}
        (code / "bte_own.c").write_text("/* our task, around brake-cal */\n")
        (code / "notes.txt").write_text("ours\n")
    assert {"bte_own.c", "notes.txt"} < {path.name for path in code.iterdir()}
    own.mkdir()
    (own / "CMakeLists.txt").write_text("project(own)\n")
    for more in (
        ("ecu", "--out", own),
        ("fmu3", "--out", own / "CMakeLists.txt"),
        ("car-fmu2", "--out", own / "car.fmu", "--prefix", "x"),
        ("ecu", "--out", own / "code", "--prefix", "math"),
        ("ecu", "--out", own / "code", "--sample-time", 0.0),
        ("dcm", "--out", own / "car.dcm", "--sample-time", 0.01),
    ):
        assert brake_cal(*words, *more).code == 2
    assert [path.name for path in own.iterdir()] == ["CMakeLists.txt"]
    assert (own / "CMakeLists.txt").read_text() == "project(own)\n"
    for form in ("car-fmu2", "FMU3"):
        ran = brake_cal(*words, form, "--out", own / "car.fmu", "--json")
        assert json.loads(ran.out)["format"] == form.lower()
