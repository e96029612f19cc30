"""`brake-cal tables diff`: whether two tables differ, and where."""

from typing import TYPE_CHECKING, Annotated

import typer

import calib
from cli.completion import table_names
from cli.console import emit, emit_json
from cli.grid import grid
from cli.options import Json, Store, example
from cli.project import STORE

if TYPE_CHECKING:
    from rich.table import Table as Grid

    from calib.table.compare import CurveGap, Difference, RecordChange, ValueGap

EPILOG = example("brake-cal tables diff sedan-2up@1 sedan-2up")
PRINTED = ("name", "vehicle", "effects", "provenance", "quality")
"""Sections whose changed keys are printed; of the others only how many there are."""


def diff(
    a: Annotated[
        str,
        typer.Argument(metavar="A", help="name, name@version or path", autocompletion=table_names),
    ],
    b: Annotated[
        str,
        typer.Argument(metavar="B", help="name, name@version or path", autocompletion=table_names),
    ],
    store: Store = STORE,
    json: Json = False,
) -> None:
    """Say whether and where two tables differ.

    They are equal, equal within their 95 % bands, or different. The JSON document holds every key
    of their records that differs.
    """
    from calib.table.compare import diff as compare

    first, second = (calib.Store(store).load(reference) for reference in (a, b))
    difference = compare(first.table, second.table)
    if json:
        states = {"a": first.state.word, "b": second.state.word}
        head = {"schema": 1, "a": first.id, "b": second.id, "states": states}
        emit_json(
            {
                **head,
                "verdict": difference.verdict,
                "identical": difference.identical,
                **vars(difference),
                "by_hand": {"a": first.table.by_hand, "b": second.table.by_hand},
            }
        )
        return
    one, other = (f"{stored.id} ({stored.state.word})" for stored in (first, second))
    emit(f"{one} and {other} are {difference.verdict}")
    for gap in difference.beyond:
        emit(f"  {_words(gap)}")
    if not difference.identical:
        _print_difference(difference, first.id, second.id)
        for stored in (first, second):
            for cell in stored.table.by_hand:
                emit(f"{stored.id}: {cell}")


def _words(gap: "CurveGap | ValueGap") -> str:
    from calib.table.compare import ValueGap

    if isinstance(gap, ValueGap):
        return f"{gap.name}: {gap.a:.4g} and {gap.b:.4g}, {_bands(gap.in_bands)}"
    axis = "slip" if gap.curve == "g" else "eta"
    return f"{gap.curve}: {gap.largest:+.4g} at {axis} {gap.at:.5f}, {_bands(gap.in_bands)} at most"


def _bands(count: float) -> str:
    return "beyond any band" if count == float("inf") else f"{count:.1f} times the bands of both"


def _print_difference(difference: "Difference", a: str, b: str) -> None:
    curves = grid("curve", "from", "to", "largest", "at", "rms", "in 95 % bands", fold=True)
    for gap in difference.curves:
        numbers = (f"{gap.start:.5f}", f"{gap.end:.5f}", f"{gap.largest:+.5f}", f"{gap.at:.5f}")
        curves.add_row(gap.curve, *numbers, f"{gap.rms:.5f}", f"{gap.in_bands:.2f}")
    for curve in difference.apart:
        curves.add_row(curve, "no common axis")
    emit("")
    emit(curves)
    values = grid("value", a, b, "in 95 % bands", fold=True)
    for value in difference.values:
        values.add_row(value.name, f"{value.a:.4f}", f"{value.b:.4f}", f"{value.in_bands:.2f}")
    emit("")
    emit(values)
    changes, rest = grid("section", "key", a, b, fold=True), []
    for section, found in difference.changes.items():
        if section in PRINTED:
            _add(changes, section, found)
        elif section != "calibration":
            rest.append(f"{len(found)} of {section}")
    if changes.row_count:
        emit("")
        emit(changes)
    if rest:
        emit(f"also different: {', '.join(rest)}; --json prints them")


def _add(rows: "Grid", section: str, found: "tuple[RecordChange, ...]") -> None:
    for change in found:
        rows.add_row(section, change.key, _short(change.a), _short(change.b))


def _short(written: str | None) -> str:
    """A value of a record, a number with four digits."""
    if written is None:
        return "-"
    try:
        return f"{float(written):.4g}"
    except ValueError:
        return written
