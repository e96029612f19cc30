"""One run, written in every dialect, reads back as the same log; what is cut off is refused."""

import gzip
import itertools
import math

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.errors import LogError
from calib.logs.read import read_log
from calib.logs.text.csv import open_csv
from calib.logs.text.dialect import TextFormat
from tests.support.made_runs import made_run

UNITS = {"time": "s", "p_mc": "bar", "a_x": "m/s²", "v": "km/h", "T_disc_f": "°C"}
STYLES = ("square", "round", "underscore", "row", "row in brackets")
ENCODINGS = ("utf-8", "utf-8-sig", "utf-16", "latin-1", "cp1252")
ENDINGS = {"m/s²": "m_s2", "°C": "degC", "km/h": "kmh", "rad/s": "rad_s"}
FACTORS = {"p_mc": 1e-5, "v": 3.6}

LOG = made_run()
ROWS = 80
NAMES = [name for name in LOG.channels if name in UNITS or name.startswith("omega_")]
TABLE = np.column_stack([np.round(LOG[n][:ROWS] * FACTORS.get(n, 1.0), 4) for n in NAMES])


def unit(name):
    return UNITS.get(name, "rad/s")


def header(style):
    if style == "square":
        return [[f"{n} [{unit(n)}]" for n in NAMES]]
    if style == "round":
        return [[f"{n}({unit(n)})" for n in NAMES]]
    if style == "underscore":
        return [[f"{n}_{ENDINGS.get(unit(n), unit(n))}" for n in NAMES]]
    units = [unit(n) if style == "row" else f"[{unit(n)}]" for n in NAMES]
    return [NAMES, units]


def text(separator, decimal, style, line_end="\n", table=TABLE):
    """As pandas writes it, but for the header."""
    rows = pd.DataFrame(table).to_csv(
        sep=separator, decimal=decimal, header=False, index=False, lineterminator=line_end
    )
    return line_end.join(separator.join(cells) for cells in header(style)) + line_end + rows


def expected():
    return {n: TABLE[:, j] / FACTORS.get(n, 1.0) for j, n in enumerate(NAMES)}


@given(
    separator=st.sampled_from([",", ";", "\t", "|"]),
    decimal=st.sampled_from([".", ","]),
    style=st.sampled_from(STYLES),
    encoding=st.sampled_from(ENCODINGS),
    packed=st.booleans(),
    line_end=st.sampled_from(["\n", "\r\n"]),
)
def test_every_dialect_reads_the_same(
    tmp_path_factory, separator, decimal, style, encoding, packed, line_end
):
    data = text(separator, decimal, style, line_end).encode(encoding)
    path = tmp_path_factory.getbasetemp() / ("run.csv.gz" if packed else "run.csv")
    path.write_bytes(gzip.compress(data) if packed else data)
    log = read_log(path)
    assert log.name == "run"
    for name, values in expected().items():
        np.testing.assert_allclose(log[name], values, rtol=1e-14, atol=1e-12)
    origins = {o.channel: o for o in log.origins}
    assert origins["p_mc"].factor == pytest.approx(1e5)
    assert origins["v"].factor == pytest.approx(1 / 3.6)


CELL = st.one_of(
    st.floats(-1e6, 1e6, allow_nan=False).map(lambda x: round(x, 3)), st.integers(-999, 9999)
)


@given(
    rows=st.lists(st.tuples(CELL, CELL, CELL), min_size=2, max_size=12),
    separator=st.sampled_from([",", ";", "\t"]),
    decimal=st.sampled_from([".", ","]),
)
def test_any_numbers_read_right_or_are_asked_for(rows, separator, decimal):
    """A wrong number never comes out, whatever the numbers look like."""
    lines = [separator.join(cell(x, separator, decimal) for x in row) for row in rows]
    data = (separator.join(["a [s]", "b [1]", "c [1]"]) + "\n" + "\n".join(lines) + "\n").encode()
    try:
        columns = open_csv(data, "run.csv").read(range(3))
    except LogError as error:
        if "--map" not in str(error):
            raise
        columns = open_csv(data, "run.csv", TextFormat(separator, decimal)).read(range(3))
    np.testing.assert_allclose(np.transpose(columns), np.array(rows, float), rtol=1e-15)


def cell(number, separator, decimal):
    written = str(number).replace(".", decimal)
    return f'"{written}"' if separator in written else written


@pytest.mark.parametrize(("separator", "decimal"), list(itertools.product(",;\t", ".,")))
@pytest.mark.parametrize("cut", [2, 5, 11])
def test_every_cut_within_the_last_line_is_refused(separator, decimal, cut):
    table = np.column_stack([np.arange(60) / 200, np.arange(60) / 8 + 0.0625, np.arange(60) + 0.25])
    rows = "".join(
        separator.join(cell(f"{x:.4f}", separator, decimal) for x in row) + "\n" for row in table
    )
    head = separator.join(["time [s]", "p_mc [bar]", "v [m/s]"]) + "\n"
    whole = head + rows
    assert open_csv(whole.encode(), "run.csv").read([0])[0].size == 60
    with pytest.raises(LogError, match="last line is cut off"):
        open_csv(whole[:-cut].encode(), "run.csv")


WHOLE = text(",", ".", "square").encode()
PACKED = gzip.compress(WHOLE)
TWO_UNITS = "time [s];p_mc [bar]\ns;kPa\n" + "".join(f"{i};{i}\n" for i in range(60))
DECIMAL_COMMAS = "time [s],p_mc [bar]\n" + "".join(f"0,{i:03d},1,5\n" for i in range(60))


@pytest.mark.parametrize(
    "data",
    [
        *(PACKED[: max(12, math.floor(share * len(PACKED)))] for share in (0.02, 0.5, 0.999)),
        PACKED[:-6] + bytes([PACKED[-6] ^ 1]) + PACKED[-5:],
        text(";", ",", "square").encode("utf-16")[:-1],
        TWO_UNITS.encode(),
        DECIMAL_COMMAS.encode(),
    ],
    ids=["gzip 2 %", "gzip 50 %", "gzip 99.9 %", "check sum", "half a character", "two units",
         "decimal commas between commas"],
)  # fmt: skip
def test_what_is_cut_off_or_contradicts_itself(data):
    with pytest.raises(LogError):
        open_csv(data, "run.csv.gz" if data[:2] == PACKED[:2] else "run.csv")


THOUSANDS = "a [s]{0}b [1]\n" + "".join(f"{i}{{0}}{i % 9 + 1},{100 + i}\n" for i in range(60))
SEPARATORS = "Zeit, s;Druck, bar\n" + "".join(f"{i},{i};{i},{i}\n" for i in range(60))
MARKS = "a [s];b [1];c [1]\n" + "".join(f"{i};0,5;0.25\n" for i in range(60))


@pytest.mark.parametrize(
    ("data", "text_format", "first"),
    [
        (THOUSANDS.format(";"), TextFormat(decimal=","), 1.1),
        (THOUSANDS.format("\t"), TextFormat(decimal=","), 1.1),
        (SEPARATORS, TextFormat(separator=";"), 0.0),
        (MARKS, None, None),
    ],
    ids=["thousands", "thousands between tabs", "two separators", "two marks"],
)
def test_what_can_be_read_in_two_ways_is_asked(data, text_format, first):
    with pytest.raises(LogError, match="--map"):
        open_csv(data.encode(), "run.csv")
    if text_format:
        assert open_csv(data.encode(), "run.csv", text_format).read([1])[0][0] == first


def test_spreadsheet_line_tells_the_separator():
    data = "sep=;\n" + text(";", ",", "square")
    assert len(open_csv(data.encode(), "run.csv").columns) == len(NAMES)
