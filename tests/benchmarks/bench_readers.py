"""Speed of the readers against the bare libraries, in one run.

    python tests/benchmarks/bench_readers.py [SECONDS]

The library alone with its own way to numbers, then `read_log`, which also checks that the file is
whole, makes a digest, converts units and brings everything onto one clock. Prints the least time of
five and the ratio; nothing is asserted, machines differ. Needs the extras `mdf` and `can`.
"""

import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

import asammdf
import can
import cantools
import numpy as np
import pandas as pd
import pyarrow.parquet as pq
from pyarrow import csv

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from calib.logs.log import Log  # noqa: E402
from calib.logs.read import read_log  # noqa: E402
from calib.logs.write import write_csv, write_parquet  # noqa: E402
from tests.benchmarks.timing import best  # noqa: E402
from tests.support import recordings as made  # noqa: E402

NAMES = list(made.CHANNELS.values())


def bare_csv(path: Path) -> object:
    return csv.read_csv(path, csv.ReadOptions(use_threads=False))


def bare_parquet(path: Path) -> object:
    return pq.read_table(path, use_threads=False)


def bare_mdf(path: Path) -> object:
    """Each channel on its own clock."""
    with asammdf.MDF(path) as mdf:
        return mdf.select(NAMES, ignore_value2text_conversions=True)


def bare_mdf_bus(path: Path) -> object:
    with (
        asammdf.MDF(path) as mdf,
        mdf.extract_bus_logging({"CAN": [(path.parent / "chassis.dbc", 0)]}) as out,
    ):
        return out.select(NAMES)


def bare_bus(path: Path) -> object:
    database = cantools.database.load_file(path.parent / "chassis.dbc")
    kept: dict[str, list[tuple[float, object]]] = {name: [] for name in NAMES}
    for message in can.LogReader(path):
        signals = database.decode_message(message.arbitration_id, message.data)
        for name in kept.keys() & signals.keys():
            kept[name].append((message.timestamp, signals[name]))
    return {name: np.array(values) for name, values in kept.items()}


def long_mdf(path: Path, seconds: float) -> Path:
    """Seven channels in three rasters and thirty that nobody asks for."""
    rng = np.random.default_rng(0)
    with asammdf.MDF(version="4.10") as mdf:
        for rate, names in ((200, list(made.UNITS)[:4]), (100, ["PMc", "VRef"]), (100, ["Ax"])):
            t = np.arange(seconds * rate) / rate
            each = [*names, *(f"other_{rate}_{names[0]}_{i}" for i in range(10))]
            mdf.append([asammdf.Signal(rng.normal(size=t.size), t, name=n,
                                       unit=made.UNITS.get(n, "V")) for n in each])  # fmt: skip
        return Path(mdf.save(path, overwrite=True))


def long_bus(path: Path, seconds: float) -> Path:
    """The frames of the run again and again."""
    with can.Logger(path) if path.suffix != ".mf4" else can.MF4Writer(path) as log:
        for turn in range(max(1, round(seconds / 9))):
            for message in made.messages():
                message.timestamp += 1.7e9 + 9.0 * turn
                message.channel = 0
                log.on_message_received(message)
    return path


def long_log(rows: int) -> Log:
    """Eight channels at 200 Hz."""
    rng = np.random.default_rng(1)
    channels = {name: 10.0 * rng.normal(size=rows) for name in made.CHANNELS}
    return Log("bench", "bench", "", {"time": np.arange(rows) / 200.0, **channels})


def told(path: Path, bare: Callable[[Path], object], *chart: Path) -> None:
    """One line."""
    theirs, ours = best(partial(bare, path), 5), best(lambda: read_log(path, *chart), 5)
    print(f"{path.name:<14}{path.stat().st_size / 2**20:7.1f} MiB  {bare.__name__:<14}"
          f"{1e3 * theirs:8.1f} ms, ours {1e3 * ours:8.1f} ms, {ours / theirs:.2f} x")  # fmt: skip


def main(seconds: float) -> None:
    """Write the files, read them both ways, print the ratios."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for rows in (2_000, 400_000):
            write_csv(long_log(rows), folder / f"{rows}.csv")
            write_parquet(long_log(rows), folder / f"{rows}.parquet")
            for bare in (bare_csv, pd.read_csv):
                told(folder / f"{rows}.csv", bare)
            told(folder / f"{rows}.parquet", bare_parquet)
        made.write_dbc(folder)
        made.write_map(folder)
        told(long_mdf(folder / "plain.mf4", 10 * seconds), bare_mdf, folder / "plain.toml")
        told(long_bus(folder / "bus.mf4", seconds / 3), bare_mdf_bus, folder / "map.toml")
        for ending in ("blf", "asc", "log"):
            told(long_bus(folder / f"bus.{ending}", seconds), bare_bus, folder / "map.toml")


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 180.0)
