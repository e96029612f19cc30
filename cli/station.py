"""`brake-cal station`, `limits`, `repeatability`: the verdict on a car, and on the gauge."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cli import options
from cli.command import FAILED, Answer, command
from cli.console import json_text, misuse, progress, say, this_run
from cli.logs import read
from cli.options import argument, option, words
from cli.outputs import check_folder, stems_of, write_file, write_folder, writing
from cli.sign import Signed

if TYPE_CHECKING:
    from calib.estimation.limits import Limit

_ID = "calib.line.station.station:identifier"
_METRICS = "calib.line.gauge.study:METRICS"
NAME = "Name of the station."
GAUGE = "repeatability.json"


@dataclass(frozen=True)
class Identifiers:
    """Identity of a run at the line, see `calib.line.station.station.TITLES`."""

    serial: Annotated[str | None, option("Serial number.", "S", make=_ID)]
    vin: Annotated[str | None, option("Vehicle identification.", "V", make=_ID)]
    station: Annotated[str | None, option(NAME, "NAME", setting="station.name", make=_ID)]
    rxswin: Annotated[str | None, option("Software identification, UN R156.", "R", make=_ID)]


@command(
    "brake-cal limits --out line.toml",
    "brake-cal station sample_logs/sedan/ramp_wet_asphalt.csv "
    "sample_logs/sedan/dry_asphalt_stop.csv sample_logs/sedan/transition_dry_to_basalt.csv "
    "--coast sample_logs/sedan/coast.csv --vehicle sample_logs/sedan/vehicle.toml "
    "--limits line.toml --serial 0815 --out runs/car-0815",
)
def station(
    ramp: Path = argument("Ramp for the fit of the table.", "RAMP"),
    holdouts: list[Path] = argument("Stops to validate it on.", "HOLDOUT..."),
    *,
    vehicle: options.Car,
    out: Path = option("Write all files here.", "DIR", writes="folder"),
    limits: "tuple[Limit, ...]" = options.limits(
        "Limits, see `brake-cal limits`.", "calib.line.station.limits_file:limits_of_car"
    ),
    coast: list[Path] = option("A coast log; repeatable.", "LOG"),
    more: list[Path] = option("A further ramp for the fit; repeatable.", "LOG", "--ramp"),
    golden: str | None = option("Golden table of the model.", "TABLE", setting="station.golden"),
    accept_warnings: str | None = option("Release with warnings, and why.", "REASON", make=words),
    by: options.By,
    identity: Identifiers,
    mass: options.Mass,
    export: list[str] = option(
        "Export as `tables export`; repeatable.",
        "F",
        names="calib.exports.export:ENDINGS",
        setting="station.export",
    ),
    store: options.Tables,
    channel_map: options.Map,
    signed: Signed,
) -> Answer:
    """Fit, validate and judge one car at the end of the line.

    Exit code 0 if every limit holds, with warnings or without, 1 if one does not. The table goes
    into the store: released where the car passed, rejected where it failed, a draft where it passed
    with warnings that nobody accepts. Only a released table is exported. With a log that cannot be
    used it ends with 3, stores nothing, and writes refused.json alone.
    """
    from calib.base.plain import counted
    from calib.base.write import work_folder
    from calib.line.station.files import outputs_of, publish_run, why_not_exported
    from calib.line.station.golden import golden_table
    from calib.line.station.station import judged_car
    from calib.show.station_page import StationRun, store_and_write

    ramps = [ramp, *more]
    identification = {name: value for name, value in vars(identity).items() if value is not None}
    stems, forms = stems_of(holdouts, "HOLDOUT"), [] if signed.public else export
    if "table" in stems:
        raise misuse("a hold-out named table takes the export's place; rename it")
    check_folder(out, outputs_of(stems, forms))
    with _telling_refusals(out, identification, [*ramps, *coast, *holdouts]):
        reference = golden_table(store, golden) if golden else None
        if golden and reference:
            say(f"{reference.id} is {reference.state.description}")
            signed.check(golden, reference)
        task = f"fitting {vehicle.name}, validating on {counted(len(holdouts), 'stop')}"
        with progress(task, len(holdouts) + 1) as step:
            fitted, coasts, stops = (
                [read(path, channel_map) for path in part] for part in (ramps, coast, holdouts)
            )
            outcome = judged_car(
                vehicle,
                fitted,
                coasts,
                stops,
                limits,
                identification,
                mass=mass,
                report=step,
                golden=reference,
                accepted=accept_warnings or "",
                by=by or "",
                limits_file=_limits_file(),
            )
        with writing(out), work_folder(out) as work:
            stored, document = store_and_write(outcome, store, forms, work)
            paths = publish_run(work, out)
    say(f"wrote {len(paths)} files to {out}")
    unsigned = "what is stored now is not signed; sign it, then `brake-cal tables export`"
    if export and (why := why_not_exported(stored) or unsigned * bool(signed.public)):
        say(f"no exports: {why}")
    return Answer(document, StationRun(outcome, stored), FAILED * (not outcome.passed), out)


def _limits_file() -> str:
    """Name and digest of the file of limits; "" if none was given."""
    from calib.base.digest import file_digest

    file = this_run().file("limits")
    return f"{file.name}, SHA-256 {file_digest(file)[:16]}" if file else ""


@contextmanager
def _telling_refusals(out: Path, identity: dict[str, str], logs: list[Path]) -> Iterator[None]:
    """Write the refusal of a car into ``out`` for the index; none of a usage error or bad store."""
    from calib.base.errors import InputError, program_failure
    from calib.line.station.files import REFUSED, write_refusal

    try:
        yield
    except Exception as error:
        is_refusal = isinstance(error, InputError) or not hasattr(error, "exit_code")
        if this_run().interrupted or not is_refusal:
            raise
        refusal = error if isinstance(error, InputError) else program_failure(error)
        with writing(out):
            write_refusal(refusal, identity, logs, out)
        say(f"no verdict; {out / REFUSED} tells the index why")
        raise


@command("brake-cal limits --out line.toml")
def limits(
    *, out: Path | None = option("File to write; else stdout.", "L.toml", writes="")
) -> Answer:
    """Write a file of all limits, ready to be edited.

    Each with its meaning, unit, default and reason. With --json also as one JSON document on
    stdout.
    """
    from calib.line.station.limits_file import document, limits_file

    text = limits_file()
    if out is not None:
        write_file(out, text.encode())
    return Answer({"limits": document()}, text.rstrip("\n") if out is None else "")


@command(
    "brake-cal repeatability --plan plan.csv --vehicle car.toml --out gauge",
    "brake-cal repeatability --plan plan.csv --metric pad_scale --limits gauge.toml",
    report=True,
)
def repeatability(
    *,
    vehicle: Path | None = option("Of logs without one in the plan.", "V.toml", setting="vehicle"),
    plan: Path = option("Columns log,car,station,road,vehicle.", "P.csv"),
    metric: list[str] = option("Only this one; repeatable.", "NAME", names=_METRICS),
    limits: Path | None = option("Limits of grr and ndc, and tolerances.", "L.toml"),
    out: Path | None = option("Write repeatability.json and .png here.", "DIR", writes="folder"),
    channel_map: options.Map,
) -> Answer:
    """Judge the calibration as a gauge, from repeated ramps.

    The ramps are of several cars. Every ramp is fitted alone; analysis of variance then splits the
    scatter of each metric into repeat, station and car. Exit code 0 if all hold their limits (%GRR
    up to 30, ndc 5 or more). A range of a metric itself in the limits file is its tolerance: %GRR
    is then given of that too.
    """
    from calib.base.plain import counted
    from calib.line.gauge.plan import read_plan, readings
    from calib.line.gauge.study import METRICS, read_gauge_limits, study, to_dict
    from calib.show.repeatability import gauge_sheet
    from calib.show.sheet import render

    check_folder(out, (GAUGE, "repeatability.png"))
    gauge_limits = read_gauge_limits(limits)
    ramps = read_plan(plan, vehicle)
    if any(ramp.vehicle is None for ramp in ramps):
        raise misuse("needed: not every log has one in the plan", "--vehicle")
    with progress(f"fitting {counted(len(ramps), 'ramp')} one by one", len(ramps)) as step:
        result = study(readings(ramps, channel_map, metric or METRICS, step), gauge_limits)
    document = to_dict(result)
    if out is not None:
        written = json_text({"schema": 1, **document}).encode()
        picture = render(gauge_sheet(result).overview(), ".png")
        write_folder(out, [(GAUGE, written), ("repeatability.png", picture)], GAUGE)
    return Answer(document, result, FAILED * (not result.passed))
