"""`brake-cal simulate`: a model driven with the pressure of a log, or through a manoeuvre."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from cli import options
from cli.command import Answer, command
from cli.console import at_option, misuse, say
from cli.logs import named, read
from cli.options import Car, OwnEffects, argument, option, quantity
from cli.outputs import refuse_foreign, writing

if TYPE_CHECKING:
    from calib.car.model import Model
    from calib.logs.channel_map import ChannelMap
    from calib.logs.log import Log

SPEED, RATE = 120 / 3.6, 200.0
"""First speed of a manoeuvre [m/s] and its samples per second, where none is given."""


def _of(si: str, text: str) -> Any:
    return option(text, typed=str | None, make=quantity(si))


@command(
    "brake-cal simulate --manoeuvre ramp --vehicle sample_logs/sedan/vehicle.toml --out ramp.csv",
    "brake-cal simulate --manoeuvre stop --deceleration '0.4 g' --noise 1 "
    "--vehicle sample_logs/sedan/vehicle.toml --out stop.csv",
)
def simulate(
    log: Path | None = argument("Log whose pressure is replayed.", "LOG"),
    *,
    vehicle: Car,
    out: Path = option("Log to write: .csv or .parquet.", "SIM", writes="simulation"),
    model: Path | None = option("Pads, tyre, effects; without it the vehicle's own.", "M.toml"),
    effect: OwnEffects,
    manoeuvre: str | None = option(
        "ramp, stop, coast, step, wave or staircase.", "NAME", known="calib.model.manoeuvre:NAMES"
    ),
    speed: float | None = _of("m/s", 'First speed of the manoeuvre, "120 km/h" if not given.'),
    pressure: float | None = _of("Pa", 'Pressure of the manoeuvre, such as "60 bar".'),
    deceleration: float | None = _of(
        "m/s^2", 'Instead of a pressure, about this deceleration, such as "0.4 g".'
    ),
    duration: float | None = _of("s", 'Time of the rise of a ramp, else at pressure, "8 s".'),
    rate: float | None = option(f"Samples per second of the manoeuvre, {RATE:g}."),
    noise: int | None = option("Add simulated sensor noise, drawn by this seed.", "SEED", min=0),
    channel_map: "ChannelMap | None" = options.channel_map(
        setting="map", when=lambda c: c.params.get("log") is not None
    ),
) -> Answer:
    """Drive a model of a car by the pressure of a log.

    Or through a manoeuvre. A log is replayed open loop: its pressures (of the wheels, where logged)
    from its first speed, at its own times. The result has the channels of a log and the true
    values. Everything in it is simulated, its noise too: it serves to try the program, never as
    evidence about a car.
    """
    from calib.car.model import default_model
    from calib.car.model_file import read_model
    from calib.car.own_effects.own_effect import with_own
    from calib.logs.write import write_csv, write_parquet
    from calib.model.replay import replay
    from calib.model.sensor_noise import add_noise

    refuse_foreign(out, lambda data: b"true_" in data)
    car = with_own(vehicle, effect)
    driven = read_model(model, car) if model else default_model(car)
    told = {"--speed": speed, "--pressure": pressure, "--deceleration": deceleration,
            "--duration": duration, "--rate": rate, "--map": channel_map}  # fmt: skip
    only_log = ("--map",) if log is None else tuple(told)[:-1]
    if wrong := [name for name in only_log if told[name] is not None]:
        other = "a LOG" if log is None else "--manoeuvre"
        raise misuse(f"only with {other}", ", ".join(wrong))
    if log is not None and manoeuvre is None:
        say(f"replaying the pressure of {named([log])[0]} with {car.name}")
        made = replay(driven, read(log, channel_map, require=("time", "p_mc")))
    elif manoeuvre is not None and log is None:
        pressure = _pressure(driven, pressure, deceleration)
        made = _drive(driven, manoeuvre, speed or SPEED, pressure, rate or RATE, duration)
    else:
        raise misuse("give either a LOG or --manoeuvre", "LOG")
    result = made if noise is None else add_noise(made, noise)
    with writing(out):
        (write_csv if out.suffix.lower() == ".csv" else write_parquet)(result, out)
    for note in result.notes:
        say(f"note: {note}")
    time, v = made.time, made["v"]  # as driven: a reading has noise and is rounded
    document = {
        "out": out,
        "name": result.name,
        "source": result.source,
        "model": model,
        "samples": time.size,
        "duration": time[-1] - time[0],
        "first_speed": v[0],
        "last_speed": v[-1],
        "channels": [*result.channels, *result.truth],
        "digest": result.digest,
        "notes": result.notes,
    }
    return Answer(document, f"{out}: {time.size} samples, {v[0]:.1f} to {v[-1]:.1f} m/s")


def _drive(
    model: "Model",
    name: str,
    speed: float,
    pressure: float | None,
    rate: float,
    duration: float | None,
) -> "Log":
    from calib.base.errors import ModelError
    from calib.model.manoeuvre import manoeuvre
    from calib.model.simulate import simulate

    with at_option("--manoeuvre", ModelError):
        plan = manoeuvre(name, speed, pressure, rate, duration)
    say(f"driving a {name} with {model.vehicle.name} from {speed:.1f} m/s")
    return simulate(model, plan.time, plan.pressure, speed, name=name)


def _pressure(model: "Model", pressure: float | None, deceleration: float | None) -> float | None:
    """The pressure [Pa] that was asked for, or the one that makes the deceleration [m/s^2]."""
    from calib.base.errors import ModelError
    from calib.car.bias import pressure_at

    if deceleration is None:
        return pressure
    if pressure is not None:
        raise misuse("not together with --pressure", "--deceleration")
    with at_option("--deceleration", ModelError):
        return pressure_at(model, deceleration)
