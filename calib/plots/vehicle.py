"""The brakes of a vehicle file: the ideal parabola, the installed line, friction used."""

from typing import TYPE_CHECKING

import numpy as np

from calib.physics.bias import friction_used, front_share, pressure_per_g
from calib.physics.forces import front_biased_up_to
from calib.physics.vehicle import Vehicle
from calib.plots.distribution import DECELERATIONS, beta_point, ideal, rear_per_front
from calib.plots.sheet import Panel, Sheet
from calib.plots.style import BODY, FRONT, IDENTIFIED, NOMINAL, REAR

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TOP = 1.0
"""Highest deceleration that is drawn [g]."""
BAR = 1e5


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
            Panel(
                "distribution",
                "Brake torque of the axles",
                lambda ax: installed(ax, vehicle),
                columns=3,
            ),
            Panel(
                "friction",
                "Friction that the axles use",
                lambda ax: friction(ax, vehicle),
                columns=3,
            ),
        ),
        rows=(("distribution",), ("friction",)),
        heights=(1.4, 1.0),
    )


def installed(ax: "Axes", vehicle: Vehicle) -> None:
    """Rear over front torque: the ideal parabola, the installed line, lines of equal z."""
    ratio = rear_per_front(vehicle, vehicle.front.pad_friction, vehicle.rear.pad_friction)
    ideal_f, ideal_r = ideal(vehicle)
    top = beta_point(vehicle, ratio, TOP)
    ax.plot(ideal_f / 1e3, ideal_r / 1e3, label="ideal: both axles use the same friction", **BODY)
    line = np.array([0.0, top[0]]) / 1e3
    ax.plot(line, ratio * line, label="installed, nominal pads", **IDENTIFIED)
    for z in (*DECELERATIONS, 0.9, TOP):
        front = vehicle.weight * z * vehicle.front.rolling_radius / 1e3
        rear = vehicle.weight * z * vehicle.rear.rolling_radius / 1e3
        ax.plot([front, 0.0], [0.0, rear], color=NOMINAL["color"], lw=0.5, alpha=0.6, zorder=1)
        at = beta_point(vehicle, ratio, z)
        ax.plot(at[0] / 1e3, at[1] / 1e3, "o", color=IDENTIFIED["color"], ms=3.0)
        ax.annotate(
            f"{z:g} g",
            (at[0] / 1e3, at[1] / 1e3),
            xytext=(4.0, -9.0),
            textcoords="offset points",
            fontsize=7.0,
        )
    biased = front_biased_up_to(vehicle)
    if 0.0 < biased <= TOP:
        at = beta_point(vehicle, ratio, biased)
        entry = f"front locks first up to {biased:.2f} g"
        ax.plot(at[0] / 1e3, at[1] / 1e3, "D", mfc="white", color=BODY["color"], label=entry)
    ax.set_xlim(0.0, 1.08 * top[0] / 1e3)
    ax.set_ylim(0.0, 1.15 * max(float(ideal_r.max()), top[1]) / 1e3)
    ax.set(xlabel="front axle torque [kN m]", ylabel="rear axle torque [kN m]")


def friction(ax: "Axes", vehicle: Vehicle) -> None:
    """Friction used by the axles over the deceleration; the higher one locks first."""
    z = np.linspace(0.0, min(TOP, 0.98 * vehicle.cg_to_front_axle / vehicle.cg_height), 201)
    used_f, used_r = friction_used(vehicle, z)
    ax.plot(z, used_f, label="front axle", **FRONT)
    ax.plot(z, used_r, label="rear axle", **REAR)
    ax.plot(z, z, label="ideal: both alike", **NOMINAL)
    ax.set_xlim(0.0, TOP)
    ax.set_ylim(0.0, 1.4 * TOP)
    ax.set(xlabel="deceleration [g]", ylabel="friction used [1]")
