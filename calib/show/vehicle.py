"""A vehicle: its facts, the effects it may have, and Fig. 2, the torques of its axles.

T_r |  .-I-.     on the I curve both axles use the same friction;
    | /  ,-' beta  on the beta line the pads share one pressure;
    |/,-'          along the thin lines the deceleration is constant.
    +-------- T_f
"""

from collections.abc import Sequence

import numpy as np

from calib.base.units import behind
from calib.car.balance import friction_used, front_biased_up_to, front_share, pressure_per_g
from calib.car.effects.effect import Card
from calib.car.forces import axle_loads
from calib.car.plausible import plausible
from calib.car.vehicle import Vehicle
from calib.show.facts import Facts
from calib.show.facts import Table as Cells
from calib.show.panel import Line, Panel
from calib.show.sheet import Sheet
from calib.show.style import BAR, BODY, FRONT, IDENTIFIED, NOMINAL, REAR, Array, Stroke, dots

_DECELERATIONS = tuple(k / 10.0 for k in range(1, 9))
"""Lines of constant deceleration [g]."""
_THIN: Stroke = {"color": NOMINAL["color"], "linewidth": 0.5, "alpha": 0.6}
_KNM = 1e3


def facts(vehicle: Vehicle) -> Facts:
    """What follows from a vehicle with its nominal pads."""
    from calib.car.facts import what_follows

    found = what_follows(vehicle)
    biased = found.front_biased_up_to
    always = {None: "front always", 0.0: "rear always"}
    axles = [
        (name, *(f"{getattr(axle, key):.{digits}f}" for axle in (found.front, found.rear)))
        for name, key, digits in (
            ("torque per bar, one wheel [N m]", "torque_per_bar_wheel", 2),
            ("torque per bar, axle [N m]", "torque_per_bar_axle", 2),
            ("load at rest [kg]", "static_load", 0),
            ("load at 0.5 g [kg]", "load_at_half_g", 0),
            ("mass of a wheel at its radius [kg]", "wheel_mass", 1),
        )
    ]
    known = [axle.pad_friction_tolerance for axle in (vehicle.front, vehicle.rear)]
    if known != [None, None]:
        told = ("" if share is None else f"{100 * share:.2g}" for share in known)
        axles.append(("pad friction known to [%]", *told))
    brakes = [
        (
            *(f"{b.deceleration:.1f}", f"{b.pressure:.1f}"),
            *(f"{100 * share:.1f}" for share in (b.front_share, b.ideal_front_share)),
            *("lifted" if x is None else f"{x:.2f}" for x in (b.friction_f, b.friction_r)),
            *(f"{b.torque_f:.0f}", f"{b.torque_r:.0f}"),
        )
        for b in found.distribution
    ]
    return Facts(
        headline=f"{vehicle.name}, {vehicle.mass:g} kg",
        rows=[
            ("wheelbase", f"{1e3 * found.wheelbase:.0f} mm"),
            ("pressure", f"{found.pressure_per_g:.1f} bar per g"),
            ("brake force", f"{100 * found.front_share:.1f} % front"),
            ("locks first", always.get(biased) or f"front up to {biased:.2f} g, rear above"),
            ("rear lifts at", f"{found.rear_lifts_at:.2f} g"),
        ],
        parts=[
            Facts("Axles and brake force", tables=[
            Cells(("axle", "front", "rear"), axles),
            Cells(("g", "pressure [bar]", "front [%]", "ideal [%]", "friction front",
                   "friction rear", "torque front [N m]", "torque rear [N m]"), brakes),
            ]),
        ],
        warnings=plausible(vehicle),
    )  # fmt: skip


def cards(found: Sequence[Card]) -> Facts:
    """Each effect with its cause."""
    return Facts(tables=[Cells(("effect", "cause"), [(one.name, one.cause) for one in found])])


def card(one: Card) -> Facts:
    """The card of an effect; its parameters as expected value, spread and range."""
    head = ("name", "cause", "equation", "source", "looks_like")
    rows = [(name.replace("_", " "), str(getattr(one, name))) for name in head]
    for p in one.parameters:
        unit = behind(p.unit)
        usual = f"{p.typical:g} +- {p.spread:g}{unit}, from {p.low:g} to {p.high:g}{unit}"
        rows.append((p.name, usual))
    return Facts(rows=rows)


def sheet(vehicle: Vehicle) -> Sheet:
    """Return the sheet of a vehicle with its nominal pads."""
    share, per_g = front_share(vehicle, 0.0), pressure_per_g(vehicle) / BAR
    z = np.linspace(0.0, min(1.0, 0.98 * vehicle.cg_to_front_axle / vehicle.cg_height), 201)
    used_f, used_r = friction_used(vehicle, z)
    used = [
        Line(z, used_f, FRONT, "front axle"),
        Line(z, used_r, REAR, "rear axle"),
        Line(z, z, NOMINAL, "ideal: both alike"),
    ]
    return Sheet(
        kind="vehicle",
        name=vehicle.name,
        panels=(
            _brake_torques(vehicle),
            Panel("friction", "Friction that the axles use", "deceleration [g]",
                  "friction used [1]", used, xlim=(0.0, 1.0), ylim=(0.0, 1.4)),
        ),
        heights=(1.4, 1.0),
        title=f"Brakes of {vehicle.name}",
        note=f"With the nominal pads of the file: {per_g:.1f} bar per g, {100 * share:.1f} % of "
        "the brake force at the front. Straight line, one pressure on both axles, no drag, no "
        "control of slip; the inertia of the wheels is neglected.",
    )  # fmt: skip


def _brake_torques(vehicle: Vehicle) -> Panel:
    """Fig. 2: torques of the axles up to 1 g, the decelerations marked along the beta line.

    As in (9), the inertia of the wheels is neglected.
    """
    ratio = rear_per_front(vehicle, vehicle.front.pad_friction, vehicle.rear.pad_friction)
    end = 1.08 * beta_point(vehicle, ratio, 1.0)[0] / _KNM
    front, rear = (torque / _KNM for torque in ideal(vehicle))
    lines = [
        Line(front, rear, BODY, "I curve: equal friction"),
        Line([0.0, end], [0.0, ratio * end], IDENTIFIED, "installed, nominal pads"),
    ]
    for z in _DECELERATIONS:
        whole_f, whole_r = (
            vehicle.weight * z * axle.rolling_radius / _KNM
            for axle in (vehicle.front, vehicle.rear)
        )
        lines.append(Line([whole_f, 0.0], [0.0, whole_r], _THIN))
    points = np.array([beta_point(vehicle, ratio, z) for z in _DECELERATIONS]) / _KNM
    lines.append(Line(points[:, 0], points[:, 1], dots(IDENTIFIED, 3.2)))
    if 0.0 < (biased := front_biased_up_to(vehicle)) <= 1.0:
        at_f, at_r = beta_point(vehicle, ratio, biased)
        label = f"front locks first up to {biased:.2f} g"
        lines.append(Line([at_f / _KNM], [at_r / _KNM], dots(BODY, 6.0, "D", mfc="white"), label))
    return Panel(
        "torque-distribution",
        "Brake torque of the axles",
        "front axle torque [kN m]",
        "rear axle torque [kN m]",
        lines,
        texts=[(f"{z:g} g", x, y) for z, (x, y) in zip(_DECELERATIONS, points, strict=True)],
        xlim=(0.0, end),
        ylim=(0.0, 1.15 * max(float(rear.max()), ratio * end)),
        columns=2,
    )


def ideal(vehicle: Vehicle) -> tuple[Array, Array]:
    """Torques of the axles [N m] at which both use the friction z [1], z up to rear-wheel lift."""
    z = np.linspace(0.0, min(1.0, vehicle.cg_to_front_axle / vehicle.cg_height), 101)
    load_f, load_r = axle_loads(vehicle, z)
    return vehicle.front.rolling_radius * z * load_f, vehicle.rear.rolling_radius * z * load_r


def rear_per_front(vehicle: Vehicle, friction_f: float, friction_r: float) -> float:
    """T_br/T_bf [1] of the axles at one pressure with these pad frictions, (2)."""
    rear = vehicle.rear.torque_gain * friction_r
    return rear / (vehicle.front.torque_gain * friction_f)


def beta_point(vehicle: Vehicle, ratio: float, z: float) -> tuple[float, float]:
    """Torques of the axles [N m] at z [1] on the line of this ``ratio`` T_br/T_bf [1], (5), (9)."""
    per_front = 1.0 / vehicle.front.rolling_radius + ratio / vehicle.rear.rolling_radius
    front = vehicle.weight * z / per_front
    return front, ratio * front
