"""The part of an ensemble that a table keeps: a later map, a budget or a merge needs no logs."""

import numpy as np

from calib.base.arrays import Array
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import Ensemble
from calib.table.maps import DEPARTS, FORMS, Draws
from calib.table.table import Calibration

KEPT = 400
"""Draws that a table keeps: a standard deviation is then known to 4 %."""


def draws_of(car: Vehicle, e: Ensemble, pads: Calibration) -> Draws:
    """Every n-th draw, with the level of the pads that the sum of forces gives at its ratio."""
    kept = e.take(np.linspace(0, e.size - 1, KEPT).astype(np.int64))
    scale = pads.pad_scale
    rng = np.random.default_rng(42)
    return Draws(
        log_pad_ratio=kept.log_pad_ratio,
        log_pad_level=np.log(scale.value) + scale.sigma / scale.value * rng.standard_normal(KEPT),
        compliance_f=kept.compliance_f,
        compliance_r=kept.compliance_r,
        load_exponent=kept.load_exponent,
        peak_load_exponent=kept.peak_load_exponent,
        peak=kept.peak,
        **dict(zip(FORMS, kept.forms.T, strict=True)),
        radius_load=kept.radius_load,
        v_late=kept.v_late,
        cg_to_front_axle=kept.cg_to_front_axle * car.cg_to_front_axle,
        cg_height=kept.cg_height * car.cg_height,
        weight=np.full(KEPT, car.weight),
        **dict(zip(DEPARTS["eta"], kept.depart_eta.T, strict=True)),
        **dict(zip(DEPARTS["slip"], kept.depart_slip.T, strict=True)),
    )


def ensemble_of(car: Vehicle, draws: Draws) -> Ensemble:
    """The ensemble of which a table of ``car`` kept these draws."""

    def together(names: tuple[str, ...]) -> Array:
        return np.stack([getattr(draws, name) for name in names], axis=1)

    return Ensemble(
        forms=together(FORMS),
        load_exponent=draws.load_exponent,
        peak_load_exponent=draws.peak_load_exponent,
        peak=draws.peak,
        log_pad_ratio=draws.log_pad_ratio,
        cg_to_front_axle=draws.cg_to_front_axle / car.cg_to_front_axle,
        cg_height=draws.cg_height / car.cg_height,
        compliance_f=draws.compliance_f,
        compliance_r=draws.compliance_r,
        radius_load=draws.radius_load,
        v_late=draws.v_late,
        depart_eta=together(DEPARTS["eta"]),
        depart_slip=together(DEPARTS["slip"]),
    )
