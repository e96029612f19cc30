"""What may be hidden in the car of the plant beside it: one record, nothing hidden by default."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Hidden:
    """Every switch of the plant, SI. The first block is the catalogue's, the second lies outside.

    "At 20 m/s" is where a moment has the value given, from which it grows mildly with speed.
    """

    drag_area: float = 0.0  # c_d A [m^2], density 1.2 kg/m^3
    rolling: float = 0.0  # moment over load and radius [1] at 20 m/s
    grade: float = 0.0  # rise over run [1], uphill positive
    grade_felt: bool = True  # a_x is specific force, as of a real accelerometer, and not dv/dt
    engine_torque: float = 0.0  # on the front axle [N m] at 20 m/s
    fade: float = 0.0  # loss per kelvin [1/K] far above the onset
    fade_onset: float = 150.0  # [degC]; it is rounded
    speed_slope: float = 0.0  # d ln(mu)/dv [s/m], nothing at 20 m/s; an exponential
    pressure_slope: float = 0.0  # change of mu per pressure [1/Pa], relative, nothing at 20 bar
    wet_loss: float = 0.0  # at first [1]
    dry_energy: float = 60e3  # in one front brake that regains 63 % [J]; half of it in a rear one
    radius_mismatch: float = 0.0  # true over nominal rear radius, less one [1]
    threshold: float = 0.0  # pressure before the pads press [Pa]; the corner is rounded
    lag: float = 0.0  # of the line pressure [s]; a delay, then two lags in a row
    lag_behind: float = 0.0  # [s]
    delay: float = 0.0  # [s]
    surge: float = 0.0  # the line pressure swings at this frequency [Hz]
    surge_damping: float = 0.4  # [1]
    knee: float = 0.0  # pressure [Pa] above which the rear one rises less
    knee_slope: float = 1.0  # with this slope [1]
    hysteresis: float = 0.0  # width of the loop of application and release, relative [1]
    hysteresis_fixed: float = 0.0  # half width of a play that no pressure changes [Pa]
    pitch_frequency: float = 0.0  # [Hz]
    pitch_damping: float = 0.3  # [1]
    pitch_gain: float = 0.0  # dive per deceleration over g [rad]
    bias: float = 0.0  # of the accelerometer [m/s^2]
    scale_error: float = 0.0  # of the accelerometer [1]
    inertia: float = 0.0  # added to each front wheel [kg m^2]
    imbalance: float = 0.0  # left wheels brake (1 + x), right (1 - x) [1]
    imbalance_rear: float = 1.0  # share of it behind [1]
    thickness: float = 0.0  # torque ripple of the front left disc [1]
    thickness_right: float = 1.0  # that of the right one over it [1]
    mass_error: float = 0.0  # true over nominal mass, less one [1]
    sticking: float = 0.0  # pressure that stays in the rear brakes after the first release [Pa]
    regen_torque: float = 0.0  # while braking, per wheel [N m]
    regen_power: float = 0.0  # which it does not exceed [W]
    regen_axle: int = 0  # 0 front, 1 rear
    regen_lag: float = 0.0  # time constant with which the torque follows [s]
    radius_load: float = 0.0  # share by which a radius falls when its wheel's load doubles [1]
    tooth_error: float = 0.0  # amplitude once per turn of the front left wheel-speed reading [1]
    filter_frequency: float = 0.0  # corner of a second-order Butterworth on a_x [Hz]; 0 for none
    v_late: float = 0.0  # time by which v is read late [s]
    wheel_window: float = 0.0  # wheel speeds are means over this time, ended now [s]

    abs_slip: float = 0.0  # slip above which wheel pressures are modulated [1]; 0 for never
    stiffness_speed: float = 0.0  # change of the tyre's stiffness per speed [s/m], 0 at 20 m/s
    stiffness_heat: float = 0.0  # loss of the tyre's stiffness per braking energy of the car [1/J]
    slosh_mass: float = 0.0  # share of the mass on a spring [1]
    slosh_frequency: float = 0.6  # of that spring [Hz]
    weaker_by: float = 0.0  # loss of brake force with each further application in a run [1]
    seized: float = 0.0  # constant torque on the rear left wheel [N m]
    through_springs: float = 1.0  # share of the load transfer that follows the pitch [1]
    flap_area: float = 0.0  # c_d A more while braking [m^2]: opens over 2 to 12 bar
