"""A diagnosis that is written down by hand, for tests of what is made of it."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from calib.car.effects.effects import Effects, EmpiricalTerm
from calib.car.model import Model
from calib.car.tyre import MagicFormula
from calib.car.vehicle_file import read_vehicle
from calib.diagnosis.diagnosis import Diagnosis, Evidence, Named, ParameterEstimate, Where
from calib.diagnosis.replays import CHANNELS, Gap
from calib.diagnosis.verdict import Oscillation, Unexplained
from calib.logs.read import read_log

CASE = Path(__file__).parents[2] / "sample_logs" / "hidden" / "case_0"
MARKUP = "<img src=x onerror=alert(1)>&\"'"


def estimate(value):
    return ParameterEstimate(value, "1", (value - 0.1, value + 0.1))


def named_drag():
    """Drag is missing; a replay equals its log, since the page reads both alike."""
    log = replace(read_log(CASE / "holdout" / "stop_a.parquet"), name=MARKUP)
    model = Model(read_vehicle(CASE / "vehicle.toml"), 0.4, 0.4, MagicFormula(20.0, 0.8), Effects())
    where = Where("a_x", "body", (0.0, 5e6), (10.0, 30.0), None)
    drag = Named(
        "aerodynamic_drag", {"drag_area": estimate(0.66)}, where, Evidence(2.5, 1.75), None,
        ("rolling_resistance",), f"coast down {MARKUP}",
    )  # fmt: skip
    sizes = np.full((2, 1, len(CHANNELS)), [[[8.0]], [[2.0]]])
    sizes[..., CHANNELS.index("a_x")] = 0.5
    sizes[..., CHANNELS.index("v")] = [[4.0], [8.0]]
    gap = Gap((MARKUP,), np.full(len(CHANNELS), 0.0625), sizes**2)
    return Diagnosis(
        verdict="named",
        effects=(drag,),
        unexplained=None,
        base={"pad_friction_f": estimate(0.375), "tyre_peak": estimate(0.8)},
        gap=gap,
        model_before=model,
        model_after=model,
        replays_before=(log,),
        replays_after=(log,),
        measured=(log,),
        reduced_before=3.5,
        reduced_after=1.0,
        withdrawn=(),
        steps=((), ("aerodynamic_drag",)),
        warnings=(),
    )


def unknown(named):
    """The same logs with a cause that is in no catalogue."""
    term = EmpiricalTerm("rear_brakes", "pressure", (0.0, 2.5e6), (0.0, -0.125))
    model = named.model_after
    remainder = Unexplained(
        place=term.place,
        axle="rear",
        wheel=None,
        driver="pressure",
        size=3.5,
        explained=0.75,
        turning=0.0,
        oscillation=Oscillation(0.0, 0.0, body=False),
        held_from=None,
        term=term,
    )
    after = replace(model, effects=replace(model.effects, terms=(term,)))
    return replace(named, verdict="unknown", effects=(), unexplained=remainder, model_after=after)
