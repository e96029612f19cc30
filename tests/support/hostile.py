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


def toml_case(name: str, text: str | bytes, large: bool = False) -> list[Case]:
    """One text as each kind of TOML file that a command reads."""
    data = text.encode() if isinstance(text, str) else text

    def as_file(words: Words) -> Callable[[Path], Words]:
        def make(folder: Path) -> Words:
            (folder / "bad.toml").write_bytes(data)
            return words

        return make

    ramp = str(RAMP)
    uses = {
        "vehicle": ["fit", ramp, "--vehicle", "bad.toml", "--store", "new"],
        "map": ["check", ramp, "--map", "bad.toml"],
        "limits": [
            "validate",
            "sedan-2up",
            ramp,
            "--limits",
            "bad.toml",
            "--store",
            str(ROOT / "tables"),
        ],
        "model": ["simulate", ramp, "--vehicle", str(CAR), "--model", "bad.toml", "--out", "o.csv"],
    }
    return [Case(f"{name} as {kind}", 3, as_file(words), large) for kind, words in uses.items()]


def car_with(line: str) -> Callable[[Path], Words]:
    """A vehicle whose mass is this value."""

    def make(folder: Path) -> Words:
        text = CAR.read_text().splitlines()
        text = [line if row.startswith("mass =") else row for row in text]
        (folder / "car.toml").write_text("\n".join(text) + "\n")
        return ["fit", str(RAMP), "--vehicle", "car.toml", "--store", "new"]

    return make


def encoding(name: str) -> Case:
    """A channel map with this encoding."""

    def make(folder: Path) -> Words:
        (folder / "map.toml").write_text(f"schema = 1\n[text]\nencoding = {json.dumps(name)}\n")
        return ["check", str(RAMP), "--map", "map.toml"]

    return Case(f"encoding {name[:20]!r}", 3, make)


def store(spoil: Callable[[Path], None], words: Words) -> Callable[[Path], Words]:
    """A command on a copy of the repository's store that ``spoil`` has spoilt."""

    def make(folder: Path) -> Words:
        shutil.copytree(ROOT / "tables", folder / "tables")
        spoil(folder / "tables")
        return [*words, "--store", "tables"]

    return make


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
    file: str,
    data: bytes | Callable[[], bytes],
    words: Words,
    code: int = 3,
    large: bool = False,
) -> Case:
    """A file of these bytes."""

    def make(folder: Path) -> Words:
        (folder / file).write_bytes(data if isinstance(data, bytes) else data())
        return words

    return Case(name, code, make, large)


def linked(name: str, target: str, words: Words, code: int = 3) -> Case:
    """A link; to itself it is a loop."""

    def make(folder: Path) -> Words:
        (folder / words[-1]).symlink_to(target)
        return words

    return Case(name, code, make)


def fifo(name: str, words: Words, code: int = 3) -> Case:
    """A named pipe, in the place of the last word."""

    def make(folder: Path) -> Words:
        os.mkfifo(folder / words[-1])
        return words

    return Case(name, code, make)


def holes(name: str, file: str, size: int, words: Words, head: bytes = b"") -> Case:
    """A file of zeros that takes no room."""

    def make(folder: Path) -> Words:
        with (folder / file).open("wb") as made:
            made.write(head)
            made.truncate(size)
        return words

    return Case(name, 3, make, large=True)


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


def unit_of_source(folder: Path) -> Words:
    (folder / "a.csv").write_bytes(header(f"y [{TERMINAL}]"))
    return ["check", "a.csv"]


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
IMPORT = ["tables", "import", "in.dcm"]
EXPORT = [
    "tables",
    "export",
    TABLE,
    "--format",
    "dcm",
    "--out",
    "o.dcm",
    "--store",
    str(ROOT / "tables"),
    "--unreleased",
    "--validation",
]

CASES: list[Case] = [
    *toml_case("TOML nested 20,000 deep", "x = " + "[" * 20_000),
    *toml_case("TOML tables nested 20,000 deep", "x = " + "{a = " * 20_000),
    *toml_case("TOML key of 20,000 parts", ".".join(["a"] * 20_000) + " = 1"),
    *toml_case("TOML header of 20,000 parts", f"[{'.'.join(['a'] * 20_000)}]"),
    *toml_case("TOML integer of 5,000 digits", "schema = " + "1" * 5_000),
    *toml_case("TOML integer of 400 digits", "schema = " + "1" * 400),
    bytes_case(
        "TOML key of 900,000 letters",
        "m.toml",
        b"schema = 1\nignore = []\n" + b"a" * 900_000 + b" = 1\n",
        ["check", str(RAMP), "--map", "m.toml"],
    ),
    *toml_case("TOML with a nul", b"schema = 1\0\n"),
    Case("mass of 400 digits", 3, car_with("mass = " + "1" * 400)),
    Case("mass of 400 digits in text", 3, car_with(f'mass = "{"1" * 400} kg"')),
    Case("mass with 200,000 blanks", 3, car_with(f'mass = "1{" " * 200_000}x kg"')),
    Case("mass of 5,000 digits", 3, car_with("mass = " + "1" * 5_000)),
    bytes_case(
        "scale of 400 digits",
        "m.toml",
        b'schema = 1\n[channels.v]\nsource = "v"\nscale = ' + b"1" * 400,
        ["check", str(RAMP), "--map", "m.toml"],
    ),
    *map(
        encoding,
        (
            "hex",
            "rot13",
            "zlib",
            "undefined",
            "punycode",
            "utf-8\0",
            "idna",
            "base64",
            "bz2",
            "unicode_escape",
            "a" * 500,
        ),
    ),
    Case(
        "record of 100,000 [, list", 0, store(replaced(RECORD, b"[" * 100_000), ["tables", "list"])
    ),
    Case(
        "record of 100,000 [, show",
        4,
        store(replaced(RECORD, b"[" * 100_000), ["tables", "show", "sedan-2up@1"]),
    ),
    Case(
        "record of 100,000 [, verify",
        4,
        store(replaced(RECORD, b"[" * 100_000), ["tables", "verify"]),
    ),
    Case(
        "record with a number of 5,000 digits",
        0,
        store(replaced(RECORD, b'{"version": ' + b"1" * 5000 + b"}"), ["tables", "list"]),
    ),
    Case(
        "journal of 100,000 [",
        4,
        store(replaced("journal.jsonl", b"[" * 100_000 + b"\n"), ["tables", "list"]),
    ),
    Case(
        "head with 5,000 digits",
        4,
        store(replaced("journal.head", b"0" * 64 + b" " + b"1" * 5000 + b"\n"), ["tables", "list"]),
    ),
    *(
        Case(f"pipe as {name}, list", code, store(pipe(name), ["tables", "list"]))
        for name, code in (
            (RECORD, 0),
            ("sedan-2up/v0001/tyre.parquet", 0),
            ("journal.jsonl", 4),
            ("journal.head", 4),
            ("sedan-2up/v0001.minisig", 0),
            ("sedan-2up/v0001.AB.minisig", 0),
        )
    ),
    bytes_case(
        "CDF with encoding UTF-0",
        "in.dcm",
        b'<?xml version="1.0" encoding="UTF-0"?><MSRSW/>',
        IMPORT,
    ),
    bytes_case(
        "CDF with encoding hex", "in.dcm", b'<?xml version="1.0" encoding="hex"?><MSRSW/>', IMPORT
    ),
    bytes_case(
        "CDF with encoding UTF-7",
        "in.dcm",
        b'<?xml version="1.0" encoding="utf-7"?><MSRSW/>',
        IMPORT,
    ),
    bytes_case("CDF with entities of 900 MB", "in.dcm", ENTITIES + b"</MSRSW>", IMPORT),
    bytes_case("CDF nested 100,000 deep", "in.dcm", b"<MSRSW>" + b"<a>" * 100_000, IMPORT),
    linked("link to /dev/zero, import", "/dev/zero", IMPORT),
    linked("loop of links as DCM", "in.dcm", IMPORT),
    linked("loop of links as log", "loop.csv", ["check", "loop.csv"]),
    linked(
        "loop of links as limits",
        "loop.toml",
        [
            "validate",
            "sedan-2up",
            str(RAMP),
            "--store",
            str(ROOT / "tables"),
            "--limits",
            "loop.toml",
        ],
    ),
    linked("loop of links as map", "loop.toml", ["check", str(RAMP), "--map", "loop.toml"]),
    linked("link to /dev/zero, log", "/dev/zero", ["check", "zero.csv"]),
    linked("link to /dev/zero, validation", "/dev/zero", [*EXPORT, "zero.json"]),
    fifo("pipe, import", IMPORT),
    fifo("pipe, validation", [*EXPORT, "v.json"]),
    fifo("pipe, log", ["check", "p.csv"]),
    fifo("pipe, recording", ["check", "p.mf4"]),
    fifo("pipe, plan", ["repeatability", "--vehicle", str(CAR), "--plan", "p.csv"]),
    fifo(
        "pipe, effect",
        ["fit", str(RAMP), "--store", "new", "--vehicle", str(CAR), "--effect", "p.py"],
    ),
    fifo(
        "pipe, key",
        ["tables", "verify", "--store", str(ROOT / "tables"), "--key", "k.pub"],
    ),
    Case("pipe, DBC", 3, dbc_pipe),
    Case("log name of 304 bytes", 3, long_name),
    bytes_case("MDF version that is no text", "a.mf4", mdf_version(b"4\xff10"), ["check", "a.mf4"]),
    bytes_case(
        "plan with a long cell",
        "p.csv",
        b"log,car\n" + b"a" * 200_000 + b",b\n",
        ["repeatability", "--vehicle", str(CAR), "--plan", "p.csv"],
    ),
    bytes_case(
        "plan with a nul",
        "p.csv",
        b"log,car\na\0b,b\n",
        ["repeatability", "--vehicle", str(CAR), "--plan", "p.csv"],
    ),
    bytes_case(
        "effect nested 100,000 deep",
        "e.py",
        b"(" * 100_000,
        ["fit", str(RAMP), "--store", "new", "--vehicle", str(CAR), "--effect", "e.py"],
    ),
    bytes_case(
        "effect of 100,000 minus signs",
        "e.py",
        b"x=" + b"-" * 100_000 + b"1",
        ["fit", str(RAMP), "--store", "new", "--vehicle", str(CAR), "--effect", "e.py"],
    ),
    *(
        case
        for kind in ("kcd", "arxml")
        for case in (
            Case(
                f"{kind.upper()} with entities of 900 MB",
                3,
                described_by(f"a.{kind}", ENTITIES + b"</MSRSW>"),
            ),
            Case(
                f"{kind.upper()} nested 100,000 deep",
                3,
                described_by(f"a.{kind}", b"<a>" * 100_000 + b"</a>" * 100_000),
            ),
        )
    ),
    Case("SYM with a text of 4 MB", 3, described_by("a.sym", SYM_TEXT)),
    Case("DBC with a text of 4 MB", 3, described_by("a.dbc", DBC_TEXT)),
    Case("DBC of 100,000 signals", 3, described_by("a.dbc", DBC_SIGNALS), large=True),
    Case("DBC of another grammar", 3, on_bus("a.dbc", b"BO_ 1 \n\nx\r\ny")),
    bytes_case(
        "controls in a header, check", "a.csv", header(f"{TERMINAL} [bar]"), ["check", "a.csv"], 0
    ),
    bytes_case(
        "header of 100,000 blanks", "r.csv", header(f"x{chr(9) * 100_000}y"), ["check", "r.csv"], 0
    ),
    bytes_case("header of 30,000 brackets", "r.csv", header("x (" * 30_000), ["check", "r.csv"], 0),
    Case("controls in a unit, check", 0, unit_of_source),
    bytes_case(
        "controls in a header, suggest",
        "a.csv",
        header(f"{TERMINAL} [bar]"),
        ["map", "suggest", "a.csv"],
        0,
    ),
    Case("controls in a file name", 0, ramp_named(f"{TERMINAL}.csv".replace("/", ""))),
    Case("byte in a file name that is not UTF-8", 0, ramp_named(os.fsdecode(b"r\xfc.csv"))),
    bytes_case(
        "controls in a map",
        "m.toml",
        ('schema = 1\n[channels.v]\nsource = "' + "\\u001b[2J\\u202e" + '"\n').encode(),
        ["check", str(RAMP), "--map", "m.toml"],
    ),
    bytes_case(
        "key with controls in a map",
        "m.toml",
        'schema = 1\n"\\u001b[2J\u202e" = 1\n'.encode(),
        ["check", str(RAMP), "--map", "m.toml"],
    ),
    bytes_case(
        "gzip bomb of 1.5 GB of lines",
        "a.csv.gz",
        lambda: bomb(row()),
        ["check", "a.csv.gz"],
        large=True,
    ),
    bytes_case(
        "gzip bomb of 1.5 GB of zeros",
        "a.csv.gz",
        lambda: bomb(b"\0" * 100),
        ["check", "a.csv.gz"],
        large=True,
    ),
    bytes_case(
        "gzip bomb of 1.5 GB of line ends",
        "a.csv.gz",
        lambda: bomb(b"\n"),
        ["check", "a.csv.gz"],
        large=True,
    ),
    bytes_case(
        "gzip bomb that is cut off",
        "a.csv.gz",
        lambda: bomb(row())[:-9],
        ["check", "a.csv.gz"],
        large=True,
    ),
    bytes_case(
        "gzip bomb as VBO", "a.vbo.gz", lambda: bomb(b"\n"), ["check", "a.vbo.gz"], large=True
    ),
    bytes_case(
        "Parquet of 3.2 GB a column", "a.parquet", parquet_bomb, ["check", "a.parquet"], large=True
    ),
    Case("BLF container of 2 GB", 3, on_bus("a.blf", blf_bomb), large=True),
    holes("CSV of 3 GB of zeros", "a.csv", 3_000_000_000, ["check", "a.csv"]),
    holes("Parquet of 3 GB of zeros", "a.parquet", 3_000_000_000, ["check", "a.parquet"]),
    holes(
        "recording of 3 GB of zeros",
        "a.mf4",
        3_000_000_000,
        ["check", "a.mf4"],
        mdf_version(b"4.10"),
    ),
    holes(
        "TOML of 3 GB of zeros", "a.toml", 3_000_000_000, ["check", str(RAMP), "--map", "a.toml"]
    ),
    holes("DCM of 3 GB of zeros", "in.dcm", 3_000_000_000, IMPORT),
    holes("validation of 3 GB of zeros", "v.json", 3_000_000_000, [*EXPORT, "v.json"]),
    holes(
        "plan of 3 GB of zeros",
        "p.csv",
        3_000_000_000,
        ["repeatability", "--vehicle", str(CAR), "--plan", "p.csv"],
    ),
    holes(
        "effect of 3 GB of zeros",
        "e.py",
        3_000_000_000,
        ["fit", str(RAMP), "--store", "new", "--vehicle", str(CAR), "--effect", "e.py"],
    ),
]
