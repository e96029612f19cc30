"""`brake-cal tables diff`: how two tables differ."""

from typing import TYPE_CHECKING, Annotated

import typer

import calib
from cli.console import emit, emit_json
from cli.grid import grid
from cli.options import STORE, Json, Store, example

if TYPE_CHECKING:
    from calib.table.compare import Difference

EPILOG = example("brake-cal tables diff sedan-2up@1 sedan-2up")


def diff(
    a: Annotated[str, typer.Argument(metavar="A", help="name, name@version or path")],
    b: Annotated[str, typer.Argument(metavar="B", help="name, name@version or path")],
    store: Store = STORE,
    json: Json = False,
) -> None:
    """Compare two tables: their curves where both are defined, and their records."""
    from calib.table.compare import diff as compare

    first, second = calib.Store(store).load(a), calib.Store(store).load(b)
    difference = compare(first.table, second.table)
    if json:
        parts = {"a": first.id, "b": second.id, "identical": difference.identical}
        hands = {"by_hand": {"a": first.table.by_hand, "b": second.table.by_hand}}
        emit_json({**parts, **vars(difference), **hands})
    elif difference.identical:
        emit(f"{first.id} and {second.id} hold the same")
    else:
        _print_difference(difference, first.id, second.id)
        for stored in (first, second):
            for one in stored.table.by_hand:
                emit(f"{stored.id}: {one}")


def _print_difference(difference: "Difference", a: str, b: str) -> None:
    table = grid("curve", "from", "to", "largest", "at", "rms", "in 95 % bands", fold=True)
    for gap in difference.curves:
        numbers = (f"{gap.start:.5f}", f"{gap.end:.5f}", f"{gap.largest:+.5f}", f"{gap.at:.5f}")
        table.add_row(gap.curve, *numbers, f"{gap.rms:.5f}", f"{gap.in_bands:.2f}")
    for curve in difference.apart:
        table.add_row(curve, "no common axis")
    emit(table)
    changes = grid("section", "key", a, b, fold=True)
    for section, found in difference.changes.items():
        for change in found:
            changes.add_row(section, change.key, change.a or "-", change.b or "-")
    emit(changes)
