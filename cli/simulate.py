"""`brake-cal simulate`: a model driven with the pressure of a log, or through a manoeuvre."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cli.console import emit, emit_json, say
from cli.inputs import quantity_of, with_own_effects
from cli.options import Json, OwnEffects, VehicleFile, example, map_file, out_file
from cli.outputs import refuse_folder, refuse_overwriting
from cli.project import from_settings

if TYPE_CHECKING:
    from calib.logs.log import Log
    from calib.physics.model import Model

EPILOG = example(
    "brake-cal simulate --manoeuvre ramp --vehicle sample_logs/sedan/vehicle.toml --out ramp.csv",
    "brake-cal simulate ramp.csv --vehicle sample_logs/sedan/vehicle.toml --out again.csv",
)
SPEED, RATE = "120 km/h", 200.0
"""Default first speed of a manoeuvre."""


def _with_log(context: typer.Context) -> bool:
    return context.params.get("log") is not None


def simulate(
    log: Annotated[
        Path | None, typer.Argument(metavar="LOG", help="Log whose pressure is replayed.")
    ] = None,
    *,
    vehicle: VehicleFile,
    out: Annotated[Path, out_file("Log to write: .csv or .parquet.", "SIM")],
    model: Annotated[
        Path | None,
        typer.Option(metavar="M.toml", help="Pads, tyre, effects; without it the vehicle's own."),
    ] = None,
    effect: OwnEffects = None,
    manoeuvre: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="ramp, step, wave, staircase, coast; stop: no lead-in."),
    ] = None,
    speed: Annotated[
        str | None, typer.Option(help=f'First speed of the manoeuvre, "{SPEED}" if not given.')
    ] = None,
    pressure: Annotated[
        str | None, typer.Option(help='Pressure of the manoeuvre, such as "60 bar".')
    ] = None,
    rate: Annotated[
        float | None, typer.Option(help=f"Samples per second of the manoeuvre, {RATE:g}.")
    ] = None,
    noise: Annotated[
        int | None, typer.Option(metavar="SEED", min=0, help="Add sensor noise with this seed.")
    ] = None,
    channel_map: Annotated[
        Path | None, map_file(callback=from_settings("map", when=_with_log))
    ] = None,
    json: Json = False,
) -> None:
    """Drive a model of the vehicle with the pressure of a LOG, or through a manoeuvre.

    A log is replayed open loop: its pressures (of the wheels, where logged) from its first speed,
    at its own times. The result has the channels of a log and the true values.
    """
    _check_usage(log, manoeuvre, {"--speed": speed, "--pressure": pressure, "--rate": rate}, out)
    if channel_map is not None and log is None:
        raise typer.BadParameter("only with a LOG; a manoeuvre has none", param_hint="--map")
    from calib.physics.model import default_model
    from calib.physics.model_file import read_model
    from calib.physics.vehicle_file import read_vehicle
    from calib.simulation.sensor_noise import add_noise

    car = with_own_effects(read_vehicle(vehicle), effect)
    driven = read_model(model, car) if model else default_model(car)
    if log is not None:
        result = _replay(driven, log, channel_map)
    else:
        result = _drive(driven, str(manoeuvre), speed, pressure, RATE if rate is None else rate)
    output = result if noise is None else add_noise(result, noise)
    _write(output, out)
    for note in output.notes:
        say(f"note: {note}")
    if json:
        emit_json({**_document(result, out, model), "digest": output.digest, "notes": output.notes})
    else:
        first, last = result["v"][0], result["v"][-1]
        emit(f"{out}: {result.time.size} samples, {first:.1f} to {last:.1f} m/s")


def _check_usage(
    log: Path | None, manoeuvre: str | None, driving: dict[str, object], out: Path
) -> None:
    from calib.simulation.manoeuvre import NAMES

    if (log is None) == (manoeuvre is None):
        raise typer.BadParameter("give either a LOG or --manoeuvre", param_hint="LOG")
    given = [option for option, value in driving.items() if value is not None]
    if log is not None and given:
        raise typer.BadParameter("only with --manoeuvre; a log has its own", param_hint=given)
    if manoeuvre is not None and manoeuvre not in NAMES:
        raise typer.BadParameter(f"one of {', '.join(NAMES)}", param_hint="--manoeuvre")
    if out.suffix.lower() not in (".csv", ".parquet"):
        raise typer.BadParameter("must end in .csv or .parquet", param_hint="--out")
    refuse_folder(out)
    refuse_overwriting([out], [log] if log else [])


def _replay(model: "Model", path: Path, channel_map: Path | None) -> "Log":
    from calib.logs.read import read_log
    from calib.simulation.replay import replay

    say(f"replaying the pressure of {path} with {model.vehicle.name}")
    return replay(model, read_log(path, channel_map, require=("time", "p_mc")))


def _drive(
    model: "Model", name: str, speed: str | None, pressure: str | None, rate: float
) -> "Log":
    from calib.errors import ModelError
    from calib.simulation.manoeuvre import manoeuvre
    from calib.simulation.simulate import simulate

    v0 = quantity_of(speed or SPEED, "m/s", "--speed")
    p = None if pressure is None else quantity_of(pressure, "Pa", "--pressure")
    try:
        plan = manoeuvre(name, v0, p, rate)
    except ModelError as error:
        raise typer.BadParameter(str(error), param_hint="--manoeuvre") from None
    say(f"driving a {name} with {model.vehicle.name} from {v0:.1f} m/s")
    return simulate(model, plan.time, plan.pressure, v0, name=name)


def _write(log: "Log", out: Path) -> None:
    from calib.logs.write import write_csv, write_parquet

    (write_csv if out.suffix.lower() == ".csv" else write_parquet)(log, out)


def _document(log: "Log", out: Path, model: Path | None) -> dict[str, object]:
    return {
        "schema": 1,
        "out": out,
        "name": log.name,
        "source": log.source,
        "model": model,
        "samples": log.time.size,
        "duration": float(log.time[-1] - log.time[0]),
        "first_speed": float(log["v"][0]),
        "last_speed": float(log["v"][-1]),
        "channels": [*log.channels, *log.truth],
    }
