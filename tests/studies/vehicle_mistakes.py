"""How many mistakes in a vehicle file are told, and how many good cars are told wrongly.

    python tests/studies/vehicle_mistakes.py

Thirty cars, roughly as they are on the road, to about 10 %, and each mistake made in each of them.
The ranges of `calib.car.plausible` were chosen with these cars in view.
"""

from collections.abc import Callable
from dataclasses import replace
from math import pi

from calib.car.plausible import plausible, to_confirm
from calib.car.vehicle import Axle, Vehicle

# name: mass [kg], wheelbase [m], front share of the load, height and track [m], rolling radii [m],
# wheels [kg], pistons of one side [mm] and disc [mm] at the front and at the rear (none: a drum),
# pad friction
CARS = {
    "small 1": (1010, 1.873, 0.43, 0.56, 1.38, 0.285, 0.285, 14, 15, [42], 258, [21], None, 0.40),
    "small 2": (1090, 2.30, 0.62, 0.54, 1.41, 0.287, 0.287, 15, 14, [54], 257, [34], 240, 0.38),
    "small 3": (1080, 2.42, 0.61, 0.53, 1.42, 0.288, 0.288, 15, 14, [51], 256, [33], 230, 0.40),
    "small 4": (980, 2.46, 0.60, 0.62, 1.30, 0.270, 0.270, 13, 12, [51], 232, [30], 215, 0.38),
    "small 5": (1280, 2.55, 0.61, 0.54, 1.50, 0.302, 0.302, 18, 17, [54], 276, [34], 232, 0.40),
    "small 6": (1260, 2.58, 0.62, 0.55, 1.51, 0.303, 0.303, 18, 17, [54], 280, [34], 240, 0.38),
    "sedan 1": (1450, 2.63, 0.59, 0.54, 1.53, 0.312, 0.312, 20, 19, [54], 288, [38], 272, 0.40),
    "sedan 2": (1480, 2.64, 0.59, 0.54, 1.53, 0.314, 0.314, 20, 19, [57], 282, [35], 270, 0.38),
    "sedan 3": (1680, 2.85, 0.51, 0.53, 1.57, 0.318, 0.318, 22, 23, [60], 330, [44], 330, 0.42),
    "sedan 4": (1720, 2.87, 0.52, 0.54, 1.57, 0.320, 0.320, 22, 23, [60], 330, [42], 300, 0.42),
    "sedan 5": (1650, 2.79, 0.58, 0.56, 1.57, 0.322, 0.322, 22, 21, [57], 312, [41], 300, 0.40),
    "sedan 6": (1720, 2.83, 0.59, 0.56, 1.60, 0.327, 0.327, 23, 22, [60], 305, [38], 281, 0.37),
    "sedan 7": (2250, 3.11, 0.52, 0.56, 1.65, 0.345, 0.345, 28, 29, [42, 42], 370, [44], 340, 0.42),
    "SUV 1": (1600, 2.67, 0.59, 0.62, 1.58, 0.340, 0.340, 24, 23, [57], 296, [38], 292, 0.38),
    "SUV 2": (1830, 2.69, 0.57, 0.65, 1.60, 0.348, 0.348, 26, 25, [45, 45], 305, [41], 281, 0.37),
    "SUV 3": (2400, 2.98, 0.50, 0.68, 1.68, 0.368, 0.368, 33, 33, [44, 44], 365, [46], 345, 0.42),
    "SUV 4": (2650, 3.00, 0.51, 0.75, 1.70, 0.380, 0.380, 36, 36,
        [38, 42, 44], 380, [48], 365, 0.40),
    "SUV 5": (2450, 3.02, 0.50, 0.80, 1.70, 0.388, 0.388, 38, 38, [42, 46], 349, [45], 325, 0.38),
    "SUV 6": (1200, 2.25, 0.53, 0.68, 1.40, 0.335, 0.335, 22, 22, [51], 290, [34], 270, 0.38),
    "van 1": (1900, 2.76, 0.55, 0.66, 1.55, 0.318, 0.318, 22, 21, [57], 288, [41], 272, 0.38),
    "van 2": (2600, 2.93, 0.53, 0.75, 1.74, 0.335, 0.335, 27, 27, [48, 48], 308, [48], 292, 0.38),
    "van 3": (3300, 3.66, 0.44, 0.85, 1.71, 0.345, 0.345, 30, 30, [48, 48], 300, [50], 303, 0.38),
    "van 4": (3000, 4.04, 0.49, 0.88, 1.80, 0.340, 0.340, 29, 29, [46, 46], 300, [48], 280, 0.38),
    "sport 1": (1620, 2.45, 0.39, 0.46, 1.58, 0.332, 0.345, 23, 27,
        [28, 30, 36], 350, [28, 34], 330, 0.44),
    "sport 2": (1180, 2.31, 0.52, 0.46, 1.50, 0.300, 0.300, 17, 17, [54], 280, [38], 280, 0.40),
    "sport 3": (1720, 2.72, 0.40, 0.45, 1.62, 0.335, 0.350, 25, 28,
        [30, 34, 36], 345, [30, 34], 350, 0.42),
    "sport 4": (1800, 2.75, 0.52, 0.50, 1.61, 0.328, 0.335, 25, 27,
        [32, 36, 38], 380, [44], 370, 0.42),
    "EV 1": (1950, 2.875, 0.48, 0.45, 1.58, 0.335, 0.335, 26, 30, [42, 42], 320, [43], 335, 0.40),
    "EV 2": (2420, 2.90, 0.49, 0.45, 1.69, 0.345, 0.352, 30, 34,
        [30, 32, 34, 34], 390, [38, 38], 365, 0.42),
    "EV 3": (2250, 2.77, 0.49, 0.53, 1.58, 0.350, 0.358, 28, 30, [60], 358, [25], None, 0.40),
}  # fmt: skip


def car(name: str) -> Vehicle:
    m, L, front, h, track, R_f, R_r, w_f, w_r, p_f, d_f, p_r, d_r, mu = CARS[name]
    f = Axle(R_f, 0.6 * w_f * R_f**2, area(p_f), d_f / 2e3 - 0.027, 2, mu)
    if d_r is None:  # a drum as the disc that brakes alike: its gain of 2.3 stands in the area
        r = Axle(R_r, 0.6 * w_r * R_r**2, area(p_r) * 2.3 / (2 * mu), 0.32 * R_r, 2, mu)
    else:
        r = Axle(R_r, 0.6 * w_r * R_r**2, area(p_r), d_r / 2e3 - 0.023, 2, mu)
    return Vehicle(name, m, L * (1.0 - front), L * front, h, track, f, r)


def area(pistons: list[float]) -> float:
    return sum(pi / 4.0 * (d / 1e3) ** 2 for d in pistons)


Change = Callable[[Axle], dict[str, float]]


def ax(c: Vehicle, f: Change | None = None, r: Change | None = None) -> Vehicle:
    front = replace(c.front, **f(c.front)) if f else c.front
    return replace(c, front=front, rear=replace(c.rear, **r(c.rear)) if r else c.rear)


def both(f: Change) -> Callable[[Vehicle], Vehicle]:
    return lambda c: ax(c, f, f)


MISTAKES = {
    "area both sides, both axles": both(lambda a: {"piston_area": 2 * a.piston_area}),
    "area both sides, front only": lambda c: ax(c, lambda a: {"piston_area": 2 * a.piston_area}),
    "area both sides, rear only": lambda c: ax(
        c, None, lambda a: {"piston_area": 2 * a.piston_area}
    ),
    "area halved, both": both(lambda a: {"piston_area": 0.5 * a.piston_area}),
    "faces 1 both": both(lambda a: {"friction_faces": 1}),
    "faces 1 rear": lambda c: ax(c, None, lambda a: {"friction_faces": 1}),
    "faces 4 both (both wheels)": both(lambda a: {"friction_faces": 4}),
    "disc diameter": both(lambda a: {"effective_radius": 2 * a.effective_radius}),
    "disc outer radius": both(lambda a: {"effective_radius": a.effective_radius + 0.027}),
    "wheel diameter": both(lambda a: {"rolling_radius": 2 * a.rolling_radius}),
    "rim radius (x.63)": both(lambda a: {"rolling_radius": 0.63 * a.rolling_radius}),
    "free radius (x1.04)": both(lambda a: {"rolling_radius": 1.04 * a.rolling_radius}),
    "J of both wheels": both(lambda a: {"wheel_inertia": 2 * a.wheel_inertia}),
    "J as m R^2*10": both(lambda a: {"wheel_inertia": 10 * a.wheel_inertia}),
    "mass without load (-150kg)": lambda c: replace(c, mass=c.mass - 150),
    "mass lb as kg": lambda c: replace(c, mass=2.2046 * c.mass),
    "mass of one axle": lambda c: replace(c, mass=0.5 * c.mass),
    "cg height from axle": lambda c: replace(c, cg_height=c.cg_height - c.front.rolling_radius),
    "cg height roof": lambda c: replace(c, cg_height=c.cg_height / 0.38),
    "l_f l_r swapped": lambda c: replace(
        c, cg_to_front_axle=c.cg_to_rear_axle, cg_to_rear_axle=c.cg_to_front_axle
    ),
    "front rear sections swapped": lambda c: replace(c, front=c.rear, rear=c.front),
    "wheelbase as l_f": lambda c: replace(c, cg_to_front_axle=c.wheelbase),
    "half track": lambda c: replace(c, track_width=c.track_width / 2),
    "pads 0.8 (tyre)": both(lambda a: {"pad_friction": 0.8}),
}


if __name__ == "__main__":
    cars = [car(name) for name in CARS]
    warned = [c.name for c in cars if plausible(c)]
    print(f"good cars with a warning: {len(warned)} of {len(cars)} {' '.join(warned)}")
    asked = [c.name for c in cars if to_confirm(c)]
    print(f"good cars with something to confirm: {len(asked)} of {len(cars)} {' '.join(asked)}")
    print(f"{'':36} a warning, or something to confirm")
    told = dict.fromkeys(MISTAKES, 0)
    for name, make in MISTAKES.items():
        made = [make(c) for c in cars]
        told[name] = sum(bool(plausible(c)) for c in made)
        either = sum(bool(plausible(c) or to_confirm(c)) for c in made)
        print(f"{name:36} {told[name]:2}, {either:2} of {len(cars)}")
    print(f"mistakes with a warning: {sum(told.values())} of {len(cars) * len(told)}")
