"""Tables whose truth is a closed form, for tests of everything that takes a table.

D = C (eta - 1) on a ramp along which z = K (eta - 1); f1, f2 follow from (18) with the load split
written out here from the wheelbase; the tyre is g = C slip.
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
from calib.table.table import (
    EXTRAPOLATED,
    INTERPOLATED,
    MEASURED,
    Calibration,
    DifferenceCurve,
    LogReference,
    PaperCurves,
    Provenance,
    Table,
    TyreCurve,
    TyrePosterior,
    Value,
)

C = 27.0
"""Slip stiffness [1]."""

K = 60.0
"""Deceleration per eta - 1 on the ramp [1]."""

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
    rear = (VEHICLE.cg_to_front_axle - z * VEHICLE.cg_height) / 2.805
    front = 1.0 - rear
    slip = np.linspace(0.0, 0.01, rows)
    force = stiffness * slip
    return Table(
        name=name,
        vehicle=replace(VEHICLE, name=name),
        difference=DifferenceCurve(eta, D, D - band, D + band, count, flag),
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
        tyre=TyreCurve(slip, force, 0.9 * force, 1.1 * force, count, flag),
        posterior=TyrePosterior(
            ("log_compliance", "load_exponent"), (-3.3, 0.1), ((1e-4, 2e-5), (2e-5, 4e-4))
        ),
        calibration=Calibration(
            Value(1.05, 0.01), Value(0.0, 0.05), Value(0.4, 0.01), Value(0.39, 0.02)
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


def stored_as(reference: str) -> Stored:
    """The table of the closed form as it would come from a store, ``reference`` name@version."""
    name, version = reference.split("@")
    table = made_table(name=name)
    return Stored(table, name, int(version), table.digest, Path(f"v{int(version):04d}"))


def from_content(record, curves) -> Table:
    """The table that `Table.content` described."""
    return table_of(validated(canonical_json(record), Record, None, StoreError), curves)
