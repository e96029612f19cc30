"""Tables of several cars of one model, each a closed form; see `tests.support.tables`.

D = stiffness (eta - 1); pads are exp(level +- ratio/2) times those of the file, and none of it has
errors of its own run unless a budget says so. Its draws lie about them.
"""

import hashlib
import math
from dataclasses import replace
from pathlib import Path

from calib.store.version import Stored
from calib.table.table import Calibration, LogReference, Table, Value
from tests.support.tables import VEHICLE, C, made_draws, made_table


def car_table(
    number: int, stiffness: float = C, level: float = 0.0, ratio: float = 0.0, rows: int = 21
) -> Table:
    """The table of car ``number``: a ramp and a serial number of its own."""
    about, table = made_draws(), made_table(stiffness, rows=rows)
    mu_f = VEHICLE.front.pad_friction * math.exp(level + 0.5 * ratio)
    mu_r = VEHICLE.rear.pad_friction * math.exp(level - 0.5 * ratio)
    digest = hashlib.sha256(f"ramp of {number}".encode()).hexdigest()
    origin = replace(
        table.provenance,
        logs=(LogReference(f"ramp_{number}.csv", digest, "ramp"),),
        identity={"serial": f"S{number}"},
    )
    return replace(
        table,
        provenance=origin,
        calibration=Calibration(
            Value(math.exp(level), 0.02),
            Value(ratio, 0.05),
            Value(mu_f, 0.01),
            Value(mu_r, 0.01),
            Value(stiffness, 0.01 * stiffness),
        ),
        draws=replace(
            about,
            log_pad_ratio=about.log_pad_ratio + ratio,
            log_pad_level=about.log_pad_level + level,
            compliance_f=about.compliance_f * C / stiffness,
            compliance_r=about.compliance_r * C / stiffness,
        ),
    )


def version(table: Table, number: int) -> Stored:
    """The table as version ``number`` of its name, as if it came out of a store."""
    return Stored(table, table.name, number, table.digest, Path())


def cars(*stiffnesses: float) -> list[Stored]:
    """Versions 1, 2, ... of cars with these slip stiffnesses [1]."""
    return [version(car_table(n, C_), n) for n, C_ in enumerate(stiffnesses, start=1)]
