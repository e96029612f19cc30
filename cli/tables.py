"""`brake-cal tables`: what a store holds, what a table says, how two differ, what is damaged.

`export` is in `cli.export`, `import` in `cli.read_back`.
"""

from typing import TYPE_CHECKING, Annotated

import typer

from cli import export, read_back
from cli.console import emit, emit_json
from cli.options import STORE, Json, Store, example

if TYPE_CHECKING:
    from rich.table import Table as Grid

    from calib.table.compare import Difference
    from calib.table.table import Table, Value
    from calib.table.version import Stored

DAMAGED = 4
"""Exit code of a damaged store, as `StoreError` has it."""
ROWS = 12
"""Rows of f1 and f2 that `show` prints; all of them are in the JSON."""

Reference = Annotated[
    str, typer.Argument(metavar="TABLE", help="name, name@version or path of a version")
]

app = typer.Typer(
    rich_markup_mode=None, no_args_is_help=True, epilog=example("brake-cal tables list")
)


@app.callback()
def tables() -> None:
    """Look into the store of tables."""


@app.command("list", epilog=example("brake-cal tables list"))
def list_tables(store: Store = STORE, json: Json = False) -> None:
    """List every version of every table."""
    from calib.table.store import listing

    entries = listing(store)
    if json:
        rows = [{"id": e.id, **vars(e)} for e in entries]
        emit_json({"store": store, "tables": rows})
        return
    grid = _grid("table", "digest", "logs")
    for entry in entries:
        digest = entry.digest[:12] if entry.digest else "cannot be read"
        grid.add_row(entry.id, digest, ", ".join(entry.logs))
    emit(grid if entries else f"{store} holds no table")


@app.command(epilog=example("brake-cal tables show sedan-2up"))
def show(table: Reference, store: Store = STORE, json: Json = False) -> None:
    """Print what a table rests on, how good it is, and its curves."""
    from calib.table.store import load

    stored = load(table, store)
    if json:
        emit_json(_document(stored))
        return
    emit(_facts(stored))
    emit(_curves(stored.table))
    for remark in stored.table.remarks:
        emit(f"- {remark}")


@app.command(epilog=example("brake-cal tables diff sedan-2up@1 sedan-2up"))
def diff(
    a: Annotated[str, typer.Argument(metavar="A", help="name, name@version or path")],
    b: Annotated[str, typer.Argument(metavar="B", help="name, name@version or path")],
    store: Store = STORE,
    json: Json = False,
) -> None:
    """Compare two tables: their curves where both are defined, and their records."""
    from calib.table.compare import diff as compare
    from calib.table.store import load

    first, second = load(a, store), load(b, store)
    difference = compare(first.table, second.table)
    if json:
        parts = {"a": first.id, "b": second.id, "identical": difference.identical}
        emit_json({**parts, **vars(difference)})
    elif difference.identical:
        emit(f"{first.id} and {second.id} hold the same")
    else:
        _print_difference(difference, first.id, second.id)


@app.command(epilog=example("brake-cal tables verify"))
def verify(
    name: Annotated[str | None, typer.Argument(help="one table; all without it")] = None,
    store: Store = STORE,
    json: Json = False,
) -> None:
    """Recompute digests and invariants of every version; exit code 4 when one is damaged."""
    from calib.table.store import verify as verdicts_of

    verdicts = verdicts_of(store, name)
    sound = all(v.sound for v in verdicts)
    if json:
        rows = [{"id": v.id, "sound": v.sound, "violations": v.violations} for v in verdicts]
        emit_json({"store": store, "sound": sound, "versions": rows})
    else:
        grid = _grid("table", "verdict")
        for verdict in verdicts:
            grid.add_row(verdict.id, "\n".join(verdict.violations) or "sound")
        emit(grid if verdicts else f"{store} holds no table")
    if not sound:
        raise typer.Exit(DAMAGED)


app.command("export", epilog=export.EPILOG)(export.export_table)
app.command("import", epilog=read_back.EPILOG)(read_back.import_table)


def _grid(*heads: str) -> "Grid":
    from rich.table import Table as Grid

    grid = Grid(box=None, header_style="bold", pad_edge=False)
    for head in heads:
        grid.add_column(head, overflow="fold")
    return grid


def _document(stored: "Stored") -> dict[str, object]:
    record, curves = stored.table.content()
    eta, D = stored.table.difference.peak
    return {
        "id": stored.id,
        "name": stored.name,
        "version": stored.version,
        "digest": stored.digest,
        "path": stored.path,
        "decelerations": stored.table.paper.decelerations,
        "peak": {"eta": eta, "D": D},
        "record": record,
        "curves": curves,
    }


def _facts(stored: "Stored") -> str:
    """Lines of name and value; not a grid, which would break a digest on a narrow terminal."""
    table = stored.table
    vehicle, pads = table.vehicle, table.calibration
    facts = [
        ("table", stored.id),
        ("digest", stored.digest),
        ("vehicle", f"{vehicle.name}, {vehicle.mass:g} kg, wheelbase {vehicle.wheelbase:g} m"),
        *table.provenance.identity.items(),
        *((log.role, f"{log.name} ({log.digest[:12]})") for log in table.provenance.logs),
        *(
            (effect, f"{parameter} {_interval(value)} {_unit(effect, parameter)}")
            for effect, parameters in table.effect_values.items()
            for parameter, value in parameters.items()
        ),
        ("pad scale", _interval(pads.pad_scale)),
        ("pad friction front", _interval(pads.pad_friction_f)),
        ("pad friction rear", _interval(pads.pad_friction_r)),
        ("deceleration", "{:.3f} to {:.3f} g".format(*table.paper.decelerations)),
        ("D peak", "eta {:.5f}, D {:.4f}".format(*table.difference.peak)),
        *((figure, f"{number:.4g}") for figure, number in table.quality.items()),
    ]
    width = max(len(name) for name, _ in facts)
    return "\n".join(f"{name:<{width}}  {value}" for name, value in facts)


def _interval(value: "Value") -> str:
    lower, upper = value.ci95
    return f"{value.value:.4g} (95 %: {lower:.4g} to {upper:.4g})"


def _unit(effect: str, parameter: str) -> str:
    """Unit on the effect's card; an effect of another catalogue is in SI all the same."""
    from calib.physics.effects.catalogue import CATALOGUE

    card = CATALOGUE[effect].card if effect in CATALOGUE else None
    units = {p.name: p.unit for p in card.parameters} if card else {}
    return units.get(parameter, "SI")


def _curves(table: "Table") -> "Grid":
    curve, grid = table.paper, _grid("eta", "z", "f1", "f2", "blocks")
    last = len(curve.eta) - 1
    for i in sorted({round(k * last / (ROWS - 1)) for k in range(ROWS)}):
        grid.add_row(
            f"{curve.eta[i]:.5f}",
            f"{curve.z[i]:.3f}",
            f"{curve.f1[i]:+.4f}",
            f"{curve.f2[i]:+.4f}",
            f"{curve.count[i]:g}",
        )
    return grid


def _print_difference(difference: "Difference", a: str, b: str) -> None:
    grid = _grid("curve", "from", "to", "largest", "at", "rms", "in 95 % bands")
    for gap in difference.curves:
        numbers = (f"{gap.start:.5f}", f"{gap.end:.5f}", f"{gap.largest:+.5f}", f"{gap.at:.5f}")
        grid.add_row(gap.curve, *numbers, f"{gap.rms:.5f}", f"{gap.in_bands:.2f}")
    for curve in difference.apart:
        grid.add_row(curve, "no common axis")
    emit(grid)
    changes = _grid("section", "key", a, b)
    for section, found in difference.changes.items():
        for change in found:
            changes.add_row(section, change.key, change.a or "-", change.b or "-")
    emit(changes)
