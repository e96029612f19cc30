"""`brake-cal fit`: make a new version of the table of a car from ramps."""

from pathlib import Path
from typing import TYPE_CHECKING

from cli.command import Answer, command
from cli.console import progress, say, this_run
from cli.logs import read_all
from cli.options import Car, KnownModel, Map, Mass, OwnEffects, Tables, argument, option

if TYPE_CHECKING:
    from calib.car.tyre_file import TyreFile
    from calib.model.roller_bench import RollerBench
    from calib.plan.achieved import PlannedRuns

_BENCH = "calib.model.roller_bench_file:read_roller_bench"
_TYRES, _PLAN = "calib.car.tyre_file:read_tyres", "calib.plan.achieved:read_plan"


@command(
    "brake-cal fit sample_logs/sedan/ramp_wet_asphalt.csv sample_logs/sedan/coast.csv "
    "--vehicle sample_logs/sedan/vehicle.toml",
    report=True,
)
def fit(
    logs: list[Path] = argument("Ramps (of both axles or of one), coast logs and stops.", "LOG..."),
    *,
    vehicle: Car,
    model: KnownModel,
    effect: OwnEffects,
    mass: Mass,
    bench: "RollerBench | None" = option("Forces on a roller tester.", "B.toml", make=_BENCH),
    tyre: "tuple[TyreFile, ...]" = option(
        "Tyre property file; twice: front, rear.", "T.tir", typed=list[Path], make=_TYRES
    ),
    plan: "PlannedRuns | None" = option("Plan to compare the result with.", "P.json", make=_PLAN),
    fleet_prior: bool = option("Take half of the prior from released cars of this model."),
    store: Tables,
    channel_map: Map,
) -> Answer:
    """Make the look-up table of a car from ramped brakings.

    A LOG whose brake is applied within less than a second is a stop, which adds to what the ramps
    tell. A LOG without braking gives drag and rolling resistance. Effects of the vehicle file or of
    --model are removed from the logs first. The table goes into the store as a new version; the
    same logs give the same version again.
    """
    from calib.base.plain import counted
    from calib.car.effects.catalogue import with_own
    from calib.car.mass import mass_used
    from calib.car.model import with_model
    from calib.car.model_file import read_model
    from calib.fitting.fit import fit as fit_table
    from calib.plan.achieved import compare
    from calib.show.fit import Fitted, document
    from calib.store.fleet import released_cars

    car = with_own(vehicle, effect)
    say(f"fitting {car.name} from {counted(len(logs), 'log')}")
    car = with_model(car, read_model(model, car)) if model else car
    with progress() as step:
        runs = read_all(logs, channel_map, step, more=1)
        step(f"fitting {car.name}", len(logs), len(logs) + 1)
        digests = [run.digest for run in runs]
        fleet = released_cars(store, car, digests) if fleet_prior else {}
        table = fit_table(car, runs, mass=mass, bench=bench, tyre=tyre, fleet=fleet)
    stored = store.save(table)
    ramps = [run for run in runs if run.digest in stored.ramp_digests]
    files = this_run().files("vehicle", "model", "bench", "tyre")
    used_mass = mass_used(car, mass)
    achieved = compare(plan, table, runs, used_mass) if plan else None
    fitted = Fitted(stored, used_mass, ramps, files, achieved)
    return Answer(document(fitted), fitted)
