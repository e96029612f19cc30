"""`brake-cal fit`: from ramps to a new version of the vehicle's table."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import calib
from cli.console import emit_facts, emit_json, say, stages, warn
from cli.inputs import channel_map_of, mass_of, tell_kin, tell_newest, with_own_effects
from cli.logs import read, refuse_stdin
from cli.options import (
    Json,
    KnownModel,
    Map,
    Mass,
    OwnEffects,
    Report,
    Store,
    VehicleFile,
    example,
)
from cli.outputs import refuse_report, today, write_report
from cli.project import STORE

if TYPE_CHECKING:
    from calib.car.mass import MassUsed
    from calib.logs.log import Log
    from calib.store.version import Stored

EPILOG = example(
    "brake-cal fit sample_logs/sedan/ramp_wet_asphalt.csv sample_logs/sedan/coast.csv "
    "--vehicle sample_logs/sedan/vehicle.toml",
)


def fit(
    logs: Annotated[
        list[Path],
        typer.Argument(metavar="LOG...", help="Ramps, also with one axle only, and coast logs."),
    ],
    *,
    vehicle: VehicleFile,
    model: KnownModel = None,
    effect: OwnEffects = None,
    mass: Mass = None,
    store: Store = STORE,
    channel_map: Map = None,
    report: Report = None,
    json: Json = False,
) -> None:
    """Make the look-up table of a car from ramped brakings.

    From a LOG without braking drag and rolling resistance are estimated. A ramp on which one axle
    brakes alone by its wheel pressures tells pads and tyres of the axles apart. Effects of the
    vehicle file or of --model are removed from the logs first. The table goes into the store as a
    new version; the same logs give the same version again.
    """
    from calib.car.mass import mass_used
    from calib.car.model import with_model
    from calib.car.model_file import read_model
    from calib.car.vehicle_file import read_vehicle
    from calib.fitting.fit import fit as fit_table

    refuse_stdin(logs)
    refuse_report(report, logs, [vehicle, model, channel_map])
    weight, car = mass_of(mass), with_own_effects(read_vehicle(vehicle), effect)
    mapping = channel_map_of(channel_map)
    say(f"fitting {car.name} from {len(logs)} log{'s' * (len(logs) > 1)}")
    known = read_model(model, car) if model else None
    given = with_model(car, known) if known else car
    runs = []
    with stages() as tell:
        for i, path in enumerate(logs):
            tell(f"reading {path.name}", i, len(logs) + 1)
            runs.append(read(path, mapping))
        tell(f"fitting {car.name}", len(logs), len(logs) + 1)
        table = fit_table(given, runs, weight)
    stored = calib.Store(store).save(table)
    told = mass_used(given, weight)
    tell_kin(store, stored)
    tell_newest(store, stored)
    warn(stored.table.warnings)
    if report is not None:
        files = {"vehicle": vehicle, "model": model, "channel map": channel_map}
        write_report(report, _page(stored, runs, told, files))
    if json:
        emit_json(_document(stored, told))
    else:
        from calib.show.fit import facts

        emit_facts(facts(stored, told))


def _page(
    stored: "Stored", runs: "list[Log]", mass: "MassUsed", files: dict[str, Path | None]
) -> str:
    from calib.show.fit import report as facts_of
    from calib.show.html import page_of
    from calib.show.origin import origin_of

    braked = {log.digest for log in stored.table.provenance.logs if log.role == "ramp"}
    ramps = [run for run in runs if run.digest in braked]
    return page_of(facts_of(stored, ramps, mass, origin_of(today(), files)))


def _document(stored: "Stored", mass: "MassUsed") -> dict[str, object]:
    from calib.base.warning import to_dict
    from calib.store.answer import answer
    from calib.table.budget import summary
    from calib.table.pads_budget import pads_budget

    table = stored.table
    return {
        "schema": 1,
        "table": stored.id,
        "digest": stored.digest,
        "path": stored.path,
        "state": stored.state.word,
        "new": not stored.existed,
        "answer": answer(stored),
        "mass": mass,
        "calibration": table.calibration,
        "budget": summary(*pads_budget(table)),
        "effects": table.effect_values,
        "quality": table.quality,
        "remarks": table.remarks,
        "warnings": [to_dict(warning) for warning in table.warnings],
    }
