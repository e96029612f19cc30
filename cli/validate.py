"""`brake-cal validate`: the estimator with a table on hold-out logs, its metrics and verdict."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import calib
from calib.base.errors import LogError
from cli.completion import table_names
from cli.console import complain, emit_facts, emit_json, progress, say, warn
from cli.inputs import channel_map_of, limits_of_stops, mass_of, vehicle_of, with_own_effects
from cli.logs import named, read
from cli.options import (
    Json,
    KnownModel,
    Map,
    Mass,
    OwnEffects,
    Report,
    Store,
    example,
    grouped,
    limits_file,
    out_folder,
    vehicle_file,
)
from cli.outputs import (
    ready_folder,
    refuse_overwriting,
    refuse_report,
    stems_of,
    today,
    write_report,
    writing,
)
from cli.project import STORE, from_settings
from cli.signed import Signing, check_signed

if TYPE_CHECKING:
    from calib.car.vehicle import Vehicle
    from calib.estimation.validate import Validation
    from calib.logs.log import Log
    from calib.store.version import Stored
    from calib.table.table import Table

EPILOG = example(
    "brake-cal validate sedan-2up sample_logs/sedan/basalt_wet_pads.csv --out results",
    "brake-cal validate sedan-2up@1 sample_logs/sedan/*stop.csv --limits sample_logs/limits.toml",
)
FAILED = 1


@grouped
def validate(
    table: Annotated[
        str,
        typer.Argument(
            metavar="TABLE", help="name, name@version or path", autocompletion=table_names
        ),
    ],
    logs: Annotated[list[Path], typer.Argument(metavar="LOG...", help="Hold-out logs.")],
    *,
    store: Store = STORE,
    vehicle: Annotated[
        Path | None,
        vehicle_file("Other nominal pads than the table's; never the settings' vehicle."),
    ] = None,
    model: KnownModel = None,
    effect: OwnEffects = None,
    mass: Mass = None,
    limits: Annotated[
        Path | None,
        limits_file("Limits that decide pass or fail.", callback=from_settings("limits")),
    ] = None,
    out: Annotated[Path | None, out_folder("Write LOG.parquet and summary.json here.")] = None,
    report: Report = None,
    channel_map: Map = None,
    signing: Signing,
    json: Json = False,
) -> None:
    """Run the estimator with a table on other logs, and judge it.

    The logs must not be part of the table's fit.

    Exit code 0 if every log holds its limits, with warnings or without, 1 if one does not, or is
    one that the table was fitted on.
    """
    from calib.estimation.validate import (
        all_warnings,
        require_same_vehicle,
        to_dict,
        validate_one,
    )
    from calib.run.gates import refuse_copy

    named(logs)
    _check_out(logs, out)
    refuse_report(report, logs, [vehicle, model, limits, channel_map])
    weight, public = mass_of(mass), signing.public()
    stored = calib.Store(store).load(table)
    check_signed(table, stored, public)
    car = vehicle_of(vehicle)
    require_same_vehicle(stored.table, car, vehicle, weight)
    used = _with_own(stored.table, effect)
    used = _with_known(used, model) if model else used
    held = limits_of_stops(limits)
    mapping = channel_map_of(channel_map)
    results: list[Validation] = []
    runs: list[Log] = []
    refused: list[LogError] = []
    told = f"{stored.id} ({stored.state.word})"
    plural = "s" * (len(logs) > 1)
    with progress(f"validating {told} on {len(logs)} log{plural}", len(logs)) as done:
        for path in logs:
            try:
                run = read(path, mapping)
                refuse_copy(run, [], runs)
                results.append(validate_one(used, run, car, held, mass=weight))
                runs.append(run)
            except LogError as error:
                refused.append(error)
            done()
    _none_refused(refused, len(logs))
    summary = to_dict(stored, results)
    warn(all_warnings(used.warnings, results))
    if out is not None:
        _write(results, summary, out)
    if report is not None:
        files = {"vehicle": vehicle, "model": model, "limits": limits, "channel map": channel_map}
        write_report(report, _page(stored, used, car, runs, results, files))
    if json:
        emit_json(summary)
    else:
        from calib.show.validation import facts

        emit_facts(facts(stored, results))
    if not all(result.passed for result in results):
        raise typer.Exit(FAILED)


def _none_refused(refused: list[LogError], of: int) -> None:
    """Raise the last of the errors, after all others; without every log there are no results."""
    if not refused:
        return
    for error in refused[:-1]:
        complain(str(error))
    if of > 1:
        say(f"{len(refused)} of {of} logs cannot be used, so there are no results:")
    raise refused[-1]


def _with_own(table: "Table", files: list[Path] | None) -> "Table":
    """The table with the files of its own effects."""
    from dataclasses import replace

    return replace(table, vehicle=with_own_effects(table.vehicle, files))


def _with_known(table: "Table", path: Path) -> "Table":
    """The table with the effects of a model added to its own; its pads stay the table's."""
    from dataclasses import replace

    from calib.car.model import with_effects
    from calib.car.model_file import read_model

    model = read_model(path, table.vehicle)
    return replace(table, vehicle=with_effects(table.vehicle, model))


def _check_out(logs: list[Path], out: Path | None) -> None:
    from calib.estimation.results import SUMMARY

    if out is None:
        return
    names = [*(f"{stem}.parquet" for stem in stems_of(named(logs), "LOG")), SUMMARY]
    refuse_overwriting((out / name for name in names), logs)
    ready_folder(out, names)


def _write(results: "list[Validation]", summary: dict[str, object], out: Path) -> None:
    from calib.estimation.results import write_results

    with writing(out):
        paths = write_results(results, summary, out)
    for path in paths:
        say(f"wrote {path}")


def _page(
    stored: "Stored",
    used: "Table",
    car: "Vehicle | None",
    runs: "list[Log]",
    results: "list[Validation]",
    files: dict[str, Path | None],
) -> str:
    from calib.show.html import page_of
    from calib.show.origin import origin_of
    from calib.show.trace import from_validation
    from calib.show.validation import report

    traces = [
        from_validation(used, stored.id, run, result, car)
        for run, result in zip(runs, results, strict=True)
    ]
    return page_of(report(stored, results, traces, origin_of(today(), files)))
