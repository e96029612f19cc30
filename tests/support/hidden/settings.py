"""What may be hidden in the car of the plant beside it: one record, nothing hidden by default."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Hidden:
    """Every switch of the plant, SI. The first block is the catalogue's, the second lies outside.

    Attributes
    ----------
    drag_area : c_d A [m^2], density 1.2 kg/m^3.
    rolling : moment over load and radius [1] at 20 m/s; it grows mildly with speed.
    grade : rise over run [1], uphill positive. ``grade_felt``: a_x is specific force, as a real
        accelerometer has it, and not dv/dt.
    engine_torque : on the front axle [N m] at 20 m/s; it grows mildly with speed.
    fade, fade_onset : loss per kelvin [1/K] far above the onset [degC]; the onset is rounded.
    speed_slope : d ln(mu)/dv [s/m], nothing at 20 m/s; an exponential.
    pressure_slope : relative change of mu per pressure [1/Pa], nothing at 20 bar.
    wet_loss, dry_energy : loss at first [1], energy in one front brake that regains 63 % [J]; a
        rear brake needs half of it.
    radius_mismatch : true over nominal rear radius, less one [1].
    threshold : pressure before the pads press [Pa]; the corner is rounded.
    lag, lag_behind, delay : of the line pressure [s]; a delay, then two lags in a row.
    surge, surge_damping : the line pressure swings at this frequency [Hz], damped so far [1].
    knee, knee_slope : rear pressure above the knee [Pa] rises with this slope [1].
    hysteresis : width of the loop between application and release, relative [1].
    hysteresis_fixed : half width of a play that does not depend on the pressure [Pa].
    pitch_frequency, pitch_damping, pitch_gain : [Hz], [1], dive per deceleration over g [rad].
    bias, scale_error : of the accelerometer [m/s^2], [1].
    inertia : added to each front wheel [kg m^2].
    imbalance : left wheels brake (1 + x), right (1 - x) [1]; ``imbalance_rear`` of it behind [1].
    thickness, thickness_right, thickness_order : torque ripple of the front left disc [1], that of
        the right one over it [1], ripples per turn.
    mass_error : true over nominal mass, less one [1].
    sticking : pressure [Pa] that stays in the rear brakes after the first release.
    regen_torque, regen_power, regen_axle : while braking, per wheel [N m], [W], 0 front, 1 rear.
    regen_lag : time constant [s] with which the motor's torque follows.
    radius_load : share by which a rolling radius falls when the load of its wheel doubles [1].
    tooth_error : amplitude [1] once per turn of the front left wheel-speed reading.
    filter_frequency : corner [Hz] of the Butterworth filter of second order on a_x; 0 for none.
    v_late : time [s] by which v is read late.
    wheel_window : wheel speeds are means over this time [s], ended now.

    abs_slip : slip above which wheel pressures are modulated [1]; 0 for never.
    stiffness_speed : relative change of the tyre's stiffness per speed [s/m], nothing at 20 m/s.
    stiffness_heat : relative loss of the tyre's stiffness per braking energy of the car [1/J].
    slosh_mass, slosh_frequency : share of the mass [1] on a spring [Hz].
    weaker_by : loss of brake force with each further application in a run [1].
    seized : constant torque on the rear left wheel [N m].
    rear_tyres : true over equal stiffness of the rear tyres, less one [1].
    tyre_load : share by which the stiffness per load falls when the load of a wheel doubles [1].
    through_springs : share of the load transfer that follows the pitch [1]; links carry the rest.
    flap_area : c_d A [m^2] more while braking: it opens over the pressure from 2 to 12 bar.
    """

    drag_area: float = 0.0
    rolling: float = 0.0
    grade: float = 0.0
    grade_felt: bool = True
    engine_torque: float = 0.0
    fade: float = 0.0
    fade_onset: float = 150.0
    speed_slope: float = 0.0
    pressure_slope: float = 0.0
    wet_loss: float = 0.0
    dry_energy: float = 60e3
    radius_mismatch: float = 0.0
    threshold: float = 0.0
    lag: float = 0.0
    lag_behind: float = 0.0
    delay: float = 0.0
    surge: float = 0.0
    surge_damping: float = 0.4
    knee: float = 0.0
    knee_slope: float = 1.0
    hysteresis: float = 0.0
    hysteresis_fixed: float = 0.0
    pitch_frequency: float = 0.0
    pitch_damping: float = 0.3
    pitch_gain: float = 0.0
    bias: float = 0.0
    scale_error: float = 0.0
    inertia: float = 0.0
    imbalance: float = 0.0
    imbalance_rear: float = 1.0
    thickness: float = 0.0
    thickness_right: float = 1.0
    thickness_order: int = 1
    mass_error: float = 0.0
    sticking: float = 0.0
    regen_torque: float = 0.0
    regen_power: float = 0.0
    regen_axle: int = 0
    regen_lag: float = 0.0
    radius_load: float = 0.0
    tooth_error: float = 0.0
    filter_frequency: float = 0.0
    v_late: float = 0.0
    wheel_window: float = 0.0

    abs_slip: float = 0.0
    stiffness_speed: float = 0.0
    stiffness_heat: float = 0.0
    slosh_mass: float = 0.0
    slosh_frequency: float = 0.6
    weaker_by: float = 0.0
    seized: float = 0.0
    rear_tyres: float = 0.0
    tyre_load: float = 0.0
    through_springs: float = 1.0
    flap_area: float = 0.0
