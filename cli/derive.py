"""`brake-cal tables derive`: a table that a person corrects, as a new version."""

from typing import Annotated

import typer

import calib
from cli.console import emit, emit_json
from cli.options import By, Json, Reason, Store, TableVersion, example
from cli.project import STORE

EPILOG = example(
    'brake-cal tables derive escort --set pad_friction_f=0.39 --reason "measured on the bench"'
)


def derive(
    table: TableVersion,
    *,
    settings: Annotated[
        list[str],
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="pad_friction_f, pad_friction_r, D[ETA], f1[ETA] or f2[ETA]; repeatable.",
        ),
    ],
    reason: Reason,
    by: By = None,
    store: Store = STORE,
    json: Json = False,
) -> None:
    """Correct a table by hand, as a new version.

    It names its parent, and every cell that was set is marked. D, f1 and f2 of a row are tied,
    level and ratio of the pads are, too: what moves along is told.
    """
    from calib.store.derive import derive as corrected

    kept = calib.Store(store)
    parent = kept.load(table)
    made = corrected(parent, settings, reason, by or "")
    stored = kept.save(made.table)
    if json:
        emit_json(
            {
                "schema": 1,
                **stored.address,
                "parent": {"id": parent.id, "digest": parent.digest},
                "set": made.set_,
                "moved": made.moved,
            }
        )
        return
    for one in made.set_:
        emit(str(one))
    for moved in made.moved:
        emit(f"{moved.key} moved along to {moved.new:.6g} from {moved.old:.6g}")
    emit(f"stored {stored.id}, derived from {parent.id}")
