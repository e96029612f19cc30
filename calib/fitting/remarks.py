"""What the user must know of a table, in words."""

import numpy as np

from calib.car.mass import MassUsed
from calib.car.vehicle import Vehicle
from calib.fitting.curves import Peak
from calib.fitting.metrics import outliers
from calib.fitting.residuals import Residuals
from calib.model.ramp import RampRun
from calib.model.resistance import Resistance
from calib.model.roller_bench import RollerBench
from calib.table.table import Value


def remarks(
    runs: list[RampRun],
    left: Residuals,
    ratio: Value,
    known: Resistance,
    peak: Peak,
    coasts: int,
    bench: RollerBench | None,
) -> tuple[str, ...]:
    """What the user must know of this table, in words.

    ``left`` residuals of the ``runs``; ``ratio`` ln of the pads' ratio over that of the file [1].
    """
    said = []
    for run, (of_eta, _) in zip(runs, left, strict=True):
        zero = float(np.mean(run.blocks.eta[run.rolling])) - 1.0
        said.append(f"{run.name}: eta zeroed by {100 * zero:+.3f} % (rolling radii)")
        said += [
            f"{run.name}: left out from {first:.2f} to {last:.2f} s, where something acts that the "
            "pressure does not make: a bump, a gear shift, another road"
            for first, last in spans(run)
        ]
        times = outliers(run, of_eta)
        if times:
            listed = ", ".join(f"{t:.2f}" for t in times[:5])
            said.append(f"{run.name}: {len(times)} outlying blocks of eta, at {listed} s")
    if not known.known and not coasts:
        said.append(
            "drag and rolling resistance share one lead-in: their sum is measured, their parts "
            "are usual values; add a coast log, or give them in the vehicle file"
        )
    if all(run.blocks.v is None for run in runs):
        on = "vehicle file" if bench is None else "roller brake tester"
        said.append(
            "no reference speed: slip stiffness and pad ratio cannot be told apart, the ratio "
            f"rests on the {on}"
        )
    if peak.real:
        said.append(
            f"eta peaks at {peak.z:.2f} g: f1, f2 of eta end before it; beyond, use the tyre curve"
        )
    low, high = np.exp(ratio.ci95)
    if not low < 1.0 < high:
        said.append(
            "the pads were not in the ratio of the vehicle file: front/rear "
            f"{np.exp(ratio.value):.2f} times nominal, 95 % {low:.2f} to {high:.2f}"
        )
    return tuple(said)


def spans(run: RampRun) -> list[tuple[float, float]]:
    """First and last time [s] of each group of blocks that was left out of a run."""
    if run.left_out is None:
        return []
    edges = np.flatnonzero(np.diff(np.concatenate([[0], run.left_out, [0]])))
    end, length = run.blocks.end, run.blocks.length
    return [
        (float(end[first]) - length, float(end[after - 1]))
        for first, after in zip(edges[::2], edges[1::2], strict=True)
    ]


def taken_out(vehicle: Vehicle) -> tuple[str, ...]:
    """What was known of the car and is not in the table's pads."""
    names = vehicle.effects.described
    return (f"known effects taken out of the logs: {', '.join(names)}",) if names else ()


def stated(mass: MassUsed) -> tuple[str, ...]:
    """The mass of the calibration, where it is not that of the table's vehicle."""
    return (f"mass in the logs: {mass}",) if mass.stated else ()
