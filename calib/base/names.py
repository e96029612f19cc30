"""The program's name, the axles and wheels, and the channels of a log with unit and sign.

Inside the program every quantity is in SI; bar, km/h, rpm and cm^2 occur only in input and output.
Forces, torques and slips are positive when they brake. Only the drive torques ``T_drive_f`` and
``T_drive_r`` are negative when they slow the car. ``a_x`` is positive forward (ISO 8855), so it is
negative while the car brakes, and the deceleration ``z = -a_x/g`` is positive.
"""

import re
from pathlib import Path
from typing import NamedTuple

NAME = "brake-cal"
VERSION = "0.1.0"
PROGRAM = f"{NAME} {VERSION}"
SETTINGS_FILE = "brake-cal.toml"
SETTINGS_VARIABLE = "BRAKE_CAL_SETTINGS"  # path of a settings file; if empty, no file is read
PUBLIC_KEY = re.compile(r"RW[A-Za-z0-9+/]{54}")  # a key of minisign, the second line of its file
STORE = Path("tables")  # the default store

G = 9.80665  # standard gravity [m/s^2], ISO 80000-3

AXLES = ("f", "r")
AXLE_NAMES = {"f": "front", "r": "rear"}
WHEELS = ("fl", "fr", "rl", "rr")
WHEEL_SPEEDS = tuple(f"omega_{w}" for w in WHEELS)
WHEEL_PRESSURES = tuple(f"p_{w}" for w in WHEELS)


class _Channel(NamedTuple):
    """A channel: its ``unit`` in a log file, its ``si`` unit inside the program."""

    name: str
    unit: str
    si: str
    required: bool = False  # whether every log must have the channel


_CHANNELS = (
    _Channel("time", "s", "s", required=True),  # t, increasing
    _Channel("p_mc", "bar", "Pa", required=True),  # P_mc, of the master cylinder
    _Channel("a_x", "m/s^2", "m/s^2", required=True),  # at the c.g., forward positive
    *(_Channel(name, "rad/s", "rad/s", required=True) for name in WHEEL_SPEEDS),
    _Channel("v", "m/s", "m/s"),  # V, over ground
    *(_Channel(name, "bar", "Pa") for name in WHEEL_PRESSURES),  # P, at the wheel
    *(_Channel(f"T_disc_{axle}", "degC", "degC") for axle in AXLES),
    _Channel("steering", "deg", "rad"),  # delta, of the steering wheel, left positive
    # T_d, of engine or motor at both wheels of an axle together, negative where it slows
    *(_Channel(f"T_drive_{axle}", "N*m", "N*m") for axle in AXLES),
    _Channel("abs_active", "1", "1"),  # 1 while ABS or ESC act, else 0
)
CHANNELS = {channel.name: channel for channel in _CHANNELS}
"""The canonical channels, in the order in which a log is written."""

FLAGS = ("abs_active",)  # channels that are 0 or 1, with no value between

TRUTH = "true_"  # prefix of a simulation's truth, which no fit, estimator or diagnosis reads
TRUTH_UNITS = {"true_Tb": "N*m", "true_Fx": "N", "true_Fz": "N", "true_mu_pad": "1"}
"""SI unit of each truth channel by the part of its name before the wheel or axle."""

_TABLE_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,99}")
_STORE_FILES = ("journal.jsonl", "journal.head")  # in a store, beside the folders of its tables
_WINDOWS_DEVICE = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)
TABLE_NAME_RULE = (
    "letters, digits and . _ - only, at most 100, a letter or digit first, no dot last, no two "
    "dots together, no file of the store, and no device of Windows (CON, NUL, COM1)"
)
"""The rule for names of a vehicle and its table, as an error message states it."""


def names_a_table(name: str) -> bool:
    """Whether a vehicle's name can be the name of its table, which is a folder of a store.

    >>> [names_a_table(x) for x in ("sedan-2up", "a b", "journal.head", "nul.2", "car.")]
    [True, False, False, False, False]
    """
    is_reserved = name.lower() in _STORE_FILES or bool(_WINDOWS_DEVICE.fullmatch(name))
    has_wrong_dot = ".." in name or name.endswith(".")
    return bool(_TABLE_NAME.fullmatch(name)) and not is_reserved and not has_wrong_dot
