"""Every reader of bytes, with good files to start from, and a mutator of files.

A reader may return or raise a BrakeCalError; whatever else it raises is a finding.
"""

import gzip
import io
import random
import struct
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path

from calib.base.errors import BrakeCalError

ROOT = Path(__file__).parents[2]
SEDAN = ROOT / "sample_logs" / "sedan"
VERSION = ROOT / "tables" / "sedan-2up" / "v0002"
NAME_OF_TABLE = "sedan-2up@2"

Seeds = Callable[[], list[bytes]]


@dataclass(frozen=True)
class Reader:
    """``read`` opens a file of the name ``file``; ``seeds`` makes good files."""

    file: str
    read: Callable[[Path], object]
    seeds: Seeds


def by(module: str, name: str, **how: object) -> Callable[[Path], object]:
    """The function of a module, which is imported when it is called: a guided study looks on."""
    return lambda path: getattr(import_module(module), name)(path, **how)


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
    import pyarrow.csv as pc
    import pyarrow.parquet as pq

    sink = io.BytesIO()
    pq.write_table(pc.read_csv(io.BytesIO(short_csv())), sink)
    return [sink.getvalue(), (VERSION / "tyre.parquet").read_bytes()]


def on_bus(path: Path) -> object:
    from calib.logs.channel_map import ChannelMap, DatabaseFile, Databases, Mapping
    from calib.logs.read import read_log
    from tests.support.recordings import CHANNELS

    mapped = {ours: Mapping(theirs) for ours, theirs in CHANNELS.items()}
    chart = ChannelMap(
        "map.toml", mapped, databases=Databases((DatabaseFile(_beside(path)),), sources=())
    )
    return read_log(path, chart, require=())


def signals_of_a_bus(path: Path) -> object:
    """Every signal; the older versions of TRC lack CAN FD, so not all channels are there."""
    from calib.logs.channel_map import ChannelMap, DatabaseFile, Databases
    from calib.logs.read import open_log

    chart = ChannelMap("map.toml", {}, databases=Databases((DatabaseFile(_beside(path)),)))
    opened = open_log(path, chart).source
    return opened.read(range(len(opened.columns)))


def _beside(path: Path) -> Path:
    """The DBC of the bus, beside a log."""
    dbc = path.with_name("chassis.dbc")
    if not dbc.exists():
        dbc.write_text(_dbc() + LONG)
    return dbc


LONG = """
BO_ 2566843646 VI: 8 ESP
 SG_ Last : 56|8@1+ (1,0) [0|255] "" ESP
"""
"""A J1939 message."""


def _dbc() -> str:
    from tests.support.recordings import DBC

    return DBC


def recorded(ending: str) -> Seeds:
    """The first frames of the run on a bus, by python-can."""

    def make() -> list[bytes]:
        import can

        from tests.support.recordings import messages

        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"a{ending}"
            with can.Logger(path) as log:
                for message in messages()[:200]:
                    log.on_message_received(message)  # type: ignore[arg-type]
            return [path.read_bytes()]

    return make


def candumps() -> list[bytes]:
    """The first frames of the run, and a J1939 frame after them."""
    (run,) = recorded(".log")()
    last = float(run.split()[-4].strip(b"()"))
    return [run + f"({last + 0.05:.6f}) can0 18FEEC0B#5756575A5A5A314A R\n".encode()]


def trcs() -> list[bytes]:
    from tests.support.recordings import messages
    from tests.support.trc import HEADS, trc

    return [trc(version, messages()[:200]).encode() for version in HEADS]


def mdfs() -> list[bytes]:
    import numpy as np
    from asammdf import MDF, Signal

    found = []
    with tempfile.TemporaryDirectory() as folder:
        for version, compression in (("4.10", 0), ("4.10", 2), ("3.30", 0)):
            time = np.arange(60) / 200.0
            with MDF(version=version) as mdf:
                mdf.append([Signal(time * 3, time, name="v", unit="m/s")])
                mdf.append([Signal(time * 2, time, name="p_mc", unit="bar")])
                saved = mdf.save(Path(folder) / "a.mf4", overwrite=True, compression=compression)
            found.append(Path(saved).read_bytes())
    return found


def read_a_dbc(path: Path) -> object:
    from calib.logs.bus.dbc import read_dbc
    from calib.logs.channel_map import DatabaseFile

    return read_dbc([DatabaseFile(path)], "can", "a.blf")


def described(kind: str) -> Seeds:
    """A file of this kind that describes a bus."""

    def make() -> list[bytes]:
        from tests.support.databases import DATABASES

        return [DATABASES[kind].encode()]

    return make


def maps() -> list[bytes]:
    text = 'schema = 1\nignore = ["a"]\n[text]\nseparator = ";"\nencoding = "latin-1"\n'
    return [f'{text}[channels.p_mc]\nsource = "P"\nunit = "kPa"\nsign = -1\nscale = 2.0\n'.encode()]


def read_some_limits(path: Path) -> object:
    from calib.estimation.limits_file import read_limits
    from calib.estimation.metrics import METRICS

    return read_limits(path, set(METRICS))


def read_a_model(path: Path) -> object:
    from calib.car.model_file import read_model
    from calib.car.vehicle_file import read_vehicle

    return read_model(path, read_vehicle(SEDAN / "vehicle.toml"))


def models() -> list[bytes]:
    from calib.car.model import default_model
    from calib.car.model_file import write_model
    from calib.car.vehicle_file import read_vehicle

    with tempfile.TemporaryDirectory() as folder:
        write_model(default_model(read_vehicle(SEDAN / "vehicle.toml")), Path(folder) / "m.toml")
        return [(Path(folder) / "m.toml").read_bytes()]


def settings() -> list[bytes]:
    return [b'schema = 1\nstore = "t"\nby = "A"\n[station]\nname = "e"\nexport = ["dcm"]\n']


@cache
def _exports() -> tuple[bytes, bytes]:
    from calib.exports.export import export
    from calib.store.store import Store

    stored = Store(ROOT / "tables").load(NAME_OF_TABLE)
    made = []
    with tempfile.TemporaryDirectory() as folder:
        for form in ("dcm", "cdfx"):
            path = Path(folder) / form
            export(stored, path, form, points=8, unreleased=True)
            made.append(path.read_bytes())
    return made[0], made[1]


def read_a_record(path: Path) -> object:
    from calib.store.version import read_version

    for name in ("difference", "paper", "tyre"):
        link = path.with_name(f"{name}.parquet")
        if not link.exists():
            link.symlink_to(VERSION / link.name)
    return read_version(path.parent)


def of_store(missing: str) -> Callable[[Path], object]:
    """What the store is now, by a file and the sound other one."""

    def read(path: Path) -> object:
        from calib.store.store import Store

        if not path.with_name(missing).exists():
            path.with_name(missing).symlink_to(ROOT / "tables" / missing)
        return Store(path.parent).now()

    return read


def read_a_summary(path: Path) -> object:
    from calib.store.evidence import read_evidence

    return read_evidence(path, _stored())


@cache
def _stored():  # type: ignore[no-untyped-def]
    from calib.store.store import Store

    return Store(ROOT / "tables").load(NAME_OF_TABLE)


def summaries() -> list[bytes]:
    logs = '[{"log": "a", "role": "hold-out", "verdict": "passed"}]'
    text = f'{{"schema": 1, "table": "{NAME_OF_TABLE}", "verdict": "passed", "logs": {logs}}}'
    return [text.encode()]


def read_a_secret(path: Path) -> object:
    from calib.store.minisign import read_secret_key

    return read_secret_key(path, lambda: "")


def read_a_signature(path: Path) -> object:
    from calib.store.minisign import read_signature, verify
    from tests.support.signing import ADA

    return verify(ADA.public, b"content", read_signature(path), path)


def public() -> list[bytes]:
    from tests.support.signing import ADA

    return [ADA.public.file]


def secrets() -> list[bytes]:
    from tests.support.signing import secret_file

    return [secret_file(b"adasline", bytes(range(32)))]


def signatures() -> list[bytes]:
    from tests.support.signing import ADA

    return [ADA.sign(b"content", "table sedan")]


READ_LOG = by("calib.logs.read", "read_log", require=())
READ_BACK = by("calib.exports.read", "read_back")
READERS = {
    "csv": Reader("a.csv", READ_LOG, csvs),
    "csv.gz": Reader("a.csv.gz", READ_LOG, lambda: [gzip.compress(short_csv(), mtime=0)]),
    "vbo": Reader("a.vbo", READ_LOG, vbos),
    "parquet": Reader("a.parquet", READ_LOG, parquets),
    "mdf": Reader("a.mf4", READ_LOG, mdfs),
    "blf": Reader("a.blf", on_bus, recorded(".blf")),
    "asc": Reader("a.asc", on_bus, recorded(".asc")),
    "candump": Reader("a.log", on_bus, candumps),
    "trc": Reader("a.trc", signals_of_a_bus, trcs),
    "dbc": Reader("a.dbc", read_a_dbc, lambda: [_dbc().encode()]),
    "arxml": Reader("a.arxml", read_a_dbc, described("arxml")),
    "kcd": Reader("a.kcd", read_a_dbc, described("kcd")),
    "sym": Reader("a.sym", read_a_dbc, described("sym")),
    "map": Reader("a.toml", by("calib.logs.channel_map_file", "read_channel_map"), maps),
    "vehicle": Reader(
        "a.toml", by("calib.car.vehicle_file", "read_vehicle"), of_file(SEDAN / "vehicle.toml")
    ),
    "limits": Reader("a.toml", read_some_limits, of_file(ROOT / "sample_logs" / "limits.toml")),
    "model": Reader("a.toml", read_a_model, models),
    "settings": Reader("a.toml", by("calib.base.settings_file", "read_settings"), settings),
    "dcm": Reader("a.dcm", READ_BACK, lambda: [_exports()[0]]),
    "cdfx": Reader("a.cdfx", READ_BACK, lambda: [_exports()[1]]),
    "record": Reader("record.json", read_a_record, of_file(VERSION / "record.json")),
    "journal": Reader(
        "journal.jsonl", of_store("journal.head"), of_file(ROOT / "tables" / "journal.jsonl")
    ),
    "head": Reader(
        "journal.head", of_store("journal.jsonl"), of_file(ROOT / "tables" / "journal.head")
    ),
    "summary": Reader("summary.json", read_a_summary, summaries),
    "plan": Reader(
        "plan.csv",
        by("calib.line.gauge.plan", "read_plan"),
        lambda: [b"log,car,station\na.csv,1,x\nb.csv,2,x\n"],
    ),
    "result": Reader("a.parquet", by("calib.show.result", "read_result"), parquets),
    "public key": Reader("a.pub", by("calib.store.minisign", "read_public_key"), public),
    "secret key": Reader("a.key", read_a_secret, secrets),
    "signature": Reader("a.minisig", read_a_signature, signatures),
}


def finding(reader: Reader, folder: Path, data: bytes) -> Exception | None:
    """What a reader raises on these bytes beside the errors of the program; None if nothing."""
    path = folder / reader.file
    path.write_bytes(data)
    try:
        reader.read(path)
    except BrakeCalError:
        return None
    except (Exception, RecursionError) as error:
        return error
    return None


WORDS = (
    b"\0", b"\xff" * 4, b"\n", b'"', b"nan", b"inf", b"-1", b"1e999", b"9" * 400, b"[" * 400,
    b"{", b"\x1b[2J", b"\xe2\x80\xae", b"\xef\xbb\xbf", b";", b",", b"=", b"&a;", b"\\u0000",
)  # fmt: skip
NUMBERS = (0, 1, 0x7F, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0xFFFFFFFF, 0x7FFFFFFFFFFFFFFF, 2**64 - 1)


def mutated(seeds: list[bytes], chance: random.Random) -> bytes:
    """A seed with one to six changes: bits, bytes, words, numbers, parts cut, moved, doubled."""
    data = bytearray(chance.choice(seeds))
    for _ in range(chance.randint(1, 6)):
        at = chance.randrange(len(data) + 1)
        end = min(len(data), at + int(chance.paretovariate(0.7)))
        match chance.randrange(8):
            case 0 if at < len(data):
                data[at] ^= 1 << chance.randrange(8)
            case 1 if at < len(data):
                data[at] = chance.randrange(256)
            case 2:
                del data[at:end]
            case 3:
                data[at:at] = data[at:end]
            case 4:
                data[at:at] = chance.choice(WORDS)
            case 5:
                word = chance.choice(WORDS)
                data[at : at + len(word)] = word
            case 6:
                kind = chance.choice("BHIQ")
                size = struct.calcsize(kind)
                number = chance.choice(NUMBERS) % 256**size
                data[at : at + size] = struct.pack(f"<{kind}", number)
            case 7 if chance.random() < 0.3:
                del data[at:]
    return bytes(data)
