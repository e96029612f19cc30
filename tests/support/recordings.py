"""Recordings of a known run as test benches write them, by the libraries that own the formats.

The run is the ramp of the sample car. Its wheels keep 200 Hz; pressure and reference speed come at
100 Hz; the acceleration every 10 ms give or take 2 ms.
"""

from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calib.base.units import from_si
from calib.logs.log import Log
from calib.logs.read import read_log
from tests.support.databases import DBC_HEAD

Array = NDArray[np.float64]

SEDAN = Path(__file__).parents[2] / "sample_logs" / "sedan"
RAMP = SEDAN / "ramp_wet_asphalt.csv"

DBC = f"""{DBC_HEAD}BO_ 256 WHEELS: 8 ESP
 SG_ WhlFL : 7|16@0+ (0.005,0) [0|327] "rad/s" ESP
 SG_ WhlFR : 23|16@0+ (0.005,0) [0|327] "rad/s" ESP
 SG_ WhlRL : 39|16@0+ (0.005,0) [0|327] "rad/s" ESP
 SG_ WhlRR : 55|16@0+ (0.005,0) [0|327] "rad/s" ESP

BO_ 2566844929 BRAKE: 8 ESP
 SG_ Page M : 0|2@1+ (1,0) [0|3] "" ESP
 SG_ PMc m1 : 4|16@1+ (1,-500) [0|65000] "kPa" ESP
 SG_ Steering m2 : 4|14@1- (0.1,0) [-800|800] "deg" ESP

BO_ 768 IMU: 24 ESP
 SG_ Ax : 68|20@1- (0.0001,0) [-50|50] "g" ESP
 SG_ VRef : 103|16@0+ (0.01,0) [0|600] "km/h" ESP

BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","StandardCAN_FD";
BA_DEF_DEF_ "VFrameFormat" "StandardCAN";
BA_ "VFrameFormat" BO_ 768 2;
"""
"""Big endian, little endian across bytes, signed, multiplexed, extended, and an FD frame."""

CHANNELS = {
    "omega_fl": "WhlFL",
    "omega_fr": "WhlFR",
    "omega_rl": "WhlRL",
    "omega_rr": "WhlRR",
    "p_mc": "PMc",
    "a_x": "Ax",
    "v": "VRef",
}
MAP = "schema = 1\n{dbc}" + "\n".join(
    f'[channels.{ours}]\nsource = "{theirs}"' for ours, theirs in CHANNELS.items()
)

UNITS = {"WhlFL": "rad/s", "WhlFR": "rad/s", "WhlRL": "rad/s", "WhlRR": "rad/s"} | {
    "PMc": "kPa",
    "Ax": "g",
    "VRef": "km/h",
}
SI = {"rad/s": "rad/s", "kPa": "Pa", "g": "m/s^2", "km/h": "m/s"}


@cache
def ramp() -> Log:
    """The run itself."""
    return read_log(RAMP)


@cache
def jittered() -> Array:
    """Every 10 ms, give or take 2 ms [s]."""
    time = ramp().time[::2]
    moved = time + np.random.default_rng(4).uniform(-0.002, 0.002, time.size)
    return np.clip(moved, time[0], time[-1])


def times() -> dict[str, Array]:
    """When each channel is sampled [s]."""
    run = ramp().time
    slow = {"PMc": run[::2], "VRef": run[1::2], "Ax": jittered()}
    return {name: slow.get(name, run) for name in CHANNELS.values()}


def written() -> dict[str, Array]:
    """Values of each channel at its `times`, in the unit of the recording."""
    log, clocks = ramp(), times()
    return {
        theirs: from_si(
            np.interp(clocks[theirs], log.time, log[ours]), UNITS[theirs], SI[UNITS[theirs]]
        )
        for ours, theirs in CHANNELS.items()
    }


def write_dbc(folder: Path) -> Path:
    """The DBC, and a channel map that names it. Returns the map."""
    (folder / "chassis.dbc").write_text(DBC)
    chart = folder / "map.toml"
    chart.write_text(MAP.format(dbc='dbc = "chassis.dbc"\n'))
    return chart


def write_map(folder: Path) -> Path:
    """A channel map without a DBC, for measured channels."""
    chart = folder / "plain.toml"
    chart.write_text(MAP.format(dbc=""))
    return chart


@cache
def messages(offset: float = 0.0) -> list["object"]:
    """The frames of the run in the order of their times, for the writers of python-can."""
    import can
    import cantools

    database = cantools.database.load_string(DBC, "dbc")
    clocks, values = times(), written()

    def frames(
        name: str, clock: Array, signals: Sequence[str], **more: float
    ) -> Iterator[can.Message]:
        message = database.get_message_by_name(name)
        columns = [np.interp(clock, clocks[s], values[s]) for s in signals]
        for t, *row in zip(clock, *columns, strict=True):
            data = message.encode({**dict(zip(signals, row, strict=True)), **more}, strict=False)
            yield can.Message(
                timestamp=offset + float(t),
                arbitration_id=message.frame_id,
                is_extended_id=message.is_extended_frame,
                is_fd=message.is_fd,
                data=data,
                channel=0,
            )

    steering = frames("BRAKE", clocks["PMc"] + 0.001, (), Page=2, Steering=1.5)
    run_frames = [
        *frames("WHEELS", clocks["WhlFL"], ("WhlFL", "WhlFR", "WhlRL", "WhlRR")),
        *frames("BRAKE", clocks["PMc"], ("PMc",), Page=1),
        *steering,
        *frames("IMU", clocks["Ax"], ("Ax", "VRef")),
    ]
    return sorted(run_frames, key=lambda m: m.timestamp)


def write_bus(path: Path, offset: float = 0.0) -> Path:
    """A log of the bus by python-can; its ending names the format."""
    import can

    with can.Logger(path) if path.suffix != ".mf4" else can.MF4Writer(path) as log:
        for message in messages(offset):
            log.on_message_received(message)
    return path


def write_mdf(path: Path, version: str = "4.10", compression: int = 0) -> Path:
    """A measurement by asammdf: one group for each raster."""
    from asammdf import MDF, Signal

    clocks, values = times(), written()
    groups = (["WhlFL", "WhlFR", "WhlRL", "WhlRR"], ["PMc"], ["VRef"], ["Ax"])
    with MDF(version=version) as mdf:
        for names in groups:
            signals = [Signal(values[n], clocks[n], name=n, unit=UNITS[n]) for n in names]
            mdf.append(signals, acq_name=names[0])
        saved = mdf.save(path.with_suffix(".mdf" if version < "4" else ".mf4"), overwrite=True,
                         compression=compression)  # fmt: skip
    return saved.rename(path)
