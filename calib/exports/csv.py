"""CSV: comments with the table's facts, then one row per number (`calib.exports.rows`)."""

import csv
import io

from calib.exports.dataset import Dataset
from calib.exports.labels import printable
from calib.exports.rows import COLUMNS, rows


def write_csv(data: Dataset) -> bytes:
    """CSV file of ``data``: UTF-8, ``#`` before comments; a missing value is an empty cell."""
    text = io.StringIO()
    for key, value in data.facts().items():
        text.write(f"# {key}: {printable(value)}\n")
    table = csv.writer(text, lineterminator="\n")
    table.writerow(COLUMNS)
    for row in rows(data):
        table.writerow("" if v is None else repr(v) if isinstance(v, float) else v for v in row)
    return text.getvalue().encode()
