"""Every key of a vehicle file: unit, meaning, how to measure it, its usual range, an example.

The examples together are the reference car, `sedan-2up`, of Tables I and II of the paper. The usual
ranges hold for passenger cars and vans; those of `calib.car.vehicle_file` only detect a wrong
unit or decimal point.
"""

from dataclasses import dataclass

CHASSIS, FRONT, REAR = "chassis", "front", "rear"


@dataclass(frozen=True)
class VehicleKey:
    """One key: ``section`` "" for the top of the file, ``unit`` "" for text, "1" for a number.

    ``low`` and ``high`` are the usual range in ``unit``; ``example`` as it stands in the file.
    """

    section: str
    name: str
    unit: str
    meaning: str
    measure: str
    example: str
    low: float = 0.0
    high: float = 0.0
    optional: bool = False

    @property
    def path(self) -> str:
        """The key with its section, ``front.piston_area``."""
        return f"{self.section}.{self.name}" if self.section else self.name

    @property
    def usual(self) -> str:
        """The usual range in words; empty for text."""
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{self.low:g} to {self.high:g}{unit}" if self.unit else ""


def _axle(
    section: str, side: str, values: tuple[str, ...], area: tuple[float, float]
) -> list[VehicleKey]:
    radius, inertia, piston, disc, faces, pads = values
    return [
        VehicleKey(
            section, "rolling_radius", "m",
            f"effective rolling radius R of one {side} wheel, unbraked",
            "roll ten turns of the wheel with the load of the test and divide the way by 20 pi; "
            "about 0.96 of the tyre's free radius",
            radius, 0.24, 0.42,
        ),
        VehicleKey(
            section, "wheel_inertia", "kg*m^2",
            f"moment of inertia J_w of one {side} wheel with tyre, hub and disc, about its axis",
            "from the makers of wheel and tyre, or about 0.6 x mass of wheel and tyre x R^2; on a "
            "driven axle the motor counts with the square of its gear ratio",
            inertia, 0.4, 4.0,
        ),
        VehicleKey(
            section, "piston_area", "cm^2",
            f"area A of all pistons that press one pad of one {side} brake",
            "pi/4 x diameter^2 of each piston; floating caliper: all its pistons; fixed caliper: "
            "those of one side only",
            piston, *area,
        ),
        VehicleKey(
            section, "effective_radius", "mm",
            f"radius r of the {side} disc at which the pads press",
            "from the axis of the wheel to the middle of the pad; a radius, not a diameter",
            disc, 80.0, 190.0,
        ),
        VehicleKey(
            section, "friction_faces", "1",
            f"pad faces that rub on one {side} disc",
            "2 for a disc with a pad on either side, for floating and for fixed calipers",
            faces, 2.0, 4.0,
        ),
        VehicleKey(
            section, "pad_friction", "1",
            f"nominal friction mu of the {side} pads",
            "from the maker of the pads, or 0.38; a common error of both axles is found by `fit`, "
            "an unequal one is not",
            pads, 0.28, 0.55,
        ),
    ]  # fmt: skip


KEYS: tuple[VehicleKey, ...] = (
    VehicleKey(
        "", "name", "",
        "name of the car with its load; tables are stored under it",
        'letters, digits, "-", "_" or "."',
        "sedan-2up",
    ),
    VehicleKey(
        CHASSIS, "mass", "kg",
        "mass M_v of the car as driven in the logs, with driver, passengers, equipment and fuel",
        "weigh it ready to drive, with everybody on board; every pad friction is wrong by the same "
        "share as the mass",
        "1744 kg", 700.0, 4500.0,
    ),
    VehicleKey(
        CHASSIS, "cg_to_front_axle", "m",
        "distance l_f from the front axle to the centre of gravity, along the car",
        "wheelbase x load of the rear axle / mass, both weighed as driven",
        "1.1556 m", 0.7, 2.7,
    ),
    VehicleKey(
        CHASSIS, "cg_to_rear_axle", "m",
        "distance l_r from the rear axle to the centre of gravity; with l_f the wheelbase",
        "wheelbase x load of the front axle / mass; wheelbase - l_f",
        "1.6494 m", 0.7, 2.7,
    ),
    VehicleKey(
        CHASSIS, "cg_height", "m",
        "height h of the centre of gravity above the road, not above the axles",
        "from the maker; else about 0.38 x height of the roof",
        "0.615 m", 0.4, 1.0,
    ),
    VehicleKey(
        CHASSIS, "track_width", "m",
        "distance l_w between the middles of the left and the right tyre",
        "from the maker; mean of both axles",
        "1.55 m", 1.2, 1.85,
    ),
    VehicleKey(
        CHASSIS, "mass_tolerance", "1",
        "one standard deviation of the relative error of the mass",
        "0.005 if the car was weighed as driven; 0.03 if the load is only known roughly",
        "0.03", 0.002, 0.05, optional=True,
    ),
    VehicleKey(
        CHASSIS, "motor_odds", "1",
        "odds that a motor or an engine brakes along with the pedal and no log has its torque",
        "0 in a car without such a motor; 0.1 if nobody knows",
        "0.1", 0.0, 10.0, optional=True,
    ),
    *_axle(
        FRONT, "front",
        ("0.322 m", "1.20 kg*m^2", "28.84 cm^2", "130.9 mm", "2", "0.38"), (12.0, 66.0),
    ),
    *_axle(
        REAR, "rear",
        ("0.322 m", "1.10 kg*m^2", "11.34 cm^2", "124.0 mm", "2", "0.38"), (3.0, 36.0),
    ),
)  # fmt: skip
"""The keys in the order of the file."""

REFERENCE = {key.path: key.example for key in KEYS}
"""What the file of the reference car says, by path of the key."""
