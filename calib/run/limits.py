"""What `check` asks of a log, in one record; each number with its reason."""

from dataclasses import dataclass


@dataclass(frozen=True)
class _CheckLimits:
    """Each is named after what it decides; the comments name the file."""

    # copies.py: computed pressures
    computed_alike: float = 1e-3
    """Largest difference of a channel and its source, over its range [1]: rounding of decimals."""

    # copies.py
    copy_correlation: float = 0.99
    """Correlation of the noise of two channels [1] from which they are one signal: the road shakes
    two wheels of an axle alike by 0.5."""
    copy_steps: float = 2.0
    """Noise of a channel over its resolution, below which it is rounding, and says nothing."""
    copy_calmer: float = 0.95
    """Share of the samples, those that change least, in which two copies agree as well: a bump
    shakes all wheels in a few samples, and these are most of the signal."""

    # wheels.py: exchanged wheels
    crossed_alone: float = 3.0
    """X or L over the larger one of the other two [1] from which it stands alone."""
    crossed_least: float = 5e-3
    """X over the deceleration [1] that unlike brakes of the four wheels do not make: slip is z/25
    or a little more, so it is an eighth of it; E of a usual car is a fifth or more
    (`tests/studies/results/crossed_wheels.md`)."""

    # channels.py of plausibility
    wheels_held: float = 0.03
    """Time for which wheel speeds keep a value [s] from which it is named: the slowest log that is
    read has 40 Hz."""

    # gates.py
    radius_tolerance: float = 0.03
    """Largest deviation of v/(R omega) from 1 without braking: tyre wear and pressure cause 2 %."""
    steady_drive: float = 20.0
    """Change of the drive's torque [N m per axle] that moves eta by 0.03 %, a tenth of its rise."""

    # observation.py
    standing: float = 0.5
    """Wheel speed [rad/s] below which a car stands still: 0.15 m/s."""

    # observation.py: pressure
    pressure_width: float = 0.3
    """Width of the means that are compared [s]: brakes build up in 0.1 to 0.2 s."""
    pressure_every: float = 0.05
    """Step at which they are compared [s]."""
    pressure_after: float = 0.5
    """Time after a braking that still tells of it [s]."""
    pressure_lead_in: float = 0.25
    """Rolling before the braking that is needed [s]: without it a steady stop has nothing to
    tell."""
    pressure_braked: float = 1.0
    """Braking that is needed [s]."""

    # rules.py
    rates: tuple[float, float] = (38.0, 1050.0)
    """Sample rates that must work [Hz]: 40 Hz to 1 kHz, with a tolerance for inexact clocks."""
    lead_in_fit: float = 0.5
    """Rolling before a ramp that is needed [s]."""
    lead_in_good: float = 1.0
    """Rolling before a braking that is asked for [s]."""
    lead_in_diagnose: float = 0.25
    """Rolling before a stop that a diagnosis needs [s]."""
    ramp_z: float = 0.25
    """Deceleration [g] that a ramp must reach."""
    ramp_time: float = 2.0
    """Braking of a ramp that is needed [s]."""
    ramp_rise: float = 1.0
    """Time for which its pressure must rise [s]."""
    wheels_held_fit: float = 0.06
    """Longest time for which wheel speeds may keep a value in a ramp [s]: half of it is as late as
    the brakes are to build up, and there is no curve of slip over force then."""
    one_axle_z: float = 0.12
    """The same of a ramp with one axle only: 0.3 of a rear axle's load."""
    braking: float = 1.0
    """Braking above 3 m/s of a stop that is needed [s]."""
    coasting: float = 2.0
    """Coasting that gives the zero of eta and the drag [s]."""
    wheel_radius: tuple[float, float] = (0.12, 0.9)
    """Range of a_x over the deceleration of the wheels [m] that a wheel can have."""
    tyre_radius: tuple[float, float] = (0.24, 0.42)
    """Rolling radius [m] of the tyres of road cars, as a vehicle file may have it."""
    radii_agree: float = 1.3
    """Largest ratio of the radii that ``v`` and a_x make with the wheels [1]: slip and the scale of
    a_x are a tenth of it, mph and km/h 1.6 apart."""
    never_free: float = 1e5
    """Pressure that a released pedal does not leave [Pa]."""
    softest: float = 20e5
    """Pressure for each g [Pa] below that of any car; usual cars need 60 to 150 bar."""
    explained: float = 0.75
    """Share of the deceleration's variance [1] that the pressure of a run explains: 0.95 and more
    with every effect of the catalogue in the brakes, three at a time
    (`tests/studies/results/mixed_up.md`), 0.86 on a race track, with gears and kerbs."""
    pressure: float = 350e5
    """Pressure above that of any master cylinder [Pa]."""
    hole: float = 0.1
    """Longest gap within a braking [s]."""
    eta_alike: float = 5e-4
    """Change of eta [1] below which the axles slip alike; a usual front bias makes 2e-3."""

    # same_run.py: fingerprint
    run_means: float = 0.05
    """Length of the means that are compared [s]."""

    # same_run.py
    run_grid: float = 0.01
    """Shortest step at which samples are compared [s]."""
    run_overlap: float = 0.5
    """Share of the shorter log that must lie within the other one."""
    run_alike: float = 0.75
    """Median of D over p_mc, a_x, v and the wheels, which count as one, below which two logs are
    one run. Of white noise, means of two samples make 0.33, of five 0.67; two runs of one motion
    make 1 (`tests/run/test_same_run.py`). Two stops at one pressure from unlike speeds agree in
    the wheels alone, laid over each other."""
    run_two: float = 1.0
    """Median of D from which two logs are two runs, whatever r is."""
    run_together: float = 0.25
    """r from which two logs whose D is below `run_two` are one run: every k-th sample of white
    noise makes 1/sqrt(k), two runs of one motion 0 (`tests/studies/results/copies.md`)."""
    run_far: float = 1e3
    """D of the wheel speeds past which nothing further is compared."""
    run_fewest: int = 20
    """Samples that must lie over each other."""

    # sensors.py
    hanging: float = 1.0
    """A value that is constant for longer than this while others change is stuck [s]."""
    held: float = 0.1
    """A highest value that is constant for longer than this may be the end of the range [s]."""
    high_pass: float = 0.2
    """Variations faster than this are noise [s]: a braking builds up more slowly."""
    presses: float = 0.1
    """A pressure that is held moves the deceleration by less than this share of it [1], once the
    brakes have followed; one at the end of its range goes on to rise."""
    followed: float = 0.3
    """Time in which the brakes have followed the pressure [s]."""
    released: float = 0.05
    """Below this deceleration no brake is applied [1]."""
    rustles: float = 0.4
    """Share of the unbraked samples with the most frequent value, up to which noise alone keeps a
    value from staying as it is for a second [1]: normal noise is then 0.78 of the resolution or
    more, and 40 samples are equal in fewer than 1 of 10^12 cases."""
    noise_fewest: int = 20
    """Samples from which noise is seen."""

    # rules.py: uses
    table_zero: float = 5e-4
    """Largest uncertainty of the zero of eta for a table [1]: eta rises by 0.1 to 0.8 %."""

    # warnings.py
    slow_rate: float = 95.0
    """Lowest rate [Hz] that resolves the build-up of the brake, 0.1 to 0.2 s."""
    jitter: float = 0.1
    """Deviation of the steps of the clock over their mean [1]."""
    tyres: float = 8e-3
    """Mismatch of the axles [1] that wear cannot cause; less is zeroed without a word."""
    sides: float = 5e-3
    """Difference of left and right [1]: as in a bend of 300 m radius with a track of 1.5 m."""
    zero: float = 5e-4
    """Uncertainty of eta [1] that is too large: eta rises by 0.1 to 0.8 %."""
    flat: float = 0.85
    """Share of zeros without braking [1]; a noisy pressure sensor that is cut off at 0 has 2/3."""
    stiff: float = 500e5
    """Pressure per g [Pa] that is too high for any car."""

    # wheels.py
    wheel_block: float = 0.2
    """Wheel noise is averaged over this before an interval is computed [s]."""
    slope_time: float = 0.3
    """Both decelerations are smoothed over this [s], because the slip of a wheel changes faster
    than the speed of the car."""
    near_lock: float = 0.5
    """Time before and after a deep slip [s] that is left out: a wheel locks within 0.1 to 0.4 s."""
    locked: float = 0.9
    """Slip from which a wheel counts as locked [1]."""
    abs_cycle: float = 1.5
    """Longest time with large slip in an ABS cycle [s]."""
    deep: float = 0.15
    """Slip of a wheel that ABS lets go of, if it falls below `deep_back` again [1]."""
    deep_back: float = 0.07
    """Slip of a wheel that rolls again [1]."""


LIMITS = _CheckLimits()
