"""From which size on a warning is given, in one record; each number with its reason."""

from dataclasses import dataclass


@dataclass(frozen=True)
class _PlausibilityLimits:
    """Each is named after what it decides; the comments name the file."""

    # accelerometer.py
    a_x_scale: float = 0.025
    """Scale error of a_x [1] from which it is named: data sheets allow 1 to 3 %."""
    a_x_offset: float = 0.05
    """Offset of a_x, or deceleration of the rolling car [m/s^2], that is not explained: 0.005 g."""
    a_x_late: float = 0.10
    """Delay of a_x against v [s] from which it is named: filters of sensors take 0.02 s."""

    # bend.py
    lateral: float = 1.5
    """Mean lateral acceleration of a ramp [m/s^2] from which it is named: half of that from which a
    sample of a stop is not valid."""
    bend_braking: float = 0.1
    """Deceleration [1] past which left and right are not compared: the inner wheels of a bend bear
    less and slip more, which looks like a tighter one."""
    bend_wheel_speed: float = 10.0
    """Wheel speed [rad/s] from which left and right are compared: 3 m/s."""

    # brakes.py
    force: float = 0.045
    """Force without pressure over the usual brake force [1] from which it is named: it moves the
    pads of one axle by 6 to 16 %."""
    usual_force: float = 0.015
    """Spread of that force where nothing but the pads brakes [1]: the pressure at which pads bite
    and the zero of p_mc within 0.5 bar, over 30 bar."""
    usual_fading: float = 0.02
    """Spread of the force that goes with the speed there [1]: what is left of slow noise in the
    half second below 3 m/s. Pads that grip more as they get slow are below zero."""
    motor_force: float = 0.1
    """Spread of both where a motor brakes along [1]: 0.01 to 0.1 g beside 0.3 g by the pads."""
    motor_stated: float = 0.01
    """Odds of such a motor, not logged, that are left where the vehicle file says that there is
    none: files are wrong, too, and a run can show it."""
    motor_likely: float = 0.4
    """Chance of a motor from which it is named [1]: what is named too often costs a look, a motor
    that is not named stands in the pads."""
    force_missing: float = -0.05
    """The same from which force is missing, below zero: pads take 0.5 to 2 bar to bite, which is 3
    % of a usual stop."""
    sure: float = 3.6
    """Standard deviations from zero from which missing force and a delay are named: one false alarm
    in 3000 runs of white noise; the noise of roads makes more."""
    pressure_lag: float = 0.11
    """Delay between pressure and deceleration [s] from which it is named."""
    pressure_zero: float = 0.5e5
    """Pressure of the rolling car [Pa] from which it is named: the zero of sensors of 250 bar
    drifts by 0.2 % of their range."""

    # channels.py
    radius: float = 0.02
    """Difference of a rolling radius from the file's [1] that wear and inflation can cause."""

    # load.py
    seats: tuple[float, float] = (-0.15, 0.65)
    """What of a load the front axle carries [1]: a boot behind the rear axle -0.15, the rear seats
    0.3, the front seats 0.5 to 0.55."""

    # pads.py
    pads_possible: tuple[float, float] = (0.05, 1.0)
    """Pad friction [1] that a brake can have: soaked pads have 0.1, racing pads 0.7."""
    pads_of_file: tuple[float, float] = (0.8, 1.25)
    """Pad friction over that of the vehicle file [1]: pads of one grade scatter by 10 %."""
    pad_ratio: float = 0.09
    """Departure of the pads' ratio from the file's (logarithm) from which it is named, if its
    interval says so too."""
    ratio_possible: float = 0.26
    """Departure of the pads' ratio from the file's (logarithm) past which, with its interval, the
    file is not that of the car: pads of two grades differ by 30 %."""
    pads_scatter: float = 0.1
    """Scatter of the pads of one grade [1]."""
    ratio_drawn: float = 0.25
    """Share of its departure by which a fit may draw the ratio to that of the file [1]."""
    stiffness: tuple[float, float] = (8.0, 60.0)
    """Slip stiffness of tyres over their load [1]: winter tyres on a wet road have 10, sports tyres
    on a dry one 40."""
    pads_apart: float = 0.08
    """Change of the front pads over that of the rear ones [1] from which it is named."""
    pad_level: float = 0.06
    """Change of the brakes since the ramp (logarithm) from which it is named: pads with one load
    and one temperature repeat to 2 %, and the estimate of a stop errs by 2 %."""
    loaded: float = 0.25
    """Change past which no load and no sensor that works is the cause (logarithm): all seats and
    the boot are a quarter of a car's mass. Pads that are soaked lose half."""

    # resistance.py
    resistance: float = 0.018
    """Rolling coefficient [1] from which it is named: tyres that may be sold have up to 0.0105, of
    the worst class 0.012 (Regulations (EC) 661/2009 and (EU) 2020/740), and half as much again
    cold."""

    # wheel_signals.py
    v_force: float = 0.05
    """Nominal brake force of an axle over its load [1] from which the slip of its tyres is seen."""
    v_time: float = 1.0
    """Time of such braking, or of rolling, that is needed [s]."""
    v_slip: float = 0.2
    """Slip (rms) over the least that a tyre has [1], below which v is made of the wheels. Tyres of
    a stiffness of 15 to 40 have 1.5 to 4; a zero of the slip that is 1e-4 off adds 0.05."""
    pulse_span: int = 11
    """Samples of the median from which a lost pulse stands out."""
    pulse_sigma: float = 5.0
    """Distance below that median, in its usual scatter, or in 0.1 % of the speed, that noise does
    not have."""
    pulses: float = 0.005
    """Share of such samples, less twice that of those above, from which the sensor is named."""


PLAUSIBLE = _PlausibilityLimits()
