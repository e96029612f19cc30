from pathlib import Path

import pytest

from calib.car.vehicle_file import read_vehicle
from calib.fitting.fit import fit
from calib.logs.read import read_log
from calib.store.store import Store
from tests.cli.conftest import parsed
from tests.support.tables import made_table

LOGS = Path(__file__).parents[2] / "sample_logs"
SEDAN = LOGS / "sedan"
RAMP, STOP = SEDAN / "ramp_wet_asphalt.csv", SEDAN / "basalt_wet_pads.csv"
WRONG = LOGS / "simulation_study" / "vehicle_wrong_pads.toml"
PNG, SVG, PDF = b"\x89PNG", b"<?xml", b"%PDF"


@pytest.fixture(scope="module")
def tables(tmp_path_factory):
    """A store with a fitted sedan-2up@1 and two made tables."""
    store = tmp_path_factory.mktemp("store")
    Store(store).save(fit(read_vehicle(SEDAN / "vehicle.toml"), [read_log(RAMP)]))
    Store(store).save(made_table())
    Store(store).save(made_table(28.0))
    return store


@pytest.fixture
def plot(brake_cal, tables, tmp_path, monkeypatch):
    """Run `plot` in an empty directory."""
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return lambda *arguments: brake_cal("plot", *arguments, "--store", tables)


def files():
    return sorted(p.name for p in Path().iterdir())


def test_a_result_of_validate(plot, brake_cal, tables):
    assert brake_cal("validate", "sedan-2up", STOP, "--store", tables, "--out", "r").code in (0, 1)
    ran = plot("r/basalt_wet_pads.parquet", "--figure", "normalised-forces", "--json")
    (sheet,) = parsed(ran)["sheets"]
    assert sheet["kind"] == "stop"
    assert "normalised-forces" in sheet["figures"]


def test_several_logs_are_pages_of_a_pdf_or_files(plot):
    few = ("--figure", "a_x")
    assert plot(RAMP, STOP, *few, "--out", "logs.pdf").code == 0
    assert Path("logs.pdf").read_bytes().count(b"/Type /Page ") == 2
    assert plot(RAMP, STOP, *few, "--out", "logs.svg").code == 0
    assert files() == ["logs-basalt_wet_pads.svg", "logs-ramp_wet_asphalt.svg", "logs.pdf"]


def test_logs_of_one_name_do_not_overwrite_each_other(plot):
    assert plot(STOP, STOP, "--figure", "eta").code == 0
    assert files() == ["basalt_wet_pads-eta-2.png", "basalt_wet_pads-eta.png"]


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (("sedan@1", "sedan@2", STOP), 2),
        (("sedan@1", "sedan@2", "sedan@1"), 2),
        (("sedan@1", "--vehicle", WRONG), 2),
        (("sedan@1", "--out", f"{STOP}/a.png"), 2),
        (("nothing.csv",), 3),
        (("sedna",), 2),
    ],
)
def test_what_cannot_be_drawn_leaves_nothing(plot, arguments, code):
    ran = plot(*arguments)
    assert (ran.code, ran.result) == (code, "")
    assert files() == []


def test_a_page_of_a_stop_is_live_where_bokeh_is(plot, monkeypatch):
    assert plot("sedan-2up", STOP, "--out", "stop.html").code == 0
    assert "<script" in Path("stop.html").read_text()
    monkeypatch.setattr("calib.show.interactive.installed", lambda: False)
    ran = plot("sedan-2up", STOP, RAMP, "--out", "stop.html")
    assert "pip install 'brake-cal[pages]'" in ran.err
    text = Path("stop.html").read_text()
    assert "<script" not in text
    assert text.count("<h2") == 2  # the table and the stop
    assert files() == ["stop.html"]
