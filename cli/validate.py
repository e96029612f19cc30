"""`brake-cal validate`: run the estimator with a table on hold-out logs, and judge it."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from cli import options
from cli.command import FAILED, Answer, command
from cli.console import at_option, progress, say, this_run
from cli.exchange import Shape
from cli.logs import read
from cli.options import argument, option
from cli.outputs import check_folder, stems_of, writing
from cli.sign import Signed

if TYPE_CHECKING:
    from calib.estimation.validate import Validation
    from calib.logs.log import Log
    from calib.table.exported import Precision
    from calib.table.table import Table

CODES = ("ecu",)  # values of --as: exported code that can run in place of the estimator


@command(
    "brake-cal validate sedan-2up sample_logs/sedan/basalt_wet_pads.csv --out results",
    "brake-cal validate sedan-2up@1 sample_logs/sedan/*stop.csv --limits sample_logs/limits.toml",
    report=True,
)
def validate(
    table: options.Table,
    logs: list[Path] = argument("Hold-out logs.", "LOG..."),
    *,
    store: options.Tables,
    vehicle: options.OtherPads,
    model: options.KnownModel,
    effect: options.OwnEffects,
    mass: options.Mass,
    limits: options.StopLimits,
    shape: Shape,
    code: str | None = option(
        "Run the C code of this export.", "ecu", "--as", names="cli.validate:CODES"
    ),
    out: Path | None = option("Write LOG.parquet and summary.json here.", "DIR", writes="folder"),
    channel_map: options.Map,
    signed: Signed,
) -> Answer:
    """Run the estimator with a table on other logs, and judge it.

    What is judged is the answer of an ECU, which has no speed over ground. With --points,
    --fixed-point or --float the table is first rounded as `tables export` rounds it; --as ecu
    compiles the C code of `tables export --format ecu` and runs it. A log with neither true torques
    nor the speed over ground v proves nothing, and the answer says so. Exit code 0 if every log
    holds its limits, with warnings or without; 1 if one does not, or the table was fitted on it.
    """
    from dataclasses import replace

    from calib.base.plain import counted
    from calib.car.effects.catalogue import with_own
    from calib.car.model import with_effects
    from calib.car.model_file import read_model
    from calib.car.vehicle import require_same_car
    from calib.estimation.results import SUMMARY, to_dict, write_results
    from calib.estimation.validate import validate_one
    from calib.run.same_run import refuse_copy
    from calib.show.validation import Validated

    if out is not None:
        check_folder(out, [*(f"{stem}.parquet" for stem in stems_of(logs, "LOG")), SUMMARY])
    stored = store.load(table)
    signed.check(table, stored)
    if vehicle is not None:  # gives the nominal pads of these logs; the car is that of the table
        file = this_run().file("vehicle")
        require_same_car(stored.table.vehicle, vehicle, file, weighed=mass is not None)
    car = with_own(stored.table.vehicle, effect)
    if model is not None:
        car = with_effects(car, read_model(model, car))  # pads and tyres stay those of the table
    used_table = replace(stored.table, vehicle=car)
    precision = shape.precision(for_ecu=code is not None)
    export_arguments = _exported(used_table, precision) if precision else {}
    runs: list[Log] = []
    results: list[Validation] = []
    task = f"validating {stored.id} ({stored.state.word}) on {counted(len(logs), 'log')}"
    with progress(task, len(logs)) as step:
        for path in logs:
            run = read(path, channel_map)
            refuse_copy(run, runs)
            result = validate_one(used_table, run, vehicle, limits, mass=mass, **export_arguments)
            results.append(result)
            runs.append(run)
            step()
    summary = to_dict(stored, results, precision)
    if out is not None:
        with writing(out):
            for path in write_results(results, summary, out):
                say(f"wrote {path}")
    exit_code = 0 if all(result.passed for result in results) else FAILED
    files = this_run().files("vehicle", "model", "limits")
    return Answer(summary, Validated(stored, results, precision, files), exit_code, out)


def _exported(table: "Table", precision: "Precision") -> dict[str, Any]:
    """Return the table as exported, and its compiled code, as arguments of `validate_one`."""
    from calib.base.errors import ExchangeError, ProgramError
    from calib.table.exported import as_exported

    with at_option("--points, --fixed-point, --float", ExchangeError):
        arguments: dict[str, Any] = {"exported": as_exported(table, precision)}
    if precision.code:
        from calib.ecu.native import coded

        with at_option("--as", ProgramError):
            arguments["coded"] = coded(table, precision)
    return arguments
