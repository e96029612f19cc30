"""The split filter's variance taken apart: which prior, which drift and which noise it comes from.

Every step of the filter is linear in the error e of the states,

    e <- (I - K H) F e + (I - K H) q - K r        F decay, q drift, r noise of the sensors

so the variance of one state at the end is a sum over all that went in. It is followed backwards, a
row a at a time:

    a_end = unit row,   a <- a (I - K H) F,   variance = sum a Q a' + sum a K R K' a' + a P_0 a'

with K = white' whitening, as `calib.estimation.pad_ratio.Step` keeps them. Everything is linearised
where the filter linearised it.
"""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from calib.estimation.filter_input import process_noise
from calib.estimation.pad_ratio import RatioStep
from calib.estimation.plan import Plan
from calib.estimation.priors import Priors
from calib.estimation.states import (
    AT,
    COUNT,
    States,
    changed_surface,
    couple_surface,
    open_surface,
    places,
    state_list,
    today_as_then,
)
from calib.model.covariance_parts import PART as OF_RAMP
from calib.model.parameters import PRIORS
from calib.run.blocks import Blocks
from calib.table.table import Table

Array = NDArray[np.float64]

PART = States[str](
    **OF_RAMP._asdict(),
    log_stiffness="tyres",
    log_peak_ratio="tyres",
    load_shift="load_geometry",
    elastic_share="load_geometry",
    pitch_tempo="load_geometry",
    eta_zero="zeros",
    slip_zero="zeros",
    table_log_pad_ratio="ramp",
    tyre_change="tyres",
    slip_delay="tyres",
)
"""The part of an uncertainty that a state's own prior and drift belong to; a state that is a
parameter of the ramp belongs where it does."""

PAIR = [AT.log_pad_ratio, AT.table_log_pad_ratio]
"""The ratio of the pads today, and that on the day of the ramp."""


def ratio_parts(
    plan: Plan, b: Blocks, steps: Sequence[RatioStep | None], block: int
) -> dict[str, Array]:
    """Covariance (2, 2) of `PAIR` after a block, by part; their sum is the filter's.

    ``steps`` of the filter over these blocks.

    Noise of the sensors while the brakes do not act is what the zeros rest on, and counts as such.
    """
    grown = process_noise(plan.nominal, b, plan.priors)
    decay = math.exp(-b.length / plan.priors.pitch_memory)
    opened = _opened(plan.priors, 1.0)
    afresh = _opened(plan.priors, changed_surface(b.length, plan.priors))
    changed = next((k for k, step in enumerate(steps) if step and step.opened), len(steps))
    out = {part: np.zeros((2, 2)) for part in (*PART, "noise")}
    drifted = np.zeros((2, 2, COUNT))
    a = np.eye(COUNT)[PAIR]
    for k in range(block, -1, -1):
        step = steps[k]
        if step is not None:
            gain, sensed = a @ step.white.T, step.whitening @ step.rows
            noise = np.eye(2) - step.white @ sensed.T
            out["zeros" if b.lead_in[k] else "noise"] += gain @ noise @ gain.T
            a = a - gain @ sensed
            if step.opened:
                out["tyres"] += a @ opened @ a.T
        if k > changed:
            out["tyres"] += a @ afresh @ a.T
        drifted += grown[k] * a[:, None] * a
        a[:, AT.load_shift] *= decay
    for i, part in enumerate(PART):
        out[part] += drifted[:, :, i]
    for part, P in _first_parts(plan.table, plan.priors).items():
        out[part] = out.get(part, 0.0) + a @ P @ a.T
    return out


def _first_parts(table: Table, priors: Priors) -> dict[str, Array]:
    """Covariance (COUNT, COUNT) before the stop by part: that of `states.first_state`.

    What the ramp left open is split as the table's budget has it; without one it is a part of its
    own, "ramp".
    """
    known = table.posterior
    shares: Mapping[str, Sequence[Sequence[float]]]
    shares = {"ramp": known.covariance} if table.budget is None else table.budget.posterior
    at = np.ix_(places(known.names), places(known.names))
    out = {part: np.zeros((COUNT, COUNT)) for part in {*PART, *shares}}
    for part, covariance in shares.items():
        out[part][at] = covariance
    for name, prior in PRIORS._asdict().items():
        if name not in known.names:
            place = States._fields.index(name)
            out[PART[place]][place, place] += prior.sigma**2
    for P in out.values():
        today_as_then(P)
    for i, row in enumerate(state_list(priors)):
        out[PART[i]][i, i] += row.sigma**2
    couple_surface(out["tyres"], priors.peak_per_stiffness, priors.stiffness)
    return out


def _opened(priors: Priors, share: float) -> Array:
    """What `open_surface` adds to the covariance."""
    P = np.zeros((COUNT, COUNT))
    open_surface(P, priors, share)
    return P
