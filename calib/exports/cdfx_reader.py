"""Reader of the CDF 2.0 files that `write_cdfx` makes, with a check of their stated counts."""

from pathlib import Path
from xml.etree import ElementTree as ET
from xml.parsers import expat

from calib.errors import ExchangeError
from calib.exports.cdfx import FACTS
from calib.exports.dataset import Content
from calib.exports.returned import Returned, returned

TREE = "SW-SYSTEMS/SW-SYSTEM/SW-INSTANCE-SPEC/SW-INSTANCE-TREE"
NUMBERS = "SW-VALUE-CONT/SW-VALUES-PHYS"


def read_cdfx(path: Path, text: bytes) -> Returned:
    """Numbers and facts of a CDF 2.0 file. Raises ExchangeError naming what is missing."""
    root = _root(path, text)
    tree = root.find(TREE)
    if root.tag != "MSRSW" or root.findtext("CATEGORY") != "CDF20" or tree is None:
        raise ExchangeError(
            f"no CDF 2.0: its root is {root.tag}", where=path, expected=f"MSRSW, CDF20, {TREE}"
        )
    facts = {
        sd.get("GID", ""): sd.text or "" for sd in root.findall(f"SDGS/SDG[@GID='{FACTS}']/SD")
    }
    instances = _instances(path, tree)
    unit = "SW-VALUE-CONT/UNIT-DISPLAY-NAME"
    units = {name: i.findtext(unit, "") for name, i in instances.items()}
    return returned(path, "CDF", facts, units, _content(path, instances))


def _root(path: Path, text: bytes) -> ET.Element:
    def refuse(*_: object) -> None:
        raise ExchangeError("declares an entity", where=path, expected="XML without entities")

    try:
        first = expat.ParserCreate()
        first.EntityDeclHandler = refuse  # a few bytes of entities can stand for gigabytes
        first.Parse(text, True)
        return ET.fromstring(text)
    except (expat.ExpatError, ET.ParseError, LookupError, ValueError) as error:
        raise ExchangeError(
            f"cut off or damaged: {error}", where=path, expected="XML that ends with </MSRSW>"
        ) from error


def _instances(path: Path, tree: ET.Element) -> dict[str, ET.Element]:
    found: dict[str, ET.Element] = {}
    for instance in tree.findall("SW-INSTANCE"):
        name = instance.findtext("SHORT-NAME") or ""
        if not name or name in found:
            what = f"{name} is in it twice" if name else "an SW-INSTANCE without SHORT-NAME"
            raise ExchangeError(what, where=path)
        found[name] = instance
    return found


def _content(path: Path, instances: dict[str, ET.Element]) -> Content:
    kinds = {name: i.findtext("CATEGORY") for name, i in instances.items()}
    odd = next((n for n, kind in kinds.items() if kind not in ("COM_AXIS", "CURVE", "VALUE")), None)
    if odd is not None:
        raise ExchangeError(
            f"category {kinds[odd]}", where=f"{path}: {odd}", expected="COM_AXIS, CURVE or VALUE"
        )
    values = {n: _numbers(f"{path}: {n}", i.find(NUMBERS)) for n, i in instances.items()}
    axes = {n: v for n, v in values.items() if kinds[n] == "COM_AXIS"}
    return Content(
        axes,
        {n: _curve(f"{path}: {n}", instances[n], axes, y) for n, y in values.items()
         if kinds[n] == "CURVE"},
        {n: v[0] for n, v in values.items() if kinds[n] == "VALUE"},
    )  # fmt: skip


def _curve(
    where: str, instance: ET.Element, axes: dict[str, tuple[float, ...]], y: tuple[float, ...]
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    over = instance.find("SW-AXIS-CONTS/SW-AXIS-CONT")
    if over is None:
        raise ExchangeError("a curve without SW-AXIS-CONT", where=where)
    name = over.findtext("SW-INSTANCE-REF")
    if name is not None and name not in axes:
        raise ExchangeError(f"is over {name}, which is missing", where=where)
    x = _numbers(where, over.find("SW-VALUES-PHYS")) if name is None else axes[name]
    if len(x) != len(y):
        raise ExchangeError(f"{len(y)} values over an axis of {len(x)}", where=where)
    return x, y


def _numbers(where: str, values: ET.Element | None) -> tuple[float, ...]:
    texts = [] if values is None else [v.text or "" for v in values.findall("V")]
    if not texts:
        raise ExchangeError("no SW-VALUES-PHYS with a V", where=where)
    try:
        return tuple(float(text) for text in texts)
    except ValueError as error:
        raise ExchangeError(str(error), where=where, expected="numbers in V") from error
