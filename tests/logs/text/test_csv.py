"""CSV: the ways in which text can fail to be a table."""

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.logs.source import Column
from calib.logs.text.csv import open_csv
from tests.support.refusals import refusal

HEADER = "time [s],p_mc [bar]\n"
ROWS = "".join(f"{i / 200:.3f},{i / 10:.2f}\n" for i in range(60))


def refused(text, indices=(0, 1)):
    data = text if isinstance(text, bytes) else text.encode()
    return refusal(lambda: open_csv(data, "run.csv").read(indices), kind=LogError, names="run.csv")


def test_reads_the_columns_that_are_asked_for():
    source = open_csv((HEADER + ROWS).encode(), "run.csv")
    assert source.columns == (Column("time", "s"), Column("p_mc", "bar"))
    (pressure,) = source.read([1])
    np.testing.assert_array_equal(pressure, np.arange(60) / 10)
    assert source.notes == ()


@pytest.mark.parametrize(
    "data",
    [
        b"\xef\xbb\xbf" + (HEADER + ROWS).encode(),
        (HEADER + ROWS).replace("\n", "\r\n").encode(),
        (HEADER + ROWS).replace(",", " , ").encode(),
        (HEADER.replace("p_mc [bar]", '"p_mc [bar]"') + ROWS).encode(),
    ],
    ids=["byte order mark", "Windows lines", "spaces", "quotes"],
)
def test_harmless_variants(data):
    source = open_csv(data, "run.csv")
    assert source.columns == (Column("time", "s"), Column("p_mc", "bar"))
    np.testing.assert_array_equal(source.read([1])[0], np.arange(60) / 10)


def test_not_text():
    assert "not text" in refused(b"MDF     \0\0\0\0")


def test_cell_that_is_no_number():
    message = refused(HEADER + ROWS.replace("0.015,0.30", "0.015,open"))
    assert "p_mc: row 4: 'open' is not a number" in message


def test_foreign_text_column_does_not_matter():
    source = open_csv((HEADER + ROWS.replace("0.30", "open")).encode(), "run.csv")
    assert source.read([0])[0].size == 60


def test_uneven_row():
    assert "row 4 has 3 cells" in refused(HEADER + ROWS.replace("0.015,", "0.015,7,"))
