"""What speaks against an estimate although it is valid: the likely sensor or part, by name."""

import math

import numpy as np

from calib.base.intervals import Z95
from calib.base.warning import VOID, WARN, PlausibilityWarning, judged
from calib.estimation.estimator import Estimate
from calib.estimation.exchanged import exchanged
from calib.estimation.known import known_resistance
from calib.plausibility.evidence import Evidence
from calib.plausibility.pads import of_changes
from calib.plausibility.rules import VALIDATE, warnings_on
from calib.run.brake_response import brake_response
from calib.run.resistance import Resistance
from calib.run.run import Run
from calib.table.pad_levels import pad_levels


def warnings_of(e: Estimate, run: Run | None = None) -> tuple[PlausibilityWarning, ...]:
    """All that speaks against an estimate, also what makes it void.

    ``run`` the log as read, if samples were filled into its gaps.
    """
    of = run or e.run
    known = known_resistance(e.table)
    evidence = Evidence(of, e.run.accelerometer(known, e.noise), brake_response(e.read, e.forces))
    of_table = [*exchanged(e, of.wheels)]
    if e.valid.any():
        i = int(np.flatnonzero(e.valid)[-1])
        middle, low, high = e.best.step.change[:, i].tolist()
        apart = middle, (high - low) / (2.0 * Z95)
        of_table += of_changes(_together(e, known, i), apart)
    does = VOID, WARN
    return (
        *warnings_on(evidence, VALIDATE, does),
        *judged(of.log.name, of_table, VALIDATE, does),
    )


def _together(e: Estimate, known: Resistance, i: int) -> tuple[float, float]:
    """ln of the brake force over that of the ramp's pads, at a sample; its sigma.

    The mass is not counted in the sigma, since another load is what it would tell.
    """
    best = e.best
    resistance = float(known.sigma_z(e.car, e.read.speed[i : i + 1])[0])
    variance = float(best.step.noise[i] + best.step.accelerometer[i])
    variance += (resistance / max(float(e.read.z[i]), 0.02)) ** 2
    variance += sum(x for part, x in e.table.budget.level.items() if part != "mass")
    ramp = pad_levels(e.table.vehicle, e.table.calibration).level
    return math.log(best.level.value[i]) - ramp, math.sqrt(variance)
