"""Plans of a gauge study: what is read, and what is refused."""

from dataclasses import replace

import pytest

from calib.base.errors import InputError
from calib.line.gauge.plan import PlannedRamp, read_plan, readings
from calib.line.gauge.study import METRICS
from calib.logs.write import write_csv
from tests.support.reference_car import REAL, SEDAN, noisy, ramp, with_pads


def plan(folder, text):
    path = folder / "plan.csv"
    path.write_text(text)
    return path


def test_a_plan_is_read_from_its_own_folder(tmp_path):
    path = plan(tmp_path, "log, car,station,vehicle\na.csv,VIN 7,n,cars/7.toml\nb.csv,8,s,\n")
    assert read_plan(path) == (
        PlannedRamp(tmp_path / "a.csv", "VIN 7", "n", tmp_path / "cars/7.toml", ""),
        PlannedRamp(tmp_path / "b.csv", "8", "s", None),
    )
    path = plan(tmp_path, "log;car;station\na, 1.csv;A;S1\n")
    assert read_plan(path) == (PlannedRamp(tmp_path / "a, 1.csv", "A", "S1"),)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "log,car,sation\n",
        "log,station\na,b\n",
        "log,car\na.csv,\n",
        "\nlog,car\n\na.csv,1\n  \nb.csv\n",
        "log,car\na.csv,1\n./a.csv,2\n",
        "log,car\na.csv,1,x,y\n",
        "log,car,station\na.csv,1,x\nb.csv,2,\n",
        None,
    ],
)
def test_a_bad_plan_is_refused(tmp_path, text):
    path = tmp_path / "plan.csv" if text is None else plan(tmp_path, text)
    with pytest.raises(InputError):
        read_plan(path)


def test_ramps_of_two_roads_are_no_repeats(tmp_path):
    path = plan(tmp_path, "log,car,road\na.csv,1,wet\nb.csv,1,dry\nc.csv,2,wet\n")
    with pytest.raises(InputError):
        read_plan(path)


def test_a_copy_of_a_ramp_is_no_repeat(tmp_path):
    log = noisy(ramp(with_pads(REAL, 0.36, 0.36)), 1)
    channels = {name: x[::2] for name, x in log.channels.items()}
    thinned = replace(log, channels=channels, truth={})
    files = tmp_path / "a.csv", tmp_path / "b.csv"
    for file, run in zip(files, (log, thinned), strict=True):
        write_csv(run, file)
    with pytest.raises(InputError):
        readings([PlannedRamp(x, "1", "", SEDAN / "vehicle.toml") for x in files], None, METRICS)
