"""CSV: the ways in which text can fail to be a table."""

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.logs.source import Column
from calib.logs.text.csv import open_csv
from tests.support.refusals import refusal

HEADER = "time [s],p_mc [bar]\n"
ROWS = "".join(f"{i / 200:.3f},{i / 10:.2f}\n" for i in range(60))


@pytest.mark.parametrize(
    "data",
    [
        (HEADER + ROWS).replace(",", " , ").encode(),
        (HEADER.replace("p_mc [bar]", '"p_mc [bar]"') + ROWS).encode(),
        (HEADER + ROWS).replace("0.015", "open").encode(),
    ],
    ids=["spaces", "quotes", "text in another column"],
)
def test_reads_the_columns_that_are_asked_for(data):
    source = open_csv(data, "run.csv")
    assert source.columns == (Column("time", "s"), Column("p_mc", "bar"))
    np.testing.assert_array_equal(source.read([1])[0], np.arange(60) / 10)


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"MDF     \0\0\0\0", "not text"),
        ((HEADER + ROWS.replace("0.015,0.30", "0.015,open")).encode(), "row 4: 'open'"),
        ((HEADER + ROWS.replace("0.015,", "0.015,7,")).encode(), "row 4 has 3 cells"),
        (b"time;p_mc\ns;bar\n", ""),
    ],
)
def test_what_is_no_table(data, says):
    assert says in refusal(lambda: open_csv(data, "run.csv").read([0, 1]), kind=LogError)
