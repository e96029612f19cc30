"""`brake-cal simulate`: a model driven with the pressure of a log, or through a manoeuvre."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cli.completion import names_of
from cli.console import emit, emit_json, say
from cli.inputs import quantity_of, with_own_effects
from cli.logs import named, read
from cli.options import Force, Json, OwnEffects, VehicleFile, example, map_file, out_file
from cli.outputs import (
    refuse_ending,
    refuse_folder,
    refuse_foreign,
    refuse_overwriting,
    writing,
)
from cli.project import from_settings

if TYPE_CHECKING:
    from calib.car.model import Model
    from calib.logs.log import Log

EPILOG = example(
    "brake-cal simulate --manoeuvre ramp --vehicle sample_logs/sedan/vehicle.toml --out ramp.csv",
    "brake-cal simulate ramp.csv --vehicle sample_logs/sedan/vehicle.toml --out again.csv",
    "brake-cal simulate --manoeuvre stop --deceleration '0.4 g' --noise 1 "
    "--vehicle sample_logs/sedan/vehicle.toml --out stop.csv",
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
        typer.Option(
            metavar="NAME",
            help="ramp, stop, coast, step, wave or staircase.",
            autocompletion=names_of("calib.model.manoeuvre", "NAMES"),
        ),
    ] = None,
    speed: Annotated[
        str | None, typer.Option(help=f'First speed of the manoeuvre, "{SPEED}" if not given.')
    ] = None,
    pressure: Annotated[
        str | None, typer.Option(help='Pressure of the manoeuvre, such as "60 bar".')
    ] = None,
    deceleration: Annotated[
        str | None,
        typer.Option(help='Instead of a pressure, about this deceleration, such as "0.4 g".'),
    ] = None,
    duration: Annotated[
        str | None, typer.Option(help='Time of the rise of a ramp, else at pressure, "8 s".')
    ] = None,
    rate: Annotated[
        float | None, typer.Option(help=f"Samples per second of the manoeuvre, {RATE:g}.")
    ] = None,
    noise: Annotated[
        int | None,
        typer.Option(metavar="SEED", min=0, help="Add simulated sensor noise, drawn by this seed."),
    ] = None,
    force: Force = False,
    channel_map: Annotated[
        Path | None, map_file(callback=from_settings("map", when=_with_log))
    ] = None,
    json: Json = False,
) -> None:
    """Drive a model of a car by the pressure of a log.

    Or through a manoeuvre. A log is replayed open loop: its pressures (of the wheels, where logged)
    from its first speed, at its own times. The result has the channels of a log and the true
    values. Everything in it is simulated, its noise too: it serves to try the program, never as
    evidence about a car.
    """
    driving = {"--speed": speed, "--pressure": pressure, "--deceleration": deceleration,
               "--duration": duration, "--rate": rate}  # fmt: skip
    _check_usage(log, manoeuvre, driving, out)
    refuse_foreign(out, lambda data: b"true_" in data, "a simulated log", force)
    if channel_map is not None and log is None:
        raise typer.BadParameter("only with a LOG; a manoeuvre has none", param_hint="--map")
    from calib.car.model import default_model
    from calib.car.model_file import read_model
    from calib.car.vehicle_file import read_vehicle
    from calib.model.sensor_noise import add_noise

    car = with_own_effects(read_vehicle(vehicle), effect)
    driven = read_model(model, car) if model else default_model(car)
    if log is not None:
        result = _replay(driven, log, channel_map)
    else:
        braking = BrakingOptions(
            speed, pressure, deceleration, duration, RATE if rate is None else rate
        )
        result = _drive(driven, str(manoeuvre), braking)
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
    log: Path | None, manoeuvre: str | None, driving: Mapping[str, object], out: Path
) -> None:
    from calib.model.manoeuvre import NAMES

    if (log is None) == (manoeuvre is None):
        raise typer.BadParameter("give either a LOG or --manoeuvre", param_hint="LOG")
    given = [option for option, value in driving.items() if value is not None]
    if log is not None and given:
        raise typer.BadParameter("only with --manoeuvre; a log has its own", param_hint=given)
    if manoeuvre is not None and manoeuvre not in NAMES:
        raise typer.BadParameter(
            f"no manoeuvre {manoeuvre!r}; expected one of {', '.join(NAMES)}",
            param_hint="--manoeuvre",
        )
    refuse_ending(out, (".csv", ".parquet"))
    refuse_folder(out)
    refuse_overwriting([out], [log] if log else [])


def _replay(model: "Model", path: Path, channel_map: Path | None) -> "Log":
    from calib.model.replay import replay

    say(f"replaying the pressure of {named([path])[0]} with {model.vehicle.name}")
    return replay(model, read(path, channel_map, require=("time", "p_mc")))


@dataclass(frozen=True)
class BrakingOptions:
    """How a manoeuvre is driven, as the options say it; ``rate`` [Hz]."""

    speed: str | None
    pressure: str | None
    deceleration: str | None
    duration: str | None
    rate: float


def _drive(model: "Model", name: str, how: BrakingOptions) -> "Log":
    from calib.base.errors import ModelError
    from calib.model.manoeuvre import manoeuvre
    from calib.model.simulate import simulate

    v0 = quantity_of(how.speed or SPEED, "m/s", "--speed")
    time = None if how.duration is None else quantity_of(how.duration, "s", "--duration")
    try:
        plan = manoeuvre(name, v0, _pressure(model, how), how.rate, time)
    except ModelError as error:
        raise typer.BadParameter(str(error), param_hint="--manoeuvre") from None
    say(f"driving a {name} with {model.vehicle.name} from {v0:.1f} m/s")
    return simulate(model, plan.time, plan.pressure, v0, name=name)


def _pressure(model: "Model", how: BrakingOptions) -> float | None:
    """The pressure [Pa] that was asked for, or the one that makes the deceleration."""
    if how.deceleration is None:
        return None if how.pressure is None else quantity_of(how.pressure, "Pa", "--pressure")
    from calib.base.errors import ModelError
    from calib.car.bias import pressure_at

    if how.pressure is not None:
        raise typer.BadParameter("not together with --pressure", param_hint="--deceleration")
    wanted = quantity_of(how.deceleration, "m/s^2", "--deceleration")
    try:
        return pressure_at(model, wanted)
    except ModelError as error:
        raise typer.BadParameter(str(error), param_hint="--deceleration") from None


def _write(log: "Log", out: Path) -> None:
    from calib.logs.write import write_csv, write_parquet

    with writing(out):
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
