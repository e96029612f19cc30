"""`brake-cal simulate`: drive a model of a car by the pressure of a log or a manoeuvre."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cli import options
from cli.command import Answer, command
from cli.console import at_option, say, usage_error
from cli.logs import read
from cli.options import Car, OwnEffects, argument, in_si, option
from cli.outputs import writing

if TYPE_CHECKING:
    from calib.logs.channel_map import ChannelMap

SPEED, RATE = 120 / 3.6, 200.0  # default first speed [m/s] and samples per second


def _quantity(si: str, text: str) -> Any:
    """Declare an option for a quantity with its unit, which is converted to the unit ``si``."""
    return option(text, typed=str | None, make=partial(in_si, si))


@command(
    "brake-cal simulate --manoeuvre ramp --vehicle sample_logs/sedan/vehicle.toml --out ramp.csv",
    "brake-cal simulate --manoeuvre stop --pressure '28 bar' --noise 1 "
    "--vehicle sample_logs/sedan/vehicle.toml --out stop.csv",
)
def simulate(
    log: Path | None = argument("Log whose pressure is replayed.", "LOG"),
    *,
    vehicle: Car,
    out: Path = option("Log to write: .csv or .parquet.", "SIM", writes="simulation"),
    model: Path | None = option("Pads, tyre and effects, else those of the vehicle.", "M.toml"),
    effect: OwnEffects,
    manoeuvre: str | None = option(
        "ramp, stop, coast, step or wave.", "NAME", names="calib.model.manoeuvre:NAMES"
    ),
    speed: float | None = _quantity("m/s", 'First speed of the manoeuvre, else "120 km/h".'),
    pressure: float | None = _quantity("Pa", 'Pressure of the manoeuvre, such as "60 bar".'),
    duration: float | None = _quantity("s", 'Time at pressure or of a ramp, else "8 s".'),
    rate: float | None = option(f"Samples per second of the manoeuvre, else {RATE:g}."),
    noise: int | None = option("Add usual sensor noise, drawn by this seed.", "SEED", min=0),
    channel_map: "ChannelMap | None" = options.channel_map(
        setting="map", when=lambda values: values["log"] is not None
    ),
) -> Answer:
    """Drive a model of a car by the pressure of a log or a manoeuvre.

    A log is replayed open loop: the model gets its pressures and its first speed, at the times of
    the log. The result has the channels of a log and the true values.
    """
    from calib.base.errors import ModelError
    from calib.car.effects.catalogue import with_own
    from calib.car.model import default_model
    from calib.car.model_file import read_model
    from calib.logs.write import write_csv, write_parquet
    from calib.model.manoeuvre import manoeuvre as make_trace
    from calib.model.sensor_noise import add_noise
    from calib.model.simulate import replay
    from calib.model.simulate import simulate as drive
    from calib.show.log import simulated_document

    car = with_own(vehicle, effect)
    car_model = read_model(model, car) if model else default_model(car)
    if log is not None and any(x is not None for x in (speed, pressure, duration, rate)):
        raise usage_error("only with --manoeuvre", "--speed, --pressure, --duration, --rate")
    if log is not None and manoeuvre is None:
        say(f"replaying the pressure of {log} with {car.name}")
        driven_log = replay(car_model, read(log, channel_map, require=("time", "p_mc")))
    elif manoeuvre is not None and log is None:
        speed = speed or SPEED
        with at_option("--manoeuvre", ModelError):
            time, trace = make_trace(manoeuvre, pressure, rate or RATE, duration)
        say(f"driving a {manoeuvre} with {car.name} from {speed:.1f} m/s")
        driven_log = drive(car_model, time, trace, speed, name=manoeuvre)
    else:
        raise usage_error("expected either a LOG or --manoeuvre NAME", "LOG")
    result = driven_log if noise is None else add_noise(driven_log, noise)
    write = write_csv if out.suffix.lower() == ".csv" else write_parquet
    with writing(out):
        write(result, out)
    for note in result.notes:
        say(f"note: {note}")
    true_speed = driven_log["v"]  # before the noise of a sensor
    document = simulated_document(result, true_speed, out, model)
    first, last = document["first_speed"], document["last_speed"]
    return Answer(document, f"{out}: {driven_log.time.size} samples, {first:.1f} to {last:.1f} m/s")
