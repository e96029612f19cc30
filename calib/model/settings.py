"""The tuned numbers of a fit in one record; each with its reason."""

from dataclasses import dataclass


@dataclass(frozen=True)
class FitSettings:
    """What a fit takes as given. Those that decide a table's numbers are in its provenance."""

    pads_differ: float = 0.3
    """Chance that the pads of a calibration run have not the ratio of the vehicle file."""
    tyres_differ: float = 0.2
    """Chance that the tyres of the axles differ in stiffness: other sizes, wear or pressures."""
    radii_fall: float = 0.3
    """Chance that the rolling radii fall under load: tyre files say so, many tyres hardly do."""
    radius_tolerance: float = 0.0005
    """How far a radius that is taken as one that does not fall may do so all the same (standard
    deviation)."""
    radius_scatter: float = 0.002
    """How far it may do so in truth, for the interval: half of what tyre files give."""
    tyre_tolerance: float = 0.02
    """How equal tyres that are taken as equal are (standard deviation of the logarithm): what
    cannot be told from that is given back as equal."""
    tyre_scatter: float = 0.07
    """How equal they are in truth, for the interval: inflation and wear of the same tyres move the
    stiffness of each axle by 5 % (Carlson and Gerdes, IEEE Trans. Control Systems Technology 13,
    2005). See `tests/studies/results/hard_ramps.md`."""
    pad_tolerance: float = 0.02
    """How exactly pads that are taken as declared have the declared ratio (standard deviation)."""
    pad_scatter: float = 0.07
    """How exactly they have it in truth, for the interval: pads of one grade scatter by 10 %, two
    standard deviations of each axle."""
    pads_repeat: float = 0.015
    """How alike the pads are on the ramps of one fit (standard deviation): friction changes by
    about 0.05 % per kelvin, and discs are 30 K warmer or colder from one ramp to the next."""
    ratio_drift: float = 0.04
    """How far the pads' ratio drifts while the car loses 15 m/s (standard deviation): friction
    changes by 3 % over such a loss, by 0.05 % per kelvin and by 2 % per 30 bar, each axle's on its
    own. Run `tests/studies/coverage_by_cause.py --cause "pads along a run"`."""
    pressure_apart: float = 3e4
    """How far the pressures [Pa] at which the axles bite, or by which they are late, are apart
    (standard deviation): springs and seals take 0.2 to 0.5 bar, and a ramp of 10 bar/s that is 20
    ms later at one axle lacks 0.2 bar there."""
    tyres_repeat: float = 0.02
    """How alike the tyres' stiffness is on a ramp with one axle and on the others (standard
    deviation): 1 % for the warmth of rubber and road, and 1.5 % that the tyre curve is off at the
    other forces and loads. See `tests/studies/results/one_axle.md`."""
    model_error: float = 0.01
    """What the tyre curve itself is off, relative to the slip: about what third-party plants
    show."""
    form_error: float = 0.11
    """What the curve is off at ``form_reach``, relative to the slip; with the power of twelve of
    the force it is 2 % at 0.86 of that. The best cubic misses a Magic Formula by 1 % of the slip at
    0.8 of its peak (`tests/fitting/test_near_the_peak.py`), over some thirty blocks alike, which
    the fit takes for as many errors by chance."""
    form_reach: float = 0.7
    """Normalised force of an axle from which the form of the curve says little."""
    zero_sigma: float = 0.02
    """Sigma of the zeros of eta and slip of a run: radii agree within 2 %."""
    huber: float = 3.0
    """Residuals past this many sigma count with Huber's weight: few of noise do."""
    min_speed: float = 5.0
    """Below this v [m/s] the clock offset and the noise of v swallow the slip."""
    outlier: float = 4.0
    """Residuals past this many sigma are named: of 500 blocks of noise one in 30 runs has one."""
    fastest: float = 0.5
    """Change of the deceleration that the pressure makes [g/s] past which a block takes no part:
    pads, brake lines and the body are then late by as much as eta shows. A ramp to 0.6 g within 3 s
    has 0.2, a pedal that is let go at its end 1 to 3."""
    late: float = 0.15
    """Time [s] for which this is so afterwards."""
    disturbance_of_eta: float = 0.12
    """How far eta stands out from its smooth course, over its range on the ramp, where something
    else acts: a gear shift of 240 N m moves it by a third, a bump by as much as the range."""
    disturbance_of_force: float = 0.03
    """The same of the demanded brake force, over its largest."""
    disturbance_gate: float = 6.0
    """How many times the usual scatter both must stand out."""
    fewest_blocks: int = 20
    """Fewest braked blocks of a ramp in which a disturbance is told, and that must be left of it
    below its top; a fifth of them must be calm before and after a disturbance."""
    disturbance_share: float = 0.3
    """Share of the braked blocks from which on what stands out is no disturbance, but the car."""
    top: float = 0.8
    """Share of the highest force of a ramp above which its top is."""
    top_apart: float = 1.25
    """Standard deviations by which the top must move the pads' ratio not to be believed."""
    top_surer: float = 1.05
    """Standard deviation of that ratio without the top, over that with it, from which the top has
    told something. Where it moved the ratio and told nothing it was wrong in all cases seen."""
    valve_doubt: float = 1.0
    """Sum of the squares of the eight parameters, in standard deviations of their priors, from
    which a limited rear pressure is asked for: a valve of slope 0.7 makes that of a usual car 2,
    one of 0.3 makes it 7 to 30."""
    valve_knees: tuple[float, ...] = (15e5, 20e5, 25e5, 30e5, 35e5)
    """Pressures [Pa] that are tried as the knee: those of usual valves."""
    valve_slope: float = 0.4
    """Slope of the rear pressure above the knee that is tried [1]: that of a usual valve."""
    valve_reach: float = 0.85
    """Share of the highest pressure of a ramp below which a knee must be to show."""
    valve_gain: float = 15.0
    """Fall of the sum of squares with a knee from which it is named. With a valve of slope 0.3 to
    0.5 it falls by 50 to 130, of 0.7 by up to 10, without one it rises or falls by 3."""
    flat: float = 0.1
    """Share of its first slope at which eta over z is too flat to be read backwards: there an error
    of eta moves D ten times as far as it should."""
    rows: int = 61
    """Rows of a look-up: linear interpolation between them errs by less than 1e-4 in D."""
    min_count: int = 3
    """Blocks that a cell needs to count as measured: two may be one disturbance."""


SETTINGS = FitSettings()
