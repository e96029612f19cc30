"""CSV: comments with the table's facts, then one row per number (`calib.exports.rows`).

The unit of a bare number is ``-``: readers that guess types would take ``1`` for an integer, and
fail at the first other unit.
"""

import csv
import io

from calib.exports.build import UNIT
from calib.exports.dataset import Dataset
from calib.exports.labels import printable
from calib.exports.rows import COLUMNS, rows

BARE = "-"
"""The unit of a bare number; `calib.units` knows it, too."""


def write_csv(data: Dataset) -> bytes:
    """CSV file of ``data``: UTF-8, ``#`` before comments; a missing value is an empty cell."""
    text = io.StringIO()
    for key, value in data.facts().items():
        text.write(f"# {key}: {printable(value)}\n")
    table = csv.writer(text, lineterminator="\n")
    table.writerow(COLUMNS)
    for row in rows(data):
        table.writerow(map(_cell, row))
    return text.getvalue().encode()


def _cell(value: str | float | None) -> str:
    if value is None:
        return ""
    if value == UNIT:
        return BARE
    return repr(value) if isinstance(value, float) else str(value)
