"""Files made to break a reader end with one line and the right exit code, and leave nothing."""

import json
import os
import re
import shutil
from collections.abc import Callable
from itertools import cycle
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SEDAN = ROOT / "sample_logs" / "sedan"
RAMP = SEDAN / "ramp_wet_asphalt.csv"
CAR = SEDAN / "vehicle.toml"
TABLE = "sedan-2up@2"

OSC, CSI, C1, BIDI = "\x1b]0;owned\x07", "\x1b[2J", "\x9b31m", "\u202e"
RAW = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069\u2028\u2029]")
"""What no output may contain."""

TERMINAL = f"x{OSC}{CSI}{C1}{BIDI}"
"""A name with everything that moves a terminal."""

Content = bytes | Callable[[Path], bytes | None]
"""Bytes of a file, or what makes it at a path, or makes its bytes when they are wanted."""


def put(path: Path, content: Content) -> None:
    data = content if isinstance(content, bytes) else content(path)
    if data is not None:
        path.write_bytes(data)


COMMANDS = {
    "check": f"check {RAMP} --map",
    "fit": f"fit {RAMP} --store new --vehicle",
    "limits": f"validate sedan-2up {RAMP} --store {ROOT / 'tables'} --limits",
    "model": f"simulate {RAMP} --vehicle {CAR} --out o.csv --model",
    "effect": f"fit {RAMP} --store new --vehicle {CAR} --effect",
    "plan": f"repeatability --vehicle {CAR} --plan",
    "key": f"tables verify --store {ROOT / 'tables'} --key",
    "import": "tables compare",
    "validation": f"tables reject {TABLE} --store {ROOT / 'tables'} --reason r --evidence",
    "log": "check",
    "map": "map",
}
"""Commands by the kind of file that is their last word."""


def case(name: str, kind: str, file: str, content: Content, code: int = 3) -> object:
    """A command whose last word is a file."""
    return pytest.param([*COMMANDS[kind].split(), file], {file: content}, code, id=name)


def car_with(mass: str) -> bytes:
    """A vehicle whose mass is this value."""
    return re.sub(r"(?m)^mass = .*$", f"mass = {mass}", CAR.read_text()).encode()


def store(name: str, code: int, path: str, content: Content, command: str) -> object:
    """A command on a copy of the repository's store in which one file is another."""

    def spoilt(tables: Path) -> None:
        shutil.copytree(ROOT / "tables", tables)
        (tables / path).unlink(missing_ok=True)
        put(tables / path, content)

    words = [*command.split(), "--store", "tables"]
    return pytest.param(words, {"tables": spoilt}, code, id=name)


def link(target: str) -> Content:
    """A link; to itself it is a loop."""
    return lambda path: path.symlink_to(target)


def header(cell: str) -> bytes:
    """The ramp with one more column of this head."""
    first, *rows = RAMP.read_text().splitlines()
    return "\n".join([f'{first},"{cell}"', *(f"{line},0.5" for line in rows), ""]).encode()


def described_by(name: str, file: str, content: Content) -> object:
    """A log of a bus whose map names ``file`` as what describes it."""
    chart = f'schema = 1\ndbc = "{file}"\n[channels.v]\nsource = "V"\n'.encode()
    words = [*["check", "--map", "map.toml", "a.log"]]
    files = {"map.toml": chart, file: content, "a.log": b"(1.0) can0 100#00\n"}
    return pytest.param(words, files, 3, id=name)


SYM_TEXT = b'FormatVersion=6.0\nTitle="' + b"a" * 4_000_000 + b'"\n'
DBC_TEXT = b'VERSION ""\nBU_: E\nCM_ "' + b"a" * 4_000_000 + b'";\n'
ENTITIES = b"<!DOCTYPE MSRSW [<!ENTITY a '" + b"z" * 100_000 + b"'>]><MSRSW>" + b"&a;" * 9_000
RECORD = "sedan-2up/v0001/record.json"
DEEP = b"[" * 100_000
TOMLS = {
    "nested 20,000 deep": "x = " + "[" * 20_000,
    "tables nested 20,000 deep": "x = " + "{a = " * 20_000,
    "key of 20,000 parts": ".".join(["a"] * 20_000) + " = 1",
    "header of 20,000 parts": f"[{'.'.join(['a'] * 20_000)}]",
    "integer of 5,000 digits": "schema = " + "1" * 5_000,
    "integer of 400 digits": "schema = " + "1" * 400,
    "nul": "schema = 1\0\n",
}
MASSES = {
    "400 digits": "1" * 400,
    "400 digits in text": f'"{"1" * 400} kg"',
    "200,000 blanks": f'"1{" " * 200_000}x kg"',
    "5,000 digits": "1" * 5_000,
}
ENCODINGS = ("hex", "undefined", "utf-8\0", "idna", "unicode_escape", "a" * 500)
XML = b'<?xml version="1.0" encoding="%s"?><MSRSW/>'
SCALE = b'schema = 1\n[channels.v]\nsource = "v"\nscale = ' + b"1" * 400

CASES = [
    *(
        case(f"TOML, {name}, for {kind}", kind, "bad.toml", text.encode())
        for (name, text), kind in zip(TOMLS.items(), cycle(("fit", "check", "limits", "model")))
    ),
    case("TOML key of 900,000 letters", "check", "m.toml",
               b"schema = 1\nignore = []\n" + b"a" * 900_000 + b" = 1\n"),
    *(
        case(f"mass of {name}", "fit", "car.toml", car_with(mass))
        for name, mass in MASSES.items()
    ),
    case("scale of 400 digits", "check", "m.toml", SCALE),
    *(
        case(f"encoding {name[:20]!r}", "check", "map.toml",
             f"schema = 1\n[text]\nencoding = {json.dumps(name)}\n".encode())
        for name in ENCODINGS
    ),
    store("record of 100,000 [, list", 0, RECORD, DEEP, "tables list"),
    store("record of 100,000 [, show", 4, RECORD, DEEP, "tables show sedan-2up@1"),
    store("record of 100,000 [, verify", 4, RECORD, DEEP, "tables verify"),
    store("record with a number of 5,000 digits", 0,
          RECORD, b'{"version": ' + b"1" * 5000 + b"}", "tables list"),
    store("journal of 100,000 [", 4, "journal.jsonl", DEEP + b"\n", "tables list"),
    store("head with 5,000 digits", 4,
          "journal.head", b"0" * 64 + b" " + b"1" * 5000 + b"\n", "tables list"),
    *(
        store(f"pipe as {name}, list", code, name, os.mkfifo, "tables list")
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
        case(f"CDF with encoding {name}", "import", "in.dcm", XML % name.encode())
        for name in ("UTF-0", "hex", "utf-7")
    ),
    case("CDF with entities of 900 MB", "import", "in.dcm", ENTITIES + b"</MSRSW>"),
    case("CDF nested 100,000 deep", "import", "in.dcm", b"<MSRSW>" + b"<a>" * 100_000),
    case("link to /dev/zero, import", "import", "in.dcm", link("/dev/zero")),
    case("link to /dev/zero, log", "log", "zero.csv", link("/dev/zero")),
    case("link to /dev/zero, validation", "validation", "zero.json", link("/dev/zero")),
    case("loop of links as DCM", "import", "in.dcm", link("in.dcm")),
    case("loop of links as log", "log", "loop.csv", link("loop.csv")),
    case("loop of links as limits", "limits", "loop.toml", link("loop.toml")),
    case("loop of links as map", "check", "loop.toml", link("loop.toml")),
    *(case(f"pipe {file} for {kind}", kind, file, os.mkfifo)
      for kind, file in (
          ("import", "in.dcm"), ("validation", "v.json"), ("log", "p.csv"), ("log", "p.mf4"),
          ("plan", "p.csv"), ("effect", "p.py"), ("key", "k.pub"),
      )),
    described_by("pipe, DBC", "a.dbc", os.mkfifo),
    case("log name of 304 bytes", "log", f"{'a' * 300}.csv", lambda path: None),
    case("MDF version that is no text", "log", "a.mf4", b"MDF     4\xff10    " + bytes(48)),
    case("plan with a long cell", "plan", "p.csv", b"log,car\n" + b"a" * 200_000 + b",b\n"),
    case("plan with a nul", "plan", "p.csv", b"log,car\na\0b,b\n"),
    case("effect nested 100,000 deep", "effect", "e.py", b"(" * 100_000),
    case("effect of 100,000 minus signs", "effect", "e.py", b"x=" + b"-" * 100_000 + b"1"),
    *(
        described_by(f"{kind} with {what}", f"a.{kind}", data)
        for kind in ("kcd", "arxml")
        for what, data in (
            ("entities of 900 MB", ENTITIES + b"</MSRSW>"),
            ("100,000 levels", b"<a>" * 100_000 + b"</a>" * 100_000),
        )
    ),
    described_by("SYM with a text of 4 MB", "a.sym", SYM_TEXT),
    described_by("DBC with a text of 4 MB", "a.dbc", DBC_TEXT),
    described_by("DBC of another grammar", "a.dbc", b"BO_ 1 \n\nx\r\ny"),
    case("controls in a header", "log", "a.csv", header(f"{TERMINAL} [bar]"), 0),
    case("header of 100,000 blanks", "log", "r.csv", header(f"x{chr(9) * 100_000}y"), 0),
    case("header of 30,000 brackets", "log", "r.csv", header("x (" * 30_000), 0),
    case("controls in a unit", "log", "a.csv", header(f"y [{TERMINAL}]"), 0),
    case("controls in a header, map", "map", "a.csv", header(f"{TERMINAL} [bar]"), 0),
    case("controls in a file name", "log", f"{TERMINAL}.csv".replace("/", ""),
         RAMP.read_bytes(), 0),
    case("byte in a file name that is not UTF-8", "log", os.fsdecode(b"r\xfc.csv"),
         RAMP.read_bytes(), 0),
    case("controls in a map", "check", "m.toml",
               b'schema = 1\n[channels.v]\nsource = "\\u001b[2J\\u202e"\n'),
    case("key with controls in a map", "check", "m.toml",
               'schema = 1\n"\\u001b[2J\u202e" = 1\n'.encode()),
]  # fmt: skip


@pytest.mark.parametrize(("words", "files", "code"), CASES)
def test_it_is_answered_in_one_line(words, files, code, request, brake_cal, tmp_path, monkeypatch):
    for name, content in files.items():
        put(tmp_path / name, content)
    paths = sorted(tmp_path.iterdir())
    monkeypatch.chdir(tmp_path)
    ran = brake_cal(*words)
    assert ran.code == code, ran.err
    assert not RAW.search(ran.out + ran.err)
    if code == 3:
        assert ran.err.count("error: ") == 1
        assert len(ran.err.partition("error: ")[2].splitlines()) == 1
    assert sorted(tmp_path.iterdir()) == paths
    if words[:2] == ["tables", "list"] and code == 0:
        lost = "record" in request.node.name or "parquet" in request.node.name
        assert ("sedan-2up@1 cannot be used" in ran.out) == lost
        for table in ("escort@1", "sedan-2up@2", "sedan-sim@1"):
            (line,) = [line for line in ran.out.splitlines() if line.startswith(table)]
            assert "released" in line or "draft" in line
