"""What the estimator takes as known before a run, in one record; each number with its reason.

Studies that try them: tests/studies/coverage.py (filter), tests/estimation/test_pad_level.py
(level), tests/estimation/test_adaptive.py (laws).
"""

from dataclasses import dataclass

from calib.car.effects.body import DAMPING, ELASTIC_SHARE, NATURAL_FREQUENCY
from calib.run.brake_response import SPREAD, USUAL
from calib.run.noise import WALK


@dataclass(frozen=True)
class Priors:
    """Priors and tuned numbers of the room; the states are named in `calib.estimation.states`."""

    # The pads' ratio.
    ratio: float = 0.25
    """Sigma of log_pad_ratio when the pads do not change alike: a wet front and a dry rear pad
    differ by a quarter."""
    ratio_odds: float = 1.0
    """Odds that the pads do change alike, before their level is known
    (`calib.estimation.odds_by_level`)."""
    ratio_alike: float = 0.02
    """How exactly pads that change alike keep the table's ratio (standard deviation)."""
    drift_ratio: float = 0.01
    """Random walk of log_pad_ratio [1/sqrt(s)]: one pad warms up faster than the other."""
    foreign: float = 0.25
    """Error of log_pad_ratio per unit of log_stiffness: on a strange surface the two axles need not
    share one curve."""

    # The tyres.
    tyre_change: float = 0.02
    """Sigma of tyre_change: wear and inflation since the ramp; new tyres on one axle are more."""

    # Brakes and tyres that act late.
    delay: float = USUAL
    """Mean of slip_delay [s]: that of brakes and filters, `calib.run.brake_response`."""
    delay_sigma: float = SPREAD
    """Sigma of it [s], there. It holds tyres as well: one that builds up its force over sigma, 0.1
    to 0.6 m, slips early by sigma/v, 25 ms with 0.5 m at 20 m/s (Pacejka, Tyre and Vehicle
    Dynamics, section 7.2). See `tests/studies/results/fast_pedal.md`."""

    # The surface.
    stiffness: float = 0.35
    """Sigma of log_stiffness: tile to dry asphalt spans factors of 0.6 to 1.1."""
    peak_per_stiffness: float = -2.0
    """Mean of log_peak_ratio per unit of log_stiffness: tile has 0.7 of the stiffness of dry
    asphalt and a quarter of its peak, basalt its stiffness and half of its peak."""
    peak: float = 0.6
    """Sigma of log_peak_ratio around that mean: both lie about one sigma above it."""
    drift_road: float = 0.02
    """Random walk of log_stiffness and of log_peak_ratio [1/sqrt(s)]: no road is the same all
    along."""

    # A bump, or a sudden change of the surface.
    wild_gate: float = 12.0
    """Mean squared innovation past which a block is not taken in: 3.5 sigma of both sensors at
    once. A bump throws the wheels about, and the pads have no part in it."""
    calm_gate: float = 4.0
    """The same after such a block: the wheels swing on, and pass their usual place."""
    wild_time: float = 0.3
    """Time [s] in which such blocks may follow each other: a bump passes below both axles and the
    wheels have calmed down. What lasts longer is taken in; where the body is calm it is a road that
    has changed."""
    change_rate: float = 1.0
    """What a road that has changed goes on changing by, of the spread of all surfaces [1/sqrt(s)]:
    a patch ends. The surface itself is open then, as before a stop."""
    change_calm: float = 0.03
    """Deceleration [1] still on its way (see ``pitch_time``) below which a change is looked for: a
    surprise while the body moves is the body's."""

    # Load that moves late.
    pitch_frequency: float = NATURAL_FREQUENCY.typical
    """Natural frequency of the pitch mode [rad/s], as the effect's card has it."""
    pitch_tempo: float = NATURAL_FREQUENCY.spread / NATURAL_FREQUENCY.typical
    """Sigma of the logarithm of the frequency [1], there."""
    pitch_damping: float = DAMPING.typical
    """Its damping ratio [1], there."""
    elastic_share: float = ELASTIC_SHARE.typical
    """Share of the load transfer that goes through the mode, there."""
    elastic_sigma: float = ELASTIC_SHARE.spread
    """Sigma of it, there."""
    known_share: float = 0.1
    """Relative sigma of share and frequency where the car's effects give them: a diagnosis from a
    few stops."""
    known_share_least: float = 0.05
    """Least sigma of a given share [1]: it is not the same over load and spring travel."""
    pitch: float = 0.25
    """Sigma of load_shift per unit of what a filter of ``pitch_time`` holds back: what is late or
    too far otherwise."""
    pitch_time: float = 0.6
    """Time constant of that filter [s]: about half a period of the mode."""
    pitch_memory: float = 0.3
    """How long load_shift lasts [s]: the mode has turned by then."""

    # Sensors and model.
    zero: float = 0.01
    """Sigma of eta_zero and slip_zero: radii agree within 1 %."""
    drift_zero: float = WALK
    """Random walk of both until the bite [1/sqrt(s)], `calib.run.noise`."""
    sync: float = 0.02
    """Misalignment of pressure and wheels [s] while the pressure moves: one frame of a slow bus."""
    model: float = 0.02
    """Relative error of a predicted slip: no tyre curve is exact."""
    model_memory: float = 0.1
    """How long an error in proportion to the slip lasts [s]: that of a curve as long as the force
    is the same, that of the level half a second, that of a road 0.1 s."""
    rolling: float = 0.08
    """Slip or eta - 1 [1] past which a tyre is beyond its peak or a wheel locks: no curve holds."""

    # The common level of the pads.
    level_free: float = 0.4
    """Spread of a pad level that is not nominal, relative: wet pads lose half."""
    level_alike: float = 0.01
    """How exactly unchanged pads keep their level, relative: from stop to stop they warm up."""
    level_odds: float = 1.0
    """Odds that the pads have the level of the calibration."""
    level_memory: float = 0.5
    """Time constant of forgetting [s]: short against a stop, long against road noise (0.1 s)."""
    level_trend: float = 0.1
    """Usual relative drift of a pad [1/s]: fading from 0.35 to 0.22 in 5 s is 0.09."""
    jolt_gate: float = 5.0
    """Departure of a block's level from that of the last half second that is a jolt of the body, in
    its own errors."""
    jolt_least: float = 0.08
    """The same, relative: a pad does not change by as much in a tenth of a second."""

    # The baselines.
    low_pass: float = 0.1
    """Time constant of the causal filter on z, loads and eta in front of a look-up [s]: takes road
    noise out and is short against the level's memory."""
    rls_memory: float = 1.0
    """Forgetting of the recursive least squares [s]: shorter, and eta's noise shows in the pads."""
    law_rate: float = 8.0
    """Rate of the gradient law at ``law_pressure`` [1/s]: 90 % of a step of zeta in 0.3 s."""
    law_pressure: float = 20e5
    """Pressure [Pa] at which it holds: a usual braking. The rate grows with its square."""
