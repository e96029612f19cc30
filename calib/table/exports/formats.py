"""The formats by name, each with the one function that writes it."""

from collections.abc import Callable
from dataclasses import dataclass

from calib.table.exports.c_header import write_c_header
from calib.table.exports.cdfx import write_cdfx
from calib.table.exports.csv import write_csv
from calib.table.exports.dataset import Dataset
from calib.table.exports.dcm import write_dcm
from calib.table.exports.document import write_json
from calib.table.exports.inca_csv import write_inca_csv
from calib.table.exports.parquet import write_parquet
from calib.table.version import Stored


@dataclass(frozen=True)
class Order:
    """What is to be written: ``data`` of ``stored``, on ``date``; integers if ``bits`` is set."""

    data: Dataset
    stored: Stored
    date: str
    bits: int | None = None


FORMATS: dict[str, Callable[[Order], bytes]] = {
    "json": lambda o: write_json(o.data, o.stored),
    "csv": lambda o: write_csv(o.data),
    "parquet": lambda o: write_parquet(o.data),
    "dcm": lambda o: write_dcm(o.data),
    "cdfx": lambda o: write_cdfx(o.data, o.date),
    "c-header": lambda o: write_c_header(o.data, o.bits),
    "inca-csv": lambda o: write_inca_csv(o.data),
}
"""Each gives the whole file as bytes. Raises ExchangeError where the order cannot be met."""

SPOKEN = {"c": "c-header", "h": "c-header", "cdf": "cdfx", "inca": "inca-csv"}
"""Other names by which the formats go."""

FIXED_POINT = ("c-header",)
"""Formats that have a fixed point."""
