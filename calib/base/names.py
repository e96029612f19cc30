"""The program's name and version, and the list of quantities with unit and sign.

Inside the program all is SI; bar, km/h, rpm and cm^2 occur only in input and output. Forces,
torques and slips are positive when they brake. ``a_x`` has the sign of ISO 8855: forward positive,
so that braking is negative; ``z = -a_x/g`` is positive when braking.
"""

import re
from pathlib import Path
from typing import NamedTuple

NAME = "brake-cal"
VERSION = "0.1.0"
PROGRAM = f"{NAME} {VERSION}"

SETTINGS_FILE = "brake-cal.toml"
SETTINGS_VARIABLE = "BRAKE_CAL_SETTINGS"  # path of a settings file; empty for none
PUBLIC_KEY = re.compile(r"RW[A-Za-z0-9+/]{54}")  # of minisign, the second line of its file
STORE = Path("tables")  # the default store

G = 9.80665  # standard gravity [m/s^2], ISO 80000-3

AXLES = ("f", "r")
AXLE_NAMES = {"f": "front", "r": "rear"}
WHEELS = ("fl", "fr", "rl", "rr")
WHEEL_SPEEDS = tuple(f"omega_{w}" for w in WHEELS)
WHEEL_PRESSURES = tuple(f"p_{w}" for w in WHEELS)


class _Quantity(NamedTuple):
    """A logged quantity with its unit in the canonical log file and inside the program."""

    name: str
    unit: str
    si: str
    required: bool = False


_QUANTITIES = (
    _Quantity("time", "s", "s", required=True),  # t, increasing
    _Quantity("p_mc", "bar", "Pa", required=True),  # P_mc, of the master cylinder
    _Quantity("a_x", "m/s^2", "m/s^2", required=True),  # at the c.g., forward positive
    *(_Quantity(name, "rad/s", "rad/s", required=True) for name in WHEEL_SPEEDS),
    _Quantity("v", "m/s", "m/s"),  # V, over ground
    *(_Quantity(name, "bar", "Pa") for name in WHEEL_PRESSURES),  # P, at the wheel
    *(_Quantity(f"T_disc_{axle}", "degC", "degC") for axle in AXLES),
    _Quantity("steering", "rad", "rad"),  # delta, of the steering wheel, left positive
    # T_d, of engine or motor at both wheels of an axle together, negative where it slows
    *(_Quantity(f"T_drive_{axle}", "N*m", "N*m") for axle in AXLES),
    _Quantity("abs_active", "1", "1"),  # 1 while ABS or ESC act, else 0
)
CHANNELS = {quantity.name: quantity for quantity in _QUANTITIES}
"""The canonical channels, in the order in which a log is written."""

FLAGS = ("abs_active",)  # 0 or 1 and nothing between

TRUTH = "true_"  # prefix of the truth channels of a simulation
TRUTH_UNITS = {"true_Tb": "N*m", "true_Fx": "N", "true_Fz": "N", "true_mu_pad": "1"}
"""SI unit of each truth channel of a simulation, by prefix. Fit, estimator and diagnosis never read
them."""

_TABLE_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,99}")
_FILES_OF_STORE = ("journal.jsonl", "journal.head")  # no folder of a table may be named so
_DEVICE = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)  # of Windows
TABLE_NAMES = (
    "letters, digits and . _ - only, at most 100, a letter or digit first, no dot last, no file of "
    "the store, and no device of Windows (CON, NUL, COM1)"
)
"""Valid names of a vehicle and its table."""


def names_a_table(name: str) -> bool:
    """Whether a vehicle's name can be that of its table, which is a folder of a store.

    >>> [names_a_table(x) for x in ("sedan-2up", "a b", "journal.head", "nul.2", "car.")]
    [True, False, False, False, False]
    """
    reserved = name.lower() in _FILES_OF_STORE or _DEVICE.fullmatch(name)
    return bool(_TABLE_NAME.fullmatch(name)) and ".." not in f"{name}." and not reserved
