"""An effect: a card that explains it, and its contribution to one or more links of the chain.

    p_mc -> pressure -> friction -> wheels -> + moment -> tyre -> + body -> mass -> accelerometer
            caliper     pads        L/R       inertia     radius  load_shift         a_x as read
                                                                               v, wheels as read

The values of its parameters are in `Effects`: one object serves simulation, analysis and diagnosis.
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

Parameters = Mapping[str, float]
Pair = tuple[Array, Array]


_NAME = re.compile("[a-z][a-z0-9_]*")


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect: SI unit, plausible range, and default prior.

    ``typical`` and ``spread`` mean and standard deviation over passenger cars; ``default`` value
    where a file gives none, None where it must; ``share`` whether it divides something between the
    axles, from 0 to 1.
    """

    name: str
    unit: str
    low: float
    high: float
    typical: float
    spread: float
    default: float | None = None
    share: bool = False

    def __post_init__(self) -> None:
        """Raise ValueError for what no fit can search."""
        if not _NAME.fullmatch(self.name):
            raise ValueError(f"{self.name!r} is no name_of_words")
        usual = (self.typical, self.typical if self.default is None else self.default)
        is_range = all(self.low <= value <= self.high for value in usual)
        if self.unit not in QUANTITIES:
            raise ValueError(f"{self.name}: unit {self.unit!r} is none of {', '.join(QUANTITIES)}")
        if not (is_range and 0.0 < self.spread < self.high - self.low < math.inf):
            raise ValueError(
                f"{self.name}: not low <= typical, default <= high and 0 < spread < high - low"
            )


@dataclass(frozen=True)
class Card:
    """Description of an effect for the user.

    The first of ``parameters`` is its strength: at ``neutral`` there is no effect, for any value
    of the others. ``not_sensed`` signal that an ECU lacks to take the effect out, else "".
    """

    name: str
    cause: str
    equation: str
    source: str
    looks_like: str
    parameters: tuple[Parameter, ...]
    neutral: float = 0.0
    not_sensed: str = ""

    def __post_init__(self) -> None:
        """Raise ValueError for what is missing, or named in two ways."""
        texts = (self.cause, self.equation, self.source, self.looks_like)
        if not (_NAME.fullmatch(self.name) and all(map(str.strip, texts))):
            raise ValueError(f"{self.name!r} is no name_of_words, or a text of the card is empty")
        if len({p.name for p in self.parameters}) < len(self.parameters):
            raise ValueError(f"{self.name}: two parameters of one name")
        for one in self.parameters[:1]:
            if not one.low <= self.neutral <= one.high or one.typical == self.neutral:
                raise ValueError(f"neutral {self.neutral:g}: no strength, or the typical one")


@dataclass(frozen=True)
class Effect:
    """A named effect: one hook for each link that it acts on, None for every other link.

    Attributes
    ----------
    card : description for the user.
    pressure : pressures of the front and the rear calipers [Pa] from those before this effect;
        reads only ``time`` and ``p_mc`` of the history.
    friction : factors on the pad friction of both axles [1] at the caliper pressures.
    wheels : factors on the brake torque of wheels that differ from the other side [1].
    axle_moment : moment on the wheels besides the brake [N m per axle], positive when it slows.
    inertia : inertia added to that of one wheel, front and rear [kg m^2].
    radius : factors on the rolling radii [1].
    load_shift : load of the front axle below that of (6), over W [1]; the rear has as much more.
    body_force : force on the body [N], positive when it slows.
    wheel_speed : factors on the speeds of wheels as read [1], by wheel name; no force changes.
    mass : factor on the mass [1].
    accelerometer : reading of a_x from the true a_x [m/s^2].
    accelerometer_lag : time constant T [s] with which that reading a follows, and the factor S
        [s^2] of its second order: S a'' + T a' + a is what it follows.
    speed_delay : time [s] by which v is read late.
    wheel_speed_delay : time [s] by which all wheel speeds are read late.
    """

    card: Card
    pressure: Callable[[Parameters, RunHistory, Array, Array], Pair] | None = None
    friction: Callable[[Parameters, RunHistory, Array, Array], Pair] | None = None
    wheels: Callable[[Parameters, RunHistory], dict[str, Array]] | None = None
    axle_moment: Callable[[Vehicle, Parameters, Motion], Pair] | None = None
    inertia: Callable[[Parameters], tuple[float, float]] | None = None
    radius: Callable[[Parameters], tuple[float, float]] | None = None
    load_shift: Callable[[Vehicle, Parameters, RunHistory], Array] | None = None
    body_force: Callable[[Vehicle, Parameters, Motion], Array] | None = None
    wheel_speed: Callable[[Vehicle, Parameters, Motion], dict[str, Array]] | None = None
    mass: Callable[[Parameters], float] | None = None
    accelerometer: Callable[[Vehicle, Parameters, RunHistory, Array], Array] | None = None
    accelerometer_lag: Callable[[Parameters], tuple[float, float]] | None = None
    speed_delay: Callable[[Parameters], float] | None = None
    wheel_speed_delay: Callable[[Parameters], float] | None = None


def _cards() -> dict[str, Card]:
    parameters: dict[str, list[Parameter]] = {}
    for row in rows("parameters.csv", "calib.car.effects"):
        low, high, typical = (float(row[k]) for k in ("low", "high", "typical"))
        of_sensor = row["spread"] in SENSOR._fields  # by its name
        spread = float(getattr(SENSOR, row["spread"]).sigma if of_sensor else row["spread"])
        default = float(row["default"]) if row["default"] else None
        numbers = (low, high, typical, spread, default)
        parameter = Parameter(row["name"], row["unit"], *numbers, row["share"] == "yes")
        parameters.setdefault(row["effect"], []).append(parameter)
    cards = {}
    for row in rows("cards.csv", "calib.car.effects"):
        name, neutral = row["name"], float(row["neutral"])
        of_effect = tuple(parameters[name])
        equation = f"{row['equation']}; no effect at {of_effect[0].name} = {neutral:g}"
        texts = (row["cause"], equation, row["source"], row["looks_like"])
        cards[name] = Card(name, *texts, of_effect, neutral, row["not_sensed"])
    return cards


CARDS = _cards()
"""The cards of the catalogue, in the order in which effects are listed and searched."""


def effect(name: str, **hooks: Callable[..., Any]) -> Effect:
    """The effect of the catalogue with these hooks."""
    return Effect(CARDS[name], **hooks)


BRAKES = ("pressure", "friction", "wheels")
"""Links that change pressures, pads or the torque of single wheels."""
READINGS = (
    *("accelerometer", "wheel_speed", "accelerometer_lag", "speed_delay", "wheel_speed_delay"),
)
"""Links that change what a sensor reads; the car moves as without them."""
AT_WHEELS = (*BRAKES, "axle_moment", "inertia", "radius", "wheel_speed", "wheel_speed_delay")
"""Links that change brakes, wheels or wheel speed sensors."""
SLOWING = ("axle_moment", "body_force")
"""Links that slow body or wheels besides the brakes."""
BALANCE = (*SLOWING, "load_shift")
"""Links of the force balance."""


def acts_on(effect: Effect, links: tuple[str, ...]) -> bool:
    """Whether an effect acts on one of these links."""
    return any(getattr(effect, link) is not None for link in links)
