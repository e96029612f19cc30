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

from calib.ecu.channels import ANSWERS, CHANNELS, samples_of
from calib.ecu.fmu import V0, simulated, write_fmu
from calib.ecu.online import Online
from calib.logs.read import read_log
from calib.model.simulate import simulate
from calib.store.store import Store
from calib.table.exported import Precision

fmpy = pytest.importorskip("fmpy", reason="no FMPy here (pip install fmpy)")
validate_fmu = pytest.importorskip("fmpy.validation").validate_fmu
FMICallException = pytest.importorskip("fmpy.fmi1").FMICallException

ROOT = Path(__file__).parents[2]
STEP = 0.005
"""Sample time of the log [s]."""
WIDTH = Precision()
PATH = os.pathsep.join((str(Path(sys.executable).parent), os.environ.get("PATH", "")))
"""With the cmake that may come with FMPy."""
MISSING = [name for name in ("cmake", "cc") if shutil.which(name, path=PATH) is None]
ERROR = 3
"""fmi2Error and fmi3Error."""
INPUTS = list(range(len(CHANNELS)))
REALS = [len(CHANNELS) + i for i in range(3 * len(ANSWERS))]
REASON = REALS[-1] + 2
ROLLING = [2e6, -3.0, 60.0, 60.0, 60.2, 60.2, 0.0, 0.0, 0.0, 0.0]


@pytest.fixture(scope="module")
def stored():
    return Store(ROOT / "tables").load("sedan-2up")


@pytest.fixture(scope="module")
def table(stored):
    return stored.table


@pytest.fixture(scope="module", params=[2, 3])
def host(request, stored, tmp_path_factory):
    """What makes instances that are ready to step, of FMUs that FMPy compiled in a bare folder."""
    if MISSING:
        pytest.skip(f"no {' and no '.join(MISSING)} here")
    folder, models, made = tmp_path_factory.mktemp("bare"), {}, []
    old = request.param == 2
    for name in ("estimator", "car"):
        path = folder / f"{name}.fmu"
        write_fmu(stored, path, WIDTH, STEP, request.param, name)
        command = [sys.executable, "-m", "fmpy", "compile", path]
        at = {"cwd": folder, "env": os.environ | {"PATH": PATH}}
        subprocess.run(command, **at, capture_output=True, check=True)
        about = fmpy.read_model_description(path)
        models[name] = fmpy.extract(path, folder / name), about

    def instance(name, **given):
        unpacked, about = models[name]
        one = fmpy.instantiate_fmu(unpacked, about, "CoSimulation")
        made.append(one)
        real, whole = ("Real", "Integer") if old else ("Float64", "Int32")
        at = {x.name: x.valueReference for x in about.modelVariables}
        made_of = {"get": f"get{real}", "set": f"set{real}", "step": "doStep", "reset": "reset"}
        made_of |= {"get_whole": f"get{whole}", "set_whole": f"set{whole}"}
        x = SimpleNamespace(at=at, **{key: getattr(one, call) for key, call in made_of.items()})
        x.set([at[key] for key in given], list(given.values()))
        if old:
            one.setupExperiment(startTime=0.0)
        one.enterInitializationMode()
        one.exitInitializationMode()
        return x

    yield instance
    for one in made:
        one.terminate()
        one.freeInstance()


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("model", ["estimator", "car"])
def test_another_program_finds_no_fault_in_it(version, model, stored, tmp_path):
    path = tmp_path / "car.fmu"
    car = replace(stored.table.vehicle, name='<"&\'> \x07 "/* ü')
    odd = replace(stored, name='a & "b", <b>', table=replace(stored.table, vehicle=car))
    made = []
    for _ in range(2):
        write_fmu(odd, path, WIDTH, STEP, version, model)
        made.append(path.read_bytes())
    assert made[0] == made[1]
    assert validate_fmu(str(path)) == []
    about = fmpy.read_model_description(path)
    assert odd.id in about.description
    assert odd.digest.encode() in made[0]
    assert about.modelName == f'<"&\'>   "/* ü, {model}'
    assert about.coSimulation.canHandleVariableCommunicationStepSize is False
    units = {x.name: x.unit for x in about.modelVariables}
    assert (units["p_mc"], units["brake_torque_f"], units["reason"]) == ("Pa", "N.m", None)


def test_the_estimator_gives_the_numbers_of_python(host, table):
    samples = samples_of(read_log(ROOT / "sample_logs/simulation_study/stop_noisy.parquet"))
    x, told = host("estimator"), []
    for k, sample in enumerate(samples.tolist()):
        x.set(INPUTS, sample)
        x.step(k * STEP, STEP)
        told.append([*x.get_whole([REASON]), *x.get(REALS)])
    expected = Online(table, STEP).run(samples)
    assert len(set(expected[:, 0])) > 3
    np.testing.assert_allclose(told, expected, rtol=1e-9, atol=1e-9)


TIME = STEP * np.arange(1200)
RAMP, STOP = 6e5 * np.maximum(TIME - 1.0, 0.0), 25e5 * np.clip((TIME - 2.0) / 0.1, 0.0, 1.0)
MOTOR = {"T_drive_f": 300.0 * np.sin(TIME), "T_drive_r": -100.0 * (TIME > 3.0)}


@pytest.mark.parametrize(("pressure", "drive"), [(RAMP, {}), (STOP, MOTOR), (4.0 * STOP, {})])
def test_the_car_gives_the_numbers_of_a_simulation(host, table, pressure, drive):
    log = simulate(
        simulated(table), TIME, pressure, V0, drive_torque={k[-1]: drive[k] for k in drive}
    )
    x, given = host("car"), {"p_mc": pressure} | drive
    names = ["a_x", "omega_fl", "omega_fr", "omega_rl", "omega_rr", "v"]
    told, at = [x.get([x.at[name] for name in names])], [x.at[name] for name in given]
    for k in range(1, TIME.size):
        x.set(at, [column[k] for column in given.values()])
        x.step(TIME[k - 1], STEP)
        told.append(x.get([x.at[name] for name in names]))
        ended = x.get_whole([x.at["reason"]]) != [0]
        assert ended == (k >= log.time.size)
    told = np.array(told[: log.time.size])
    np.testing.assert_allclose(told, np.stack([log[n] for n in names], 1), rtol=1e-8, atol=1e-8)


def test_an_estimator_behind_the_car_finds_the_pads_that_were_put_in(host):
    car, ecu = host("car", pad_friction_f=0.31, pad_friction_r=0.27), host("estimator")
    seen = [name for name in CHANNELS if name in car.at]
    answers = [f"{x}{end}" for x in ("pad_friction_f", "pad_friction_r", "brake_torque_f")
               for end in ("_lower", "", "_upper")]  # fmt: skip
    for k, p in enumerate(STOP[:700].tolist()):
        car.set([car.at["p_mc"]], [p])
        car.step(k * STEP, STEP)
        ecu.set([ecu.at[name] for name in seen], car.get([car.at[name] for name in seen]))
        ecu.step(k * STEP, STEP)
    assert ecu.get_whole([REASON]) == [0]
    told = np.reshape(ecu.get([ecu.at[name] for name in answers]), (3, 3))
    for (low, found, high), true in zip(
        told, [0.31, 0.27, *car.get([car.at["brake_torque_f"]])], strict=True
    ):
        assert low < true < high
        assert found == pytest.approx(true, rel=0.05)


def test_a_long_step_is_several_with_the_inputs_held_and_instances_do_not_share(host):
    one, other, idle = host("estimator"), host("estimator"), host("estimator")
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


def test_other_steps_and_unknown_references_are_refused_and_change_nothing(host):
    x = host("estimator")
    x.set(INPUTS, ROLLING)
    before = x.get(INPUTS + REALS)
    calls = [(x.step, 0.0, y) for y in (0.0, -STEP, 0.5 * STEP, 1.5 * STEP, 1e12, np.nan, np.inf)]
    calls += [(x.get, [0, unknown]) for unknown in (REASON, REASON + 2, 2**32 - 1)]
    calls += [(x.set, [0, y], [1.0, 1.0]) for y in (REALS[0], REASON, REASON + 1, 2**32 - 1)]
    calls += [(x.get_whole, [0]), (x.set_whole, [REASON], [0])]
    for function, *arguments in calls:
        with pytest.raises(FMICallException) as caught:
            function(*arguments)
        assert caught.value.status == ERROR
        assert x.get(INPUTS + REALS) == before
    assert x.get_whole([REASON]) == [1]
