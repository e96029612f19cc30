"""Mistakes as people make them at a station, by name: how large, and what names them.

A mistake changes a good line of `made_lines` in one place. Sizes are drawn. Each has the words (a
regular expression) of which one must be in the answer that names it.
"""

import math
from dataclasses import dataclass

from tests.studies import mistakes_in_cars as car
from tests.studies import mistakes_in_logs as log
from tests.studies.made_lines import RUNS, STOPS
from tests.studies.mistake import Make

RAMP = ("ramp",)


@dataclass(frozen=True)
class Kind:
    """``named`` words that name the cause; ``runs`` that it touches; ``make`` draws one.

    ``needs_v`` for a mistake of v; ``counts`` for one that is wrong whatever it moves.
    """

    named: str
    runs: tuple[str, ...]
    make: Make
    needs_v: bool = False
    counts: bool = False


# Words ------------------------------------------------------------------------------------------

A_X = r"\ba_x\b|acceleromet"
PRESSURE = r"\bp_mc\b|(?<!tyre )\bpressures?\b"
CLOCK = r"clock|sample rate|sampling"
HEIGHT = r"cg_height|cent(re|er) of gravity"
MASS = r"\bmass\b|weigh|payload|loaded|\bload of the car|\bload that"
MOTOR = r"engine|motor|in gear|regenerat|T_drive|retard"
PADS = r"\bpads?\b|pad_friction|caliper|piston"
TYRES = r"\btyres?\b"
RADIUS = r"radius|radii|\btyres?\b|wheel size"
SPEED = r"\bv\b|reference speed"
BEND = r"\bbend|corner|curve|steer|lateral"
SLOPE = r"slope|grade|hill|incline"
DRAG = r"drags|dragging|residual|seiz|stuck|sticks"
SWAPPED = r"swapp|exchang|mixed up|wrong (side|axle)"
CONTROL = r"rear brakes|brake control|wheel pressure|proportion|\bp_r[lr]\b"

# Kinds ------------------------------------------------------------------------------------------

ALL = RUNS
BOTH = ("front", "rear")
KINDS: dict[str, Kind] = {
    "a_x gain, all": Kind(A_X, ALL, log.gain(ALL, "a_x", 0.03, 0.20)),
    "a_x gain, ramp": Kind(A_X, RAMP, log.gain(RAMP, "a_x", 0.03, 0.20)),
    "a_x gain, stops": Kind(A_X, STOPS, log.gain(STOPS, "a_x", 0.03, 0.20)),
    "a_x offset, all": Kind(A_X, ALL, log.acceleration_offset(ALL)),
    "a_x offset, ramp": Kind(A_X, RAMP, log.acceleration_offset(RAMP)),
    "a_x offset, stops": Kind(A_X, STOPS, log.acceleration_offset(STOPS)),
    "a_x late, ramp": Kind(A_X, RAMP, log.late(RAMP, "a_x")),
    "p_mc offset": Kind(PRESSURE, ALL, log.pressure_offset(-math.inf)),
    "p_mc offset, clipped": Kind(PRESSURE, ALL, log.pressure_offset(0.0)),
    "p_mc gain, all": Kind(PRESSURE, ALL, log.gain(ALL, "p_mc", 0.05, 0.20)),
    "p_mc gain, ramp": Kind(PRESSURE, RAMP, log.gain(RAMP, "p_mc", 0.05, 0.20)),
    "p_mc in MPa called bar": Kind(PRESSURE, ALL, log.times(ALL, "p_mc", 0.1)),
    "p_mc late, ramp": Kind(PRESSURE, RAMP, log.late(RAMP, "p_mc")),
    "p_mc late, all": Kind(PRESSURE, ALL, log.late(ALL, "p_mc")),
    "centre of gravity too high": Kind(HEIGHT, ALL, car.too_high),
    "mass of the file": Kind(MASS, ALL, car.file_value("mass", 0.05, 0.20)),
    "loaded in the stops": Kind(MASS, STOPS, car.heavier),
    "engine drag, all": Kind(MOTOR, ALL, car.engine(ALL)),
    "engine drag, ramp": Kind(MOTOR, RAMP, car.engine(RAMP)),
    "engine drag, stops": Kind(MOTOR, STOPS, car.engine(STOPS)),
    "regeneration, stops": Kind(MOTOR, STOPS, car.regeneration),
    "pad ratio of the file": Kind(PADS, ALL, car.pads_swapped),
    "piston area of one axle": Kind(PADS, ALL, car.axle_value("piston_area", 0.10, 0.30, ())),
    "rear tyres unlike": Kind(TYRES, ALL, car.rear_tyres),
    "tyres changed after": Kind(TYRES, STOPS, car.tyres_changed),
    "rolling radius, both": Kind(RADIUS, ALL, car.axle_value("rolling_radius", 0.02, 0.06, BOTH)),
    "rolling radius, one axle": Kind(RADIUS, ALL, car.axle_value("rolling_radius", 0.02, 0.06, ())),
    "wheel inertia": Kind(r"inertia", ALL, car.axle_value("wheel_inertia", 0.3, 0.7, BOTH)),
    "omega_rl copied": Kind(r"omega_r[lr]|one signal|same signal|cop(y|ied)", ALL,
                            log.copied("omega_rr", "omega_rl"), counts=True),
    "p_mc in a_x": Kind(f"{A_X}|{PRESSURE}", ALL, log.pressure_in_acceleration, counts=True),
    "left and right swapped": Kind(SWAPPED, ALL, log.swapped((("fl", "fr"), ("rl", "rr")))),
    "front and rear swapped": Kind(SWAPPED, ALL, log.swapped((("fl", "rl"), ("fr", "rr")))),
    "clock of the logs": Kind(CLOCK, ALL, log.clock("time")),
    "clock of v": Kind(f"{CLOCK}|{SPEED}", ALL, log.clock("v"), needs_v=True),
    "v in km/h called m/s": Kind(SPEED, ALL, log.times(ALL, "v", 3.6), needs_v=True),
    "v gain": Kind(SPEED, ALL, log.gain(ALL, "v", 0.02, 0.05), needs_v=True),
    "bend, ramp": Kind(BEND, RAMP, car.bend(RAMP)),
    "bend, stops": Kind(BEND, STOPS, car.bend(STOPS)),
    "slope, all": Kind(SLOPE, ALL, car.slope(ALL)),
    "slope, ramp": Kind(SLOPE, RAMP, car.slope(RAMP)),
    "slope, stops": Kind(SLOPE, STOPS, car.slope(STOPS)),
    "rear pressure held, stops": Kind(CONTROL, STOPS, car.rear_held),
    "brake drags, all": Kind(DRAG, ALL, car.dragging(ALL)),
    "brake drags, ramp": Kind(DRAG, RAMP, car.dragging(RAMP)),
    "brake drags, stops": Kind(DRAG, STOPS, car.dragging(STOPS)),
    "ramp as hold-out": Kind(r"fitted on this log|hold-out|run once", STOPS, log.ramp_again,
                             counts=True),
    "ABS in the ramp": Kind(r"\bABS\b|\block", RAMP, car.abs_in_ramp),
}  # fmt: skip
