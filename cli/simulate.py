"""`brake-cal simulate`: a model driven with the pressure of a log."""

from pathlib import Path

from cli.command import Answer, command
from cli.console import say
from cli.logs import read
from cli.options import Car, Map, OwnEffects, argument, option
from cli.outputs import writing


@command(
    "brake-cal simulate sample_logs/sedan/ramp_wet_asphalt.csv "
    "--vehicle sample_logs/sedan/vehicle.toml --out ramp.csv",
    "brake-cal simulate sample_logs/sedan/dry_asphalt_stop.csv --noise 1 "
    "--vehicle sample_logs/sedan/vehicle.toml --out stop.csv",
)
def simulate(
    log: Path = argument("Log whose pressure is replayed.", "LOG"),
    *,
    vehicle: Car,
    out: Path = option("Log to write: .csv or .parquet.", "SIM", writes="simulation"),
    model: Path | None = option("Pads, tyre, effects; without it the vehicle's own.", "M.toml"),
    effect: OwnEffects,
    noise: int | None = option("Add simulated sensor noise, drawn by this seed.", "SEED", min=0),
    channel_map: Map,
) -> Answer:
    """Drive a model of a car by the pressure of a log.

    Open loop: the pressures of the log from its first speed, at its own times. The result has the
    channels of a log and the true values.
    """
    from calib.car.effects.catalogue import with_own
    from calib.car.model import default_model
    from calib.car.model_file import read_model
    from calib.logs.write import write_csv, write_parquet
    from calib.model.sensor_noise import add_noise
    from calib.model.simulate import replay
    from calib.show.log import simulated

    car = with_own(vehicle, effect)
    driven = read_model(model, car) if model else default_model(car)
    say(f"replaying the pressure of {log} with {car.name}")
    driven_log = replay(driven, read(log, channel_map, require=("time", "p_mc")))
    result = driven_log if noise is None else add_noise(driven_log, noise)
    with writing(out):
        (write_csv if out.suffix.lower() == ".csv" else write_parquet)(result, out)
    for note in result.notes:
        say(f"note: {note}")
    document = simulated(result, driven_log["v"], out, model)  # as driven: a reading has noise
    first, last = document["first_speed"], document["last_speed"]
    return Answer(document, f"{out}: {driven_log.time.size} samples, {first:.1f} to {last:.1f} m/s")
