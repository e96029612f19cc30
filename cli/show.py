"""`brake-cal tables show`: may it be used, how good is it, where does it come from."""

from typing import TYPE_CHECKING

import calib
from cli.console import emit, emit_json
from cli.grid import grid
from cli.options import Json, Store, TableVersion, example
from cli.origin import origin_facts
from cli.project import STORE

if TYPE_CHECKING:
    from rich.table import Table as Grid

    from calib.store.version import Stored
    from calib.table.table import Table, Value

EPILOG = example("brake-cal tables show sedan-2up")
ROWS = 12
"""Rows of f1 and f2 that are printed; all of them are in the JSON."""


def show(table: TableVersion, store: Store = STORE, json: Json = False) -> None:
    """Say whether a table may be used, and how good it is.

    Prints its quality, its origin and its curves, and last the verdict.
    """
    from calib.store.answer import verdict_lines

    stored = calib.Store(store).load(table)
    if json:
        emit_json(_document(stored))
        return
    emit(_answer(stored))
    emit("")
    emit(_facts(stored))
    emit(_curves(stored.table))
    for remark in stored.table.remarks:
        emit(f"- {remark}")
    emit("")
    for line in verdict_lines(stored):
        emit(line)


def _document(stored: "Stored") -> dict[str, object]:
    from calib.store.answer import answer
    from calib.store.signature import key_ids

    record, curves = stored.table.content()
    eta, D = stored.table.difference.peak
    return {
        "schema": 1,
        **stored.address,
        "state": stored.state.word,
        "keys": key_ids(stored),
        "answer": answer(stored),
        "decelerations": stored.table.paper.decelerations,
        "peak": {"eta": eta, "D": D},
        "record": record,
        "curves": curves,
    }


def _answer(stored: "Stored") -> str:
    from calib.store.answer import answer

    said = answer(stored)
    low, high = said.decelerations
    rows = [
        ("to be used", said.may),
        ("usable", f"{low:.2f} to {high:.2f} g, eta - 1 up to {100 * (said.eta[1] - 1):.2f} %"),
        ("limited by", said.limit),
        *(("warning", str(warning)) for warning in stored.table.warnings),
        ("next", said.next),
    ]
    return _lines(rows)


def _lines(rows: "list[tuple[str, str]]") -> str:
    """Lines of name and value; not a grid, which would break a digest on a narrow terminal."""
    width = max(len(name) for name, _ in rows)
    return "\n".join(f"{name:<{width}}  {value}" for name, value in rows)


def _facts(stored: "Stored") -> str:
    from calib.store.figures import effect_figures
    from calib.store.signature import key_ids

    table = stored.table
    keys = ", ".join(key_ids(stored))
    vehicle, pads = table.vehicle, table.calibration
    facts = [
        ("table", stored.id),
        ("digest", stored.digest),
        ("signed", f"by key {keys}; `tables verify --key` checks it" if keys else "no"),
        ("vehicle", f"{vehicle.name}, {vehicle.mass:g} kg, wheelbase {vehicle.wheelbase:g} m"),
        *table.provenance.identity.items(),
        *origin_facts(table),
        *((log.role, f"{log.name} ({log.digest[:12]})") for log in table.provenance.logs),
        *((of.effect, str(of)) for of in effect_figures(table)),
        ("pad scale", _interval(pads.pad_scale)),
        ("pad friction front", _interval(pads.pad_friction_f)),
        ("pad friction rear", _interval(pads.pad_friction_r)),
        ("deceleration", "{:.3f} to {:.3f} g".format(*table.paper.usable)),
        ("D peak", "eta {:.5f}, D {:.4f}".format(*table.difference.peak)),
        *((figure, f"{number:.4g}") for figure, number in table.quality.items()),
    ]
    return _lines(facts)


def _interval(value: "Value") -> str:
    lower, upper = value.ci95
    return f"{value.value:.4g} (95 %: {lower:.4g} to {upper:.4g})"


def _curves(table: "Table") -> "Grid":
    curve, rows = table.paper, grid("eta", "z", "f1", "f2", "blocks", fold=True)
    last = len(curve.eta) - 1
    for i in sorted({round(k * last / (ROWS - 1)) for k in range(ROWS)}):
        rows.add_row(
            f"{curve.eta[i]:.5f}",
            f"{curve.z[i]:.3f}",
            f"{curve.f1[i]:+.4f}",
            f"{curve.f2[i]:+.4f}",
            f"{curve.count[i]:g}",
        )
    return rows
