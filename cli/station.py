"""`brake-cal station`: one car, from its logs to a verdict, a report and the files of the line."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import calib
from calib.base.plain import counted
from cli.completion import names_of, table_names
from cli.console import emit_facts, emit_json, progress, say, warn
from cli.inputs import (
    channel_map_of,
    golden_of,
    limits_of_car,
    mass_of,
    require_day,
    tell_kin,
    unknown_format,
)
from cli.logs import read, refuse_stdin
from cli.options import (
    By,
    Json,
    Map,
    Mass,
    Store,
    VehicleFile,
    example,
    grouped,
    limits_file,
    out_folder,
)
from cli.outputs import ready_folder, refuse_overwriting, stems_of, writing
from cli.project import STORE, from_settings
from cli.signed import Signing, check_signed

if TYPE_CHECKING:
    from calib.line.station.identity import Identity
    from calib.line.station.station import StationOutcome
    from calib.store.version import Stored

EPILOG = example(
    "brake-cal limits init --out line.toml",
    "brake-cal station sample_logs/sedan/ramp_wet_asphalt.csv "
    "sample_logs/sedan/dry_asphalt_stop.csv sample_logs/sedan/transition_dry_to_basalt.csv "
    "--coast sample_logs/sedan/coast.csv --vehicle sample_logs/sedan/vehicle.toml "
    "--limits line.toml --serial 0815 --out runs/car-0815",
)
FAILED = 1


@dataclass(frozen=True)
class MoreLogs:
    """Logs for the fit besides the ramp."""

    coasts: Annotated[
        list[Path] | None, typer.Option("--coast", metavar="LOG", help="A coast log; repeatable.")
    ] = None
    ramps: Annotated[
        list[Path] | None,
        typer.Option("--ramp", metavar="LOG", help="A further ramp for the fit; repeatable."),
    ] = None


@dataclass(frozen=True)
class IdentityOptions:
    """Identifiers of the car at the line."""

    serial: Annotated[str | None, typer.Option(metavar="S", help="Serial number.")] = None
    vin: Annotated[str | None, typer.Option(metavar="V", help="Vehicle identification.")] = None
    name: Annotated[
        str | None,
        typer.Option(
            "--station",
            metavar="NAME",
            help="Name of the station.",
            callback=from_settings("station"),
        ),
    ] = None
    rxswin: Annotated[
        str | None, typer.Option(metavar="R", help="Software identification, UN R156.")
    ] = None

    def identity(self) -> "Identity":
        """The identity of the run; refuses an identifier that is not valid."""
        from calib.line.station.identity import Identity

        identity = Identity(self.serial, self.vin, self.name, self.rxswin)
        flaw = identity.flaw()
        if flaw is not None:
            raise typer.BadParameter(flaw[1], param_hint=f"--{flaw[0]}")
        if doubt := identity.doubt():
            say(doubt)
        return identity


@dataclass(frozen=True)
class ExportOptions:
    """Files for the ECU."""

    exports: Annotated[
        list[str] | None,
        typer.Option(
            "--export",
            metavar="F",
            help="Export as `tables export`; repeatable.",
            autocompletion=names_of("calib.exports.export", "ENDINGS"),
            callback=from_settings("export"),
        ),
    ] = None
    date: Annotated[
        str | None,
        typer.Option(
            metavar="YYYY-MM-DD",
            help="Date of the report and in a cdfx, which else has that of storing the table.",
        ),
    ] = None

    def forms(self) -> list[str]:
        """The formats; refuses an unknown one, and a date that is not valid."""
        from calib.exports.export import ENDINGS

        forms = self.exports or []
        for form in forms:
            if form not in ENDINGS:
                raise unknown_format(form, form.lower(), ENDINGS, "--export")
        require_day(self.date, "--date")
        return forms


@grouped
def station(
    ramp: Annotated[Path, typer.Argument(metavar="RAMP", help="Ramp for the fit of the table.")],
    holdouts: Annotated[
        list[Path], typer.Argument(metavar="HOLDOUT...", help="Stops to validate it on.")
    ],
    *,
    vehicle: VehicleFile,
    out: Annotated[Path, out_folder("Write all files here.")],
    limits: Annotated[
        Path | None,
        limits_file("Limits, see `brake-cal limits init`.", callback=from_settings("limits")),
    ] = None,
    more: MoreLogs,
    golden: Annotated[
        str | None,
        typer.Option(
            metavar="TABLE",
            help="Golden table of the model; a bare name is its newest released version.",
            autocompletion=table_names,
            callback=from_settings("golden"),
        ),
    ] = None,
    accept: Annotated[
        str | None,
        typer.Option(
            "--accept-warnings", metavar="REASON", help="Release a car with warnings, and say why."
        ),
    ] = None,
    by: By = None,
    line: IdentityOptions,
    mass: Mass = None,
    ecu: ExportOptions,
    store: Store = STORE,
    channel_map: Map = None,
    signing: Signing,
    json: Json = False,
) -> None:
    """Fit, validate and judge one car at the end of the line.

    The first log is its ramp, the others are hold-outs. Exit code 0 if every limit holds, with
    warnings or without, 1 if one does not. The table goes into the store: released where the car
    passed, rejected where it failed, a draft where it passed with warnings that nobody accepts.
    Only a released table is exported. With a log that cannot be used it ends with 3, stores
    nothing, and writes refused.json alone, which says why on the index of the line. The same
    command gives the same bytes and no new version.
    """
    from calib.base.publish import workshop
    from calib.car.vehicle_file import read_vehicle
    from calib.estimation.validate import require_same_vehicle
    from calib.line.station.folder import publish_run
    from calib.line.station.metrics import Car
    from calib.line.station.station import outcome, table_of, validated
    from calib.run.gates import refuse_copies
    from calib.show.station_files import store_and_write

    ramps, coasts = [ramp, *(more.ramps or [])], more.coasts or []
    refuse_stdin([*ramps, *coasts, *holdouts])
    identity, forms, weight = line.identity(), ecu.forms(), mass_of(mass)
    public = signing.public()
    if accept is not None and not accept.strip():
        raise typer.BadParameter("says nothing", param_hint="--accept-warnings")
    if public and forms:
        say("no exports: what is stored now is not signed; sign it, then `brake-cal tables export`")
        forms = []
    outputs = _outputs(holdouts, forms, out)
    refuse_overwriting(outputs, [*ramps, *coasts, *holdouts], [vehicle, limits, channel_map])
    with _telling_refusals(out, identity, [*ramps, *coasts, *holdouts]):
        car, held = read_vehicle(vehicle), limits_of_car(limits)
        reference = golden_of(store, golden) if golden else None
        if golden and reference:
            check_signed(golden, reference, public)
            require_same_vehicle(reference.table, car, vehicle)
        mapping = channel_map_of(channel_map)
        with progress(
            f"fitting {car.name}, validating on {counted(len(holdouts), 'stop')}", len(holdouts) + 1
        ) as done:
            ramp_logs = [read(path, mapping) for path in ramps]
            coast_logs = [read(path, mapping) for path in coasts]
            table = table_of(car, ramp_logs, coast_logs, identity, weight)
            done()
            stops, results = [read(path, mapping) for path in holdouts], []
            refuse_copies([*ramp_logs, *coast_logs], stops)
            for log in stops:
                results.append(validated(table, log, held, weight))
                done()
        judged = Car(table, ramp_logs, stops, results, reference.table if reference else None)
        named = reference.id if reference else ""
        told = _limits_file(limits)
        found = outcome(judged, coast_logs, held, identity, named, accept or "", by or "", told)
        with writing(out), workshop(out) as work:
            stored, document = store_and_write(
                found, calib.Store(store), forms, ecu.date or "", work
            )
            paths = publish_run(work, out)
    say(f"wrote {len(paths)} files to {out}")
    _tell_addresses(stored, forms)
    tell_kin(store, stored)
    warn(found.warnings)
    if json:
        emit_json(document)
    else:
        _report(found, stored, forms)
    if not found.passed:
        raise typer.Exit(FAILED)


@contextmanager
def _telling_refusals(out: Path, identity: "Identity", logs: list[Path]) -> Iterator[None]:
    """Leave word in ``out`` of a car that cannot be judged, so that the index of the line has it.

    Not of a mistake in what was typed, nor of a store that is damaged: they say nothing of a car.
    """
    from calib.base.errors import InputError
    from calib.line.station.folder import REFUSED
    from calib.line.station.refused import write_refusal

    try:
        yield
    except InputError as error:
        with writing(out):
            write_refusal(error, identity, logs, out)
        say(f"no verdict; {out / REFUSED} tells the index why")
        raise


def _limits_file(path: Path | None) -> str:
    """Name and digest of the limits, as the report tells them; empty for those of the program."""
    from calib.base.digest import file_digest

    return f"{path.name}, SHA-256 {file_digest(path)[:16]}" if path else ""


def _outputs(holdouts: list[Path], forms: list[str], out: Path) -> list[Path]:
    """Every file that will be written; refuses two files of the same name."""
    from calib.line.station.folder import FIXED, REFUSED, export_name

    stems = stems_of(holdouts, "HOLDOUT", "hold-outs")
    if "table" in stems:
        raise typer.BadParameter("a hold-out named table takes the export's place; rename it")
    names = [*FIXED, REFUSED, *map(export_name, forms), *(f"{stem}.parquet" for stem in stems)]
    ready_folder(out, names)
    return [out / name for name in names]


def _tell_addresses(stored: "Stored", forms: list[str]) -> None:
    """Say that the exports with addresses have none: the station knows no linked program."""
    from calib.exports.export import ADDRESSED, NOWHERE
    from calib.line.station.folder import export_name

    for form in forms:
        if form in ADDRESSED and stored.state.released:
            say(f"{export_name(form)}: {'; '.join(NOWHERE.remarks)}")


def _report(found: "StationOutcome", stored: "Stored", forms: list[str]) -> None:
    from calib.show.station_page import facts
    from calib.store.state import DRAFT

    emit_facts(facts(found, stored))
    if forms and not stored.state.released:
        say("no exports: only a released table may reach an ECU")
    if found.passed and not stored.state.usable:
        say("a person decides: `brake-cal tables release` with this station.json as --evidence")
    if stored.state.word == DRAFT:
        say("release it with --accept-warnings REASON, or later with `brake-cal tables release`")
