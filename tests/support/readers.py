"""Every reader of bytes, with good files of its kind."""

import gzip
import io
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

import can
import numpy as np
import pyarrow.csv as pc
import pyarrow.parquet as pq
from asammdf import MDF, Signal

from calib.base.settings_file import read_settings
from calib.car.model import default_model
from calib.car.model_file import read_model, write_model
from calib.car.vehicle_file import read_vehicle
from calib.estimation.limits_file import read_limits
from calib.estimation.metrics import METRICS
from calib.exports.export import export
from calib.exports.read import read_back
from calib.line.gauge.plan import read_plan
from calib.logs.bus.dbc import read_databases
from calib.logs.channel_map import ChannelMap
from calib.logs.channel_map_file import read_channel_map
from calib.logs.formats import as_table
from calib.logs.read import open_log, read_log
from calib.show.result import read_result
from calib.store.evidence import read_evidence
from calib.store.minisign import read_public_key, read_secret_key, read_signature, verify
from calib.store.store import Store
from calib.store.version import Stored, read_version
from tests.support.databases import DATABASES
from tests.support.recordings import DBC, messages
from tests.support.signing import ADA, secret_file
from tests.support.trc import HEADS, trc

ROOT = Path(__file__).parents[2]
SEDAN = ROOT / "sample_logs" / "sedan"
VERSION = ROOT / "tables" / "sedan-2up" / "v0002"
NAME_OF_TABLE = "sedan-2up@2"
CAR = SEDAN / "vehicle.toml"

Seeds = Callable[[], list[bytes]]


@dataclass(frozen=True)
class Reader:
    """``read`` opens a file of the name ``file``; ``seeds`` makes good files."""

    file: str
    read: Callable[[Path], object]
    seeds: Seeds


def of_file(*paths: Path) -> Seeds:
    return lambda: [path.read_bytes() for path in paths]


def short_csv(rows: int = 60) -> bytes:
    lines = (SEDAN / "ramp_wet_asphalt.csv").read_bytes().splitlines(keepends=True)
    return b"".join(lines[: rows + 1])


def csvs() -> list[bytes]:
    text = short_csv().decode()
    german = text.replace(",", ";").replace(".", ",")
    units = text.replace(" [", "_").replace("]", "")
    return [text.encode(), german.encode("latin-1"), text.encode("utf-16"), units.encode()]


def vbos() -> list[bytes]:
    rows = (f"8 1622{35 + i / 100:05.2f} {50 - i / 10:.3f} {i / 8:+.6E}\r\n" for i in range(60))
    head = "[header]\r\nsatellites\r\ntime\r\nvelocity kmh\r\nBrake Pressure\r\n\r\n"
    names = "[column names]\r\nsats time velocity Brake_Pressure\r\n\r\n[data]\r\n"
    return [f"File created on 31/07/2006\r\n\r\n{head}{names}{''.join(rows)}".encode()]


def parquets() -> list[bytes]:
    sink = io.BytesIO()
    pq.write_table(pc.read_csv(io.BytesIO(short_csv())), sink)
    return [sink.getvalue(), (VERSION / "tyre.parquet").read_bytes()]


def signals_of_a_bus(path: Path) -> object:
    """Every signal; the older versions of TRC lack CAN FD, so not all channels are there."""
    dbc = path.with_name("chassis.dbc")
    dbc.write_text(DBC)
    with open_log(path, ChannelMap("a", {}, databases={"": (dbc,)})) as opened:
        table = as_table(opened.source, str(path))
    return table.read(range(len(table.columns)))


def recorded(ending: str) -> Seeds:
    """The first frames of the run on a bus, by python-can."""

    def make() -> list[bytes]:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"a{ending}"
            with can.Logger(path) as log:
                for message in messages()[:200]:
                    log.on_message_received(message)  # type: ignore[arg-type]
            return [path.read_bytes()]

    return make


def candumps() -> list[bytes]:
    """The first frames of the run but one, so that its middle is not the end of a line."""
    return [run.split(b"\n", 1)[1] for run in recorded(".log")()]


def mdfs() -> list[bytes]:
    values = []
    with tempfile.TemporaryDirectory() as folder:
        for version, compression in (("4.10", 0), ("4.10", 2), ("3.30", 0)):
            time = np.arange(60) / 200.0
            with MDF(version=version) as mdf:
                mdf.append([Signal(time * 3, time, name="v", unit="m/s")])
                mdf.append([Signal(time * 2, time, name="p_mc", unit="bar")])
                saved = mdf.save(Path(folder) / "a.mf4", overwrite=True, compression=compression)
            values.append(Path(saved).read_bytes())
    return values


def maps() -> list[bytes]:
    text = 'schema = 1\nignore = ["a"]\n[text]\nseparator = ";"\nencoding = "latin-1"\n'
    return [f'{text}[channels.p_mc]\nsource = "P"\nunit = "kPa"\nsign = -1\nscale = 2.0\n'.encode()]


def models() -> list[bytes]:
    with tempfile.TemporaryDirectory() as folder:
        write_model(default_model(read_vehicle(CAR)), Path(folder) / "m.toml")
        return [(Path(folder) / "m.toml").read_bytes()]


@cache
def stored() -> Stored:
    return Store(ROOT / "tables").load(NAME_OF_TABLE)


def exported(form: str) -> Seeds:
    def make() -> list[bytes]:
        with tempfile.TemporaryDirectory() as folder:
            export(stored(), Path(folder) / form, form, points=8, unreleased=True)
            return [(Path(folder) / form).read_bytes()]

    return make


def read_a_record(path: Path) -> object:
    for name in (part.name for part in VERSION.glob("*.parquet")):
        link = path.with_name(name)
        if not link.exists():
            link.symlink_to(VERSION / link.name)
    return read_version(path.parent)


def of_store(missing: str) -> Callable[[Path], object]:
    """What the store is now, by a file and the sound other one."""

    def read(path: Path) -> object:
        if not path.with_name(missing).exists():
            path.with_name(missing).symlink_to(ROOT / "tables" / missing)
        return Store(path.parent).snapshot()

    return read


def summaries() -> list[bytes]:
    logs = '[{"log": "a", "role": "hold-out", "verdict": "passed"}]'
    fields = f'"table": "{NAME_OF_TABLE}", "digest": "{stored().digest}", "proof": "truth"'
    return [f'{{"schema": 1, {fields}, "verdict": "passed", "logs": {logs}}}'.encode()]


def read_a_database(path: Path) -> object:
    return read_databases({"": (path,)}, "can", "a.blf")


READ_LOG = partial(read_log, require=())
READERS = {
    "csv": Reader("a.csv", READ_LOG, csvs),
    "csv.gz": Reader("a.csv.gz", READ_LOG, lambda: [gzip.compress(short_csv(), mtime=0)]),
    "vbo": Reader("a.vbo", READ_LOG, vbos),
    "parquet": Reader("a.parquet", READ_LOG, parquets),
    "mdf": Reader("a.mf4", READ_LOG, mdfs),
    "blf": Reader("a.blf", signals_of_a_bus, recorded(".blf")),
    "asc": Reader("a.asc", signals_of_a_bus, recorded(".asc")),
    "candump": Reader("a.log", signals_of_a_bus, candumps),
    "trc": Reader(
        "a.trc", signals_of_a_bus, lambda: [trc(v, messages()[:200]).encode() for v in HEADS]
    ),
    "dbc": Reader("a.dbc", read_a_database, lambda: [DBC.encode()]),
    **{
        kind: Reader(f"a.{kind}", read_a_database, lambda kind=kind: [DATABASES[kind].encode()])
        for kind in ("arxml", "kcd", "sym")
    },
    "map": Reader("a.toml", read_channel_map, maps),
    "vehicle": Reader("a.toml", read_vehicle, of_file(CAR)),
    "limits": Reader(
        "a.toml",
        partial(read_limits, metrics=set(METRICS)),
        of_file(ROOT / "sample_logs" / "limits.toml"),
    ),
    "model": Reader("a.toml", lambda path: read_model(path, read_vehicle(CAR)), models),
    "settings": Reader(
        "a.toml",
        read_settings,
        lambda: [b'schema = 1\nstore = "t"\nby = "A"\n[station]\nname = "e"\nexport = ["dcm"]\n'],
    ),
    "dcm": Reader("a.dcm", read_back, exported("dcm")),
    "cdfx": Reader("a.cdfx", read_back, exported("cdfx")),
    "record": Reader("record.json", read_a_record, of_file(VERSION / "record.json")),
    "journal": Reader(
        "journal.jsonl", of_store("journal.head"), of_file(ROOT / "tables" / "journal.jsonl")
    ),
    "head": Reader(
        "journal.head", of_store("journal.jsonl"), of_file(ROOT / "tables" / "journal.head")
    ),
    "summary": Reader("summary.json", lambda path: read_evidence(path, stored()), summaries),
    "plan": Reader("plan.csv", read_plan, lambda: [b"log,car,station\na.csv,1,x\nb.csv,2,x\n"]),
    "result": Reader("a.parquet", read_result, parquets),
    "public key": Reader("a.pub", read_public_key, lambda: [ADA.public.file]),
    "secret key": Reader(
        "a.key",
        lambda path: read_secret_key(path, lambda: ""),
        lambda: [secret_file(b"adasline", bytes(range(32)))],
    ),
    "signature": Reader(
        "a.minisig",
        lambda path: verify(ADA.public, b"content", read_signature(path), path),
        lambda: [ADA.sign(b"content", "table sedan")],
    ),
}
