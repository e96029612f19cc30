"""What a reader costs is bounded by the length of its input, whatever that holds."""

import time

import pytest

from calib.base.errors import BrakeCalError
from calib.car.tyre_file import read_tyres
from calib.logs.channel_map_file import read_channel_map
from calib.logs.read import read_log

MEGABYTE = 1_000_000
HEAD = "time [s],p_mc [bar],a_x [m/s^2],omega_fl [rad/s],omega_fr [rad/s],omega_rl [rad/s],"
HEAD += "omega_rr [rad/s]\n"
ROW = "0.01,1.0,0.0,90.0,90.0,90.0,90.0\n"
ROWS = HEAD + "".join(ROW.replace("0.01", f"{0.01 * i:.2f}") for i in range(60))

WORST = {
    "digits and a letter": ROWS + "1" * MEGABYTE + "x,1,0,90,90,90,90\n",
    "digits, comma, letter": ROWS + "1" * (MEGABYTE // 2) + "," + "1" * (MEGABYTE // 2) + "x\n",
    "colons": ROWS.replace("0.00,", ":" * MEGABYTE + ","),
    "blanks in a header": "time [s]," + " " * MEGABYTE + "x\n" + ROW * 60,
    "brackets in a header": "(" * MEGABYTE + "," + HEAD + ROW * 60,
    "quotes": ROWS + '"' * MEGABYTE + "\n",
    "one long word": ROWS + "x" * MEGABYTE + ",1,0,90,90,90,90\n",
    "blank lines": HEAD + "\n" * MEGABYTE + ROW,
    "separators": ROWS + "," * MEGABYTE + "\n",
}


def cpu_of(read, path):
    """Seconds of processor time until a reader has refused a file."""
    begun = time.process_time()
    with pytest.raises(BrakeCalError):
        read(path)
    return time.process_time() - begun


@pytest.mark.parametrize("kind", WORST)
def test_a_table_of_a_megabyte_is_refused_within_two_seconds(tmp_path, kind):
    path = tmp_path / "run.csv"
    path.write_text(WORST[kind])
    assert cpu_of(read_log, path) < 2.0


@pytest.mark.parametrize("reader", [lambda path: read_tyres([path]), read_channel_map])
@pytest.mark.parametrize(
    "text", ["\n" * MEGABYTE, "a" * MEGABYTE, " " * MEGABYTE + "=", "[" * 9999]
)
def test_other_files_too(tmp_path, reader, text):
    path = tmp_path / "file.toml"
    path.write_text(text[:900_000])
    assert cpu_of(reader, path) < 2.0
