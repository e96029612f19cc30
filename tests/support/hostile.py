"""Files made to break a reader, each with the command that reads it and the exit code it ends with.

A case makes its files in an empty folder and returns the words of the command, which runs there.
Large ones are made by holes and by compression, so that they take no room on the disk.
"""

import json
import os
import shutil
import struct
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
SEDAN = ROOT / "sample_logs" / "sedan"
RAMP = SEDAN / "ramp_wet_asphalt.csv"
CAR = SEDAN / "vehicle.toml"
TABLE = "sedan-2up@2"

OSC, CSI, C1, BIDI = "\x1b]0;owned\x07", "\x1b[2J", "\x9b31m", "\u202e"
TERMINAL = f"x{OSC}{CSI}{C1}{BIDI}"
"""A name with everything that moves a terminal."""

Words = list[str]


@dataclass(frozen=True)
class Case:
    """``make`` writes the files into a folder and returns the command; ``code`` is its exit code.

    ``large`` cases are for the study alone: they take seconds.
    """

    name: str
    code: int
    make: Callable[[Path], Words]
    large: bool = False


COMMANDS = {
    "check": f"check {RAMP} --map",
    "fit": f"fit {RAMP} --store new --vehicle",
    "limits": f"validate sedan-2up {RAMP} --store {ROOT / 'tables'} --limits",
    "model": f"simulate {RAMP} --vehicle {CAR} --out o.csv --model",
    "effect": f"fit {RAMP} --store new --vehicle {CAR} --effect",
    "plan": f"repeatability --vehicle {CAR} --plan",
    "key": f"tables verify --store {ROOT / 'tables'} --key",
    "import": "tables compare",
    "validation": f"tables export {TABLE} --format dcm --out o.dcm --store {ROOT / 'tables'} "
    "--unreleased --validation",
    "log": "check",
    "map": "map",
}
"""Commands by the kind of file that is their last word."""


def words(kind: str, file: str) -> Words:
    return [*COMMANDS[kind].split(), file]


def toml_case(name: str, text: str | bytes) -> list[Case]:
    """One text as each kind of TOML file that a command reads."""
    data = text.encode() if isinstance(text, str) else text
    kinds = ("fit", "check", "limits", "model")
    return [bytes_case(f"{name} for {kind}", kind, "bad.toml", data) for kind in kinds]


def car_with(name: str, line: str) -> Case:
    """A vehicle whose mass is this value."""
    text = [line if row.startswith("mass =") else row for row in CAR.read_text().splitlines()]
    return bytes_case(name, "fit", "car.toml", ("\n".join(text) + "\n").encode())


def encoding(name: str) -> Case:
    """A channel map with this encoding."""
    text = f"schema = 1\n[text]\nencoding = {json.dumps(name)}\n"
    return bytes_case(f"encoding {name[:20]!r}", "check", "map.toml", text.encode())


def store(name: str, code: int, spoil: Callable[[Path], None], command: str) -> Case:
    """A command on a copy of the repository's store that ``spoil`` has spoilt."""

    def make(folder: Path) -> Words:
        shutil.copytree(ROOT / "tables", folder / "tables")
        spoil(folder / "tables")
        return [*command.split(), "--store", "tables"]

    return Case(name, code, make)


def replaced(path: str, data: bytes) -> Callable[[Path], None]:
    def spoil(tables: Path) -> None:
        (tables / path).write_bytes(data)

    return spoil


def pipe(path: str) -> Callable[[Path], None]:
    def spoil(tables: Path) -> None:
        (tables / path).unlink(missing_ok=True)
        os.mkfifo(tables / path)

    return spoil


def bytes_case(
    name: str,
    kind: str,
    file: str,
    data: bytes | Callable[[], bytes],
    code: int = 3,
    large: bool = False,
) -> Case:
    """A file of these bytes."""

    def make(folder: Path) -> Words:
        (folder / file).write_bytes(data if isinstance(data, bytes) else data())
        return words(kind, file)

    return Case(name, code, make, large)


def linked(name: str, kind: str, file: str, target: str) -> Case:
    """A link; to itself it is a loop."""

    def make(folder: Path) -> Words:
        (folder / file).symlink_to(target)
        return words(kind, file)

    return Case(name, 3, make)


def fifo(kind: str, file: str) -> Case:
    """A named pipe."""

    def make(folder: Path) -> Words:
        os.mkfifo(folder / file)
        return words(kind, file)

    return Case(f"pipe {file} for {kind}", 3, make)


def holes(kind: str, file: str, head: bytes = b"") -> Case:
    """A file of 3 GB of zeros that takes no room."""

    def make(folder: Path) -> Words:
        with (folder / file).open("wb") as made:
            made.write(head)
            made.truncate(3_000_000_000)
        return words(kind, file)

    return Case(f"3 GB of zeros in {file}", 3, make, large=True)


def bomb(line: bytes, size: int = 1_500_000_000) -> bytes:
    """A gzip file that unpacks to ``size`` bytes of the ramp's header and one line again."""
    pack = zlib.compressobj(1, wbits=31)
    block = line * (10_000_000 // len(line))
    head = RAMP.read_bytes().splitlines(keepends=True)[0]
    parts = [pack.compress(head)]
    parts += [pack.compress(block) for _ in range(size // len(block))]
    return b"".join([*parts, pack.flush()])


def row() -> bytes:
    return RAMP.read_bytes().splitlines(keepends=True)[1]


def parquet_bomb() -> bytes:
    """A Parquet file of 400 million equal values in a few kilobytes."""
    import io

    import pyarrow as pa
    import pyarrow.parquet as pq

    sink, names = io.BytesIO(), RAMP.read_text().splitlines()[0].split(",")
    part = pa.table({name: pa.array([1.0]).take(pa.array([0] * 1_000_000)) for name in names})
    with pq.ParquetWriter(sink, part.schema, compression="zstd") as writer:
        for _ in range(400):
            writer.write_table(part)
    return sink.getvalue()


def blf_bomb() -> bytes:
    """A BLF file with one container that unpacks to 2 GB."""
    pack, block = zlib.compressobj(1), bytes(10_000_000)
    packed = b"".join([*(pack.compress(block) for _ in range(200)), pack.flush()])
    body = struct.pack("<HHLLL", 2, 0, 0, 2_000_000_000, 0) + packed
    container = struct.pack("<4sHHLL", b"LOBJ", 16, 1, 16 + len(body), 10) + body
    size = 144 + len(container)
    head = struct.pack("<4sL8xQQL", b"LOGG", 144, size, 2_000_000_000, 9).ljust(144, b"\0")
    return head + container


def mdf_version(written: bytes) -> bytes:
    """The first block of an MDF file with this version."""
    return b"MDF     " + written.ljust(8)[:8] + bytes(48)


def header(cell: str) -> bytes:
    """The ramp with one more column of this head."""
    first, *rows = RAMP.read_text().splitlines()
    return "\n".join([f'{first},"{cell}"', *(f"{line},0.5" for line in rows), ""]).encode()


def bus_map(folder: Path) -> None:
    (folder / "map.toml").write_text('schema = 1\ndbc = "a.dbc"\n[channels.v]\nsource = "V"\n')
    (folder / "a.dbc").write_text(
        'VERSION ""\nBU_: E\nBO_ 256 M: 8 E\n SG_ V : 0|8@1+ (1,0) [0|1] "km/h" E\n'
    )


def on_bus(file: str, data: bytes | Callable[[], bytes]) -> Callable[[Path], Words]:
    def make(folder: Path) -> Words:
        bus_map(folder)
        (folder / file).write_bytes(data if isinstance(data, bytes) else data())
        return ["check", file, "--map", "map.toml"]

    return make


def described_by(file: str, data: bytes) -> Callable[[Path], Words]:
    """A log of a bus whose map names ``file`` as what describes it."""

    def make(folder: Path) -> Words:
        (folder / "map.toml").write_text(f'schema = 1\ndbc = "{file}"\n')
        (folder / file).write_bytes(data)
        (folder / "a.log").write_text("(1.0) can0 100#00\n")
        return ["check", "a.log", "--map", "map.toml"]

    return make


def long_name(folder: Path) -> Words:
    return ["check", f"{'a' * 300}.csv"]


def dbc_pipe(folder: Path) -> Words:
    bus_map(folder)
    (folder / "a.dbc").unlink()
    os.mkfifo(folder / "a.dbc")
    (folder / "a.log").write_text("(1.0) can0 100#00\n")
    return ["check", "a.log", "--map", "map.toml"]


def ramp_named(name: str) -> Callable[[Path], Words]:
    def make(folder: Path) -> Words:
        shutil.copy(RAMP, folder / name)
        return ["check", name]

    return make


SYM_TEXT = b'FormatVersion=6.0\nTitle="' + b"a" * 4_000_000 + b'"\n'
DBC_TEXT = b'VERSION ""\nBU_: E\nCM_ "' + b"a" * 4_000_000 + b'";\n'
DBC_SIGNALS = b'VERSION ""\nBU_: E\nBO_ 256 M: 64 E\n' + b"".join(
    b' SG_ V%d m%d : 8|8@1+ (1,0) [0|1] "" E\n' % (i, i) for i in range(100_000)
)
ENTITIES = b"<!DOCTYPE MSRSW [<!ENTITY a '" + b"z" * 100_000 + b"'>]><MSRSW>" + b"&a;" * 9_000
RECORD = "sedan-2up/v0001/record.json"
DEEP = b"[" * 100_000
ENCODINGS = ("hex", "rot13", "zlib", "undefined", "punycode", "utf-8\0", "idna", "base64", "bz2")
XML = b'<?xml version="1.0" encoding="%s"?><MSRSW/>'
SCALE = b'schema = 1\n[channels.v]\nsource = "v"\nscale = ' + b"1" * 400

CASES: list[Case] = [
    *toml_case("TOML nested 20,000 deep", "x = " + "[" * 20_000),
    *toml_case("TOML tables nested 20,000 deep", "x = " + "{a = " * 20_000),
    *toml_case("TOML key of 20,000 parts", ".".join(["a"] * 20_000) + " = 1"),
    *toml_case("TOML header of 20,000 parts", f"[{'.'.join(['a'] * 20_000)}]"),
    *toml_case("TOML integer of 5,000 digits", "schema = " + "1" * 5_000),
    *toml_case("TOML integer of 400 digits", "schema = " + "1" * 400),
    *toml_case("TOML with a nul", b"schema = 1\0\n"),
    bytes_case("TOML key of 900,000 letters", "check", "m.toml",
               b"schema = 1\nignore = []\n" + b"a" * 900_000 + b" = 1\n"),
    car_with("mass of 400 digits", "mass = " + "1" * 400),
    car_with("mass of 400 digits in text", f'mass = "{"1" * 400} kg"'),
    car_with("mass with 200,000 blanks", f'mass = "1{" " * 200_000}x kg"'),
    car_with("mass of 5,000 digits", "mass = " + "1" * 5_000),
    bytes_case("scale of 400 digits", "check", "m.toml", SCALE),
    *map(encoding, (*ENCODINGS, "unicode_escape", "a" * 500)),
    store("record of 100,000 [, list", 0, replaced(RECORD, DEEP), "tables list"),
    store("record of 100,000 [, show", 4, replaced(RECORD, DEEP), "tables show sedan-2up@1"),
    store("record of 100,000 [, verify", 4, replaced(RECORD, DEEP), "tables verify"),
    store("record with a number of 5,000 digits", 0,
          replaced(RECORD, b'{"version": ' + b"1" * 5000 + b"}"), "tables list"),
    store("journal of 100,000 [", 4, replaced("journal.jsonl", DEEP + b"\n"), "tables list"),
    store("head with 5,000 digits", 4,
          replaced("journal.head", b"0" * 64 + b" " + b"1" * 5000 + b"\n"), "tables list"),
    *(
        store(f"pipe as {name}, list", code, pipe(name), "tables list")
        for name, code in (
            (RECORD, 0),
            ("sedan-2up/v0001/tyre.parquet", 0),
            ("journal.jsonl", 4),
            ("journal.head", 4),
            ("sedan-2up/v0001.minisig", 0),
            ("sedan-2up/v0001.AB.minisig", 0),
        )
    ),
    *(
        bytes_case(f"CDF with encoding {name}", "import", "in.dcm", XML % name.encode())
        for name in ("UTF-0", "hex", "utf-7")
    ),
    bytes_case("CDF with entities of 900 MB", "import", "in.dcm", ENTITIES + b"</MSRSW>"),
    bytes_case("CDF nested 100,000 deep", "import", "in.dcm", b"<MSRSW>" + b"<a>" * 100_000),
    linked("link to /dev/zero, import", "import", "in.dcm", "/dev/zero"),
    linked("link to /dev/zero, log", "log", "zero.csv", "/dev/zero"),
    linked("link to /dev/zero, validation", "validation", "zero.json", "/dev/zero"),
    linked("loop of links as DCM", "import", "in.dcm", "in.dcm"),
    linked("loop of links as log", "log", "loop.csv", "loop.csv"),
    linked("loop of links as limits", "limits", "loop.toml", "loop.toml"),
    linked("loop of links as map", "check", "loop.toml", "loop.toml"),
    *map(fifo, ("import", "validation", "log", "log", "plan", "effect", "key"),
         ("in.dcm", "v.json", "p.csv", "p.mf4", "p.csv", "p.py", "k.pub")),
    Case("pipe, DBC", 3, dbc_pipe),
    Case("log name of 304 bytes", 3, long_name),
    bytes_case("MDF version that is no text", "log", "a.mf4", mdf_version(b"4\xff10")),
    bytes_case("plan with a long cell", "plan", "p.csv", b"log,car\n" + b"a" * 200_000 + b",b\n"),
    bytes_case("plan with a nul", "plan", "p.csv", b"log,car\na\0b,b\n"),
    bytes_case("effect nested 100,000 deep", "effect", "e.py", b"(" * 100_000),
    bytes_case("effect of 100,000 minus signs", "effect", "e.py", b"x=" + b"-" * 100_000 + b"1"),
    *(
        Case(f"{kind} with {what}", 3, described_by(f"a.{kind}", data))
        for kind in ("kcd", "arxml")
        for what, data in (
            ("entities of 900 MB", ENTITIES + b"</MSRSW>"),
            ("100,000 levels", b"<a>" * 100_000 + b"</a>" * 100_000),
        )
    ),
    Case("SYM with a text of 4 MB", 3, described_by("a.sym", SYM_TEXT)),
    Case("DBC with a text of 4 MB", 3, described_by("a.dbc", DBC_TEXT)),
    Case("DBC of 100,000 signals", 3, described_by("a.dbc", DBC_SIGNALS), large=True),
    Case("DBC of another grammar", 3, on_bus("a.dbc", b"BO_ 1 \n\nx\r\ny")),
    bytes_case("controls in a header", "log", "a.csv", header(f"{TERMINAL} [bar]"), 0),
    bytes_case("header of 100,000 blanks", "log", "r.csv", header(f"x{chr(9) * 100_000}y"), 0),
    bytes_case("header of 30,000 brackets", "log", "r.csv", header("x (" * 30_000), 0),
    bytes_case("controls in a unit", "log", "a.csv", header(f"y [{TERMINAL}]"), 0),
    bytes_case("controls in a header, map", "map", "a.csv", header(f"{TERMINAL} [bar]"), 0),
    Case("controls in a file name", 0, ramp_named(f"{TERMINAL}.csv".replace("/", ""))),
    Case("byte in a file name that is not UTF-8", 0, ramp_named(os.fsdecode(b"r\xfc.csv"))),
    bytes_case("controls in a map", "check", "m.toml",
               b'schema = 1\n[channels.v]\nsource = "\\u001b[2J\\u202e"\n'),
    bytes_case("key with controls in a map", "check", "m.toml",
               'schema = 1\n"\\u001b[2J\u202e" = 1\n'.encode()),
    *(
        bytes_case(f"gzip bomb of 1.5 GB of {what}", "log", file, made, large=True)
        for what, file, made in (
            ("lines", "a.csv.gz", lambda: bomb(row())),
            ("zeros", "a.csv.gz", lambda: bomb(b"\0" * 100)),
            ("line ends", "a.csv.gz", lambda: bomb(b"\n")),
            ("lines, cut off", "a.csv.gz", lambda: bomb(row())[:-9]),
            ("line ends, as VBO", "a.vbo.gz", lambda: bomb(b"\n")),
        )
    ),
    bytes_case("Parquet of 3.2 GB a column", "log", "a.parquet", parquet_bomb, large=True),
    Case("BLF container of 2 GB", 3, on_bus("a.blf", blf_bomb), large=True),
    holes("log", "a.csv"),
    holes("log", "a.parquet"),
    holes("log", "a.mf4", mdf_version(b"4.10")),
    *map(holes, ("check", "import", "validation", "plan", "effect"),
         ("a.toml", "in.dcm", "v.json", "p.csv", "e.py")),
]  # fmt: skip
