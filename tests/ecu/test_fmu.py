"""FMUs as FMPy (BSD) sees them: it checks, compiles and runs them; the numbers are Python's."""

import os
import shutil
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from calib.ecu.fmu import compile_fmu, simulated, write_fmu
from calib.estimation.online import ANSWERS, CHANNELS, answered
from calib.model.simulate import simulate
from calib.table.exported import Precision
from tests.support.ecu_code import SEDAN

fmpy = pytest.importorskip("fmpy", reason="no FMPy here (pip install fmpy)")
validate_fmu = pytest.importorskip("fmpy.validation").validate_fmu
FMICallException = pytest.importorskip("fmpy.fmi1").FMICallException

PATH = os.pathsep.join((str(Path(sys.executable).parent), os.environ.get("PATH", "")))
"""The PATH with the cmake that FMPy may have brought."""
STEP, ERROR = 0.005, 3  # [s]; fmi2Error and fmi3Error
TIME = STEP * np.arange(1200)
RAMP, STOP = 6e5 * np.maximum(TIME - 1.0, 0.0), 25e5 * np.clip((TIME - 2.0) / 0.1, 0.0, 1.0)
RELEASED = 56.5e5 * np.clip((TIME - 0.1) / 0.4, 0.0, 1.0) * (TIME < 1.1)  # from near the peak
MOTOR = {"T_drive_f": 300.0 * np.sin(np.maximum(TIME - 0.1, 0.0)), "T_drive_r": -100.0 * (TIME > 3)}
ROLLING = [2e6, -3.0, 60.0, 60.0, 60.2, 60.2, 0.0, 0.0, 0.0, 0.0, 0.0]
INPUTS, REALS, REASON = list(range(11)), list(range(11, 38)), 39  # 38 is the time


def written(path, stored, version, model):
    """Write an FMU; return its path and description."""
    write_fmu(stored, path, Precision(), STEP, version, model)
    return path, fmpy.read_model_description(path)


@pytest.fixture(scope="module")
def fmus(tmp_path_factory):
    """The estimator in FMI 3 and the car in FMI 2, as FMPy compiled and unpacked them in a bare
    folder. No part of their sources depends on version and model at once: two FMUs are enough."""
    if any(shutil.which(name, path=PATH) is None for name in ("cmake", "cc")):
        pytest.skip("missing here: cmake or cc")
    folder, fmus = tmp_path_factory.mktemp("bare"), {}
    for model, version in (("estimator", 3), ("car", 2)):
        path, parsed = written(folder / f"{model}.fmu", SEDAN, version, model)
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("PATH", PATH)
            compile_fmu(path)
        fmus[model] = fmpy.extract(path, folder / model), parsed
    return fmus


def run(fmu, inputs, **parameters):
    """Return the outputs of an FMU at its start and after a step with each row of the inputs."""
    unpacked, parsed = fmu
    time = STEP * np.arange(len(inputs["p_mc"]))
    rows = np.rec.fromarrays([time, *inputs.values()], names=["time", *inputs])
    how = {"model_description": parsed, "stop_time": STEP * len(time), "output_interval": STEP}
    return fmpy.simulate_fmu(unpacked, input=rows, start_values=parameters, **how)


def ready(fmu):
    """Return an instance that can step; its methods have the names of FMI 3."""
    unpacked, parsed = fmu
    instance = fmpy.instantiate_fmu(unpacked, parsed, "CoSimulation")
    if parsed.fmiVersion == "2.0":
        instance.setupExperiment(startTime=0.0)
        instance.getFloat64, instance.setFloat64 = instance.getReal, instance.setReal
        instance.getInt32, instance.setInt32 = instance.getInteger, instance.setInteger
    instance.enterInitializationMode()
    instance.exitInitializationMode()
    return instance


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("model", ["estimator", "car"])
def test_another_program_finds_no_fault_in_it(version, model, tmp_path):
    car = replace(SEDAN.table.vehicle, name='<"&\'> \x07 "/* ü')
    odd = replace(SEDAN, name='a & "b", <b>', table=replace(SEDAN.table, vehicle=car))
    path, parsed = written(tmp_path / "car.fmu", odd, version, model)
    again, _ = written(tmp_path / "again.fmu", odd, version, model)
    assert path.read_bytes() == again.read_bytes()
    assert validate_fmu(str(path)) == []
    assert odd.id in parsed.description
    assert odd.digest.encode() in path.read_bytes()
    assert parsed.modelName == f'<"&\'>   "/* ü, {model}'
    assert parsed.coSimulation.canHandleVariableCommunicationStepSize is False
    units = {x.name: x.unit for x in parsed.modelVariables}
    assert (units["p_mc"], units["brake_torque_fl"], units["reason"]) == ("Pa", "N.m", None)


@pytest.mark.parametrize(
    ("pressure", "v0", "drive"),
    [(RAMP, 30.0, {}), (STOP, 30.0, MOTOR), (4.0 * STOP, 30.0, {}), (RELEASED, 12.0, {})],
)
def test_the_car_gives_the_numbers_of_a_simulation(fmus, pressure, v0, drive):
    torque = {name[-1]: column for name, column in drive.items()}
    log = simulate(simulated(SEDAN.table), TIME, pressure, v0, drive_torque=torque)
    inputs = {"p_mc": pressure, **drive}
    outputs = run(fmus["car"], {name: column[1:] for name, column in inputs.items()}, v0=v0)
    assert np.array_equal(outputs["reason"] != 0, np.arange(TIME.size) >= log.time.size)
    for name in ("a_x", "omega_fl", "omega_fr", "omega_rl", "omega_rr", "v"):
        np.testing.assert_allclose(outputs[name][: log.time.size], log[name], rtol=1e-8, atol=1e-8)


def test_an_estimator_behind_the_car_has_the_numbers_of_python_and_finds_its_pads(fmus):
    true = {"pad_friction_f": 0.31, "pad_friction_r": 0.27}
    inputs = {"p_mc": STOP[:700]}
    car = run(fmus["car"], inputs, **true)[1:]
    inputs |= {name: car[name] for name in car.dtype.names if name in CHANNELS}
    samples = np.stack([inputs.get(name, np.zeros(700)) for name in CHANNELS], axis=1)
    outputs = run(fmus["estimator"], inputs)[1:]
    names = ("reason", *(f"{x}{end}" for x in ANSWERS for end in ("", "_lower", "_upper")))
    answers = np.stack([outputs[name] for name in names], axis=1)
    expected = answered(SEDAN.table, STEP, samples)
    np.testing.assert_allclose(answers, expected, rtol=1e-9, atol=1e-9)
    assert outputs["reason"][-1] == 0
    for name, value in (true | {"brake_torque_rr": car["brake_torque_rr"][-1]}).items():
        assert outputs[f"{name}_lower"][-1] < value < outputs[f"{name}_upper"][-1]
        assert outputs[name][-1] == pytest.approx(value, rel=0.05)


def test_a_long_step_is_several_with_the_inputs_held_and_instances_do_not_share(fmus):
    instance, other, idle = (ready(fmus["estimator"]) for _ in range(3))
    untouched = idle.getFloat64(REALS)
    for x in (instance, other):
        x.setFloat64(INPUTS, ROLLING)
    instance.doStep(0.0, 60 * STEP)
    for k in range(60):
        other.doStep(k * STEP, STEP)
    assert instance.getFloat64(REALS) == other.getFloat64(REALS) != untouched
    instance.reset()
    assert instance.getFloat64(REALS) == idle.getFloat64(REALS) == untouched


def test_other_steps_and_unknown_references_are_refused_and_change_nothing(fmus):
    x = ready(fmus["estimator"])
    x.setFloat64(INPUTS, ROLLING)
    numbers, last = x.getFloat64(INPUTS + REALS), 2**32 - 1
    lengths = (0.0, -STEP, 0.5 * STEP, 1.5 * STEP, 1e12, np.nan, np.inf)
    calls = [(x.doStep, 0.0, length) for length in lengths]
    calls += [(x.getFloat64, [0, k]) for k in (REASON, REASON + 1, last)]
    calls += [(x.setFloat64, [0, k], [1.0, 1.0]) for k in (*range(REALS[0], REASON + 2), last)]
    calls += [(x.getInt32, [0]), (x.setInt32, [REASON], [0])]
    for function, *arguments in calls:
        with pytest.raises(FMICallException) as caught:
            function(*arguments)
        assert caught.value.status == ERROR
        assert x.getFloat64(INPUTS + REALS) == numbers
    assert x.getInt32([REASON]) == [1]


@pytest.mark.parametrize("model", ["estimator", "car"])
def test_a_state_is_taken_up_again_and_carried_to_another_instance(fmus, model):
    instance, other = ready(fmus[model]), ready(fmus[model])
    inputs = ROLLING if model == "estimator" else [2e6, 0.0, 0.0]
    variables = fmus[model][1].modelVariables
    outputs = [x.valueReference for x in variables if x.causality == "output"][:-1]
    instance.setFloat64([*range(len(inputs))], inputs)
    instance.doStep(0.0, 40 * STEP)
    saved, at_save = instance.getFMUState(), instance.getFloat64(outputs)
    instance.doStep(40 * STEP, 40 * STEP)
    later = instance.getFloat64(outputs)
    instance.setFMUState(saved)
    carried = other.deserializeFMUState(instance.serializeFMUState(saved))
    other.setFMUState(carried)
    for x, state in ((instance, saved), (other, carried)):
        assert x.getFloat64(outputs) == at_save != later
        x.doStep(40 * STEP, 40 * STEP)
        assert x.getFloat64(outputs) == later
        x.freeFMUState(state)
