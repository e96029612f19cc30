"""A vehicle: its facts, the cards of effects, and Fig. 2, the brake torques of its axles.

T_r |  .-I-.       I curve: both axles use the same friction of the road
    | /  ,-' beta  beta line: both axles have the same pressure, with the pads of the file
    |/,-'          thin lines: the deceleration is constant
    +-------- T_f
"""

from collections.abc import Sequence

import numpy as np

from calib.base.units import BAR, unit_suffix
from calib.car.balance import front_biased_up_to, front_share, pressure_per_g
from calib.car.characteristics import characteristics
from calib.car.effects.effect import Card
from calib.car.forces import axle_loads
from calib.car.plausible import vehicle_warnings
from calib.car.vehicle import Vehicle
from calib.show.facts import Facts, Table
from calib.show.numbers import spaced
from calib.show.panel import Line, Panel
from calib.show.sheet import Sheet
from calib.show.style import BODY, IDENTIFIED, NOMINAL, Array, Stroke, dots

_DECELERATIONS = tuple(k / 10.0 for k in range(1, 9))
"""Lines of constant deceleration [g]."""
_THIN: Stroke = {"color": NOMINAL["color"], "linewidth": 0.5, "alpha": 0.6}
_KNM = 1e3  # [N m] to the kN m


def vehicle_facts(vehicle: Vehicle) -> Facts:
    """Return loads and torques of a vehicle with its nominal pads."""
    values = characteristics(vehicle)
    biased_up_to = values["front_biased_up_to"]
    locks_first = "rear always"
    if biased_up_to is None:
        locks_first = "front always"
    elif biased_up_to > 0.0:
        locks_first = f"front up to {biased_up_to:.2f} g, rear above"
    axles = [
        (name, *(f"{values[side][key]:.{digits}f}" for side in ("front", "rear")))
        for name, key, digits in (
            ("torque per bar, one wheel [N m]", "torque_per_bar_wheel", 2),
            ("torque per bar, axle [N m]", "torque_per_bar_axle", 2),
            ("load at rest [kg]", "static_load", 0),
            ("load at 0.5 g [kg]", "load_at_half_g", 0),
            ("mass of a wheel at its radius [kg]", "wheel_mass", 1),
        )
    ]
    tolerances = [axle.pad_friction_tolerance for axle in (vehicle.front, vehicle.rear)]
    if tolerances != [None, None]:
        shares = ("" if share is None else f"{100 * share:.2g}" for share in tolerances)
        axles.append(("pad friction known to [%]", *shares))
    return Facts(
        headline=f"{vehicle.name}, {vehicle.mass:g} kg",
        rows=[
            ("wheelbase", f"{1e3 * values['wheelbase']:.0f} mm"),
            ("pressure", f"{values['pressure_per_g']:.1f} bar per g"),
            ("brake force", f"{100 * values['front_share']:.1f} % front"),
            ("locks first", locks_first),
            ("rear lifts at", f"{values['rear_lifts_at']:.2f} g"),
        ],
        parts=[Facts("Axles", tables=[Table(("axle", "front", "rear"), axles)])],
        warnings=vehicle_warnings(vehicle),
    )


def cards(effects: Sequence[Card]) -> Facts:
    """Return each effect with its cause."""
    rows = [(effect.name, effect.cause) for effect in effects]
    return Facts(tables=[Table(("effect", "cause"), rows)])


def card(effect: Card) -> Facts:
    """Return the card of an effect; parameters have expected value, spread and range."""
    keys = ("name", "cause", "equation", "source", "looks_like")
    rows = [(spaced(key), str(getattr(effect, key))) for key in keys]
    for p in effect.parameters:
        unit = unit_suffix(p.unit)
        usual = f"{p.typical:g} +- {p.spread:g}{unit}, from {p.low:g} to {p.high:g}{unit}"
        rows.append((p.name, usual))
    return Facts(rows=rows)


def vehicle_sheet(vehicle: Vehicle) -> Sheet:
    """Return the sheet of Fig. 2: torques of the axles up to 1 g.

    Points on the beta line mark 0.1 g, 0.2 g ...; as in (9), the wheels' inertia is neglected.
    """
    share, per_g = front_share(vehicle, 0.0), pressure_per_g(vehicle) / BAR
    front, rear = vehicle.front, vehicle.rear
    gain_f, gain_r = (axle.torque_gain * axle.pad_friction for axle in (front, rear))
    ratio = gain_r / gain_f  # T_br/T_bf at one pressure, (2)

    def beta(z: Array) -> Array:
        """Return the axles' torques [kN m] (n, 2) at z [1] (n,) on the beta line, (5), (9)."""
        force_per_front = (
            1.0 / front.rolling_radius + ratio / rear.rolling_radius
        )  # over T_bf [1/m]
        torque_f = np.asarray(z)[:, None] * vehicle.weight / force_per_front / _KNM  # (n, 1)
        return np.array([1.0, ratio]) * torque_f

    rear_lifts_at = vehicle.cg_to_front_axle / vehicle.cg_height  # z [1] without load at the rear
    z = np.linspace(0.0, min(1.0, rear_lifts_at), 101)
    load_f, load_r = axle_loads(vehicle, z)
    ideal_f = front.rolling_radius * z * load_f / _KNM
    ideal_r = rear.rolling_radius * z * load_r / _KNM
    points = beta(np.array(_DECELERATIONS))
    end = 1.08 * beta(np.ones(1))[0, 0]  # the front torque at 1 g, and a margin
    lines = [
        Line(ideal_f, ideal_r, BODY, "I curve: equal friction"),
        Line([0.0, end], [0.0, ratio * end], IDENTIFIED, "installed, nominal pads"),
    ]
    for deceleration in _DECELERATIONS:
        force = vehicle.weight * deceleration / _KNM
        intercepts = [force * front.rolling_radius, 0.0], [0.0, force * rear.rolling_radius]
        lines.append(Line(*intercepts, _THIN))
    lines.append(Line(points[:, 0], points[:, 1], dots(IDENTIFIED, 3.2)))
    biased_up_to = front_biased_up_to(vehicle)
    if 0.0 < biased_up_to <= 1.0:
        point = beta(np.array([biased_up_to]))
        label = f"front locks first up to {biased_up_to:.2f} g"
        lines.append(Line(point[:, 0], point[:, 1], dots(BODY, 6.0, "D", mfc="white"), label))
    panel = Panel(
        "torque-distribution",
        "Brake torque of the axles",
        "front axle torque [kN m]",
        "rear axle torque [kN m]",
        lines,
        texts=[(f"{z:g} g", x, y) for z, (x, y) in zip(_DECELERATIONS, points, strict=True)],
        xlim=(0.0, end),
        ylim=(0.0, 1.15 * max(float(ideal_r.max()), ratio * end)),
        columns=2,
    )
    return Sheet(
        kind="vehicle",
        name=vehicle.name,
        panels=(panel,),
        heights=(1.8,),
        title=f"Brakes of {vehicle.name}",
        note=f"With the nominal pads of the file: {per_g:.1f} bar per g, {100 * share:.1f} % of "
        "the brake force at the front. Straight line, one pressure on both axles, no drag, no "
        "control of slip; the inertia of the wheels is neglected.",
    )
