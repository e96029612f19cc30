"""The gates of a diagnosis in one record; each number with its reason."""

from dataclasses import dataclass


@dataclass(frozen=True)
class _DiagnosisGates:
    """Each is named after what it decides; the comments name the file."""

    # runs/gates.py
    stronger: float = 2.5
    """Brakes of a log over those of the others [1], or the inverse, that no pads make: soaked ones
    lose half, and the effects of the catalogue, three at a time, moved a log by 1.6 at most."""

    # runs/sides.py
    sides_settled: float = 0.3
    """Time before the first braking that is left out [s]: means over a lead-in end before the
    bite."""
    sides_slow: float = 10.0
    """Wheel speed [rad/s], about 3 m/s, below which the sensors are too inexact."""
    sides_least: float = 0.5
    """Seconds of rolling, of all logs together, from which the sides are compared."""

    # explanation/own_pads.py
    own_pads: float = 0.03
    """Standard deviation of a log's pads about those of all [1]: they repeat to 2 or 3 % from run
    to run, `calib.plausibility.pads`."""
    own_tyres: float = 0.03
    """The same of the stiffness of the tyres: their temperature and pressure, and the road's."""

    # search/offsets.py
    offsets_alike: float = 0.01
    """Standard deviation [m/s^2] of dv/dt less a_x between logs of one level road: a scale of a_x
    that is 5 % off makes as much between a coast at 30 m/s and one at 10 m/s. What is smaller hides
    in the drift that the noise of v allows."""
    offsets_sure: float = 4.0
    """Standard deviations by which the sum of squares must exceed what chance gives for logs to
    differ."""
    offsets_unlike: float = 4.0
    """Mean square by which the offsets of one kind disagree with the lead-ins, over that of the
    other kind, past which it is not that kind: of the right kind it was 3.2 at most on 19 cars."""

    # explanation/candidate.py
    quieter: float = 0.9
    """Share of a channel's noise below which it counts as quieter with an explanation than
    without."""

    # explanation/fit.py
    higher_peak: float = 0.3
    """Logarithm by which the second fit of the base begins at a higher peak of the tyre: a third,
    more than roads and tyres of one surface differ."""

    # explanation/problem.py
    coasting: float = 1e5
    """Weight of a ripple in the wheel speeds without torque, as a pressure [Pa]: little beside that
    of a braked disc."""

    # explanation/ranges.py
    at_bound: float = 0.01
    """Share of a parameter's range that counts as its bound."""
    usual_range: float = 4.0
    """Widest range of a parameter, in its spreads, that this is a share of: a truck has 20 times
    the drag area of a car, and a small one is not at its bound."""
    pressed: float = 25.0
    """Least fall of the chi-square, in one step past the end of a parameter's range, with which
    that range holds the parameter: five sigma."""
    divided: float = 0.1
    """How far a share of an axle is from nothing, from all and from its usual value to be odd
    [1]."""

    # explanation/vector.py
    pads: float = 0.7
    """Largest logarithm of a pad friction over that of the file: half and double. With rear pads of
    2.8 times the file's, a valve imitated a motor."""
    second_sigma: float = 2.0
    """Prior on the further parameters of an effect, in spreads of their cards."""

    # search/chance.py
    chance_block: int = 25
    """Innovations in a block: 0.5 s, several times the correlation time of a road's noise."""
    chance_replicas: int = 400
    """Replicas: four of them lie past the 99 % point."""
    false_alarms: float = 0.01
    """Share of cars without an effect in which the best effect of the catalogue gains more."""
    chance_least: float = 1e-6
    """Change in squared sigma below which these runs do not show an effect at all."""

    # search/clocks.py
    clocks_beside: int = 4
    """Explanations of the first search beside which delays are tried; that without any is one."""
    clocks_share: float = 0.5
    """Share of what is unexplained that delays must explain for a search with them."""
    clocks_rivals: int = 2
    """Other effects that are tried in the place of each delay."""

    # search/decide.py
    sure: float = 4.0
    """Gain, over what chance gives, above which an effect counts as present: twice the size. From 1
    on it may be present, and counts only if the hold-outs, which may excite it more, show it
    clearly."""
    form: float = 0.003
    """Least gain in the mean squared innovation with which the calibration logs alone show an
    effect. Where the form of the tyre differs from the car's, an effect that is not there gains as
    much, however many logs there are."""
    floor: float = 1.01
    """Mean squared innovation that the best model leaves on an independent plant."""
    quiet: float = 3.0
    """Scatter above `floor` up to which nothing is left to explain."""
    strange: float = 6.0
    """The same from which a cause is present even if no known effect explains it."""
    parameter: float = 0.001
    """Gain in the mean squared innovation that each further parameter must bring. So an effect that
    can imitate a simpler one is not preferred to it."""
    hurts: float = 0.35
    """Rise of the mean squared innovation of one channel in one run above which a cause is refuted:
    five sigma of the difference of two runs of 450 steps."""
    enough: float = 0.80
    """Share of the excess over what is quiet that an explanation must close to be accepted."""
    felt_power: float = 50.0
    """Least change by an effect, in squared sigma, for a channel to count in the test of that
    effect. A wrong effect raises the channel's sum of squares by as much, which is seven sigma of
    chance."""
    second: float = 0.02
    """Least gain in the mean squared innovation of a second effect."""
    second_of_all: float = 0.03
    """Least share of the whole gap that a further effect must explain of the rest to count."""
    second_share: float = 0.6
    """Share of the excess left by the first effect that a second must close."""
    faint_second: float = 0.002
    """Gain above which a second effect may be present. It counts only if the hold-outs show it
    clearly. A wrong second effect gains up to 0.003, or 0.009 where the form of the first differs
    from the plant's; on the hold-outs up to 0.012."""
    surely_shown: float = 10.0
    """What an effect brings by a linear step, over its price, from which it is not spared, and no
    fit without it is asked."""
    confusable: float = 0.004
    """Rivals whose mean squared innovation is within this of the best are indistinguishable from
    it."""

    # search/groups.py
    groups_shown: float = 100.0
    """Least information of a log on one of its factors: known to 10 %."""
    groups_price: float = 100.0
    """Fall of the chi-square that a further group must bring."""
    most_groups: int = 3
    """Most groups of logs: of twelve logs three or four are in each then."""

    # search/heats.py
    heats_spread: float = 150.0
    """Standard deviation of the heat at the start of a run about that of discs of 100 degC [K]:
    from a cold disc to one after some stops in a row."""
    heats_apart: float = 60.0
    """Standard deviation of the rear discs' heat about that of the front ones [K]: they take a
    third of the energy, and cool slower."""
    heats_share: float = 0.3
    """Share of what is unexplained that the heats must explain for a search with them."""

    # search/jointly.py
    jointly_steps: int = 25
    """Most steps of a fit of parameters and states together."""
    beyond_reach: float = 1.0 / 3.0
    """Share of what is unexplained that all effects together leave in one linear step, from which
    no search can explain it."""

    # search/own_pads.py
    own_pads_pressure: float = 2e5
    """Pressure [Pa] from which a log brakes."""
    own_pads_logs: int = 5
    """Fewest logs that brake in which own pads can be seen to follow something."""
    own_pads_driven: float = 0.002
    """Chance of a correlation below which they do: six are asked, so that one set of pads that
    differ by chance in a hundred is taken for driven."""

    # search/radii.py
    radii_least: float = 25.0
    """Least fall of the chi-square by other radii with which they are tried. Where nothing is left,
    it is what tells two explanations apart."""
    radii_share: float = 0.02
    """Share of what is left unexplained that other radii must explain to be tried. With radii 0.3 %
    off they explained 85 to 99 % of it beside effects that stood for them; with right ones at most
    1 %."""
    radii_nearly: float = 0.25
    """Share of what an effect brings that it may still bring beside free radii, for them to be
    tried. Radii 0.1 % off with a drag were a rolling resistance and a slope, which still brought 14
    %."""
    radii_further: int = 3
    """Further effects that are fitted, the most promising ones, before radii count as better."""

    # search/regroup.py
    groups_beside: int = 4
    """Explanations of the first search beside which groups are looked for; that without any is
    one."""
    groups_fitted: int = 2
    """Of these, so many are fitted with their groups: those that leave least."""
    groups_share: float = 0.3
    """Share of what is unexplained that groups must explain for a search with them."""

    # search/search.py
    promise: float = 0.7
    """Share of the chi-square that a linear step promises down to which a full fit may come, to
    tell what cannot be the best one: a motor came to 0.76 of it."""
    refined: int = 6
    """Effects that are fitted in full after the first ranking."""

    # search/together.py
    together_alike: float = 0.999
    """Cosine between the changes of two effects from which they are one direction."""
    together_same: float = 1e-4
    """Singular value, over the largest, below which directions of all effects are one another's."""

    # proof/prove.py
    tried: int = 3
    """Further effects that are fitted in each step, the most promising ones."""
    runners_up: int = 2
    """Other pairs from which an explanation is looked for, where the best one leaves something."""
    further_of_all: float = 0.003
    """Least gain of an effect that replays show well, as a share of that of the effects before. A
    wheel that rolls 0.5 % faster explains so much that a trifle of it, 0.0002, is a wrong drag."""
    nearly_all: float = 0.9
    """Share of what is clearly left, in the innovations or the replays, that no difference in form
    would close. Of an effect that closes as much of the replays half the gain is enough."""
    step: float = 0.3
    """Share of the excess of the innovations that each step of a search must close to go on."""
    worse: float = 1.05
    """Growth of the lasting errors of the replays with which no further effect is tried: an effect
    that has no part in them, such as a ripple, changes nothing there while another one is
    missing."""
    several: int = 2
    """Effects from which one empirical term is held against all of them."""

    # proof/remainder.py
    remainder_block: float = 0.5
    """Span of a mean [s]: several times the correlation time of a road's noise, a part of a
    stop."""
    remainder_least: float = 2.0
    """Rms of the lasting errors over the noise of the sensors from which something is left [1].
    With nothing hidden, on a plant with other forms of tyre than here, up to 1.3 is left; see
    tests/studies/naming.py."""
    remainder_sure: float = 5.0
    """Least distance of the sum of squares from that of noise, in its standard deviations."""
    remainder_farthest: float = 2.0
    """Largest move along a direction of the parameters' covariance, in standard deviations: 95
    %."""

    # proof/unexplained.py
    held: float = 0.5
    """Rise of a brake torque with the pressure, over that before, below which something holds it.
    From knot to knot: it may be held from the middle on."""
    plain: float = 0.03
    """Share of the excess that a term must explain beyond a plainer one to be preferred to it:
    beyond a constant one, and beyond one that holds a brake torque, which is a single number."""
    one_sided: float = 0.3
    """Share of the excess in left less right from which one wheel of an axle is named."""
    no_term: float = 0.1
    """Share of the excess that must go with the angle of the wheels, or swing, to be told as
    that."""

    # proof/oscillation.py
    over_slower: float = 2.0
    """Least power of a peak over that of the slower lines beside which it stands."""
    over_slowest: float = 3.0
    """Least power of a peak over that of the first line, at 0.25 Hz. What every application leaves,
    as a lag does, is in both; a swing of 0.5 Hz or more has at most a fifth there."""

    # undecided/drives.py
    clear: float = 10.0
    """Size from which a drive shows an effect [sigma]: well beyond what chance gives an effect of
    the catalogue (`calib.diagnosis.search.chance`), some 4 sigma, or 9 for a ripple."""

    # undecided/separate.py
    simulated: int = 2
    """Manoeuvres that are simulated after the linear step."""

    # show/diagnosis.py
    sides_told: float = 3e-4
    """Difference of the sides [1] from which it is told: 10 N m on one wheel make as much."""
    within: float = 1.0
    """Gap, in units of the sensors' noise, up to which replays are within the noise."""
    trifle: float = 0.01
    """Share of what is left that a term must explain for its driver to be told [1]."""


GATES = _DiagnosisGates()
