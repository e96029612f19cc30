"""`brake-cal tables merge`."""

import pytest

from calib.store.store import Store
from tests.support.cars_of_a_line import car_table


@pytest.fixture
def line(brake_cal, store):
    """Run a command of `brake-cal tables` on a store with sedan@1, @2, @3 of three cars."""
    for number, stiffness in enumerate((26.0, 27.0, 28.0), start=1):
        Store(store).save(car_table(number, stiffness))

    def run(*arguments):
        return brake_cal("tables", *arguments, "--store", store)

    return run


CARS = ("sedan@1", "sedan@2", "sedan@3")


def test_the_mean_is_stored_with_its_parents(line, store):
    ran = line("merge", *CARS, "--name", "golden")
    assert ran.code == 0, ran.err
    assert "stored golden@1" in ran.out
    for part in ("D at eta 1.00500", "0.135", "3.70 %", "pad level", "less than noise",
                 "slip stiffness", "vehicle file, the surface of the track"):  # fmt: skip
        assert part in ran.out
    assert "of sedan@2" in ran.err
    assert [p.id for p in Store(store).load("golden").table.provenance.parents] == list(CARS)
    again = line("merge", *reversed(CARS), "--name", "golden")
    assert "stored golden@1" in again.out


def test_the_document(line, store, document):
    told = document(line("merge", *CARS, "--name", "golden", "--json"))
    stored = Store(store).load("golden@1")
    assert (told["id"], told["digest"], told["cars"]) == ("golden@1", stored.digest, 3)
    assert [p["id"] for p in told["parents"]] == list(CARS)
    assert told["parents"][0]["digest"] == Store(store).load("sedan@1").digest
    assert told["eta"] == [1.0, 1.005]
    D = told["figures"][0]
    assert D["value"] == pytest.approx(0.135)
    assert D["between"] == pytest.approx(1.0 / 27.0, rel=1e-6)
    # t of two degrees of freedom times 1/sqrt(3)
    assert D["half_width"] == pytest.approx(4.30265 / 3.0**0.5 / 27.0, rel=1e-4)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("sedan@1", "--name", "golden"), "a mean needs two cars or more"),
        (("sedan@1", "sedan@1", "--name", "golden"), "sedan@1 was given twice"),
        ((*CARS, "--name", "sedan"), "next version of a car's table"),
        ((*CARS, "--name", "no/name"), "cannot name a table"),
        (CARS, "Missing option '--name'"),
    ],
)
def test_what_has_no_mean_ends_with_2_and_stores_nothing(line, store, words, says):
    ran = line("merge", *words)
    assert (ran.code, ran.result) == (2, "")
    assert says in ran.err
    assert [entry.id for entry in Store(store).list()] == list(CARS)


def test_every_look_at_a_table_works_with_a_mean(line, tmp_path, brake_cal, store):
    line("merge", *CARS, "--name", "golden")
    shown = line("show", "golden").out
    assert "sedan@3 (" in shown
    assert "spread of slip stiffness" in shown
    assert line("diff", "golden", "sedan@1").code == 0
    assert "3 cars" in line("show", "golden").out
    assert line("verify").code == 0
    for form in ("json", "csv", "parquet", "dcm", "cdfx", "a2l", "c-header", "inca-csv"):
        out = tmp_path / f"golden.{form}"
        assert line("export", "golden@1", "--unreleased", "--format", form, "--out", out).code == 0
        assert b"sedan@1, sedan@2, sedan@3" in out.read_bytes()
    for form in ("dcm", "cdfx"):
        assert line("import", tmp_path / f"golden.{form}").code == 0
    drawn = brake_cal("plot", "golden@1", "--store", store, "--out", tmp_path / "golden.svg")
    assert drawn.code == 0, drawn.err
