from dataclasses import replace

import numpy as np
import pyarrow.parquet as pq
import pytest

from calib.estimation.baselines import METHODS
from calib.estimation.results import write_result
from calib.show import stop
from calib.show.result import read_result
from tests.support.plot_lines import line, panel

PAD = r"estimate $\mu_{p,c}$, 95 %"


@pytest.fixture(scope="module")
def drawn(sedan, transition, stopped):
    return stop.of_validation(sedan, "sedan@1", transition, stopped)


def test_panels_in_the_order_of_the_paper(drawn):
    assert drawn.names == (
        "wheel-speeds",
        "deceleration",
        "normalised-forces",
        "slip",
        "pad-front",
        "pad-rear",
        "pad-level",
        "axle-torques",
    )


def test_pad_friction_with_interval_nominal_and_rivals(drawn, stopped):
    e, pads = stopped.estimate, panel(drawn, "pad-front")
    found = line(pads, PAD)[1]
    assert np.array_equal(found[e.valid], e.best.pads_f.value[e.valid])
    assert np.isnan(found[~e.valid]).all()
    # the table's vehicle has 28.84 cm^2 and 130.9 mm in front
    nominal = line(pads, r"$\mu_{p,n}$ of the table")[1]
    p = np.maximum(e.read.p_f, 0.0)
    torque = line(panel(drawn, "axle-torques"), "front, pads of the table")[1]
    assert torque == pytest.approx(1e-3 * 4.0 * 28.84e-4 * 0.1309 * nominal * p)
    for name, (label, _) in stop.BASELINES.items():
        rival = line(pads, label)[1]
        assert np.array_equal(rival[e.valid], METHODS[name](e)[0][e.valid])
        assert np.isnan(rival[~e.valid]).all()
    low, high = pads.ylim
    assert low < e.best.pads_f.lower[e.valid].min()
    assert high > e.best.pads_f.upper[e.valid].max()


def test_level_and_pads_of_an_ecu_are_beside_those_of_all_channels(drawn, stopped):
    e = stopped.estimate
    for name, best, ecu in (
        ("pad-front", e.best.pads_f, e.ecu.pads_f),
        ("pad-rear", e.best.pads_r, e.ecu.pads_r),
        ("pad-level", e.best.level, e.ecu.level),
    ):
        one = panel(drawn, name)
        of_ecu = line(one, "ECU, without $v$")[1]
        assert np.array_equal(of_ecu[e.ecu.valid], ecu.value[e.ecu.valid])
        assert np.isnan(of_ecu[~e.ecu.valid]).all()
        (estimate,) = (x for x in one.lines if x.band is not None)
        for end, known in zip(estimate.band, (best.lower, best.upper), strict=True):
            assert np.array_equal(end[e.valid], known[e.valid])


def test_a_stored_result_is_drawn_as_the_stop_that_was_judged(stopped, drawn, tmp_path):
    write_result(stopped.estimate, tmp_path / "stop.parquet")
    sheet = stop.of_result(read_result(tmp_path / "stop.parquet"))
    assert sheet.result.lower() in drawn.result
    for name, label in (
        ("pad-rear", PAD),
        ("normalised-forces", "rear $F_r$"),
        ("axle-torques", "rear compensated"),
    ):
        a, b = (line(panel(one, name), label)[1] for one in (sheet, drawn))
        assert np.array_equal(a, b, equal_nan=True)
    # the interval before the bite is that of the prior, and does not set the axis
    e = stopped.estimate
    span = e.best.pads_f.upper[e.valid].max() - e.best.pads_f.lower[e.valid].min()
    before = e.best.pads_f.upper[~e.valid].max() - e.best.pads_f.lower[~e.valid].min()
    low, high = panel(sheet, "pad-front").ylim
    assert span < high - low < 1.3 * span
    assert before > 1.5 * span


def test_a_result_of_an_older_program_is_drawn_without_what_it_lacks(stopped, tmp_path):
    write_result(stopped.estimate, tmp_path / "new.parquet")
    written = pq.read_table(tmp_path / "new.parquet")
    kept = [name for name in written.column_names if not name.startswith(("ecu_", "pad_level"))]
    pq.write_table(written.select(kept), tmp_path / "older.parquet")
    new, older = (stop.of_result(read_result(tmp_path / f"{n}.parquet")) for n in ("new", "older"))
    assert [name for name in new.names if name not in older.names] == ["pad-level"]
    lines = [len(panel(sheet, "pad-front").lines) for sheet in (new, older)]
    assert lines == [2, 1]


def test_a_stop_of_which_nothing_is_valid_is_drawn_all_the_same(sedan, transition, stopped):
    none = replace(stopped, estimate=replace(stopped.estimate, unfit=("nothing brakes",)))
    assert len(stop.of_validation(sedan, "sedan@1", transition, none).overview().axes) == 8


def test_a_simulation_shows_its_truth_beside_the_nominal_pads(simulated):
    assert simulated.kind == "simulation"
    # the paper's Section IV: 0.4; the pressure is noisy
    truth = line(panel(simulated, "pad-rear"), "truth")[1]
    assert np.nanmean(truth) == pytest.approx(0.4, rel=0.01)
    assert np.isnan(truth[0])
    for axle, nominal in (("front", 0.5), ("rear", 0.6)):
        found = line(panel(simulated, f"pad-{axle}"), r"$\mu_{p,n}$ of the vehicle file")[1]
        assert (found == nominal).all()
