"""The formats by name, each with the function that writes it."""

from collections.abc import Callable
from dataclasses import dataclass

from calib.documents.toml import did_you_mean
from calib.errors import ExchangeError
from calib.exports.a2l import write_a2l
from calib.exports.addresses import Addresses
from calib.exports.c_header import write_c_header
from calib.exports.cdfx import write_cdfx
from calib.exports.csv import write_csv
from calib.exports.dataset import Dataset
from calib.exports.dcm import write_dcm
from calib.exports.document import write_json
from calib.exports.inca_csv import write_inca_csv
from calib.exports.parquet import write_parquet
from calib.store.version import Stored

NOWHERE = Addresses()
"""No program was given."""


@dataclass(frozen=True)
class Order:
    """Input of a format: ``data`` of ``stored``, ``date``; integers if ``bits`` is set.

    ``addresses`` of the objects in the linked program.
    """

    data: Dataset
    stored: Stored
    date: str
    bits: int | None = None
    addresses: Addresses = NOWHERE


FORMATS: dict[str, Callable[[Order], bytes]] = {
    "json": lambda o: write_json(o.data, o.stored),
    "csv": lambda o: write_csv(o.data),
    "parquet": lambda o: write_parquet(o.data),
    "dcm": lambda o: write_dcm(o.data),
    "cdfx": lambda o: write_cdfx(o.data, o.date),
    "a2l": lambda o: write_a2l(o.data, o.bits, o.addresses),
    "c-header": lambda o: write_c_header(o.data, o.bits),
    "inca-csv": lambda o: write_inca_csv(o.data),
}
"""Each returns the whole file as bytes. Raises ExchangeError where it cannot hold the data."""

ENDINGS = {
    "json": "json",
    "csv": "csv",
    "parquet": "parquet",
    "dcm": "dcm",
    "cdfx": "cdfx",
    "a2l": "a2l",
    "c-header": "h",
    "inca-csv": "inca.csv",
}
"""Ending of the file name by format."""

SPOKEN = {"c": "c-header", "h": "c-header", "cdf": "cdfx", "inca": "inca-csv", "asap2": "a2l"}
"""Other accepted names of the formats."""

FIXED_POINT = ("c-header", "a2l")
"""Formats that can be in fixed point."""

ADDRESSED = ("a2l",)
"""Formats that hold addresses."""


def format_named(written: str) -> str:
    """The format of that name. Raises ExchangeError for an unknown one.

    >>> format_named("DCM"), format_named("c_header"), format_named("inca")
    ('dcm', 'c-header', 'inca-csv')
    """
    name = written.lower().replace("_", "-").lstrip(".")
    known = SPOKEN.get(name, name)
    if known in FORMATS:
        return known
    near = did_you_mean(name, FORMATS)
    what = f"unknown format {written!r}; {near} " if near else f"unknown format {written!r}; "
    raise ExchangeError(f"{what}known: {', '.join(FORMATS)}")


def format_of(name: str) -> str:
    """The format of a file by its ending. Raises ExchangeError where the ending names none.

    >>> format_of("car.inca.csv"), format_of("car.csv"), format_of("CAR.H")
    ('inca-csv', 'csv', 'c-header')
    """
    fits = [form for form, ending in ENDINGS.items() if name.lower().endswith(f".{ending}")]
    if not fits:
        endings = ", ".join(f".{ending}" for ending in ENDINGS.values())
        raise ExchangeError("its ending names no format", where=name, expected=f"one of {endings}")
    return max(fits, key=lambda form: len(ENDINGS[form]))
