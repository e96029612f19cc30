"""Calibration of a brake-torque estimator from one ramped braking run.

The steps of the workflow are imported from here. Each function has an example.

    read_log ──> check       what is in a log, and what it is good for
             ──> fit ──> Store ──> export     from ramps to a table, and to an ECU
             ──> estimate, validate           a table on other logs
             ──> diagnose ──> simulate        where model and car disagree, and why

The first argument is the car: a vehicle, a table, or a version of a table in a store. The logs
follow. Options are given by name.

>>> import calib
>>> folder = calib.sample_logs() / "simulation_study"
>>> car = calib.read_vehicle(folder / "vehicle.toml")
>>> ramp, stop = (calib.read_log(folder / f"{run}_noisy.parquet") for run in ("ramp", "stop"))
>>> table = calib.fit(car, [ramp])
>>> f1, f2 = table.f1(1.002), table.f2(1.002)  # eta = 1.002
>>> pads = table.map(0.3, 0.01, 0.0)  # z = 0.3, (eta - 1)/z = 0.01, and the usual slip
>>> bool(f2 < 0.0 < f1), bool(pads["ratio_lower"] < pads["ratio"] < pads["ratio_upper"])
(True, True)
>>> list(table.curves())[:3]
['D', 'D_lower', 'D_upper']
>>> (result,) = calib.validate(table, [stop])
>>> result.passed
True
>>> frame = calib.estimate(table, stop).to_frame()
>>> bool(frame[frame.valid].brake_torque_fl.max() > 0.0), frame.attrs["units"]["brake_torque_fl"]
(True, 'N*m')
>>> figure = result.plot()  # a notebook shows the page of each result, too
"""

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

from calib.base.names import VERSION
from calib.base.viewable import Viewable

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
"""The module of each name. It is imported when the name is first used: ``import calib`` is fast."""

__all__ = [*_HOMES]


def _view(name: str) -> Callable[[Viewable], Any]:
    """Return a function of `calib.show.notebook`, which is imported when the function is called."""
    return lambda result: getattr(import_module("calib.show.notebook"), name)(result)


# a result calls these for its picture and its page
Viewable.views.update(plot=_view("plot"), page=_view("page"))


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
