"""FMUs as FMPy (BSD) sees them: it checks, compiles and runs them; the numbers are Python's."""

import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from calib.ecu.fmu import VARIABLES, write_fmu
from calib.ecu.native import samples_of
from calib.ecu.online import RANGES, Online
from calib.ecu.width import Width
from calib.logs.read import read_log
from calib.store.store import Store
from calib.table.exported import Precision

fmpy = pytest.importorskip("fmpy", reason="no FMPy here (pip install fmpy)")
validate_fmu = pytest.importorskip("fmpy.validation").validate_fmu
FMICallException = pytest.importorskip("fmpy.fmi1").FMICallException

ROOT = Path(__file__).parents[2]
STEP = 0.005
"""Sample time of the log [s]."""
WIDTH = Width(64, Precision())
TOLD = 'sedan-2up@2 & "others", <b>'
PATH = os.pathsep.join((str(Path(sys.executable).parent), os.environ.get("PATH", "")))
"""With the cmake that may come with FMPy."""
MISSING = [name for name in ("cmake", "cc") if shutil.which(name, path=PATH) is None]
OUTPUTS = [x.name for x in VARIABLES if x.causality == "output"]
ERROR = 3
"""fmi2Error and fmi3Error."""

versions = pytest.mark.parametrize("version", [2, 3])


@pytest.fixture(scope="module")
def table():
    return Store(ROOT / "tables").load("sedan-2up").table


@pytest.fixture(scope="module", params=[2, 3])
def compiled(request, table, tmp_path_factory):
    """The file of an FMU that FMPy compiled where nothing else is."""
    if MISSING:
        pytest.skip(f"no {' and no '.join(MISSING)} here")
    path = tmp_path_factory.mktemp("bare") / "car.fmu"
    write_fmu(table, path, STEP, WIDTH, request.param, TOLD, table.digest)
    subprocess.run(
        [sys.executable, "-m", "fmpy", "compile", path],
        cwd=path.parent, env=os.environ | {"PATH": PATH}, capture_output=True, check=True,
    )  # fmt: skip
    return path


@pytest.fixture
def host(compiled, tmp_path):
    """What makes instances that are ready to step, and the names of their functions."""
    folder, about = fmpy.extract(compiled, tmp_path), fmpy.read_model_description(compiled)
    old = about.fmiVersion == "2.0"
    made = []

    def instance():
        one = fmpy.instantiate_fmu(folder, about, "CoSimulation")
        made.append(one)
        if old:
            one.setupExperiment(startTime=0.0)
        one.enterInitializationMode()
        one.exitInitializationMode()
        real, whole = ("Real", "Integer") if old else ("Float64", "Int32")
        return SimpleNamespace(
            get=getattr(one, f"get{real}"),
            set=getattr(one, f"set{real}"),
            get_whole=getattr(one, f"get{whole}"),
            set_whole=getattr(one, f"set{whole}"),
            step=one.doStep,
            reset=one.reset,
        )

    yield instance
    for one in made:
        one.terminate()
        one.freeInstance()


INPUTS = list(range(len(RANGES)))
REALS = list(range(len(RANGES), len(VARIABLES) - 1))
ROLLING = [2e6, -3.0, 60.0, 60.0, 60.2, 60.2, 0.0, 0.0, 0.0, 0.0]


@versions
def test_another_program_finds_no_fault_in_it(version, table, tmp_path):
    path = tmp_path / "car.fmu"
    odd = replace(table, vehicle=replace(table.vehicle, name='<"&\'> \x07 "/* ü'))
    made = [write_fmu(odd, path, STEP, WIDTH, version, TOLD, odd.digest) for _ in range(2)]
    content = path.read_bytes()
    assert made == [content, content]
    assert validate_fmu(str(path)) == []
    about = fmpy.read_model_description(path)
    assert TOLD in about.description
    assert odd.digest.encode() in content
    assert about.modelName == '<"&\'>   "/* ü'
    assert about.coSimulation.canHandleVariableCommunicationStepSize is False
    units = {x.name: x.unit for x in about.modelVariables}
    assert (units["p_mc"], units["brake_torque_sum"], units["reason"]) == ("Pa", "N.m", None)


def test_it_gives_the_numbers_of_the_estimator_in_python(compiled, table):
    samples = samples_of(read_log(ROOT / "sample_logs/simulation_study/stop_noisy.parquet"))
    signals = np.zeros(len(samples), [("time", float), *((name, float) for name in RANGES)])
    signals["time"] = STEP * np.arange(len(samples))
    for name, column in zip(RANGES, samples.T, strict=True):
        signals[name] = column
    run = fmpy.simulate_fmu(
        compiled, stop_time=STEP * len(samples), output_interval=STEP, input=signals,
        output=OUTPUTS,
    )  # fmt: skip
    told = np.array([run[name] for name in OUTPUTS]).T[1:]
    python = Online(table, STEP)
    answers = [python.step(dict(zip(RANGES, row, strict=True))) for row in samples.tolist()]
    expected = np.array([[*np.concatenate(x[1:]), x.reason] for x in answers])
    assert len(set(expected[:, -1])) > 3
    np.testing.assert_allclose(told, expected, rtol=1e-9, atol=1e-9)


def test_a_long_step_is_several_with_the_inputs_held_and_instances_do_not_share(host):
    one, other, idle = host(), host(), host()
    untouched = idle.get(REALS)
    for x in (one, other):
        x.set(INPUTS, ROLLING)
    one.step(0.0, 60 * STEP)
    for k in range(60):
        other.step(k * STEP, STEP)
    assert one.get(REALS) == other.get(REALS) != untouched
    assert idle.get(REALS) == untouched
    one.reset()
    assert one.get(REALS) == untouched


def refused(function, *arguments):
    """Whether a call ends as an error."""
    with pytest.raises(FMICallException) as caught:
        function(*arguments)
    return caught.value.status == ERROR


@pytest.mark.parametrize("length", [0.0, -STEP, 0.5 * STEP, 1.5 * STEP, 1e12, np.nan, np.inf])
def test_another_step_is_refused_and_changes_nothing(host, length):
    x = host()
    x.set(INPUTS, ROLLING)
    before = x.get(REALS)
    assert refused(x.step, 0.0, length)
    assert x.get(REALS) == before


def test_unknown_references_are_refused(host):
    x, reason = host(), len(VARIABLES) - 1
    before = x.get(INPUTS)
    for unknown in (reason, len(VARIABLES) + 1, 2**32 - 1):
        assert refused(x.get, [0, unknown])
    for no_input in (REALS[0], reason, len(VARIABLES), 2**32 - 1):
        assert refused(x.set, [0, no_input], [1.0, 1.0])
    assert x.get(INPUTS) == before
    assert refused(x.get_whole, [0])
    assert refused(x.set_whole, [reason], [0])
    assert x.get_whole([reason]) == [1]
