"""From ramps to a table: the whole of `brake-cal fit` in one place.

logs --> signals --> resistance (coasting) --> tyre and pads --> curves --> table, warnings
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict

import numpy as np

from calib.base.errors import LogError
from calib.base.warning import judged
from calib.car.bias import front_biased_up_to
from calib.car.mass import mass_used, weighed
from calib.car.tyre_file import TyreFile
from calib.car.vehicle import Vehicle
from calib.fitting.budget import level_parts, table_budget
from calib.fitting.calibration import calibration_of
from calib.fitting.curves import difference_curves, tyre_curve
from calib.fitting.disturbances import without_disturbances
from calib.fitting.ensemble import draws_of
from calib.fitting.known import contradicted, known_before, likely
from calib.fitting.maps import maps, pressure_odds
from calib.fitting.metrics import metrics
from calib.fitting.moments import as_cubic, tyre_posterior
from calib.fitting.one_axle_ramps import bought, with_both_axles
from calib.fitting.pad_level import pad_levels_of, ratio_by_levels
from calib.fitting.posterior import parts_of, posterior
from calib.fitting.provenance import provenance
from calib.fitting.remarks import remarks, stated, taken_out
from calib.fitting.residuals import explained
from calib.fitting.ridge import find_peak, readable_up_to, ridge
from calib.fitting.stated_pads import UNSAID, measured, stated_pad_ratio
from calib.fitting.warnings import file_warnings, log_warnings
from calib.logs.log import Log
from calib.model.known_effects import remove_known_effects
from calib.model.ramp import prepare
from calib.model.resistance import RESISTANCE
from calib.model.resistance import identify as identify_resistance
from calib.model.roller_bench import RollerBench
from calib.model.sensors import of_whole_run, put_right
from calib.model.sort_logs import sort_logs
from calib.plausibility.pads import of_calibration, require_possible_pads
from calib.plausibility.speed import require_measured_speed
from calib.plausibility.vehicle_file import require_file_of_run
from calib.run.noise import worst_noise
from calib.table.invariants import require_finite
from calib.table.table import Table, Value


def fit(
    vehicle: Vehicle,
    logs: list[Log],
    mass: float | None = None,
    bench: RollerBench | None = None,
    tyre: Sequence[TyreFile] = (),
    fleet: Mapping[str, Table] | None = None,
) -> Table:
    """Fit one table from ramped brakings.

    Parameters
    ----------
    vehicle : names the table. The effects that it knows are taken out of the logs first, see
        `calib.model.known_effects`.
    logs : one ramp or more; logs without braking serve as coast logs, and ramps on which one axle
        brakes alone by its wheel pressures tell tyres and pads of the axles apart.
    mass : of the car in these logs [kg], if it is not that of ``vehicle``. The table keeps the
        vehicle as it is: what was weighed once need not be the load of the next run.
    bench : brake forces of the same pads on a roller brake tester. Their ratio is then known before
        the ramps, as it is to some degree by a `pad_friction_tolerance` of the vehicle.
    tyre : file of the tyres of both axles, or those of the front and of the rear axle.
    fleet : tables of other cars of this model by name@version, see
        `calib.store.fleet.released_cars`.

    What ``tyre`` and ``fleet`` say is half of the prior; a warning says where the ramps contradict
    it, and the answer is then that of ramps alone.

    Raises LogError when no log is a ramp that will do, with the reason and what to drive instead,
    and for a pad friction that no pad has; BenchError for forces on rollers that are on no line;
    TyreError for a file of another tyre; VehicleError for a file that the logs contradict;
    StoreError for a ``fleet`` without draws; ModelError when an effect cannot be taken out of a
    log; NotFiniteError, with the name of the quantity, rather than a table that holds a number
    which is not finite.

    >>> import calib
    >>> logs = calib.sample_logs() / "simulation_study"
    >>> car = calib.read_vehicle(logs / "vehicle.toml")
    >>> table = calib.fit(car, [calib.read_log(logs / "ramp_noisy.parquet")])
    >>> pads = table.calibration
    >>> [low < 0.4 < high for low, high in (pads.pad_friction_f.ci95, pads.pad_friction_r.ci95)]
    [True, True]

    0.4 is what the simulation had [1].
    """
    read = {(log.name, log.digest): log for log in logs}
    driven = weighed(vehicle, mass)
    stated_ratio = stated_pad_ratio(driven, bench)
    told = known_before(driven, tyre, fleet or {})
    corrected = [remove_known_effects(driven, log) for log in logs]
    car = corrected[0].vehicle if corrected else driven
    as_read = sort_logs(car, [run.log for run in corrected])
    sensors, _ = own = [[of_whole_run(car, *run[1:]) for run in group] for group in as_read]
    ramps, coasts = (list(map(put_right, *pair)) for pair in zip(as_read, own, strict=True))
    known = identify_resistance(car, [(b, noise.z) for _, b, noise in ramps + coasts])
    runs = [
        without_disturbances(car, prepare(car, log.name, b, noise, known.effects, sensor))
        for (log, b, noise), sensor in zip(ramps, sensors, strict=True)
    ]
    warnings = (*file_warnings(vehicle), *log_warnings(car, *as_read, known))
    require_measured_speed(warnings)
    normal = with_both_axles(runs)
    z_max = float(max(np.max(run.blocks.z[run.use]) for run in normal))
    sources = ", ".join(log.source for log, _, _ in ramps)
    before = ratio_by_levels(car, runs, known, stated_ratio or UNSAID)
    ensemble, left, valve = explained(car, runs, before, sources, warnings, told)
    alone = (
        posterior(car, normal, stated_ratio or UNSAID, known=told)
        if len(normal) < len(runs)
        else None
    )
    some = ensemble.take(slice(None, None, 4))
    of = ridge(car, some, np.linspace(0.0, z_max, 201))
    peak, z_end = find_peak(of), readable_up_to(of)
    if z_end <= 0.0:
        raise LogError(
            "eta does not rise under braking, so there is no curve over it: the rear axle brakes "
            "as hard for its load as the front axle, or harder",
            where=sources,
            expected=f"a front-biased car; by its file {car.name} is so up to "
            f"{front_biased_up_to(car):.2f} g",
            do="check areas and radii of the brakes in the vehicle file",
            lines=tuple(map(str, warnings)),
        )
    drawn = as_cubic(ensemble, float(np.max(np.median([of.F_f, of.F_r], axis=1))))
    of_tyre = tyre_posterior(drawn)
    ratio = Value(of_tyre.value("log_pad_ratio"), of_tyre.sigma("log_pad_ratio"))
    scales = pad_levels_of(car, normal, ratio.value)
    level = level_parts(car, scales, runs, known)
    pads = calibration_of(car, float(np.mean(scales)), ratio, level)
    require_file_of_run(car, pads, warnings)
    require_possible_pads(car, pads, sources)
    difference, paper = difference_curves(car, some, runs, z_end)
    pad_map, level_map = maps(car, ensemble, pressure_odds(runs))
    table = Table(
        name=vehicle.name,
        vehicle=vehicle,
        difference=difference,
        paper=paper,
        tyre=tyre_curve(some, runs, of),
        posterior=of_tyre,
        calibration=pads,
        effects=known.effects.only(*RESISTANCE),
        noise=asdict(worst_noise([run.noise for run in runs])),
        quality=metrics(car, runs, left, peak, z_max, _weight(before, ratio)),
        remarks=(
            *taken_out(driven),
            *stated(mass_used(vehicle, mass)),
            *remarks(runs, left, ratio, known, peak, len(coasts), bench),
            *bought(runs, ensemble, alone),
            *measured(driven, bench, pads),
            *likely(told, ensemble.held),
        ),
        provenance=provenance({"ramp": ramps, "coast": coasts}, read, bench, tyre, fleet or {}),
        warnings=(
            *judged(vehicle.name, contradicted(told, ensemble.held)),
            *judged(car.name, of_calibration(car, pads, of_tyre, stated_ratio)),
            *valve,
            *warnings,
        ),
        budget=table_budget(car, level, pads, parts_of(drawn, ensemble)),
        map=pad_map,
        level_map=level_map,
        draws=draws_of(car, ensemble, pads),
    )
    require_finite(table)
    return table


def _weight(before: Value, now: Value) -> float:
    """Share of what was known of the pads' ratio ``before`` in what is known ``now`` [1]."""
    return min((now.sigma / before.sigma) ** 2, 1.0)
