"""Tables whose truth is a closed form, for tests of everything that takes a table.

D = C (eta - 1) on a ramp along which z = K (eta - 1); f1, f2 follow from (18) with the load split
written out here from the wheelbase; the tyre is g = C slip. ln of the pads' ratio in the maps is
A + B_Z z + B_SHIFT shift + B_SLIP slip.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from calib.base.digest import canonical_json
from calib.base.errors import StoreError
from calib.base.record import validated
from calib.car.effects.effects import Effects
from calib.car.vehicle import Axle, Vehicle
from calib.store.record_file import Record, table_of
from calib.store.version import Stored
from calib.table.curves import (
    EXTRAPOLATED,
    INTERPOLATED,
    MEASURED,
    DifferenceCurve,
    PaperCurves,
    TyreCurve,
)
from calib.table.maps import Draws, LevelMap, PadMap
from calib.table.table import Calibration, LogReference, Provenance, Table, TableBudget, Value

C = 27.0
"""Slip stiffness [1]."""

K = 60.0
"""Deceleration per eta - 1 on the ramp [1]."""

A, B_Z, B_SHIFT, B_SLIP = 0.02, -0.3, 18.0, 0.07
"""ln of the pads' ratio [1] in the origin, per z, per (eta - 1)/z and along the slip."""

VEHICLE = Vehicle(
    name="sedan",
    mass=1744.0,
    cg_to_front_axle=1.1556,
    cg_to_rear_axle=1.6494,
    cg_height=0.615,
    track_width=1.55,
    front=Axle(0.322, 1.2, 28.84e-4, 0.1309, 2, 0.38),
    rear=Axle(0.322, 1.1, 11.34e-4, 0.124, 2, 0.38),
    effects=Effects({"aerodynamic_drag": {"drag_area": 0.66}}),
)


def made_table(stiffness: float = C, name: str = "sedan", rows: int = 21) -> Table:
    """Return the table of the closed form; two stiffnesses make two tables that differ by it."""
    eta = 1.0 + np.linspace(0.0, 0.005, rows)
    count = np.arange(rows, dtype=float)
    flag = np.full(rows, MEASURED)
    flag[rows // 2], flag[-1] = INTERPOLATED, EXTRAPOLATED
    D, band = stiffness * (eta - 1.0), 2.0 * (eta - 1.0)
    z = K * (eta - 1.0)
    none = np.zeros(rows)
    rear = (VEHICLE.cg_to_front_axle - z * VEHICLE.cg_height) / 2.805
    front = 1.0 - rear
    slip = np.linspace(0.0, 0.01, rows)
    force = stiffness * slip
    return Table(
        name=name,
        vehicle=replace(VEHICLE, name=name),
        difference=DifferenceCurve(eta, D, D - band, D + band, count, flag, none),
        paper=PaperCurves(
            eta=eta,
            z=z,
            f1=D * rear,
            f1_lower=(D - band) * rear,
            f1_upper=(D + band) * rear,
            f2=-D * front,
            f2_lower=-(D + band) * front,
            f2_upper=-(D - band) * front,
            count=count,
            flag=flag,
        ),
        tyre=TyreCurve(slip, force, 0.9 * force, 1.1 * force, count, flag, none),
        map=made_map(),
        level_map=made_level_map(),
        draws=made_draws(),
        calibration=Calibration(
            Value(1.05, 0.01),
            Value(0.0, 0.05),
            Value(0.4, 0.01),
            Value(0.39, 0.02),
            Value(stiffness, 0.01 * stiffness),
        ),
        budget=TableBudget(
            {"mass": 0.01, "tyres": 0.02},
            {"mass": 0.01, "tyres": 0.05},
            {"mass": 1e-4},
            {"tyres": 0.05**2},
            {"tyres": 0.01**2},
        ),
        effects=Effects(
            {"aerodynamic_drag": {"drag_area": 0.66}},
            sigma={"aerodynamic_drag": {"drag_area": 0.02}},
        ),
        noise={"a_x": 0.01, "omega": 0.004},
        quality={"rms": 0.0021},
        remarks=("made from a closed form",),
        provenance=Provenance(
            (
                LogReference("ramp.csv", "ab" * 32, "ramp"),
                LogReference("coast.csv", "cd" * 32, "coast"),
            ),
            {"block": 0.25},
            "brake-cal 0.1.0",
        ),
    )


def _bounded(ratio):
    """Columns of a map from its medians: the change is 0.05 less, the bounds 0.1 and 0.2 off."""
    change = ratio - 0.05
    return {
        "ratio": ratio,
        "ratio_lower": ratio - 0.1,
        "ratio_upper": ratio + 0.2,
        "change": change,
        "change_lower": change - 0.1,
        "change_upper": change + 0.2,
        "prior": np.full_like(ratio, 0.25),
    }


Z, SHIFT, SLIP = (0.1, 0.3, 0.45, 0.8), (-0.004, 0.0, 0.003, 0.007, 0.02), (-1.0, 0.5, 2.0)
"""Values of the axes of `made_map`, in uneven steps."""


def made_map(z=Z, shift=SHIFT, slip=SLIP):
    """The closed form A + B_Z z + B_SHIFT shift + B_SLIP slip: exact however it is read.

    The mean of ln(slip/z) is z - 3 - shift, its sigma 0.2 + z; every shift is as usual.
    """
    axes = [np.array(z), np.array(shift), np.array(slip)]
    x, y, s = np.meshgrid(*axes, indexing="ij")
    columns = {"log_slip": x - 3.0 - y, "log_slip_sigma": 0.2 + x, "share": np.full_like(x, 0.2)}
    return PadMap.from_grids(axes, **_bounded(A + B_Z * x + B_SHIFT * y + B_SLIP * s), **columns)


def made_draws(n=40):
    """Draws in equal steps about the middle of each prior, the forms alike."""
    u = np.linspace(-1.0, 1.0, n)
    return Draws(
        log_pad_ratio=0.03 * u,
        log_pad_level=0.01 * u[::-1],
        compliance_f=0.04 + 0.002 * u,
        compliance_r=0.04 - 0.001 * u,
        load_exponent=0.15 * u,
        peak_load_exponent=0.05 + 0.07 * u,
        peak=0.95 + 0.1 * u,
        forms=np.full((n, 5), 0.2),
        radius_load=0.002 + 0.001 * u,
        v_late=0.003 + 0.002 * u,
        cg_to_front_axle=1.1556 + 0.005 * u,
        cg_height=0.615 + 0.01 * u,
        weight=9.80665 * (1744.0 + 8.0 * u),
        depart_eta=np.repeat(0.01 * u[:, None], 10, axis=1),
        depart_slip=np.repeat(-0.003 * u[:, None], 10, axis=1),
    )


def made_level_map(z=(0.1, 0.4, 0.8)):
    """The ratio of `made_map` without a reading; the level is 0.01 z, +- 0.02."""
    z_array = np.array(z)
    prior = _bounded(A + B_Z * z_array)
    del prior["prior"]
    return LevelMap(z_array, 0.01 * z_array, 0.01 * z_array - 0.02, 0.01 * z_array + 0.02, **prior)


def stored_as(reference: str) -> Stored:
    """The table of the closed form as it would come from a store, ``reference`` name@version."""
    name, version = reference.split("@")
    table = made_table(name=name)
    return Stored(table, name, int(version), table.digest, Path(f"v{int(version):04d}"))


def from_content(record, curves) -> Table:
    """The table that `Table.content` described."""
    read = validated(canonical_json(record), Record, None, StoreError)
    return table_of(read, curves, [None] * len(record["provenance"]["logs"]))
