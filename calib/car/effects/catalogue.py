"""The list of all effects, and the order in which they act.

A new effect needs one file and one line here. If it changes a pressure or the reading of the
accelerometer, it also needs its place in `LINE`, `CALIPER` or `SENSOR`, in their physical order.
"""

from calib.base.errors import ModelError
from calib.car.effects import (
    accelerometer_bias,
    accelerometer_lag,
    accelerometer_scale,
    aerodynamic_drag,
    brake_threshold_pressure,
    caliper_hysteresis,
    disc_thickness_variation,
    engine_drag,
    hydraulic_delay,
    hydraulic_lag,
    hydraulic_oscillation,
    mass_error,
    pad_pressure_dependence,
    pad_speed_dependence,
    pad_thermal_fade,
    pitch_coupling,
    rear_proportioning,
    regenerative_torque,
    residual_torque,
    road_grade,
    rolling_radius_load,
    rolling_radius_mismatch,
    rolling_resistance,
    side_imbalance,
    speed_delay,
    tone_ring_runout,
    wet_pad_recovery,
    wheel_inertia,
    wheel_speed_delay,
)
from calib.car.effects.effect import Effect

CATALOGUE: dict[str, Effect] = {
    effect.card.name: effect
    for effect in (
        aerodynamic_drag.EFFECT,
        rolling_resistance.EFFECT,
        road_grade.EFFECT,
        engine_drag.EFFECT,
        pad_thermal_fade.EFFECT,
        pad_speed_dependence.EFFECT,
        pad_pressure_dependence.EFFECT,
        wet_pad_recovery.EFFECT,
        rolling_radius_mismatch.EFFECT,
        brake_threshold_pressure.EFFECT,
        hydraulic_lag.EFFECT,
        hydraulic_delay.EFFECT,
        rear_proportioning.EFFECT,
        caliper_hysteresis.EFFECT,
        pitch_coupling.EFFECT,
        accelerometer_bias.EFFECT,
        accelerometer_scale.EFFECT,
        wheel_inertia.EFFECT,
        side_imbalance.EFFECT,
        disc_thickness_variation.EFFECT,
        mass_error.EFFECT,
        residual_torque.EFFECT,
        hydraulic_oscillation.EFFECT,
        regenerative_torque.EFFECT,
        rolling_radius_load.EFFECT,
        tone_ring_runout.EFFECT,
        accelerometer_lag.EFFECT,
        speed_delay.EFFECT,
        wheel_speed_delay.EFFECT,
    )
}

LINE = ("hydraulic_delay", "hydraulic_lag", "hydraulic_oscillation", "rear_proportioning")
"""Effects between the master cylinder and the wheels, in the direction of flow."""

CALIPER = ("brake_threshold_pressure", "caliper_hysteresis", "residual_torque")
"""Effects in the caliper, behind a wheel pressure sensor."""

SENSOR = ("road_grade", "pitch_coupling", "accelerometer_scale", "accelerometer_bias")
"""Effects on the accelerometer: those on the sensed acceleration first, then on the reading."""


def effect_named(name: str) -> Effect:
    """Return the effect of that name. Raises ModelError naming the known ones."""
    if name not in CATALOGUE:
        raise ModelError(
            f"unknown effect {name!r}",
            expected=f"one of {', '.join(CATALOGUE)}",
            do="see calib/car/effects; give --effect FILE.py for one of your own",
        )
    return CATALOGUE[name]


def nothing(name: str) -> dict[str, float]:
    """Parameters [SI] at which the effect changes nothing: neutral strength, typical values else.

    Raises ModelError for an unknown name.
    """
    card = effect_named(name).card
    strength, *others = card.parameters
    return {strength.name: card.neutral} | {p.name: p.typical for p in others}
