"""Ensembles whose members are given: what draws of a car make of forces is then known."""

from dataclasses import replace

import numpy as np

from calib.base.arrays import Array
from calib.car.tyre_forms import FORMS
from calib.fitting.ensemble import DEPART_AT, Ensemble


def one_car(form: str = "brush", **other: Array | float) -> Ensemble:
    """One car as its file has it, with tyres of one form, a peak of 0.9 and a compliance of 0.04.

    ``other`` values of the ensemble (n,) [1], in place of the usual ones.
    """
    count = max(np.size(value) for value in (1.0, *other.values()))
    ones, none = np.ones(count), np.zeros(count)
    usual = Ensemble(
        forms=np.tile(np.eye(len(FORMS))[FORMS.index(form)], (count, 1)),
        load_exponent=none,
        peak_load_exponent=none,
        peak=0.9 * ones,
        log_pad_ratio=none,
        cg_to_front_axle=ones,
        cg_height=ones,
        compliance_f=0.04 * ones,
        compliance_r=0.04 * ones,
        radius_load=none,
        v_late=none,
        depart_eta=np.zeros((count, DEPART_AT.size)),
        depart_slip=np.zeros((count, DEPART_AT.size)),
    )
    return replace(usual, **{name: value * ones for name, value in other.items()})
