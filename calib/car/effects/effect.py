"""An effect: a card that describes it, and functions that add it to the computation of a braking.

Such a function is a hook. It acts on one link of this chain of computation:

    p_mc -> pressure -> friction -> wheels -> axle_moment -> slip -> body_force -> accelerometer

Each link but p_mc and the tyres' slip is a field of `Effect`, where a comment says what it changes.
Further links are numbers of the car (``inertia``, ``radius``, ``mass``, ``load_shift``) and other
readings (``accelerometer_lag``, ``wheel_speed``, ``wheel_speed_delay``, ``speed_delay``).
"""

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from calib.base.arrays import Array
from calib.base.plain import rows
from calib.base.units import QUANTITIES
from calib.car.beliefs import SENSOR
from calib.car.history import Motion, RunHistory
from calib.car.vehicle import Vehicle

Parameters = Mapping[str, float]  # values [SI] of an effect's parameters by name, as in `Effects`
Pair = tuple[Array, Array]  # values of the front and of the rear axle

_NAME = re.compile("[a-z][a-z0-9_]*")


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect: its SI unit, plausible range, and prior."""

    name: str
    unit: str
    low: float
    high: float
    typical: float  # mean over passenger cars that have the effect
    spread: float  # standard deviation over these cars
    default: float | None = None  # value if a file gives none; None if each file must give one
    share: bool = False  # whether the parameter divides something between the axles, from 0 to 1

    def __post_init__(self) -> None:
        """Raise ValueError for a name, unit or range with which no fit could search."""
        if not _NAME.fullmatch(self.name):
            raise ValueError(f"{self.name!r} is not a name in lower case, such as drag_area")
        if self.unit not in QUANTITIES:
            raise ValueError(f"{self.name}: unit {self.unit!r} is none of {', '.join(QUANTITIES)}")
        values = [self.typical] if self.default is None else [self.typical, self.default]
        is_range = all(self.low <= value <= self.high for value in values)
        if not (is_range and 0.0 < self.spread < self.high - self.low < math.inf):
            expected = "low <= typical, default <= high and 0 < spread < high - low"
            raise ValueError(f"{self.name}: not {expected}")


@dataclass(frozen=True)
class Card:
    """Description of an effect for the user."""

    name: str
    cause: str
    equation: str
    source: str
    looks_like: str
    parameters: tuple[Parameter, ...]  # first the strength of the effect
    neutral: float = 0.0  # strength at which nothing changes, whatever the other parameters are
    not_sensed: str = ""  # the signal that an ECU lacks to take the effect out

    def __post_init__(self) -> None:
        """Raise ValueError for an empty text, a name that occurs twice, or a wrong ``neutral``."""
        texts = (self.cause, self.equation, self.source, self.looks_like)
        if not (_NAME.fullmatch(self.name) and all(map(str.strip, texts))):
            expected = "a name in lower case, such as air_brake_flap, and no empty text"
            raise ValueError(f"card {self.name!r}: expected {expected}")
        if len({p.name for p in self.parameters}) < len(self.parameters):
            raise ValueError(f"{self.name}: two parameters of one name")
        if self.parameters:  # an empirical term has none
            strength = self.parameters[0]
            is_possible = strength.low <= self.neutral <= strength.high
            if not is_possible or strength.typical == self.neutral:
                limits = f"{strength.low:g} to {strength.high:g}"
                expected = f"must lie within {limits} and differ from typical"
                raise ValueError(f"neutral {self.neutral:g} {expected}")


@dataclass(frozen=True)
class Effect:
    """An effect: one hook for each link on which it acts, None for every other link.

    A comment before a hook says what the hook returns.
    """

    card: Card
    # pressures of the front and the rear calipers [Pa] from the pressures before this effect; the
    # hook reads only ``time`` and ``p_mc`` of the history
    pressure: Callable[[Parameters, RunHistory, Array, Array], Pair] | None = None
    # factors on the pad friction of both axles [1] at the caliper pressures
    friction: Callable[[Parameters, RunHistory, Array, Array], Pair] | None = None
    # factors [1] on the brake torque by wheel, for the wheels of axles whose sides differ
    wheels: Callable[[Parameters, RunHistory], dict[str, Array]] | None = None
    # moment on the wheels besides the brake [N m per axle], positive when it slows
    axle_moment: Callable[[Vehicle, Parameters, Motion], Pair] | None = None
    # inertia that is added to one wheel, front and rear [kg m^2]
    inertia: Callable[[Parameters], tuple[float, float]] | None = None
    # factors on the front and the rear rolling radius [1]
    radius: Callable[[Parameters], tuple[float, float]] | None = None
    # load over W [1] to take from the front axle of (6) and to add to the rear axle
    load_shift: Callable[[Vehicle, Parameters, RunHistory], Array] | None = None
    # force on the body [N], positive when it slows
    body_force: Callable[[Vehicle, Parameters, Motion], Array] | None = None
    # factors [1] by wheel on wheel speeds as read; no force changes
    wheel_speed: Callable[[Vehicle, Parameters, Motion], dict[str, Array]] | None = None
    # factor on the mass [1]
    mass: Callable[[Parameters], float] | None = None
    # reading of a_x from the true a_x [m/s^2]
    accelerometer: Callable[[Vehicle, Parameters, RunHistory, Array], Array] | None = None
    # T [s] and S [s^2] of the reading a of a_x in S a'' + T a' + a = b, b without this lag
    accelerometer_lag: Callable[[Parameters], tuple[float, float]] | None = None
    # time [s] by which v is read late
    speed_delay: Callable[[Parameters], float] | None = None
    # time [s] by which all wheel speeds are read late
    wheel_speed_delay: Callable[[Parameters], float] | None = None


def _parameter(row: dict[str, str]) -> Parameter:
    """Return the parameter of a row; its ``spread`` is a number or the name of a sensor's prior."""
    low, high, typical = (float(row[key]) for key in ("low", "high", "typical"))
    has_prior = row["spread"] in SENSOR._fields
    spread = float(getattr(SENSOR, row["spread"]).sigma if has_prior else row["spread"])
    default = float(row["default"]) if row["default"] else None
    name, unit, is_share = row["name"], row["unit"], row["share"] == "yes"
    return Parameter(name, unit, low, high, typical, spread, default, is_share)


def _card(row: dict[str, str], parameters: tuple[Parameter, ...]) -> Card:
    neutral = float(row["neutral"])
    equation = f"{row['equation']}; no effect at {parameters[0].name} = {neutral:g}"
    texts = (row["cause"], equation, row["source"], row["looks_like"])
    return Card(row["name"], *texts, parameters, neutral, row["not_sensed"])


_PARAMETERS: dict[str, list[Parameter]] = {}
for _row in rows("parameters.csv", "calib.car.effects"):
    _PARAMETERS.setdefault(_row["effect"], []).append(_parameter(_row))

_CARD_ROWS = rows("cards.csv", "calib.car.effects")
CARDS = {row["name"]: _card(row, tuple(_PARAMETERS[row["name"]])) for row in _CARD_ROWS}
"""The cards of the catalogue, in the order in which effects are listed and searched."""


def effect(name: str, **hooks: Callable[..., Any]) -> Effect:
    """Return the effect of the catalogue with these hooks."""
    return Effect(CARDS[name], **hooks)


BRAKES = ("pressure", "friction", "wheels")  # links that change a brake torque
READINGS = ("accelerometer", "accelerometer_lag", "wheel_speed", "speed_delay", "wheel_speed_delay")
"""Links that change the readings of sensors, but not the motion of the car."""
AT_WHEELS = (*BRAKES, "axle_moment", "inertia", "radius", "wheel_speed", "wheel_speed_delay")
"""Links that change brakes, wheels or wheel speed sensors."""
SLOWING = ("axle_moment", "body_force")  # links that slow the car, as the brakes do
BALANCE = (*SLOWING, "load_shift")  # links that `calib.car.balance` takes into account


def sides(side: float) -> tuple[float, float]:
    """Shares [1] of left and right wheel: 1 and 1 at ``side`` 0, left alone at 1, right at -1."""
    return min(1.0, 1.0 + side), min(1.0, 1.0 - side)


def acts_on(effect: Effect, links: tuple[str, ...]) -> bool:
    """Whether an effect acts on one of these links."""
    return any(getattr(effect, link) is not None for link in links)
