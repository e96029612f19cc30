"""A vehicle: its facts, the effects it may have, the torques of its axles, Fig. 2 of a table.

T_r |  .-I-.     on the I curve both axles use the same friction;
    | /  ,-' beta  on the beta line the pads share one pressure;
    |/,-'          along the thin lines the deceleration is constant.
    +-------- T_f
"""

from collections.abc import Sequence

import numpy as np

from calib.base.intervals import Z95
from calib.base.units import behind
from calib.car.bias import friction_used, front_share, pressure_per_g
from calib.car.effects.effect import Card
from calib.car.forces import axle_loads, front_biased_up_to
from calib.car.plausible import plausible
from calib.car.vehicle import Vehicle
from calib.show.facts import Facts
from calib.show.facts import Table as Cells
from calib.show.sheet import Panel, Sheet
from calib.show.style import (
    BAR,
    BODY,
    FRONT,
    IDENTIFIED,
    NOMINAL,
    REAR,
    Array,
    Axes,
    Stroke,
    band,
    beside,
)
from calib.table.table import Table

_TOP = 1.0
"""Highest deceleration that is drawn [g]."""
_DECELERATIONS = tuple(k / 10.0 for k in range(1, 9))
"""Lines of constant deceleration [g]."""
P = 0.3
"""The deceleration of the paper's point P [g]."""
_KNM = 1e3


def facts(vehicle: Vehicle) -> Facts:
    """What follows from a vehicle with its nominal pads."""
    from calib.car.facts_file import what_follows

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
    brakes = [
        (
            *(f"{b.deceleration:.1f}", f"{b.pressure:.1f}"),
            *(f"{100 * share:.1f}" for share in (b.front_share, b.ideal_front_share)),
            *("lifted" if x is None else f"{x:.2f}" for x in (b.friction_f, b.friction_r)),
            *(f"{b.torque_f:.0f}", f"{b.torque_r:.0f}"),
        )
        for b in found.distribution
    ]
    locks = [
        (f"{x.friction:.1f}", x.axle, f"{x.deceleration:.2f}", f"{x.pressure:.0f}")
        for x in found.first_lock
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
        tables=[
            Cells(("axle", "front", "rear"), axles),
            Cells(("g", "pressure [bar]", "front [%]", "ideal [%]", "friction front",
                   "friction rear", "torque front [N m]", "torque rear [N m]"), brakes),
            Cells(("road friction", "locks first", "at [g]", "at [bar]"), locks),
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
    share, per_g = front_share(vehicle), pressure_per_g(vehicle) / BAR
    return Sheet(
        kind="vehicle",
        name=vehicle.name,
        title=f"Brakes of {vehicle.name}",
        note=f"With the nominal pads of the file: {per_g:.1f} bar per g, {100 * share:.1f} % of "
        "the brake force at the front. Straight line, one pressure on both axles, no drag, no "
        "control of slip; the inertia of the wheels is neglected.",
        panels=(
            Panel("distribution", "Brake torque of the axles", _installed, (vehicle,)),
            Panel("friction", "Friction that the axles use", friction, (vehicle,)),
        ),
        rows=(("distribution",), ("friction",)),
        heights=(1.4, 1.0),
    )


def _installed(ax: Axes, vehicle: Vehicle) -> None:
    """Rear over front torque: the ideal parabola, the _installed line, lines of equal z."""
    ratio = _nominal_ratio(vehicle)
    top = beta_point(vehicle, ratio, _TOP)[0]
    _lines(ax, vehicle, {"installed, nominal pads": (ratio, IDENTIFIED)}, 1.08 * top, ratio)
    _biased(ax, vehicle, ratio, _TOP, BODY["color"])


def friction(ax: Axes, vehicle: Vehicle) -> None:
    """Friction used by the axles over the deceleration; the higher one locks first."""
    z = np.linspace(0.0, min(_TOP, 0.98 * vehicle.cg_to_front_axle / vehicle.cg_height), 201)
    used_f, used_r = friction_used(vehicle, z)
    ax.plot(z, used_f, label="front axle", **FRONT)
    ax.plot(z, used_r, label="rear axle", **REAR)
    ax.plot(z, z, label="ideal: both alike", **NOMINAL)
    ax.set(xlabel="deceleration [g]", ylabel="friction used [1]")
    ax.set(xlim=(0.0, _TOP), ylim=(0.0, 1.4 * _TOP))


def distribution(ax: Axes, table: Table) -> None:
    """Draw Fig. 2 for the car of a table, with its nominal and its identified pads.

    Torques are per axle. As in (9), the inertia of the wheels is neglected.
    """
    vehicle, pads = table.vehicle, table.calibration
    half = Z95 * pads.pad_log_ratio.sigma
    nominal = _nominal_ratio(vehicle)
    found = rear_per_front(vehicle, pads.pad_friction_f.value, pads.pad_friction_r.value)
    top = beta_point(vehicle, min(nominal, found), _DECELERATIONS[-1])[0] * 1.08
    ends = np.array([0.0, top]) / _KNM
    band(ax, ends, np.exp(-half) * found * ends, np.exp(half) * found * ends, IDENTIFIED)
    betas = {
        r"$\beta$, pads as identified": (found, IDENTIFIED),
        r"$\beta$, nominal pads": (nominal, NOMINAL),
    }
    _lines(ax, vehicle, betas, top, found)
    end = table.paper.usable[1]
    front, rear = (torque / _KNM for torque in beta_point(vehicle, found, end))
    mark = {"color": BODY["color"], "ms": 12.0, "mew": 1.4}
    ax.plot(front, rear, "|", label=f"usable up to {end:.2f} g", **mark)
    _biased(ax, vehicle, nominal, _DECELERATIONS[-1], NOMINAL["color"])


def _lines(
    ax: Axes, vehicle: Vehicle, betas: dict[str, tuple[float, Stroke]], top: float, ratio: float
) -> None:
    """The I curve, each beta line up to ``top`` [N m], and the decelerations along ``ratio``."""
    front, rear = (torque / _KNM for torque in ideal(vehicle))
    ax.plot(front, rear, label="I curve: equal friction", **BODY)
    for label, (slope, stroke) in betas.items():
        ax.plot([0.0, top / _KNM], [0.0, slope * top / _KNM], label=label, **stroke)
    for z in _DECELERATIONS:
        _constant_deceleration(ax, vehicle, ratio, z)
    ax.plot([], [], "o", color=IDENTIFIED["color"], ms=3.2, label="deceleration [g]")
    highest = max(float(rear.max()), *(slope * top / _KNM for slope, _ in betas.values()))
    ax.set(xlim=(0.0, top / _KNM), ylim=(0.0, 1.15 * highest))
    ax.set(xlabel="front axle torque [kN m]", ylabel="rear axle torque [kN m]")


def _constant_deceleration(ax: Axes, vehicle: Vehicle, ratio: float, z: float) -> None:
    """A thin line of constant z, its point on the beta line, and the number beside it."""
    radii = vehicle.front.rolling_radius, vehicle.rear.rolling_radius
    front, rear = (vehicle.weight * z * radius / _KNM for radius in radii)
    ax.plot([front, 0.0], [0.0, rear], color=NOMINAL["color"], lw=0.5, alpha=0.6, zorder=1)
    front, rear = (torque / _KNM for torque in beta_point(vehicle, ratio, z))
    named = z == P
    ax.plot(front, rear, "o", color=IDENTIFIED["color"], ms=6.0 if named else 3.2, zorder=3)
    text, weight = (f"P, {z:g} g", "bold") if named else (f"{z:g}", "normal")
    beside(ax, text, (front, rear), (4.0, -9.5), fontweight=weight)


def _biased(ax: Axes, vehicle: Vehicle, ratio: float, top: float, colour: str) -> None:
    """Mark the deceleration up to which the front axle uses more friction, if it is in view."""
    biased = front_biased_up_to(vehicle)
    if 0.0 < biased <= top:
        front, rear = (torque / _KNM for torque in beta_point(vehicle, ratio, biased))
        label = f"front locks first up to {biased:.2f} g"
        ax.plot(front, rear, "D", mfc="white", color=colour, label=label)


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


def _nominal_ratio(vehicle: Vehicle) -> float:
    return rear_per_front(vehicle, vehicle.front.pad_friction, vehicle.rear.pad_friction)
