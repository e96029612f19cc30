"""Our own files read back: what was cut off or changed is named."""

import random
import re
from pathlib import Path

import numpy as np
import pytest

from calib.base.errors import ExchangeError
from calib.exports.build import build
from calib.exports.compare import Difference, difference, parent
from calib.exports.read import read_back
from calib.exports.write import FORMATS
from calib.store.store import Store

TABLES = Path(__file__).parents[2] / "tables"
FORMS = {"DCM": FORMATS["dcm"], "CDF": FORMATS["cdfx"]}
WRITERS = {name: form.write for name, form in FORMS.items()}


def built(stored, form, points=None):
    """The data set of a version for one of the formats."""
    return build(stored, points, most_axes=FORMS[form].most_axes)


@pytest.fixture(params=WRITERS)
def written(request, stored, tmp_path):
    """A path and the file of the made table in one of the formats."""
    path = tmp_path / "table.out"
    path.write_bytes(WRITERS[request.param](built(stored, request.param)))
    return path


@pytest.mark.parametrize(("form", "points"), [("DCM", None), ("CDF", 16), ("DCM", 4)])
def test_it_comes_back_to_the_last_bit(real, tmp_path, form, points):
    path, data = tmp_path / "table", built(real, form, points)
    path.write_bytes(WRITERS[form](data))
    file = read_back(path)
    assert (file.format, file.facts, file.unchanged) == (form, data.facts(), True)
    assert file.content == data.content()
    assert file.units[f"{data.prefix}_mass"] == "kg"
    assert difference(file, real) == Difference([])


def test_no_cut_is_taken_for_the_whole(written):
    """Wherever it is cut it is refused, except within the end of the last line."""
    whole = written.read_bytes()
    chance = random.Random(1)
    for length in [0, 1, len(whole) - 5, *(chance.randrange(len(whole) - 5) for _ in range(60))]:
        written.write_bytes(whole[:length])
        with pytest.raises(ExchangeError):
            read_back(written)


def test_no_lost_line_is_overlooked(written):
    """Without one of its lines a file is refused, or differs, or has lost words only."""
    lines = written.read_text().splitlines(keepends=True)
    whole = read_back(written)
    words = ("LANGNAME", "FUNKTION", "EINHEIT", "* ", "*\n", "FKT", "\n", "<?xml", "<!DOCTYPE",
             "<LONG-NAME", "<UNIT", "<STATE", "<DATE", "<CS", "<P>", "<SD GID",
             "<SHORT-NAME>sedan<", "<DATA-FILE", "<CATEGORY")  # fmt: skip
    for i in range(0, len(lines), 1 + len(lines) // 200):
        line = lines[i]
        written.write_text("".join(lines[:i] + lines[i + 1 :]))
        try:
            file = read_back(written)
        except ExchangeError:
            continue
        if file.unchanged:
            assert line.lstrip().startswith(words) or line == "\n", line
            assert file.content == whole.content


WRONG = {
    "DCM": [
        ("\nEND\n\nFESTWERT sedan_mass", "\n\nFESTWERT sedan_mass"),
        ("VERTEILUNG sedan_eta 21", "VERTEILUNG sedan_eta 22"),
        ("  WERT 1744.0\n", ""),
        ("  WERT 1744.0", "  WERT 1.744,0"),
        ("  WERT 1744.0", "  WERTE 1744.0"),
        ("_FORMAT 2.0", "_FORMAT 1.0"),
        ("*SSTX sedan_eta\n", ""),
        ("* objects: ", "* objects: 1"),
        ("FESTWERT sedan_l_r", "FESTWERT sedan_l_f"),
        ("KENNLINIE sedan_g 21", "KENNLINIE sedan_g"),
        ("FUNKTIONEN\n", "FUNKTIONE\n"),
    ],
    "CDF": [
        ("</MSRSW>", ""),
        ("CDF20", "CDF19"),
        ("<V>1744.0</V>", ""),
        ("<V>1744.0</V>", "<V>heavy</V>"),
        (">sedan_eta</SW-INSTANCE-REF>", ">sedan_etc</SW-INSTANCE-REF>"),
        ("<V>1.005</V>", ""),
        ("<SHORT-NAME>sedan_l_r", "<SHORT-NAME>sedan_l_f"),
        ("<CATEGORY>VALUE<", "<CATEGORY>MAP<"),
        ("<SHORT-NAME>sedan_mass</SHORT-NAME>", ""),
        ("<MSRSW", "<!DOCTYPE a [<!ENTITY b 'c'>]><MSRSW"),
    ],
}


@pytest.mark.parametrize(
    ("form", "old", "new"), [(form, *row) for form, rows in WRONG.items() for row in rows]
)
def test_what_is_wrong_in_a_file_is_refused(stored, tmp_path, form, old, new):
    text = WRITERS[form](built(stored, form)).decode()
    assert old in text
    (tmp_path / "a").write_text(text.replace(old, new))
    with pytest.raises(ExchangeError) as error:
        read_back(tmp_path / "a")
    assert error.value.exit_code == 3


def test_a_number_that_was_changed_is_found_and_where(written, stored):
    written.write_text(written.read_text().replace("1744.0", "1745.0"))
    wrong = difference(read_back(written), stored).wrong
    assert "checksum" in wrong[0]
    assert wrong[1] == "sedan_mass: 1745.0, the table has 1744.0"
    assert len(wrong) == 2
    assert len(difference(read_back(written), None).wrong) == 1  # the checksum still speaks


NUMBER = re.compile(r"(?<=[ >])-?[0-9]+\.[0-9]+(?:e[-+][0-9]+)?(?=[ <\n])")
WAYS = {
    "single": lambda x: str(np.float32(x)),
    "nine digits of single": lambda x: f"{np.float32(x):.9g}",
    "seven digits": lambda x: f"{x:.7g}",
    "five digits": lambda x: f"{x:.4E}",
    "six decimals": lambda x: f"{x:.6f}",
}
BEGIN = {"DCM": "FUNKTIONEN", "CDF": "<SW-INSTANCE-TREE"}


def saved_again(path, data, form, way, changed=lambda text: text):
    """A file of ``data`` as another tool saves it: no head, each number of the objects rounded."""
    _, word, objects = WRITERS[form](data).decode().partition(BEGIN[form])
    head = "* CANape\nKONSERVIERUNG_FORMAT 2.0\n"
    if form == "CDF":
        head = "<MSRSW><CATEGORY>CDF20</CATEGORY><SW-SYSTEMS><SW-SYSTEM><SW-INSTANCE-SPEC>"
        objects = objects.partition("</SW-SYSTEMS>")[0] + "</SW-SYSTEMS></MSRSW>"
    rounded = NUMBER.sub(lambda m: WAYS[way](float(m.group())), changed(objects))
    path.write_text(head + word + rounded)
    return read_back(path)


@pytest.mark.parametrize(("way", "form"), [*zip(WAYS, 3 * [*WRITERS], strict=False)])
def test_what_a_tool_has_rounded_is_told_from_a_change(tmp_path, form, way):
    real = Store(TABLES).load("sedan-2up")
    data = built(real, form, 8)
    file = saved_again(tmp_path / "a", data, form, way)
    result = difference(file, real)
    assert file.unchanged is None
    assert parent(file, Store(real.path.parents[1])).id == real.id
    assert (result.wrong, bool(result.rounded)) == ([], True)
    values = {x.label: x.values for x in data.objects}
    changes = {"f1": 1.01, "g": 0.9, "mass": 1.002}

    def changed(text):
        for name, by in changes.items():
            old = float(values[f"{data.prefix}_{name}"][-1])
            text = text.replace(repr(old), f"{old * by:.4g}")
        return text

    wrong = difference(saved_again(tmp_path / "a", data, form, way, changed), real).wrong
    assert {re.match(rf"{data.prefix}_(\w+)", flaw)[1] for flaw in wrong} == changes.keys()


def test_the_labels_name_a_table_of_the_store(stored, store, tmp_path):
    file = saved_again(tmp_path / "a", built(stored, "DCM"), "DCM", "single")
    assert parent(file, Store(store)).id == stored.id
    with pytest.raises(ExchangeError):
        difference(file, None)


def test_other_files_are_refused(tmp_path):
    for content in (b"", b"\x00\xff", b"<html></html>", b"{}"):
        (tmp_path / "a").write_bytes(content)
        with pytest.raises(ExchangeError):
            read_back(tmp_path / "a")
    with pytest.raises(ExchangeError, match="no such file"):
        read_back(tmp_path / "none")


@pytest.mark.parametrize("odd", ["\0", "\x0b", "\x1b[31m", "\x85", "\u2028"])
def test_a_control_character_is_named_with_its_line(stored, tmp_path, odd):
    path, text = tmp_path / "t.dcm", WRITERS["DCM"](built(stored, "DCM")).decode()
    path.write_text(text.replace("LANGNAME ", f"LANGNAME {odd}", 1), encoding="utf-8")
    line = text[: text.index("LANGNAME ")].count("\n") + 1
    with pytest.raises(ExchangeError, match=rf"U\+{ord(odd[0]):04X} in line {line}\b"):
        read_back(path)
