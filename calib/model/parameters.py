"""The parameters of a ramp by name: unit, prior and its reason."""

from typing import Generic, NamedTuple, TypeVar

import numpy as np

from calib.car.tyre import AxleTyres, Tyre
from calib.table.table import TyrePosterior

T = TypeVar("T")


class RampParameters(NamedTuple, Generic[T]):
    """One thing for each parameter, by the parameter's name, in the order of a table's posterior.

    The first four are the tyre of `calib.car.tyre`; ``clock_offset`` by which v is late against
    the wheels; ``log_pad_ratio`` ln of the pads' ratio front over rear, relative to nominal;
    ``log_tyre_ratio``, ``radius_load`` in what the axles' tyres differ (`AxleTyres`).
    """

    log_compliance: T
    curvature_2: T
    curvature_3: T
    load_exponent: T
    clock_offset: T
    log_pad_ratio: T
    log_tyre_ratio: T
    radius_load: T


class Prior(NamedTuple):
    """What is known of a parameter before any ramp: ``mean`` and ``sigma`` in ``unit``, and why."""

    unit: str
    mean: float
    sigma: float
    reason: str


# fmt: off
PRIORS = RampParameters(
    #                      unit mean          sigma reason
    log_compliance = Prior("1", np.log(0.04), 1.0,  "slip stiffness 10 to 70 per load"),
    curvature_2    = Prior("1", 0.05,         0.2,  "Magic Formula 0, brush 1/3, at a peak of 1"),
    curvature_3    = Prior("1", 0.4,          0.4,  "Magic Formula 0.45, brush 0.2"),
    load_exponent  = Prior("1", 0.03,         0.05, "0 to 10 % softer per load at twice the load"),
    clock_offset   = Prior("s", 0.0,          0.01, "sensors on a bus are within 10 ms"),
    log_pad_ratio  = Prior("1", 0.0,          0.15, "pads within 15 % of the vehicle file"),
    log_tyre_ratio = Prior("1", 0.0,          0.1,  "rear tyres of another size: 10 %"),
    radius_load    = Prior("1", 0.0,          0.003, "common tyre files: 0.4 % at twice the load"),
)
# fmt: on
"""Passenger cars. Their errors are taken as independent."""


COUNT = len(PRIORS)
AT = RampParameters[int](*range(COUNT))
"""The place of each parameter in vectors and matrices."""


def parameters_of(posterior: TyrePosterior) -> RampParameters[float]:
    """Return the means of a table's posterior; the prior's where an older table has none."""
    return RampParameters(
        *(
            posterior.value(name) if name in posterior.names else prior.mean
            for name, prior in PRIORS._asdict().items()
        )
    )


def tyres_of(parameters: RampParameters[float]) -> AxleTyres:
    """Return the tyres of the parameters, at the table's surface."""
    p = parameters
    tyre = Tyre(p.log_compliance, p.curvature_2, p.curvature_3, p.load_exponent)
    return AxleTyres(tyre, p.log_tyre_ratio, p.radius_load)
