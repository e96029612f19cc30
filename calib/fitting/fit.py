"""Fit a table to ramps: `fit` does all steps of `brake-cal fit` in their order.

logs --> signals --> resistance (coasting) --> tyre and pads --> curves and maps --> table, warnings
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from functools import partial

import numpy as np

from calib.base.errors import LogError
from calib.base.names import PROGRAM
from calib.base.warning import REFUSE, Measured, PlausibilityWarning, rule_warnings, unexplained
from calib.car.balance import front_biased_up_to
from calib.car.beliefs import CAR, LOG
from calib.car.braking import BITE
from calib.car.mass import mass_used, with_mass
from calib.car.tyre_file import TyreFile
from calib.car.vehicle import Vehicle
from calib.fitting.curves import difference_curves, ramp_path, readable_up_to, tyre_curve
from calib.fitting.disturbances import without_disturbances
from calib.fitting.ensemble import SlipPrediction, draws_of
from calib.fitting.evidence import Cause
from calib.fitting.learning import learn
from calib.fitting.maps import maps, pressure_odds
from calib.fitting.mistakes import causes_of, certain, measured, other_than_pads
from calib.fitting.pads import calibration_of, level_of, pad_ratio_prior, ratio_by_levels
from calib.fitting.posterior import Posterior, parts_of
from calib.fitting.prior import informative_priors
from calib.fitting.quality import MOVE_ETA, explained, metrics, remarks, warnings_of
from calib.logs.log import Log
from calib.model.ramp import RampRun, prepare, sort_runs
from calib.model.roller_bench import RollerBench
from calib.plausibility.pads import calibration_figures, require_possible_pads
from calib.plausibility.rules import FIT
from calib.run.blocks import BLOCK
from calib.run.noise import worst_noise
from calib.run.resistance import RESISTANCE, Resistance
from calib.run.resistance import identify as identify_resistance
from calib.run.run import Run
from calib.run.same_run import fingerprint_of
from calib.table.invariants import require_finite
from calib.table.table import (
    Calibration,
    LogReference,
    Provenance,
    Table,
    TableBudget,
    TableReference,
    Value,
)

_V_OR_A_X = "v or a_x, which contradict each other: the clock, the scale or a filter of one"


def fit(
    vehicle: Vehicle,
    logs: list[Log],
    *,
    mass: float | None = None,
    bench: RollerBench | None = None,
    tyre: Sequence[TyreFile] = (),
    fleet: Mapping[str, Table] | None = None,
) -> Table:
    """Fit one table from ramped brakings.

    Parameters
    ----------
    vehicle : the car of the logs, whose name the table gets. Its known effects are taken out of the
        logs first, see `calib.run.known_effects`.
    logs : one ramp or more. Logs without braking serve as coast logs. Ramps on which one axle
        brakes alone, by its wheel pressures, separate tyres from pads. Logs that brake too fast for
        a ramp are stops, which change the weights of the draws, see `calib.fitting.learning`.
    mass : of the car in these logs [kg], if it is not that of ``vehicle``. The table keeps the mass
        of the vehicle, since the next run may have another load.
    bench : brake forces of the same pads on a roller brake tester. They give the prior of the pads'
        ratio, in place of the `pad_friction_tolerance` of the vehicle.
    tyre : file of the tyres of both axles, or those of the front and of the rear axle.
    fleet : tables of other cars of this model by name@version, see
        `calib.store.fleet.released_cars`.

    If they are given, ``tyre`` and ``fleet`` make half of the prior; the other half is that of cars
    in general. Where the ramps contradict the first half, a warning says so, and the table rests on
    the second.

    Raises LogError where no log is a ramp that can be used; BenchError where the forces on rollers
    lie on no line; TyreError for a file of another tyre; VehicleError where the logs contradict the
    vehicle file, or no pad has such a friction; ModelError for an effect that cannot be taken out
    of a log; NotFiniteError for a number of the table that is not finite.

    >>> import calib
    >>> logs = calib.sample_logs() / "simulation_study"
    >>> car = calib.read_vehicle(logs / "vehicle.toml")
    >>> table = calib.fit(car, [calib.read_log(logs / "ramp_noisy.parquet")])
    >>> pads = table.calibration
    >>> [low < 0.4 < high for low, high in (pads.pad_friction_f.ci95, pads.pad_friction_r.ci95)]
    [True, True]

    0.4 is what the simulation had [1].
    """
    # vehicle is that of the file, driven has the mass of these logs, car lacks the known effects
    # that are taken out of the logs
    driven, used = with_mass(vehicle, mass), mass_used(vehicle, mass)
    pad_prior = pad_ratio_prior(driven, bench)
    priors = informative_priors(driven, tyre, fleet or {})
    ramps, coasts, stops = sort_runs([Run(log, driven) for log in logs])
    car = ramps[0].car
    runs, runs_of_stops, resistance = _ready(car, ramps, coasts, stops)
    warnings = unexplained(warnings_of(vehicle, ramps, coasts, resistance))
    where = ", ".join(run.log.source for run in ramps)
    refused = partial(LogError, where=where, lines=tuple(map(str, warnings)))
    ratio_prior = ratio_by_levels(car, runs, resistance, pad_prior)
    # curves over eta, and the level of both axles' pads, come from ramps on which both axles brake
    full = [run for run in runs if run.only is None]
    causes = causes_of(car, full)
    mistakes = unexplained(_mistakes(causes, full, refused), warnings)
    moves_eta = [warning for warning in warnings if warning.code in MOVE_ETA]
    ensemble, figures = explained(car, runs, ratio_prior, priors, refused, [*mistakes, *moves_eta])
    ensemble, by_stops = learn(car, ensemble, runs_of_stops)
    support = list(zip(priors, ensemble.prior_support.tolist(), strict=True))
    # every fourth draw is enough for curves; pulls are the errors of the draws by cause
    quarter = ensemble.take_with_pulls(slice(None, None, 4))
    path, z_end = _path(car, quarter, full, refused)
    pads, budget = _calibration(car, ensemble, full, resistance)
    disagree = any(warning.code in ("a_x_scale", "a_x_against_v") for warning in warnings)
    likely_cause = _V_OR_A_X if disagree else other_than_pads(causes)
    require_possible_pads(car, pads, warnings, likely_cause)
    difference, paper = difference_curves(car, quarter, full, z_end)
    pad_map, level_map = maps(car, ensemble, pressure_odds(full))
    roles = {"ramp": ramps, "coast": coasts, "stop": stops}
    share_of_prior = min((pads.pad_log_ratio.sigma / ratio_prior.sigma) ** 2, 1.0)
    table = Table(
        name=vehicle.name,
        vehicle=vehicle,
        difference=difference,
        paper=paper,
        tyre=tyre_curve(quarter, path, full),
        calibration=pads,
        effects=resistance.effects.only(*RESISTANCE),
        noise=asdict(worst_noise([run.noise for run in runs])),
        quality=metrics(car, runs, path, share_of_prior) | figures,
        remarks=(*remarks(driven, used, runs, support), *by_stops),
        provenance=_provenance(roles, bench, tyre, fleet or {}),
        warnings=(
            *rule_warnings(vehicle.name, [Measured(prior.code, p) for prior, p in support], FIT),
            *mistakes,
            *rule_warnings(car.name, calibration_figures(car, pads, pad_prior), FIT),
            *warnings,
        ),
        budget=budget,
        map=pad_map,
        level_map=level_map,
        draws=draws_of(car, ensemble, pads),
    )
    require_finite(table)
    return table


def _mistakes(
    causes: Sequence[Cause], runs: Sequence[RampRun], refused: Callable[..., LogError]
) -> tuple[PlausibilityWarning, ...]:
    """Return warnings of mistakes that explain the ramps.

    Raises the error that ``refused`` makes if the ramps certainly hold a mistake.
    """
    mistakes, logs = tuple(measured(causes)), ", ".join(run.name for run in runs)
    refusals = rule_warnings(logs, mistakes, FIT, (REFUSE,)) if certain(causes) else ()
    if refusals:
        raise refused(
            "; or ".join(refusal.text for refusal in refusals),
            expected="forces that the pressure and the logged torques make",
        )
    return rule_warnings(logs, mistakes, FIT)


def _ready(
    car: Vehicle, ramps: Sequence[Run], coasts: Sequence[Run], stops: Sequence[Run]
) -> tuple[list[RampRun], list[RampRun], Resistance]:
    """Return ramps and stops ready to fit, and the resistance by ramps and coasts.

    The accelerometers are corrected first, with the resistance of usual cars and its spread, since
    that of this car is not known yet.
    """
    usual = identify_resistance(car, ())
    sensors = {run: run.accelerometer(usual) for run in (*ramps, *coasts, *stops)}
    corrected = ((run.felt(sensors[run]), run.noise.z) for run in (*ramps, *coasts))
    resistance = identify_resistance(car, corrected)
    prepared = [prepare(run, resistance.effects, sensors[run]) for run in (*ramps, *stops)]
    ramps_ready = [without_disturbances(car, run) for run in prepared[: len(ramps)]]
    return ramps_ready, prepared[len(ramps) :], resistance


def _path(
    car: Vehicle, e: Posterior, runs: list[RampRun], refused: Callable[..., LogError]
) -> tuple[SlipPrediction, float]:
    """Return eta and slips of the draws up to the highest z, and the z up to which eta rises."""
    z_max = max(float(np.max(run.blocks.z[run.use])) for run in runs)
    path = ramp_path(car, e, np.linspace(0.0, z_max, 201))
    z_end = readable_up_to(path)
    if z_end > 0.0:
        return path, z_end
    raise refused(
        "eta does not rise under braking: the rear axle brakes as hard for its load, or harder",
        expected=f"a front-biased car; by its file {car.name} is so up to "
        f"{front_biased_up_to(car):.2f} g",
        do="check areas and radii of the brakes in the vehicle file",
    )


def _calibration(
    car: Vehicle, e: Posterior, runs: list[RampRun], resistance: Resistance
) -> tuple[Calibration, TableBudget]:
    """Return pads and stiffness with their budget.

    The ratio of the pads and the stiffness come from the draws ``e``, the level of the pads from
    the sum of the brake forces.
    """
    log_stiffness = -0.5 * np.log(e.compliance_f * e.compliance_r)  # geometric mean of the axles
    logs = np.stack([e.log_pad_ratio, log_stiffness])  # (2, n)
    sigmas = np.sqrt(np.diag(np.cov(logs, bias=True))).tolist()
    ratio, stiffness = map(Value, np.mean(logs, axis=1).tolist(), sigmas)
    scale, level = level_of(car, runs, resistance, ratio.value)
    variances = {"level": level, "ratio": dict[str, float](), "stiffness": dict[str, float]()}
    for part, (of_ratio, of_stiffness) in parts_of(logs, e.pulls).items():
        variances["ratio"][part] = float(of_ratio)
        variances["stiffness"][part] = float(of_stiffness)
    return calibration_of(car, scale, ratio, stiffness, variances)


def _provenance(
    roles: Mapping[str, Sequence[Run]],
    bench: RollerBench | None,
    tyres: Sequence[TyreFile],
    fleet: Mapping[str, Table],
) -> Provenance:
    """Return the logs by role, files, tables, settings and program that made a table."""
    files = [
        LogReference(x.name, x.digest, role, x.notes, fingerprint_of(x), x.sample_time)
        for role, runs in roles.items()
        for x in (run.log for run in runs)
    ]
    files += [LogReference(bench.name, bench.digest, "bench")] if bench else []
    files += [LogReference(tyre.name, tyre.digest, "tyre") for tyre in tyres]
    return Provenance(
        logs=tuple(files),
        settings={
            "block": BLOCK,
            "bite_pressure": BITE,
            "pads_repeat": LOG.pads_repeat.sigma,
            "pad_scatter": CAR.log_pad_ratio.sigma,
        },
        program=PROGRAM,
        parents=tuple(TableReference(id_, table.digest) for id_, table in fleet.items()),
    )
