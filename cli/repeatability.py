"""`brake-cal repeatability`: how good a gauge the calibration is, from repeated ramps of cars."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cli.completion import names_of
from cli.console import emit_facts, emit_json, json_text, progress, say
from cli.inputs import channel_map_of
from cli.logs import read
from cli.options import Json, Map, example, limits_file, out_folder, vehicle_file
from cli.outputs import ready_folder, writing
from cli.project import from_settings

if TYPE_CHECKING:
    from calib.car.vehicle import Vehicle
    from calib.line.gauge.plan import Place
    from calib.line.gauge.study import GaugeReading, GaugeResult, GaugeStudy
    from calib.logs.channel_map import ChannelMap
    from calib.table.table import LogReference

EPILOG = example(
    "brake-cal repeatability --plan plan.csv --vehicle car.toml --out gauge",
    "brake-cal repeatability ramps/*/*/*.csv --folders car/station --vehicle car.toml",
)
FAILED = 1
DOCUMENT, PICTURE = "repeatability.json", "repeatability.png"


def repeatability(
    logs: Annotated[
        list[Path] | None,
        typer.Argument(metavar="LOG", help="Ramps; if none, all of the plan."),
    ] = None,
    *,
    vehicle: Annotated[
        Path | None,
        vehicle_file(
            "Vehicle, if the plan names none per log; else that of the settings.",
            callback=from_settings("vehicle"),
        ),
    ] = None,
    plan: Annotated[
        Path | None, typer.Option(metavar="P.csv", help="Columns log,car,station,road,vehicle.")
    ] = None,
    road: Annotated[
        str | None, typer.Option(metavar="NAME", help="Judge the ramps of this road of the plan.")
    ] = None,
    folders: Annotated[
        str | None,
        typer.Option(
            metavar="LAYOUT",
            help="Folders name car, car/station or station/car.",
            autocompletion=names_of("calib.line.gauge.plan", "LAYOUTS"),
        ),
    ] = None,
    quantity: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Judge only this metric; repeatable.",
            autocompletion=names_of("calib.line.gauge.study", "METRICS"),
        ),
    ] = None,
    eta: Annotated[
        float, typer.Option(metavar="PERCENT", help="eta - 1 where D, f1 and f2 are compared [%].")
    ] = 0.15,
    limits: Annotated[
        Path | None, limits_file("Limits of grr and ndc, and tolerances; never the settings'.")
    ] = None,
    out: Annotated[Path | None, out_folder("Write repeatability.json and .png here.")] = None,
    channel_map: Map = None,
    json: Json = False,
) -> None:
    """Judge the calibration as a gauge, from repeated ramps.

    The ramps are of several cars. Every ramp is fitted alone; analysis of variance then splits the
    scatter of each metric into repeat, station and car. Exit code 0 if all hold their limits (%GRR
    up to 30, ndc 5 or more). A range of a metric itself in the limits file is its tolerance: %GRR
    is then given of that too.
    """
    from calib.line.gauge.study import METRICS, read_gauge_limits, study

    _check_names(quantity or [], list(METRICS))
    ready_folder(out, (DOCUMENT, PICTURE))
    held = read_gauge_limits(limits)
    places = _places(logs or [], plan, road, folders)
    mapping = channel_map_of(channel_map)
    readings = _readings(places, vehicle, mapping, eta / 100.0, quantity or list(METRICS))
    found = study(readings, held, eta / 100.0)
    document = _document(found)
    if out is not None:
        _write(found, document, out)
    if json:
        emit_json(document)
    else:
        from calib.show.repeatability import facts

        emit_facts(facts(found))
    if not found.passed:
        raise typer.Exit(FAILED)


def _check_names(wanted: list[str], known: list[str]) -> None:
    from calib.base.toml import did_you_mean

    for name in wanted:
        if name not in known:
            hint = did_you_mean(name, known) or f"one of {', '.join(known)}"
            raise typer.BadParameter(f"no metric {name!r}; {hint}", param_hint="--quantity")


def _places(
    logs: list[Path], plan: Path | None, road: str | None, folders: str | None
) -> "tuple[Place, ...]":
    from calib.line.gauge.plan import (
        LAYOUTS,
        certain_layout,
        chosen,
        on_road,
        places_from_folders,
        read_plan,
    )
    from calib.logs.read import refuse_no_log

    if plan is not None and folders is not None:
        raise typer.BadParameter("not together with --plan", param_hint="--folders")
    if plan is not None:
        return on_road(chosen(read_plan(plan), logs, plan), road, plan)
    if road is not None:
        raise typer.BadParameter("only with a --plan that has roads", param_hint="--road")
    if not logs:
        raise typer.BadParameter("name the ramps, or give a --plan with ramps", param_hint="LOG...")
    if folders is not None and folders not in LAYOUTS:
        raise typer.BadParameter(f"one of {', '.join(LAYOUTS)}", param_hint="--folders")
    for log in logs:
        refuse_no_log(log)
    layout = folders or certain_layout(logs)
    places = places_from_folders(logs, layout)
    cars, stations = sorted({p.car for p in places}), sorted({p.station for p in places} - {""})
    named = f"; stations {', '.join(stations)}" if stations else ""
    say(f"folders as {layout}: cars {', '.join(cars)}{named}")
    return places


def _readings(
    places: "tuple[Place, ...]",
    vehicle: Path | None,
    mapping: "ChannelMap | None",
    reference: float,
    names: list[str],
) -> "tuple[GaugeReading, ...]":
    from calib.fitting.fit import fit
    from calib.line.gauge.study import GaugeReading, metrics_of, refuse_repeated

    cars = _vehicles(places, vehicle)
    readings: list[GaugeReading] = []
    parents: list[LogReference] = []
    with progress(f"fitting {len(places)} ramps one by one", len(places)) as done:
        for place in places:
            log = read(place.log, mapping)
            refuse_repeated(log, parents)
            table = fit(cars[place.vehicle or vehicle], [log])
            parents += table.provenance.logs
            metrics = metrics_of(table, log, reference)
            kept = {name: metrics[name] for name in names}
            readings.append(
                GaugeReading(str(place.log), place.car, place.station, kept, log.digest)
            )
            done()
    return tuple(readings)


def _vehicles(places: "tuple[Place, ...]", vehicle: Path | None) -> "dict[Path | None, Vehicle]":
    from calib.car.vehicle_file import read_vehicle

    files = {place.vehicle or vehicle for place in places}
    if None in files:
        raise typer.BadParameter(
            "needed: not every log has one in the plan", param_hint="--vehicle"
        )
    return {file: read_vehicle(file) for file in files if file is not None}


def _document(found: "GaugeStudy") -> dict[str, object]:
    return {
        "schema": 1,
        "passed": found.passed,
        "cars": found.cars,
        "stations": found.stations,
        "reference_eta_rise": found.reference,
        "notes": found.notes,
        "ramps": [
            {
                "log": r.log,
                "car": r.car,
                "station": r.station,
                "figures": r.metrics,
                "digest": r.digest,
            }
            for r in found.readings
        ],
        "quantities": {result.name: _entry(result) for result in found.results},
    }


def _entry(result: "GaugeResult") -> dict[str, object]:
    entry: dict[str, object] = {"unit": "1", "verdict": result.verdict, "limits": result.judgements}
    if result.analysis is None or result.gauge is None:
        return entry | dict.fromkeys(
            ("components", "grr", "ndc", "grr_of_tolerance", "cars_differ")
        )
    g = result.gauge
    return entry | {
        "mean": float(result.values.mean()),
        "anova": [
            {"source": s.name, "df": s.df, "ss": s.ss, "ms": s.ms, "effective_df": s.effective_df}
            for s in result.analysis.sources
        ],
        "components": {
            name: {"sd": c.sd, "ci95": c.sd95, "variance": c.variance, "raw_variance": c.raw}
            for name, c in g.components.items()
        },
        "negative": g.negative,
        "grr": {"value": g.grr, "ci95": g.grr95},
        "ndc": {"value": g.categories, "uncut": g.ndc, "ci95": g.ndc95},
        "grr_of_tolerance": None
        if g.tolerance is None
        else {"value": g.tolerance, "ci95": g.tolerance95},
        "cars_differ": g.cars_differ,
    }


def _write(found: "GaugeStudy", document: dict[str, object], out: Path) -> None:
    from calib.base.publish import publish, workshop
    from calib.base.write import write_whole
    from calib.show.repeatability import sheet
    from calib.show.sheet import render

    contents = {
        DOCUMENT: json_text(document).encode(),
        PICTURE: render(sheet(found).overview(), ".png"),
    }
    with writing(out), workshop(out) as work:
        for name, content in contents.items():
            write_whole(work / name, content)
        publish(work, out, DOCUMENT)
    say(f"wrote {out}: {', '.join(contents)}")
