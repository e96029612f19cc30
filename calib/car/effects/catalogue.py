"""The list of all effects.

A new effect needs its place in `EFFECTS` of the file of its link, in the order in which effects of
that link act, and its name in `_ORDER`.
"""

from calib.base.errors import ModelError
from calib.car.effects import body, caliper, line, pads, sensors, wheels
from calib.car.effects.effect import Effect

_CHAIN = {
    effect.card.name: effect
    for link in (line, caliper, pads, wheels, body, sensors)
    for effect in link.EFFECTS
}
_ORDER = (
    "aerodynamic_drag rolling_resistance road_grade engine_drag pad_thermal_fade "
    "pad_speed_dependence pad_pressure_dependence wet_pad_recovery rolling_radius_mismatch "
    "brake_threshold_pressure hydraulic_lag hydraulic_delay rear_proportioning "
    "caliper_hysteresis pitch_coupling accelerometer_bias accelerometer_scale wheel_inertia "
    "side_imbalance disc_thickness_variation mass_error residual_torque hydraulic_oscillation "
    "regenerative_torque rolling_radius_load tone_ring_runout accelerometer_lag speed_delay "
    "wheel_speed_delay"
)
"""The order in which effects are listed, and tried by a diagnosis."""

CATALOGUE: dict[str, Effect] = {name: _CHAIN[name] for name in _ORDER.split()}

LINE = tuple(effect.card.name for effect in line.EFFECTS)
"""Effects between the master cylinder and the wheels, in the direction of flow."""

CALIPER = tuple(effect.card.name for effect in caliper.EFFECTS)
"""Effects in the caliper, behind a wheel pressure sensor."""

SENSOR = tuple(name for name, effect in _CHAIN.items() if effect.accelerometer is not None)
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
