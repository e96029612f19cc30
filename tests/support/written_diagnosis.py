"""A diagnosis that is written down by hand, for tests of what is made of it."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from calib.car.effects.effects import Effects, EmpiricalTerm
from calib.car.magic_formula import MagicFormula
from calib.car.model import Model
from calib.car.vehicle_file import read_vehicle
from calib.diagnosis.diagnosis import Diagnosis, Evidence, Named, ParameterEstimate, Where
from calib.diagnosis.explanation.channels import ChannelNoise
from calib.diagnosis.proof.oscillation import Oscillation
from calib.diagnosis.proof.unexplained import Unexplained
from calib.diagnosis.replays.gap import CHANNELS, ChannelGap, Gap
from calib.diagnosis.replays.remainder import Remainder
from calib.diagnosis.search.search import SearchStep
from calib.logs.read import read_log

CASE = Path(__file__).parents[2] / "sample_logs" / "hidden" / "case_0"
QUIET = Remainder(0.5, 1.0, "v", "stop", 0.75, (1e6, 2e6), (10.0, 20.0), (3.0, 6.0))
LEFT = Remainder(3.5, 40.0, "v", "stop", 7.25, (1e6, 2e6), (10.0, 20.0), (3.0, 6.0))
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
    channels = dict.fromkeys(CHANNELS, ChannelGap(0.5, 0.125, 0.0625))
    cells = channels | {
        "a_x": ChannelGap(0.03125, 0.03125, 0.0625),
        "v": ChannelGap(0.25, 0.5, 0.0625),
    }
    gap = Gap(8.25, 1.5, 0.875, channels, {MARKUP: (8.25, 1.5)}, {MARKUP: cells})  # fmt: skip
    return Diagnosis(
        verdict="named",
        effects=(drag,),
        unexplained=None,
        base={"pad_friction_f": estimate(0.375), "tyre_peak": estimate(0.8)},
        gap=gap,
        model_before=model,
        model_after=model,
        before=(log,),
        after=(log,),
        measured=(log,),
        reduced_before=3.5,
        reduced_after=1.0,
        left=QUIET,
        withdrawn=(),
        steps=(
            SearchStep((), 3.5, 0.0, 0.0),
            SearchStep(("aerodynamic_drag",), 1.0, 320.5, 160.25, ("aerodynamic_drag",), (), 2.5),
        ),
        noise=ChannelNoise(np.zeros((6, 3)), np.ones(6), "unbraked parts", 900),
        own={},
        drives=(),
        confusion=None,
        sides={},
        warnings=(),
    )


def unknown(named):
    """The same logs with a cause that is in no catalogue; something is left in the replays."""
    term = EmpiricalTerm("rear_brakes", "pressure", (0.0, 2.5e6), (0.0, -0.125))
    model = named.model_after
    rest = Unexplained(
        at=SimpleNamespace(effects=Effects(terms=(term,))),
        axle="rear",
        driver="pressure",
        explained=0.75,
        turning=0.0,
        oscillation=Oscillation(0.0, 0.0, body=False),
        wheel=None,
        runners_up=(("body", "speed", 0.5),),
    )
    after = replace(model, effects=replace(model.effects, terms=(term,)))
    return replace(
        named, verdict="unknown", effects=(), unexplained=rest, model_after=after, left=LEFT
    )
