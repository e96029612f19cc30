"""The page on validation has the columns, the default limits, and the gates of a valid sample."""

import re

import numpy as np

from calib.car.braking import MOVING
from calib.estimation.estimator import COLUMNS
from calib.estimation.limits import DEFAULTS
from calib.estimation.reasons import Reason
from calib.estimation.state import Constants
from calib.help.page import FOLDER

PAGE = (FOLDER / "validation.md").read_text()


def test_every_column_is_in_the_table_of_columns():
    table = PAGE.partition("| column | unit |")[2].partition("\n\n")[0]
    told: set[str] = set()
    for line in table.splitlines():
        first, *others = re.findall(r"`(\w+)`", line.split(" | ")[0]) or [""]
        root = first.rpartition("_")[0]
        told |= {first, *(root + name if name.startswith("_") else name for name in others)}
    bare = {name for name in told if name.startswith(("pad_", "brake_torque"))}
    out = {name + end for name in bare for end in ("", "_lower", "_upper")} | {"valid"}
    assert "ecu_reason" in told
    assert (told - {""}) | out | {f"ecu_{name}" for name in out} == set(COLUMNS)


def test_the_default_limits_are_those_of_the_program():
    rows = dict(re.findall(r"^\| `(\w+)`.*\| ([^|]+) \|$", PAGE, flags=re.MULTILINE))
    for limit in DEFAULTS:
        axle = 1 if limit.figure.endswith("_r") else 0
        told = rows[re.sub("_(r|level)$", "_f", limit.figure)]
        numbers = [float(number) for number in re.findall(r"\d\.\d+", told)]
        bound = next(x for x in (limit.low, limit.high, limit.warn_low) if x is not None)
        assert numbers[axle] == bound, limit.figure


def test_the_gates_and_the_reasons_are_those_of_the_program():
    for words in (
        f"below {Constants.least_pressure / 1e5:g} bar, or the car below {MOVING:g} m/s",
        f"less than {Constants.settle:g} s",
        f"and {Constants.recover:g} s after it",
        f"(a level below {Constants.least_level:g} or above {Constants.most_level:g})",
        f"more than {Constants.lateral:g} m/s^2",
        f"more than {np.rad2deg(Constants.steering):g} degrees",
        *(f"{reason.value} {reason.name.lower().replace('_', ' ')}" for reason in Reason),
    ):
        assert words in " ".join(PAGE.split()), words
