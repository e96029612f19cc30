from dataclasses import replace

import numpy as np
import pytest

from calib.estimation.results import fill, to_dict
from calib.show import stop
from calib.show.result import read_result
from calib.store.store import Store
from tests.support.plot_lines import line, panel

FRONT, REAR, TOTAL = (f"{side}, with 95 % band" for side in ("front", "rear", "total"))


@pytest.fixture(scope="module")
def drawn(sedan, transition, stopped):
    return stop.of_validation(stopped, "sedan@1")


def test_pad_friction_and_its_interval_are_drawn_beside_the_ramp_pads(sedan, drawn, stopped):
    e, pads = stopped.estimate, panel(drawn, "pads")
    calibration, pressure = sedan.calibration, np.maximum(e.signals.p_f, 0.0)
    for label, best, ramp in (
        (FRONT, e.ecu.pads_f, calibration.pad_friction_f.value),
        (REAR, e.ecu.pads_r, calibration.pad_friction_r.value),
    ):
        (curve,) = (x for x in pads.lines if x.label == label)
        for y, expected in zip((curve.y, *curve.band), best, strict=True):
            assert np.array_equal(y[e.ecu.valid], expected[e.ecu.valid])
            assert np.isnan(y[~e.ecu.valid]).all()
        ramp_label = f"{label.split(',')[0]} on the ramp, {ramp:.3f}"
        assert line(pads, ramp_label)[1].tolist() == [ramp, ramp]
    # the table's vehicle has 28.84 cm^2 and 130.9 mm in front
    torques = panel(drawn, "axle-torques")
    torque = line(torques, "front pads on the ramp")[1]
    mu = calibration.pad_friction_f.value
    assert torque.mean() == pytest.approx(4e-3 * 28.84e-4 * 0.1309 * mu * pressure.mean(), rel=1e-3)
    front, rear, total = (line(torques, label)[1] for label in (FRONT, REAR, TOTAL))
    assert front == pytest.approx(1e-3 * 4.0 * 28.84e-4 * 0.1309 * e.ecu.pads_f.value * pressure)
    assert total == pytest.approx(front + rear)
    low, high = pads.ylim
    assert low < e.ecu.pads_r.lower[e.ecu.valid].min()
    assert high > e.ecu.pads_r.upper[e.ecu.valid].max()


def test_a_stored_result_is_drawn_as_the_stop_that_was_judged(sedan, stopped, drawn, tmp_path):
    stored = Store(tmp_path / "tables").save(sedan)
    limit = stopped.judgements[0]
    failed = replace(stopped, judgements=(replace(limit, high=-1.0), *stopped.judgements[1:]))
    for result in (failed, stopped):
        fill([result], to_dict(stored, [result]), tmp_path)
        sheet = stop.of_result(read_result(tmp_path / f"{stopped.log}.parquet"))
        judged = stop.of_validation(result, stored.id)
        assert (sheet.title, sheet.result) == (judged.title, judged.result)
        assert (limit.figure in sheet.result) == (result is failed)
        assert judged.note in sheet.note
    for name, label in (("pads", REAR), ("normalised-forces", "rear"), ("axle-torques", TOTAL)):
        a, b = (line(panel(page, name), label)[1] for page in (sheet, drawn))
        assert np.array_equal(a, b, equal_nan=True)
    # the interval before the bite is that of the prior, and does not set the axis
    ecu = stopped.estimate.ecu
    width = ecu.pads_r.upper[ecu.valid].max() - ecu.pads_r.lower[ecu.valid].min()
    width_before = ecu.pads_r.upper[~ecu.valid].max() - ecu.pads_r.lower[~ecu.valid].min()
    low, high = panel(sheet, "pads").ylim
    assert width < high - low < 1.3 * width
    assert width_before > 1.5 * width


def test_a_stop_without_a_valid_sample_is_drawn(sedan, transition, stopped):
    invalid = replace(stopped, estimate=replace(stopped.estimate, unfit=("nothing brakes",)))
    sheet = stop.of_validation(invalid, "sedan@1")
    assert len(sheet.overview().axes) == 5
    assert np.isnan(line(panel(sheet, "pads"), REAR)[1]).all()


def test_a_simulation_shows_its_truth_beside_the_pads_of_the_file(simulated):
    assert simulated.kind == "simulation"
    # the paper's Section IV: 0.4; the pressure is noisy
    truth = line(panel(simulated, "pads"), "truth")[1]
    assert np.nanmean(truth) == pytest.approx(0.4, rel=0.01)
    assert np.isnan(truth[0])
    for label, nominal in (("front by the file, 0.500", 0.5), ("rear by the file, 0.600", 0.6)):
        assert (line(panel(simulated, "pads"), label)[1] == nominal).all()
