"""Fig. 2: brake torque of the rear axle over that of the front axle.

T_r |  .-I-.     on the I curve both axles use the same friction;
    | /  ,-' beta  on the beta line the pads share one pressure;
    |/,-'          along the thin lines the deceleration is constant.
    +-------- T_f
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from calib.physics.forces import axle_loads, front_biased_up_to
from calib.physics.vehicle import Vehicle
from calib.plots.style import BODY, IDENTIFIED, NOMINAL, band
from calib.statistics.intervals import Z95
from calib.table.table import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

DECELERATIONS = tuple(k / 10.0 for k in range(1, 9))
"""Lines of constant deceleration [g]."""
P = 0.3
"""The deceleration of the paper's point P [g]."""


def distribution(ax: "Axes", table: Table) -> None:
    """Draw Fig. 2 for the car of a table, with its nominal and its identified pads.

    Torques are per axle. As in (9), the inertia of the wheels is neglected.
    """
    vehicle, pads = table.vehicle, table.calibration
    half = Z95 * pads.pad_log_ratio.sigma
    nominal = rear_per_front(vehicle, vehicle.front.pad_friction, vehicle.rear.pad_friction)
    found = rear_per_front(vehicle, pads.pad_friction_f.value, pads.pad_friction_r.value)
    top = beta_point(vehicle, min(nominal, found), DECELERATIONS[-1])[0] * 1.08
    ideal_f, ideal_r = ideal(vehicle)
    ax.plot(ideal_f / 1e3, ideal_r / 1e3, label="I curve: equal friction", **BODY)
    line = np.array([0.0, top])
    band(
        ax,
        line / 1e3,
        found * np.exp(-half) * line / 1e3,
        found * np.exp(half) * line / 1e3,
        IDENTIFIED,
    )
    ax.plot(line / 1e3, found * line / 1e3, label=r"$\beta$, pads as identified", **IDENTIFIED)
    ax.plot(line / 1e3, nominal * line / 1e3, label=r"$\beta$, nominal pads", **NOMINAL)
    _constant_decelerations(ax, vehicle, found)
    end = table.paper.usable[1]
    last = beta_point(vehicle, found, end)
    entry = f"usable up to {end:.2f} g"
    ax.plot(last[0] / 1e3, last[1] / 1e3, "|", color=BODY["color"], ms=12.0, mew=1.4, label=entry)
    biased = front_biased_up_to(vehicle)
    if 0.0 < biased <= DECELERATIONS[-1]:
        entry = f"front-biased up to {biased:.2f} g"
        at = beta_point(vehicle, nominal, biased)
        ax.plot(at[0] / 1e3, at[1] / 1e3, "D", mfc="white", color=NOMINAL["color"], label=entry)
    ax.set_xlim(0.0, top / 1e3)
    ax.set_ylim(0.0, 1.15 * max(float(ideal_r.max()), found * top, nominal * top) / 1e3)
    ax.set(xlabel="front axle torque [kN m]", ylabel="rear axle torque [kN m]")


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


def _constant_decelerations(ax: "Axes", vehicle: Vehicle, ratio: float) -> None:
    """Thin lines of constant z, and their intersections with the identified beta line."""
    grey = NOMINAL["color"]
    for z in DECELERATIONS:
        front = vehicle.weight * z * vehicle.front.rolling_radius / 1e3
        rear = vehicle.weight * z * vehicle.rear.rolling_radius / 1e3
        ax.plot([front, 0.0], [0.0, rear], color=grey, linewidth=0.5, alpha=0.6, zorder=1)
        at_f, at_r = (torque / 1e3 for torque in beta_point(vehicle, ratio, z))
        label = "deceleration [g]" if z == DECELERATIONS[0] else None
        size = 6.0 if z == P else 3.2
        ax.plot(at_f, at_r, "o", color=IDENTIFIED["color"], ms=size, zorder=3, label=label)
        ax.annotate(
            f"P, {z:g} g" if z == P else f"{z:g}",
            (at_f, at_r),
            xytext=(4.0, -9.5),
            textcoords="offset points",
            fontsize=7.0,
            fontweight="bold" if z == P else "normal",
        )
