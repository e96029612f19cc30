"""Speed and memory of the readers against the bare libraries, in one run.

    python tests/benchmarks/bench_readers.py [SECONDS]

Each reading runs in its own process: the library alone with its own way to numbers on a DataFrame
or in arrays, then `read_log` with a channel map, which also checks that the file is whole, makes a
digest, converts units and brings everything onto one clock. MDF is compared twice: with `select`,
which leaves each channel on its own clock, and with `to_dataframe`, which does not. Prints the
least wall time of five, the peak memory above that of the imports, and the ratios; nothing is
asserted, machines differ. Needs the extras `mdf` and `can`, and Linux for the memory.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from tests.support import recordings as made  # noqa: E402

READ = """
import json, os, sys, threading, time
sys.path.insert(0, {root!r})
from pathlib import Path
import numpy, pandas, can, cantools, asammdf
import calib.logs.read
path, folder = Path({path!r}), Path({folder!r})
def resident():
    return int(open("/proc/self/statm").read().split()[1]) * os.sysconf("SC_PAGESIZE") / 2**20
def watch():
    while not done.is_set():
        peak[0] = max(peak[0], resident())
        done.wait(0.005)
before, peak, done = resident(), [0.0], threading.Event()
if {watched}:
    threading.Thread(target=watch).start()
try:
    start = time.perf_counter()
    {body}
    wall = time.perf_counter() - start
finally:
    done.set()
print(json.dumps([wall, max(peak[0], resident()) - before]))
"""

OURS = "calib.logs.read.read_log(path, folder / {map!r})"

BARE_MDF = """
with asammdf.MDF(path) as mdf:
    signals = mdf.select({names!r}, ignore_value2text_conversions=True)
    kept = [(s.timestamps, s.samples) for s in signals]
"""

BARE_MDF_CLOCK = """
with asammdf.MDF(path) as mdf:
    kept = mdf.to_dataframe({names!r}, use_interpolation=True, ignore_value2text_conversions=True)
"""

BARE_MDF_BUS = """
with asammdf.MDF(path) as mdf:
    with mdf.extract_bus_logging({{"CAN": [(folder / "chassis.dbc", 0)]}}) as out:
        kept = [(s.timestamps, s.samples) for s in out.select({names!r})]
"""

BARE_BUS = """
database = cantools.database.load_file(folder / "chassis.dbc")
kept = {{name: ([], []) for name in {names!r}}}
for message in can.LogReader(path):
    signals = database.decode_message(message.arbitration_id, message.data)
    for name, value in signals.items():
        if name in kept:
            kept[name][0].append(message.timestamp)
            kept[name][1].append(value)
kept = {{name: (numpy.array(t), numpy.array(x)) for name, (t, x) in kept.items()}}
"""


def measured(body: str, path: Path) -> tuple[float, float]:
    """Least wall time [s] of five runs, and peak memory [MiB] of one that is watched."""
    walls = [_run(body, path, False)[0] for _ in range(5)]
    return min(walls), _run(body, path, True)[1]


def _run(body: str, path: Path, watched: bool) -> list[float]:
    code = READ.format(
        root=str(ROOT),
        path=str(path),
        folder=str(path.parent),
        body=body.strip().replace("\n", "\n    "),
        watched=watched,
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    if run.returncode:
        sys.exit(run.stderr)
    found: list[float] = json.loads(run.stdout.splitlines()[-1])
    return found


def long_mdf(path: Path, seconds: float, compression: int) -> Path:
    """Seven channels in three rasters and thirty that nobody asks for."""
    from asammdf import MDF, Signal

    rng = np.random.default_rng(0)
    with MDF(version="4.10") as mdf:
        for rate, names in ((200, list(made.UNITS)[:4]), (100, ["PMc", "VRef"]), (100, ["Ax"])):
            t = np.arange(seconds * rate) / rate
            more = [f"other_{rate}_{i}" for i in range(10)]
            mdf.append(
                [
                    Signal(rng.normal(size=t.size), t, name=n, unit=made.UNITS.get(n, "V"))
                    for n in [*names, *more]
                ]
            )
        return mdf.save(path, overwrite=True, compression=compression)


def long_bus(path: Path, seconds: float) -> Path:
    """The frames of the run again and again."""
    import can

    one = made.messages()
    with can.Logger(path) if path.suffix != ".mf4" else can.MF4Writer(path) as log:
        for turn in range(max(1, round(seconds / 9))):
            for message in one:
                moved = can.Message(
                    timestamp=1.7e9 + message.timestamp + 9.0 * turn,
                    arbitration_id=message.arbitration_id,
                    is_extended_id=message.is_extended_id,
                    is_fd=message.is_fd,
                    data=message.data,
                    channel=0,
                )
                log.on_message_received(moved)
    return path


def main(seconds: float) -> None:
    """Write the files, read them both ways, print the ratios."""
    names = list(made.CHANNELS.values())
    print(
        f"{'file':<12}{'MiB':>7}{'bare':>9}{'ours':>9}{'ratio':>7}{'bare':>9}{'ours':>9}{'ratio':>7}"
    )
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        made.write_dbc(folder)
        made.write_map(folder)
        plain = {"map": "plain.toml"}
        for path, bare, chart in (
            (long_mdf(folder / "plain.mf4", 10 * seconds, 0), BARE_MDF, plain),
            (folder / "plain.mf4", BARE_MDF_CLOCK, plain),
            (long_mdf(folder / "packed.mf4", 10 * seconds, 2), BARE_MDF, plain),
            (folder / "packed.mf4", BARE_MDF_CLOCK, plain),
            (long_bus(folder / "bus.mf4", seconds / 3), BARE_MDF_BUS, {"map": "map.toml"}),
            (long_bus(folder / "bus.blf", seconds), BARE_BUS, {"map": "map.toml"}),
            (long_bus(folder / "bus.asc", seconds), BARE_BUS, {"map": "map.toml"}),
            (long_bus(folder / "bus.log", seconds), BARE_BUS, {"map": "map.toml"}),
        ):
            theirs = measured(bare.format(names=names), path)
            ours = measured(OURS.format(**chart), path)
            print(
                f"{path.name:<12}{path.stat().st_size / 2**20:>7.1f}"
                f"{theirs[0]:>8.2f}s{ours[0]:>8.2f}s{ours[0] / theirs[0]:>7.2f}"
                f"{theirs[1]:>6.0f}MiB{ours[1]:>6.0f}MiB{ours[1] / max(theirs[1], 1e-3):>7.2f}",
                flush=True,
            )


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 180.0)
