"""`brake-cal station`: one car, from its logs to a verdict, a report and the files of the line."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cli.console import emit, emit_json, progress, say
from cli.options import STORE, Json, Map, Store, example

if TYPE_CHECKING:
    from rich.table import Table as Grid

    from calib.station.identity import Identity
    from calib.station.station import StationOutcome
    from calib.table.version import Stored
    from calib.validation.limits import Limit

EPILOG = example(
    "brake-cal limits init --out line.toml",
    "brake-cal station sample_logs/sedan/ramp_wet_asphalt.csv "
    "sample_logs/sedan/dry_asphalt_stop.csv sample_logs/sedan/transition_dry_to_basalt.csv "
    "--coast sample_logs/sedan/coast.csv --vehicle sample_logs/sedan/vehicle.toml "
    "--limits line.toml --serial 0815 --out car-0815",
)
FAILED = 1


def station(
    ramp: Annotated[Path, typer.Argument(metavar="RAMP", help="The ramp that the table is of.")],
    holdouts: Annotated[
        list[Path], typer.Argument(metavar="HOLDOUT...", help="Stops to prove it on.")
    ],
    *,
    vehicle: Annotated[Path, typer.Option(metavar="V.toml", help="Vehicle file.")],
    out: Annotated[Path, typer.Option(metavar="DIR", help="Write everything here.")],
    limits: Annotated[
        Path | None, typer.Option(metavar="L.toml", help="Limits, see `brake-cal limits init`.")
    ] = None,
    coasts: Annotated[
        list[Path] | None, typer.Option("--coast", metavar="LOG", help="A coast log; repeatable.")
    ] = None,
    ramps: Annotated[
        list[Path] | None,
        typer.Option("--ramp", metavar="LOG", help="A further ramp for the fit; repeatable."),
    ] = None,
    golden: Annotated[
        str | None, typer.Option(metavar="TABLE@N", help="Golden table of the model.")
    ] = None,
    serial: Annotated[str | None, typer.Option(metavar="S", help="Serial number.")] = None,
    vin: Annotated[str | None, typer.Option(metavar="V", help="Vehicle identification.")] = None,
    name: Annotated[
        str | None, typer.Option("--station", metavar="NAME", help="Name of the station.")
    ] = None,
    rxswin: Annotated[
        str | None, typer.Option(metavar="R", help="Software identification, UN R156.")
    ] = None,
    exports: Annotated[
        list[str] | None,
        typer.Option("--export", metavar="F", help="Export as `tables export`; repeatable."),
    ] = None,
    date: Annotated[
        str | None, typer.Option(metavar="YYYY-MM-DD", help="Date in the history of a cdfx.")
    ] = None,
    store: Store = STORE,
    channel_map: Map = None,
    json: Json = False,
) -> None:
    """Fit, prove and judge one car: the first log is its ramp, the others are hold-outs.

    Exit code 0 if every limit holds, with warnings or without, 1 if one does not. The table goes
    into the store either way; a car that failed gets no exports. A log that will not do ends it
    with 3, and nothing is stored. The same command gives the same bytes again and no new version.
    """
    from calib.checks.gates import refuse_twice
    from calib.files import workshop
    from calib.logs.channel_map_file import read_channel_map
    from calib.logs.read import read_log
    from calib.physics.vehicle_file import read_vehicle
    from calib.station.folder import publish
    from calib.station.metrics import Car
    from calib.station.station import outcome, table_of, validated
    from calib.station.write import store_and_write
    from calib.table.store import load
    from calib.validation.validate import require_same_vehicle

    forms, count = exports or [], 1 + len(ramps or [])
    for_fit = [ramp, *(ramps or []), *(coasts or [])]
    identity = _identity(serial, vin, name, rxswin)
    _check_forms(forms, date)
    _check_golden(golden)
    given = [*for_fit, *holdouts, *(path for path in (vehicle, limits, channel_map) if path)]
    _check_out(given, holdouts, forms, out)
    car, held = read_vehicle(vehicle), _limits(limits)
    reference = load(golden, store) if golden else None
    if reference:
        require_same_vehicle(reference.table, car, vehicle)
    mapping = read_channel_map(channel_map) if channel_map else None
    with progress(f"fitting {car.name}, proving on {len(holdouts)}", len(holdouts) + 1) as done:
        logs = [read_log(path, mapping) for path in for_fit]
        table = table_of(car, logs[:count], logs[count:], identity)
        done()
        stops, results = [read_log(path, mapping) for path in holdouts], []
        refuse_twice(stops)
        for log in stops:
            results.append(validated(table, log, held))
            done()
    judged = Car(table, logs[:count], stops, results, reference.table if reference else None)
    found = outcome(judged, logs[count:], held, identity, reference.id if reference else "")
    try:
        with workshop(out) as work:
            stored, document = store_and_write(found, store, forms, date or "", work)
            paths = publish(work, out)
    except OSError as error:
        raise typer.BadParameter(
            f"{out} cannot be written ({error.strerror})", param_hint="--out"
        ) from error
    say(f"wrote {len(paths)} files to {out}")
    if json:
        emit_json(document)
    else:
        _report(found, stored, forms)
    if not found.passed:
        raise typer.Exit(FAILED)


def _identity(
    serial: str | None, vin: str | None, name: str | None, rxswin: str | None
) -> "Identity":
    from calib.station.identity import Identity

    identity = Identity(serial, vin, name, rxswin)
    flaw = identity.flaw()
    if flaw is not None:
        raise typer.BadParameter(flaw[1], param_hint=f"--{flaw[0]}")
    return identity


def _check_forms(forms: list[str], date: str | None) -> None:
    from datetime import date as day

    from calib.station.write import DATED, ENDINGS
    from calib.toml import did_you_mean

    for form in forms:
        if form not in ENDINGS:
            near = did_you_mean(form.lower(), ENDINGS)
            what = f"unknown format {form!r}; {near} " if near else f"unknown format {form!r}; "
            raise typer.BadParameter(f"{what}known: {', '.join(ENDINGS)}", param_hint="--export")
        if form in DATED and date is None:
            raise typer.BadParameter(
                f"{form} holds a date; give one, so that the same run gives the same bytes",
                param_hint="--date",
            )
    if date is not None:
        try:
            day.fromisoformat(date)
        except ValueError:
            raise typer.BadParameter(
                f"{date!r} is no date such as 2025-03-31", param_hint="--date"
            ) from None


def _check_golden(golden: str | None) -> None:
    """Refuse a table without its version: the next car would be compared with this one."""
    if golden is not None and "@" not in golden and not Path(golden).is_dir():
        raise typer.BadParameter(
            f"{golden!r} names no version, and every car adds one; give {golden}@N or a path",
            param_hint="--golden",
        )


def _check_out(inputs: list[Path], holdouts: list[Path], forms: list[str], out: Path) -> None:
    from calib.logs.tables import stem_of
    from calib.station.folder import FIXED
    from calib.station.write import export_name

    stems = [stem_of(path) for path in holdouts]
    twice = sorted({stem for stem in stems if stems.count(stem) > 1})
    if twice:
        raise typer.BadParameter(
            f"two hold-outs are named {twice[0]}, and --out has one file a name",
            param_hint="HOLDOUT",
        )
    if "table" in stems:
        raise typer.BadParameter("a hold-out named table takes the export's place; rename it")
    if out.exists() and not out.is_dir():
        raise typer.BadParameter(f"{out} is a file", param_hint="--out")
    names = [*FIXED, *map(export_name, forms), *(f"{stem}.parquet" for stem in stems)]
    written = {(out / name).resolve() for name in names}
    lost = [path for path in inputs if path.resolve() in written]
    if lost:
        raise typer.BadParameter(f"would overwrite {lost[0]}", param_hint="--out")


def _limits(path: Path | None) -> "tuple[Limit, ...]":
    from calib.station.advice import LIMITS
    from calib.station.metrics import METRICS as OF_CAR
    from calib.validation.limits_file import read_limits
    from calib.validation.metrics import METRICS as OF_STOPS

    return read_limits(path, {*OF_STOPS, *OF_CAR}) if path else LIMITS


def _report(found: "StationOutcome", stored: "Stored", forms: list[str]) -> None:
    from calib.station.advice import action
    from calib.station.words import HEADINGS, sentence, summary

    emit(_grid(found))
    for check in found.with_verdict("failed") + found.with_verdict("warning"):
        emit(f"{check.verdict}: {sentence(check)}. {action(check.figure)}")
    if forms and not found.passed:
        emit("no exports: nothing of a car that failed must reach an ECU")
    emit(f"{HEADINGS[found.verdict]}: {stored.id}, {summary(found)}")


def _grid(found: "StationOutcome") -> "Grid":
    from rich.table import Table

    from calib.station.words import bounds, value_of

    grid = Table(box=None, header_style="bold", pad_edge=False)
    for title in ("scope", "figure", "value", "no warning", "limit", "verdict"):
        grid.add_column(title, justify="right" if title == "value" else "left")
    for check in found.checks:
        j = check.judgement
        warn, fail = bounds(j.warn_low, j.warn_high), bounds(j.low, j.high)
        grid.add_row(check.scope, check.figure, value_of(check), warn, fail, check.verdict)
    return grid
