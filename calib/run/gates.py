"""Requirements that a set of logs must fulfil before anything is computed from it."""

from collections.abc import Sequence

import numpy as np

from calib.base.arrays import Mask
from calib.base.errors import LogError
from calib.car.bias import front_biased_up_to
from calib.car.braking import BITE
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.run.blocks import Blocks, braked_alone
from calib.run.driving_record import SETTLE
from calib.run.limits import LIMITS
from calib.run.run import Run
from calib.run.same_run import same_run
from calib.run.wheels import what_to_check


def refuse_copies(fitted: Sequence[Log], held: Sequence[Log] = ()) -> None:
    """Raise LogError for a run that is given twice, also if it was cut, rounded or resampled.

    ``fitted`` are the logs that something is made of, ``held`` those that are to prove it.
    """
    for i, log in enumerate(fitted):
        refuse_copy(log, fitted[:i])
    for i, log in enumerate(held):
        refuse_copy(log, fitted, held[:i])


def refuse_copy(log: Log, fitted: Sequence[Log], held: Sequence[Log] | None = None) -> None:
    """Raise LogError if ``log`` is a run that is given already, see `calib.run.same_run`.

    ``fitted`` as in `refuse_copies`; with ``held`` the log is one more of those.
    """
    first = next((k for k in (*fitted, *(held or ())) if same_run(k, log)), None)
    if first is None:
        return
    told, do = "given twice", "give each run once"
    if held is not None:
        told = "held out twice"
        if any(first is one for one in fitted):
            told = "which is among the calibration logs: it is no hold-out and proves nothing"
            do = "hold out a run of its own"
    raise LogError(f"the same run as {first.source}, {told}", where=log.source, do=do)


def require_same_wheels(run: Run) -> None:
    """Raise LogError if the wheels do not roll with the radii of the car.

    Without ``v`` nothing is checked. A log of another car with the same wheels is not detected.
    """
    if run.rolling_radii is None:
        return
    axles = (("front", run.car.front), ("rear", run.car.rear))
    for (side, axle), radius in zip(axles, run.rolling_radii, strict=True):
        if abs(radius / axle.rolling_radius - 1.0) > LIMITS.radius_tolerance:
            raise LogError(
                f"the {side} wheels roll with a radius of {radius:.3f} m",
                where=run.log.source,
                expected=f"{axle.rolling_radius:.3f} m as {run.car.name} has",
                do="this log is of another vehicle, its wheel speeds or v have another unit, or "
                "rolling_radius in the vehicle file is not a radius [m]",
            )


def eta_rise(b: Blocks, use: Mask) -> tuple[float, float]:
    """Median of eta over ``use`` minus that of the lead-in, and its standard error, both [1].

    The median is robust against wheels that lock for a short time. NaN with fewer than four blocks
    in one of the two parts, and where engine or motor changes between them: it moves eta too.
    """
    if min(np.count_nonzero(use), np.count_nonzero(b.lead_in)) < 4:
        return np.nan, np.nan
    for drive in (b.drive_f, b.drive_r):
        if abs(float(np.median(drive[use]) - np.median(drive[b.lead_in]))) > LIMITS.steady_drive:
            return np.nan, np.nan
    sides = [b.eta[b.lead_in], b.eta[use]]
    free, braked = (float(np.median(side)) for side in sides)
    variance = sum(np.var(side, ddof=1) / side.size for side in sides)
    return braked - free, float(np.sqrt(0.5 * np.pi * variance))


def bitten(b: Blocks) -> float:
    """Time after which the brakes are applied and settled [s]; infinite if they never are."""
    braked = np.flatnonzero(np.maximum(b.p_f, b.p_r) > BITE)
    return float(b.end[braked[0]]) + SETTLE if braked.size else np.inf


def wrong_slip(vehicle: Vehicle, b: Blocks) -> float | None:
    """Rise of eta [1] under braking where it goes the wrong way; None where it does not.

    The axle that brakes more must slip more: the front one of a front-biased car, or the one that
    brakes alone by its pressures.
    """
    alone = braked_alone(b.p_f, b.p_r)
    end = np.inf if alone else 0.8 * front_biased_up_to(vehicle)
    rise, error = eta_rise(b, (b.z > 0.1) & (b.z < end) & (b.end > bitten(b)))
    return rise if (-rise if alone == "r" else rise) < -4.0 * error else None


def require_right_slip(run: Run) -> None:
    """Raise LogError for a run on which eta goes the wrong way, see `wrong_slip`."""
    rise = wrong_slip(run.car, run.blocks)
    if rise is None:
        return
    alone = run.only
    way, more, less = ("fall", "rear", "front") if alone == "r" else ("rise", "front", "rear")
    why = f"only the {more} brakes have pressure" if alone else f"{run.car.name} is front-biased"
    raise LogError(
        f"the {more} wheels slip less than the {less} while braking: eta {100 * rise:+.2f} %",
        where=run.log.source,
        expected=f"a {way}: {why}",
        do=what_to_check(less)
        + ("; leave out wheel pressures that are not measured" if alone else ""),
    )
