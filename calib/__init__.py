"""Calibration of a brake-torque estimator from one ramped braking run.

The steps of the workflow can be imported from here; each has an example. All else is in the
subpackages.

    read_log ──> check       what is in a log, and what it is good for
             ──> fit ──> Store ──> export     from ramps to a table, and to an ECU
             ──> estimate, validate           a table on other logs
             ──> diagnose ──> simulate        where model and car disagree, and why
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from calib.base.names import VERSION

if TYPE_CHECKING:
    from calib.car.model import default_model as default_model
    from calib.car.vehicle_file import read_vehicle as read_vehicle
    from calib.diagnosis.diagnose import diagnose as diagnose
    from calib.estimation.estimator import estimate as estimate
    from calib.estimation.sample_by_sample import online as online
    from calib.estimation.validate import validate as validate
    from calib.exports.export import export as export
    from calib.fitting.fit import fit as fit
    from calib.help.samples import sample_logs as sample_logs
    from calib.logs.read import read_log as read_log
    from calib.model.simulate import simulate as simulate
    from calib.plausibility.check import check as check
    from calib.store.store import Store as Store

__version__ = VERSION

_HOMES = {
    "Store": "calib.store.store",
    "check": "calib.plausibility.check",
    "default_model": "calib.car.model",
    "diagnose": "calib.diagnosis.diagnose",
    "estimate": "calib.estimation.estimator",
    "export": "calib.exports.export",
    "fit": "calib.fitting.fit",
    "online": "calib.estimation.sample_by_sample",
    "read_log": "calib.logs.read",
    "read_vehicle": "calib.car.vehicle_file",
    "sample_logs": "calib.help.samples",
    "simulate": "calib.model.simulate",
    "validate": "calib.estimation.validate",
}
"""The module of each name. It is imported when the name is first used: ``import calib`` is
fast."""

__all__ = [*_HOMES]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
