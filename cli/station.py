"""`brake-cal station`, `limits`, `repeatability`: judge a car, and the calibration itself."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cli import options
from cli.command import FAILED, Answer, command
from cli.console import json_text, progress, say, this_run, usage_error
from cli.logs import read
from cli.options import argument, not_empty, option
from cli.outputs import check_folder, stems_of, write_file, write_folder, writing
from cli.sign import Signed

if TYPE_CHECKING:
    from calib.estimation.limits import Limit

_ID = "calib.line.station.station:identifier"
_METRICS, _FORMATS = "calib.line.gauge.study:METRICS", "calib.exports.export:ENDINGS"
GAUGE = "repeatability.json"


@dataclass(frozen=True)
class Identifiers:
    """Options that identify a run at the line, see `calib.line.station.station.TITLES`."""

    serial: Annotated[str | None, option("Serial number.", "S", make=_ID)]
    vin: Annotated[str | None, option("Vehicle identification.", "V", make=_ID)]
    station: Annotated[str | None, option("Station.", "NAME", setting="station.name", make=_ID)]
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
    further_ramps: list[Path] = option("A further ramp for the fit; repeatable.", "LOG", "--ramp"),
    golden: str | None = option("Golden table of the model.", "TABLE", setting="station.golden"),
    accept_warnings: str | None = option("Release in spite of warnings.", "REASON", make=not_empty),
    by: options.By,
    identity: Identifiers,
    mass: options.Mass,
    export: list[str] = option(
        "Format to export; repeatable.", "F", names=_FORMATS, setting="station.export"
    ),
    store: options.Tables,
    channel_map: options.Map,
    signed: Signed,
) -> Answer:
    """Fit, validate and judge one car at the end of the line.

    The table goes into the store: released where the car passed, rejected where it failed, a draft
    where it passed with warnings that nobody accepts. Only a released table is exported. Exit code
    0 if every limit holds, with warnings or without, 1 if one does not. With a log that cannot be
    used nothing is stored, refused.json alone is written, and the exit code is 3.
    """
    from calib.base.digest import file_digest
    from calib.base.plain import counted
    from calib.base.write import work_folder
    from calib.line.station.files import outputs_of, publish_run, why_not_exported
    from calib.line.station.golden import golden_table
    from calib.line.station.station import judged_car
    from calib.show.station_page import StationRun, store_and_write

    ramps = [ramp, *further_ramps]
    file = this_run().file("limits")
    limits_file = f"{file.name}, SHA-256 {file_digest(file)[:16]}" if file else ""
    identification = {name: value for name, value in vars(identity).items() if value is not None}
    stems = stems_of(holdouts, "HOLDOUT")
    if "table" in stems:
        raise usage_error("table is the name of the exported file; rename this hold-out", "HOLDOUT")
    forms = [] if signed.public else export  # the new version has no signature yet
    check_folder(out, outputs_of(stems, forms))
    with _refusals_written(out, identification, [*ramps, *coast, *holdouts]):
        reference = None
        if golden:
            reference = golden_table(store, golden)
            say(f"{reference.id} is {reference.state.description}")
            signed.check(golden, reference)
        task = f"fitting {vehicle.name}, validating on {counted(len(holdouts), 'stop')}"
        with progress(task, len(holdouts) + 1) as step:
            outcome = judged_car(
                vehicle,
                [read(path, channel_map) for path in ramps],
                [read(path, channel_map) for path in coast],
                [read(path, channel_map) for path in holdouts],
                limits,
                identification,
                mass=mass,
                report=step,
                golden=reference,
                accepted=accept_warnings or "",
                by=by or "",
                limits_file=limits_file,
            )
        with writing(out), work_folder(out) as work:
            stored, document = store_and_write(outcome, store, forms, work)
            paths = publish_run(work, out)
    say(f"wrote {len(paths)} files to {out}")
    why = why_not_exported(stored)
    if signed.public and not why:
        why = "the new version is not signed; sign it, then use `brake-cal tables export`"
    if export and why:
        say(f"no exports: {why}")
    code = 0 if outcome.passed else FAILED
    return Answer(document, StationRun(outcome, stored), code, out)


@contextmanager
def _refusals_written(out: Path, identity: dict[str, str], logs: list[Path]) -> Iterator[None]:
    """Write into ``out`` the error for which a car cannot be judged, and raise it again."""
    from calib.base.errors import InputError, program_failure
    from calib.line.station.files import REFUSED, write_refusal

    try:
        yield
    except Exception as error:
        is_fault_of_program = not hasattr(error, "exit_code")  # an error that we expect has one
        if this_run().interrupted or not (isinstance(error, InputError) or is_fault_of_program):
            raise
        refusal = error if isinstance(error, InputError) else program_failure(error)
        with writing(out):
            write_refusal(refusal, identity, logs, out)
        say(f"no verdict; {out / REFUSED} says why")
        raise


@command("brake-cal limits --out line.toml")
def limits(
    *, out: Path | None = option("File to write, else stdout.", "L.toml", writes="")
) -> Answer:
    """Write a file of all limits, ready to be edited.

    Each limit has its meaning, unit, default and reason.
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
    vehicle: Path | None = option("Vehicle, if the plan has none.", "V.toml", setting="vehicle"),
    plan: Path = option("CSV with columns log,car,station,road,vehicle.", "P.csv"),
    metric: list[str] = option("Study only this metric; repeatable.", "NAME", names=_METRICS),
    limits: Path | None = option("File with limits of grr and ndc, and tolerances.", "L.toml"),
    out: Path | None = option("Write repeatability.json and .png here.", "DIR", writes="folder"),
    channel_map: options.Map,
) -> Answer:
    """Judge the calibration as a gauge, from repeated ramps.

    Every ramp of several cars is fitted alone; analysis of variance then splits the scatter of each
    metric into repeat, station and car. The range of a metric in the limits file is its tolerance;
    %GRR is then also told as a share of this tolerance. Exit code 0 if all metrics hold their
    limits (%GRR up to 30, ndc 5 or more), 1 if one does not.
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
        raise usage_error("missing; a log of the plan has no vehicle", "--vehicle")
    with progress(f"fitting {counted(len(ramps), 'ramp')} one by one", len(ramps)) as step:
        result = study(readings(ramps, channel_map, metric or METRICS, step), gauge_limits)
    document = to_dict(result)
    if out is not None:
        written = json_text({"schema": 1, **document}).encode()
        picture = render(gauge_sheet(result).overview(), ".png")
        write_folder(out, [(GAUGE, written), ("repeatability.png", picture)], GAUGE)
    return Answer(document, result, 0 if result.passed else FAILED)
