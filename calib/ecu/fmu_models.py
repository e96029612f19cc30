"""What an FMU can be of: the estimator, or the car that it is for, so that both can be coupled.

p_mc --> car: a_x, wheel speeds, v --> estimator: pad friction and torque with their bounds
"""

from dataclasses import dataclass
from typing import NamedTuple

from calib.base.names import AXLE_NAMES, AXLES
from calib.car.magic_formula import MagicFormula
from calib.car.model import WET_ASPHALT, Model
from calib.ecu.channels import ANSWERS, CHANNELS
from calib.estimation.known import known_effects
from calib.estimation.reasons import Reason
from calib.table.table import Table


class Variable(NamedTuple):
    """A number of the FMU; ``unit`` None for an integer, ``start`` None for what it computes."""

    name: str
    unit: str | None
    meaning: str
    causality: str = "output"
    variability: str = "discrete"
    start: float | None = None


@dataclass(frozen=True)
class FmuModel:
    """``name`` of the header in C that has its steps; ``what`` it is in words; ``variables``.

    The place of a variable is its reference: what is given, what is told, and last the reason.
    """

    name: str
    what: str
    variables: tuple[Variable, ...]

    @property
    def given(self) -> list[Variable]:
        """Inputs and parameters."""
        return [x for x in self.variables if x.start is not None]


_BOUNDS = {"": "", "_lower": ", lower end of 95 %", "_upper": ", upper end of 95 %"}
ESTIMATOR = FmuModel(
    "estimator",
    "Brake torque of each axle, estimated",
    (
        *(Variable(x, c.unit, c.meaning, "input", "continuous", 0.0) for x, c in CHANNELS.items()),
        *(
            Variable(f"{name}{bound}", unit, f"{meaning}{end}")
            for name, (unit, meaning) in ANSWERS.items()
            for bound, end in _BOUNDS.items()
        ),
        Variable("reason", None, "; ".join(f"{int(reason)} {reason.words}" for reason in Reason)),
    ),
)

_CAR = ("p_mc", *(f"T_drive_{axle}" for axle in AXLES))
_TOLD = ("a_x", *(name for name in CHANNELS if name.startswith("omega")))
_ENDS = "0 it drives; 1 it stands; 2 an axle would lift; 3 a wheel would pass the peak of its tyre"
V0 = 30.0
"""First speed of the car where nothing else is set [m/s]."""


def simulated(table: Table) -> Model:
    """The car of a table: the pads, the resistance and the stiffness of the tyres of its ramp.

    The peak, which no ramp shows, is that of wet asphalt.
    """
    tyre = table.posterior.tyre
    stiffness = 1.0 / float(tyre.gain(1.0))
    return Model(
        vehicle=table.vehicle,
        pad_friction_f=table.calibration.pad_friction_f.value,
        pad_friction_r=table.calibration.pad_friction_r.value,
        tyre=MagicFormula(stiffness, WET_ASPHALT.peak, load_exponent=tyre.load_exponent),
        effects=known_effects(table),
    )


def car_of(table: Table) -> FmuModel:
    """The simulated car of a table, with its pads and tyres as parameters."""
    car = simulated(table)
    parameters = {
        "pad_friction_f": (car.pad_friction_f, "Friction of the front pads"),
        "pad_friction_r": (car.pad_friction_r, "Friction of the rear pads"),
        "tyre_stiffness": (car.tyre.stiffness, "Normalised force over slip, at zero slip"),
        "tyre_peak": (car.tyre.peak, "Largest normalised force"),
        "tyre_shape": (car.tyre.shape, "C of the Magic Formula, 1 to 2"),
        "tyre_load_exponent": (car.tyre.load_exponent, "Stiffness per load falls with the load"),
    }
    tuned = (
        Variable(name, "1", meaning, "parameter", "tunable", float(value))
        for name, (value, meaning) in parameters.items()
    )
    given = ((name, CHANNELS[name]) for name in _CAR)
    told = ((name, CHANNELS[name]) for name in _TOLD)
    return FmuModel(
        "car",
        "The car of the table as calib.simulate has it",
        (
            *(Variable(x, c.unit, c.meaning, "input", "continuous", 0.0) for x, c in given),
            *tuned,
            Variable("v0", "m/s", "First speed", "parameter", "fixed", V0),
            *(Variable(x, c.unit, c.meaning) for x, c in told),
            Variable("v", "m/s", "Speed over ground"),
            *(
                Variable(f"brake_torque_{axle}", "N.m", f"Torque of one {name} brake")
                for axle, name in AXLE_NAMES.items()
            ),
            Variable("reason", None, _ENDS),
        ),
    )
