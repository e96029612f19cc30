from pathlib import Path

import pytest

from calib.base.errors import InputError
from calib.line.gauge.plan import (
    Place,
    certain_layout,
    chosen,
    on_road,
    places_from_folders,
    read_plan,
)


def plan(folder, text):
    path = folder / "plan.csv"
    path.write_text(text)
    return path


def test_a_plan_is_read_from_its_own_folder(tmp_path):
    path = plan(
        tmp_path, "log, car,station,vehicle\na.csv,VIN 7,north,cars/7.toml\nb.csv,8,south,\n"
    )
    assert read_plan(path) == (
        Place(tmp_path / "a.csv", "VIN 7", "north", tmp_path / "cars/7.toml", ""),
        Place(tmp_path / "b.csv", "8", "south", None),
    )


def test_semicolons_separate_too(tmp_path):
    path = tmp_path / "plan.csv"
    path.write_text("log;car;station\na, 1.csv;A;S1\n")
    (place,) = read_plan(path)
    assert (place.log, place.car, place.station) == (tmp_path / "a, 1.csv", "A", "S1")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("log,car,sation\n", "did you mean 'station'"),
        ("log,station\na,b\n", "no column 'car'"),
        ("log,car\n", "the plan has no logs"),
        ("log,car\na.csv,\n", "line 2 has no car"),
        ("log,car\na.csv,1\n./a.csv,2\n", "a.csv occurs twice"),
        ("log,car,station\na.csv,1,x\nb.csv,2,\n", "some logs have a station"),
        ("log,car,road\na.csv,1,wet\nb.csv,2,\n", "some logs have a road"),
        ("log,car\na.csv,1,x,y\n", "more cells than columns"),
        ("\nlog,car\n\na.csv,1\n  \nb.csv\n", "line 6 has no car"),
        ("log,car,car\na.csv,1,2\n", "column 'car' occurs twice"),
    ],
)
def test_a_bad_plan_says_what_is_wrong(tmp_path, text, says):
    with pytest.raises(InputError, match=says):
        read_plan(plan(tmp_path, text))


def test_a_missing_plan(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        read_plan(tmp_path / "plan.csv")


def test_named_logs_are_looked_up_in_the_plan(tmp_path):
    path = plan(tmp_path, "log,car\na.csv,1\nb.csv,2\n")
    places = read_plan(path)
    assert chosen(places, [], path) == places
    assert chosen(places, [tmp_path / "x/../b.csv"], path) == places[1:]
    with pytest.raises(InputError, match=r"c\.csv is not in the plan"):
        chosen(places, [tmp_path / "c.csv"], path)


def test_ramps_of_one_road_are_chosen(tmp_path):
    path = plan(tmp_path, "log,car,road\na.csv,1,wet\nb.csv,1,dry\nc.csv,2,wet\n")
    places = read_plan(path)
    assert [place.log.name for place in on_road(places, "wet", path)] == ["a.csv", "c.csv"]
    with pytest.raises(InputError, match=r"2 roads; expected one road: dry, wet; .*--road"):
        on_road(places, None, path)
    with pytest.raises(InputError, match="no ramp on road 'damp'; expected one road: dry, wet"):
        on_road(places, "damp", path)
    one = on_road(places, "dry", path)
    assert on_road(one, None, path) == one
    without = read_plan(plan(tmp_path, "log,car\na.csv,1\nb.csv,2\n"))
    assert on_road(without, None, path) == without
    with pytest.raises(InputError, match="expected a column road"):
        on_road(without, "wet", path)


def test_folders_name_car_and_station():
    log = Path("/d/a/b/x.csv")
    assert places_from_folders([log], "car/station") == (Place(log, "a", "b"),)
    assert places_from_folders([log], "station/car") == (Place(log, "b", "a"),)
    assert places_from_folders([log], "car") == (Place(log, "b", ""),)


def test_a_link_names_the_folders_it_lies_in(tmp_path):
    (tmp_path / "pool").mkdir()
    logs = []
    for car, station in ("ax", "ay", "bx", "by"):
        (tmp_path / "pool" / f"{car}{station}.csv").touch()
        logs.append(tmp_path / car / station / "1.csv")
        logs[-1].parent.mkdir(parents=True)
        logs[-1].symlink_to(tmp_path / "pool" / f"{car}{station}.csv")
    assert certain_layout(logs) == "car/station"
    assert [(p.car, p.station) for p in places_from_folders(logs, "car/station")] == [
        ("a", "x"), ("a", "y"), ("b", "x"), ("b", "y")]  # fmt: skip
    (turned,) = places_from_folders([logs[0].parent / ".." / "y" / "1.csv"], "car/station")
    assert turned.station == "y"


@pytest.mark.parametrize(
    ("log", "layout"), [("/x.csv", "car"), ("/x.csv", "car/station"), ("/a/x.csv", "car/station")]
)
def test_a_log_without_its_folders_is_refused(log, layout):
    with pytest.raises(InputError, match="not enough folders"):
        places_from_folders([Path(log)], layout)
    with pytest.raises(InputError, match="ambiguous from its folders"):
        certain_layout([Path(log)])


def test_a_layout_is_taken_only_where_it_is_certain():
    full = [Path(f"/d/{car}/{station}/1.csv") for car in "ab" for station in "xy"]
    assert certain_layout(full) == "car/station"
    for logs in (
        full[:2],
        [full[0], full[3]],
        [Path("/d/a/1.csv"), Path("/d/b/1.csv")],
        [Path("/x/1.csv"), Path("/a/x/1.csv"), Path("/b/x/1.csv")],
    ):
        with pytest.raises(InputError, match="ambiguous from its folders"):
            certain_layout(logs)
