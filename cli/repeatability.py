"""`brake-cal repeatability`: how good a gauge the calibration is, from repeated ramps of cars."""

from pathlib import Path

from cli.command import FAILED, Answer, command
from cli.console import json_text, misuse, progress
from cli.options import Map, argument, option
from cli.outputs import check_folder, write_folder

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
    metric: list[str] = option(
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
    from calib.base.plain import counted
    from calib.line.gauge.plan import read_plan, readings
    from calib.line.gauge.study import METRICS, read_gauge_limits, study, to_dict
    from calib.show.repeatability import sheet
    from calib.show.sheet import render

    check_folder(out, (DOCUMENT, PICTURE))
    held = read_gauge_limits(limits)
    places, reference = read_plan(plan, logs or [], vehicle), eta / 100.0
    if any(place.vehicle is None for place in places):
        raise misuse("needed: not every log has one in the plan", "--vehicle")
    with progress(f"fitting {counted(len(places), 'ramp')} one by one", len(places)) as step:
        found = study(
            readings(places, channel_map, reference, metric or METRICS, step), held, reference
        )
    document = to_dict(found)
    if out is not None:
        written = json_text({"schema": 1, **document}).encode()
        picture = render(sheet(found).overview(), ".png")
        write_folder(out, [(DOCUMENT, written), (PICTURE, picture)], DOCUMENT)
    return Answer(document, found, FAILED * (not found.passed))
