"""Checks of store and export: files read by other readers, damage that must be refused."""

import csv
import io
import re
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from calib.errors import BrakeCalError
from calib.exports.export import export
from calib.exports.read import read_back
from calib.qualification.check import COUNT, Check
from calib.qualification.material import Material
from calib.store.store import Store
from calib.store.version import Stored

F2 = "sedan_sim_f2"
"""Label of the curve that is compared."""
DATE = "2025-01-01"


def _stored(material: Material) -> Stored:
    return Store(material.scratch / "tables").save(material.table("simulation_study"))


def _written(material: Material, name: str) -> Path:
    path = material.scratch / name
    export(_stored(material), path, unreleased=True, date=DATE)
    return path


def _csv(content: bytes) -> list[float]:
    lines = [line for line in content.decode().splitlines() if not line.startswith("#")]
    rows = csv.DictReader(io.StringIO("\n".join(lines)))
    return [float(row["value"]) for row in rows if row["label"] == F2]


def _dcm(content: bytes) -> list[float]:
    """Numbers of the lines WERT in the block of the curve."""
    block = content.decode("latin-1").split(f"GRUPPENKENNLINIE {F2} ")[1].split("\nEND")[0]
    return [float(x) for line in re.findall(r"^\s*WERT (.*)$", block, re.M) for x in line.split()]


def _cdfx(content: bytes) -> list[float]:
    for instance in ElementTree.fromstring(content).iter("SW-INSTANCE"):
        if instance.findtext("SHORT-NAME") == F2:
            values = instance.find("SW-VALUE-CONT/SW-VALUES-PHYS")
            return [] if values is None else [float(v.text or "nan") for v in values.iter("V")]
    return []


def _c_header(content: bytes) -> list[float]:
    body = re.search(rf"const double {F2}\w*\[[^\]]*\] = {{([^}}]*)}}", content.decode())
    return [float(x) for x in body[1].split(",") if x.strip()] if body else []


def _changed(name: str, numbers: Callable[[bytes], list[float]]) -> Callable[[Material], float]:
    """How many numbers of f2 in the file are not those of the table to the last bit."""

    def measure(material: Material) -> float:
        found = np.array(numbers(_written(material, name).read_bytes()))
        table = material.table("simulation_study").paper.f2
        return float(np.sum(found != table)) if found.shape == table.shape else float(table.size)

    return measure


def _refused(material: Material) -> float:
    """How many of three damaged things are refused: a version, an export cut off, one edited."""
    stored = _stored(material)
    cut, edited = (_written(material, name) for name in ("cut.dcm", "edited.dcm"))
    cut.write_bytes(cut.read_bytes()[:-2000])
    value = _dcm(edited.read_bytes())[-1]
    edited.write_bytes(
        edited.read_bytes().replace(repr(value).encode(), repr(value + 1e-3).encode())
    )
    return float(_version_refused(material, stored) + sum(map(_export_refused, (cut, edited))))


def _version_refused(material: Material, stored: Stored) -> bool:
    """Whether a stored version of which one byte changes is refused."""
    store = material.scratch / "damaged"
    Store(store).save(stored.table)
    curve = next((store / stored.table.name / "v0001").glob("*.parquet"))
    content = bytearray(curve.read_bytes())
    content[len(content) // 4] ^= 1
    curve.chmod(0o644)
    curve.write_bytes(content)
    try:
        Store(store).load(stored.table.name)
    except BrakeCalError:
        return True
    return False


def _export_refused(path: Path) -> bool:
    try:
        return not read_back(path).unchanged
    except BrakeCalError:
        return True


REPEATS = "the table itself, its file read by {}"

CHECKS = (
    Check(
        "export_csv", "numbers of f2 that differ in the CSV file", "numbers", 0, COUNT,
        REPEATS.format("Python's csv module"), _changed("car.csv", _csv),
    ),
    Check(
        "export_dcm", "numbers of f2 that differ in the DCM file", "numbers", 0, COUNT,
        REPEATS.format("a search for its lines WERT"), _changed("car.dcm", _dcm),
    ),
    Check(
        "export_cdfx", "numbers of f2 that differ in the CDFX file", "numbers", 0, COUNT,
        REPEATS.format("Python's XML reader"), _changed("car.cdfx", _cdfx),
    ),
    Check(
        "export_c_header", "numbers of f2 that differ in the C header", "numbers", 0, COUNT,
        REPEATS.format("a search for the array"), _changed("car.h", _c_header),
    ),
    Check(
        "damaged_tables", "refused of a version, a cut and an edited export that were damaged",
        "files", 3, COUNT, "each file was changed by this check", _refused,
    ),
)  # fmt: skip
