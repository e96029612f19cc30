"""`brake-cal repeatability`: how good a gauge the calibration is, from repeated ramps of cars."""

from pathlib import Path
from typing import TYPE_CHECKING

from cli.command import FAILED, Answer, command
from cli.console import json_text, misuse, progress
from cli.logs import read
from cli.options import Map, argument, option
from cli.outputs import check_folder, write_folder

if TYPE_CHECKING:
    from calib.car.vehicle import Vehicle
    from calib.line.gauge.plan import Place
    from calib.line.gauge.study import GaugeReading
    from calib.table.table import LogReference

DOCUMENT, PICTURE = "repeatability.json", "repeatability.png"


@command(
    "brake-cal repeatability --plan plan.csv --vehicle car.toml --out gauge",
    "brake-cal repeatability wet/*.csv --plan plan.csv --vehicle car.toml",
)
def repeatability(
    logs: list[Path] | None = argument("Ramps of the plan; if none, all.", "LOG"),
    *,
    vehicle: Path | None = option(
        "Vehicle, if the plan names none per log; else that of the settings.",
        "V.toml",
        setting="vehicle",
    ),
    plan: Path = option("Columns log,car,station,road,vehicle.", "P.csv"),
    quantity: list[str] = option(
        "Judge only this metric; repeatable.", "NAME", known="calib.line.gauge.study:METRICS"
    ),
    eta: float = option("eta - 1 where D, f1 and f2 are compared [%].", "PERCENT", built_in=0.15),
    limits: Path | None = option(
        "Limits of grr and ndc, and tolerances; never the settings'.", "L.toml"
    ),
    out: Path | None = option("Write repeatability.json and .png here.", "DIR", writes="folder"),
    channel_map: Map,
) -> Answer:
    """Judge the calibration as a gauge, from repeated ramps.

    The ramps are of several cars. Every ramp is fitted alone; analysis of variance then splits the
    scatter of each metric into repeat, station and car. Exit code 0 if all hold their limits (%GRR
    up to 30, ndc 5 or more). A range of a metric itself in the limits file is its tolerance: %GRR
    is then given of that too.
    """
    from calib.line.gauge.plan import read_plan
    from calib.line.gauge.study import METRICS, read_gauge_limits, study, to_dict
    from calib.show.repeatability import facts, sheet
    from calib.show.sheet import render

    check_folder(out, (DOCUMENT, PICTURE))
    held = read_gauge_limits(limits)
    places = read_plan(plan, logs or [])
    readings = _readings(places, vehicle, channel_map, eta / 100.0, quantity or list(METRICS))
    found = study(readings, held, eta / 100.0)
    document = to_dict(found)
    if out is not None:
        written = json_text({"schema": 1, **document}).encode()
        picture = render(sheet(found).overview(), ".png")
        write_folder(out, [(DOCUMENT, written), (PICTURE, picture)], DOCUMENT)
    return Answer(document, facts(found), FAILED * (not found.passed))


def _readings(
    places: "tuple[Place, ...]",
    vehicle: Path | None,
    mapping: Map,
    reference: float,
    names: list[str],
) -> "tuple[GaugeReading, ...]":
    from calib.base.plain import counted
    from calib.car.vehicle_file import read_vehicle
    from calib.fitting.fit import fit
    from calib.line.gauge.study import GaugeReading, metrics_of, refuse_repeated

    files = {place.vehicle or vehicle for place in places}
    if None in files:
        raise misuse("needed: not every log has one in the plan", "--vehicle")
    cars: dict[Path | None, Vehicle] = {f: read_vehicle(f) for f in files if f is not None}
    readings: list[GaugeReading] = []
    parents: list[LogReference] = []
    with progress(f"fitting {counted(len(places), 'ramp')} one by one", len(places)) as step:
        for place in places:
            log = read(place.log, mapping)
            refuse_repeated(log, parents)
            table = fit(cars[place.vehicle or vehicle], [log])
            parents += table.provenance.logs
            found = metrics_of(table, log, reference)
            kept = {name: found[name] for name in names}
            readings.append(
                GaugeReading(str(place.log), place.car, place.station, kept, log.digest)
            )
            step()
    return tuple(readings)
