import pytest

from calib.base.errors import InputError
from calib.line.gauge.plan import Place, on_road, read_plan


def plan(folder, text):
    path = folder / "plan.csv"
    path.write_text(text)
    return path


def test_a_plan_is_read_from_its_own_folder(tmp_path):
    path = plan(tmp_path, "log, car,station,vehicle\na.csv,VIN 7,n,cars/7.toml\nb.csv,8,s,\n")
    assert read_plan(path) == (
        Place(tmp_path / "a.csv", "VIN 7", "n", tmp_path / "cars/7.toml", ""),
        Place(tmp_path / "b.csv", "8", "s", None),
    )
    path = plan(tmp_path, "log;car;station\na, 1.csv;A;S1\n")
    assert read_plan(path) == (Place(tmp_path / "a, 1.csv", "A", "S1"),)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "log,car,sation\n",
        "log,station\na,b\n",
        "log,car,car\na.csv,1,2\n",
        "log,car\na.csv,\n",
        "\nlog,car\n\na.csv,1\n  \nb.csv\n",
        "log,car\na.csv,1\n./a.csv,2\n",
        "log,car\na.csv,1,x,y\n",
        "log,car\na.csv,1\0\n",
        "log,car,station\na.csv,1,x\nb.csv,2,\n",
        None,
    ],
)
def test_a_bad_plan_is_refused(tmp_path, text):
    path = tmp_path / "plan.csv" if text is None else plan(tmp_path, text)
    with pytest.raises(InputError):
        read_plan(path)


def test_ramps_of_one_road_are_chosen(tmp_path):
    path = plan(tmp_path, "log,car,road\na.csv,1,wet\nb.csv,1,dry\nc.csv,2,wet\n")
    places = read_plan(path)
    assert [place.log.name for place in on_road(places, "wet", path)] == ["a.csv", "c.csv"]
    one = on_road(places, "dry", path)
    assert on_road(one, None, path) == one
    without = read_plan(plan(tmp_path, "log,car\na.csv,1\nb.csv,2\n"))
    assert on_road(without, None, path) == without
    for given, road in ((places, None), (places, "damp"), (without, "wet")):
        with pytest.raises(InputError):
            on_road(given, road, path)
