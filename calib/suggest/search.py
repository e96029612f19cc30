"""Find the channels of a car among columns: each step uses the results of the steps before.

clock --> wheels --> speed --> a_x --> pressures --> the rest, by name and unit
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from calib.base.names import CHANNELS, WHEELS, G
from calib.base.units import from_si, is_unit, to_si
from calib.logs.channel_map import Mapping
from calib.logs.clock import step_of
from calib.logs.source import Array
from calib.run.computed_channels import factor_between, is_other_quantity
from calib.run.limits import LIMITS
from calib.suggest.columns import (
    ColumnClock,
    Series,
    correlation,
    follows,
    lead,
    moving,
    rising,
    together,
    without_gaps,
)
from calib.suggest.words import (
    BRAKE,
    DECELERATION,
    DERIVED,
    DISC,
    DRIVE,
    LONG,
    MASTER,
    NO_BRAKE,
    NO_DRIVE,
    NO_LONG,
    NO_SPEED,
    NO_STEERING,
    PRESSURE,
    SPEED,
    STEERING,
    TIME,
    TORQUE,
    axle,
    corner,
    loose_corner,
    score,
    words,
)

SURE, LIKELY = "sure", "likely"
"""Sure: name, unit and physics agree. Likely: one is missing, and none contradicts."""

SCALES = {"s": 1.0, "ms": 1e-3, "us": 1e-6}
"""Possible units of a time column without a unit [s]; the sample rate decides between them."""
REPEATED = 0.01
"""Largest share of rows that repeat the time of the row before them [1]."""
FOLLOWS = 0.8
"""Lowest correlation [1] of two signals that belong together."""
ACCELERATED = 0.5
"""Smallest range of the derivative of speed [m/s^2] to check an acceleration with."""
LATE = 0.06
"""A pressure may be later than its effect by this [s], because sensor filters differ."""
LATER = 0.01
"""Gain of correlation [1] from which on a pressure counts as later than the deceleration."""
PRESSED = 2e5
"""Smallest range of a brake pressure [Pa] in a log with braking."""
SLOPES = (0.7, 1.4)
"""Allowed a_x over the derivative of speed [1]: slope, pitch and slip change it less than this."""

WITH_WHEELS = 0.98
"""Lowest correlation [1] of the speed of the car with that of its wheels."""

ALL_WHEELS = tuple(f"omega_{w}" for w in WHEELS)
NAMED = 99
"""Score of a column that has the name of the channel."""


@dataclass(frozen=True)
class Proposal:
    """Source of one channel, how ``sure`` it is, and the ``reasons`` in words."""

    channel: str
    mapping: Mapping
    sure: str
    reasons: tuple[str, ...]


@dataclass(frozen=True)
class Doubt:
    """A question that only the user can answer: ``candidates`` for ``channel``, and ``why``."""

    channel: str
    candidates: tuple[str, ...]
    why: str
    do: str

    def __str__(self) -> str:
        names = f": {', '.join(self.candidates)}" if self.candidates else ""
        return f"{self.why}{names}; {self.do}"


def rim_mapping(
    channel: str, source: str, unit: str | None, radius: float | None
) -> Mapping | None:
    """The mapping of a wheel speed that is written as a speed at the rim.

    None for another channel, a unit that is not one of speed, or without the ``radius`` [m].
    """
    if not channel.startswith("omega_") or not unit or radius is None or not is_unit(unit, "m/s"):
        return None
    return Mapping(source, "rad/s", scale=to_si(1.0, unit, "m/s") / radius)


def rim_reason(radius: float) -> str:
    """How a speed at the rim became a wheel speed, in words."""
    return f"divided by the given radius of {radius:g} m"


@dataclass
class Search:
    """What is known so far; a column that is proposed or in ``left`` is not looked at again.

    ``gapped`` columns have no value in some rows; ``told`` channels have no proposals but those of
    the user.
    """

    series: list[Series]
    gapped: list[Series]
    left: dict[str, str]
    told: dict[str, str]
    radius: float | None
    proposals: dict[str, Proposal] = field(default_factory=dict)
    doubts: list[Doubt] = field(default_factory=list)
    clock: ColumnClock | None = None

    def run(self) -> None:
        """Find every channel that the user did not give."""
        self._find_clock()
        if self.clock is None:
            self.left.update({s.name: "has missing values" for s in self.gapped})
            return
        self._bridge(self.clock)
        mean, angular = self._find_wheels()
        speed = self._find_speed(mean)
        metres = speed is not None or not (angular or "omega_fl" in self.told)
        rate = self._while_moving(speed if speed is not None else mean, self.clock)
        self._find_acceleration(rate, self.clock, metres)
        self._refuse_computed()
        self._find_pressure(None if rate is None else -rate, self.clock)
        self._find_wheel_pressures()
        self._find_by_name()

    def _free(self) -> list[Series]:
        taken = {p.mapping.source for p in self.proposals.values()}
        return [s for s in self.series if s.name not in taken and s.name not in self.left]

    def _refuse(self, item: Series, why: str) -> None:
        self.left.setdefault(item.name, why)

    def _propose(self, channel: str, mapping: Mapping, sure: bool, *reasons: str) -> None:
        if channel not in self.told:
            self.proposals[channel] = Proposal(channel, mapping, SURE if sure else LIKELY, reasons)

    def _doubt(self, channel: str, candidates: list[Series], why: str, do: str) -> None:
        if channel not in self.told:
            self.doubts.append(Doubt(channel, tuple(s.name for s in candidates), why, do))

    def _given(self, channel: str) -> Array | None:
        """The values [SI] of the column that the user gave for a channel, or None."""
        proposal = self.proposals.get(channel)
        item = proposal and next(
            (s for s in self.series if s.name == proposal.mapping.source), None
        )
        if not proposal or not item:
            return None
        mapping, written = proposal.mapping, item.values
        if mapping.unit is None:
            return written
        # A given unit overrides the file's: undo that conversion, then apply the given one.
        if item.column.unit and item.si not in (None, "?"):
            written = from_si(written, item.column.unit, str(item.si))
        return mapping.to_si(written, mapping.unit, CHANNELS[channel].si)

    # The clock.

    def _find_clock(self) -> None:
        """Not decreasing, named as a time, with a unit of time.

        A missing unit follows from the rate: of seconds, milliseconds and microseconds only one
        gives 40 Hz to 1 kHz. Nothing is proposed if no column, or more than one, fits.
        """
        if "time" not in self.told:
            self._propose_clock()
        elif (given := self._given("time")) is not None:
            given = given[rising(given)]
            self.clock = ColumnClock(given, step_of(given))
        if self.clock is None:
            return
        source = self.proposals["time"].mapping.source
        written = next((s.values for s in self.series if s.name == source), None)
        if written is not None:
            kept = rising(written)
            self.series = [replace(s, values=s.values[kept]) for s in self.series]
            self.gapped = [replace(s, values=s.values[kept]) for s in self.gapped]

    def _propose_clock(self) -> None:
        free = self._free()
        running = [s for s in free if s.si in ("s", None) and _runs(s.values)]
        named = [s for s in running if _is_time(s.name)]
        fit = [s for s in named if s.name == "time"] or named
        if len(fit) > 1:
            self._doubt(
                "time", fit, "more than one column is a time", "choose one: --take time=NAME"
            )
        elif fit:
            self._take_clock(fit[0])
        elif broken := [
            s for s in (*free, *self.gapped) if s.si in ("s", None) and _is_time(s.name)
        ]:
            why = f"{broken[0].name} is named a time, but {_disorder(broken[0].values)}"
            self._doubt("time", broken[:1], why, "correct the log, or export it again")
        elif unread := [(name, why) for name, why in self.left.items() if _is_time(name)]:
            name, why = unread[0]
            do = "export the log again, with a time for each row"
            self.doubts.append(Doubt("time", (name,), why, do))
        else:
            candidates = [s for s in running if s.si == "s"] or running
            do = "choose one and give its unit: --take 'time=NAME [s]'"
            do = do if candidates else "export the log again, with its time"
            self._doubt("time", candidates, "no column is named a time", do)

    def _take_clock(self, item: Series) -> None:
        time = item.values[rising(item.values)]
        step, order = step_of(time), "increasing"
        if time.size < item.values.size:
            order += f", but {_disorder(item.values)}: the log is refused until they are deleted"
        if item.si == "s":
            unit = f"unit {item.column.unit}"
            self._propose("time", Mapping(item.name), True, "name", unit, order)
            self.clock = ColumnClock(time, step)
            return
        for unit, scale in SCALES.items():
            if LIMITS.rates[0] <= 1.0 / (step * scale) <= LIMITS.rates[1]:
                only = f"only {unit} gives a rate of 40 Hz to 1 kHz"
                self._propose("time", Mapping(item.name, unit), False, "name", order, only)
                self.clock = ColumnClock(time * scale, step * scale)
                return
        do = "give the unit: --take 'time=NAME [s]'"
        self._doubt("time", [item], f"no unit, and steps of {step:.4g}", do)

    def _bridge(self, clock: ColumnClock) -> None:
        for item in self.gapped:
            filled = without_gaps(item, clock.time)
            if isinstance(filled, str):
                self.left[item.name] = filled
            else:
                self.series.append(filled)
        self.series = [replace(s, rate=s.rate or 1.0 / clock.step) for s in self.series]

    def _while_moving(self, motion: Array | None, clock: ColumnClock) -> Array | None:
        """Derivative of the speed; drops all rows in which the car does not move."""
        if motion is None:
            return None
        part = moving(motion, clock)
        self.series = [replace(s, values=s.values[part]) for s in self.series]
        self.clock = ColumnClock(clock.time[part], clock.step)
        return clock.rate_of(motion)[part]

    # Wheels.

    def _fours(self, *quantities: str | None) -> list[dict[str, Series]]:
        """Sets of four free columns of the given quantities, one for each wheel."""
        found: dict[tuple[str, str | None], dict[str, Series]] = {}
        for item in self._free():
            wheel, rest = loose_corner(item.name)
            if wheel and item.si in quantities:
                found.setdefault((rest, item.si), {}).setdefault(wheel, item)
        return [four for four in found.values() if len(four) == 4]

    def _find_wheels(self) -> tuple[Array | None, bool]:
        """Named for the four wheels, similar, with a unit; speeds at the rim need the radius.

        Returns the mean wheel speed and whether it is in rad/s.
        """
        good = []
        for four in self._fours("rad/s", "m/s", None):
            if together([four[w].values for w in WHEELS]):
                good.append([four[w] for w in WHEELS])
            elif four["fl"].si is not None:
                for item in four.values():
                    self._refuse(item, "does not agree with the other three wheels")
        angular = [each for each in good if each[0].si == "rad/s"]
        fit = [each for each in angular if each[0].name == "omega_fl"] or angular or good
        if len(fit) != 1:
            if fit:
                names = [" ".join(item.name for item in each) for each in fit]
                do = "choose one: --take omega_fl=NAME, and the same for the others"
                self._doubt_wheels(names, "several sets of four", do)
            given = [x for w in WHEELS if (x := self._given(f"omega_{w}")) is not None]
            return (np.mean(given, axis=0) if len(given) == 4 else None), False
        (chosen,) = fit
        mean = np.mean([x.values for x in chosen], axis=0)
        unit, si = chosen[0].column.unit, chosen[0].si
        names = [item.name for item in chosen]
        if si is None:
            do = "give it: --take 'omega_fl=NAME [rad/s]', and the same for the others"
            self._doubt_wheels(names, "the file gives no unit", do)
            return mean, False
        if si == "m/s" and self.radius is None:
            why = f"speeds at the rim, in {unit}, need a radius to become wheel speeds"
            do = "give the radius with which the car computes them: --radius 0.31"
            self._doubt_wheels(names, why, do)
            return mean, False
        if not self._wheels_told:
            for channel, one in zip(ALL_WHEELS, chosen, strict=True):
                at_rim = rim_mapping(channel, one.name, unit, self.radius)
                reasons = ["name", f"unit {unit}", "the four wheels agree"]
                reasons += [rim_reason(self.radius)] if at_rim and self.radius else []
                self._propose(channel, at_rim or Mapping(one.name), True, *reasons)
        return mean / self.radius if si == "m/s" and self.radius else mean, True

    @property
    def _wheels_told(self) -> bool:
        return any(channel in self.told for channel in ALL_WHEELS)

    def _doubt_wheels(self, names: list[str], why: str, do: str) -> None:
        if not self._wheels_told:
            channel = f"{ALL_WHEELS[0]} ... {ALL_WHEELS[-1]}"
            self.doubts.append(Doubt(channel, tuple(names), why, do))

    # Speed, acceleration and pressure.

    def _choose(self, channel: str, passed: list[tuple[Series, int]], why: str) -> Series | None:
        """The column whose name fits best; if several fit equally well, a doubt.

        Of measured columns, those that are sampled coarsely beside another are no candidates.
        """
        measured = [s for s, points in passed if points > 0 and not DERIVED & set(words(s.name))]
        top = max((s.rate or 0.0 for s in measured), default=0.0)
        coarse = {s.name for s in measured if 2.0 * (s.rate or 0.0) < top}
        if any(s.name == channel for s, _ in passed):
            coarse = set()
        best = max((points for s, points in passed if s.name not in coarse), default=0)
        fit = [s for s, points in passed if points == best and s.name not in coarse]
        fit = [s for s in fit if s.name == channel] or fit
        if len(fit) != 1:
            if fit:
                self._doubt(channel, fit, why, f"choose one: --take {channel}=NAME")
            return None
        for item, _ in passed:
            if item.name in coarse:
                why = f"sampled at {item.rate:.3g} Hz, and {fit[0].name} at {fit[0].rate:.3g} Hz"
                self._refuse(item, why)
            elif item is not fit[0]:
                self._refuse(item, f"{fit[0].name} is more likely {channel}")
        return fit[0]

    def _find_speed(self, wheels: Array | None) -> Array | None:
        """The values [m/s] of a speed by name and unit that agrees with the wheels."""
        moves = wheels is not None and bool(np.ptp(wheels))
        passed = []
        for item in self._free():
            if item.si != "m/s" or corner(item.name):
                continue
            points = NAMED if item.name == "v" else score(item.name, SPEED, NO_SPEED)
            if points < 1:
                self._refuse(item, "a speed, but not of the car, by its name")
            elif wheels is not None and moves and correlation(item.values, wheels) < WITH_WHEELS:
                self._refuse(item, "a speed that does not agree with the wheels")
            else:
                passed.append((item, points))
        chosen = self._choose("v", passed, "more than one speed of the car")
        if "v" in self.told:
            return self._given("v")
        if chosen is None:
            return None
        agrees = ["agrees with the wheels"] if moves else []
        self._propose(
            "v", Mapping(chosen.name), moves, "name", f"unit {chosen.column.unit}", *agrees
        )
        return chosen.values

    def _find_acceleration(self, rate: Array | None, clock: ColumnClock, metres: bool) -> None:
        """By unit, and by the derivative of speed up to its sign.

        ``rate`` is that derivative, shape (n,): in m/s^2 with ``metres``, else of the wheels in
        rad/s^2.
        """
        checked = None
        if rate is not None and float(np.ptp(rate)) > (ACCELERATED if metres else 2.0):
            checked = rate
        passed = []
        for item in self._free():
            if item.si != "m/s^2":
                continue
            points = NAMED if item.name == "a_x" else score(item.name, LONG, NO_LONG)
            if points < 0:
                self._refuse(item, "an acceleration, but not longitudinal, by its name")
            elif checked is not None and abs(follows(item.values, checked, clock)) < FOLLOWS:
                self._refuse(item, "an acceleration that is not the derivative of speed")
            elif checked is None and points < 1:
                self._refuse(item, "an acceleration, not known to be longitudinal")
            else:
                passed.append((item, points))
        chosen = self._choose("a_x", passed, "more than one longitudinal acceleration")
        if chosen is None:
            return
        named = chosen.name == "a_x" or score(chosen.name, LONG, NO_LONG) > 0
        reasons = [*(["name"] if named else []), f"unit {chosen.column.unit}"]
        if checked is not None:
            if self._wrong_size(chosen, checked, clock, metres):
                return
            agrees = follows(chosen.values, checked, clock)
            sign = 1 if agrees > 0 else -1
            reasons.append(f"is the derivative of speed (correlation {abs(agrees):.2f})")
            reasons += ["positive when the car slows down: sign reversed"] if sign < 0 else []
        else:
            sign = -1 if DECELERATION & set(words(chosen.name)) else 1
            if rate is None:
                reasons.append("no speed is known to check its sign with")
            else:
                most = f"{float(np.abs(rate).max()):.2g} {'m/s^2' if metres else 'rad/s^2'}"
                reasons.append(f"the speed changes by {most} at most: too slowly to check its sign")
            reasons += ["named a deceleration: sign reversed"] if sign < 0 else []
        sure = named and checked is not None
        self._propose("a_x", Mapping(chosen.name, sign=sign), sure, *reasons)

    def _wrong_size(self, item: Series, rate: Array, clock: ColumnClock, metres: bool) -> bool:
        """Whether the size of the acceleration contradicts its unit, which is then asked for."""
        slope = np.cov(clock.smooth(item.values), rate)[0, 1] / np.var(rate, ddof=1)
        off, what = abs(float(slope)), "speed" if metres else "the wheel speed [m]"
        low, high = SLOPES if metres else LIMITS.wheel_radius
        if low <= off <= high:
            return False
        meant = [u for u, f in (("g", 1 / G), ("m/s^2", G)) if SLOPES[0] < off / f < SLOPES[1]]
        hint = f": is it in {meant[0]}?" if meant else ""
        why = f"in {item.column.unit} it is {off:.3g} times the derivative of {what}{hint}"
        self._doubt("a_x", [item], why, "give its unit: --take 'a_x=NAME [UNIT]'")
        return True

    def _refuse_computed(self) -> None:
        """Refuse pressures that are a column of another quantity times a number."""
        others = [s for s in self.series if is_other_quantity(s.column.unit)]
        for item in self._free():
            for other in others if item.si == "Pa" else []:
                if factor_between(item.values, other.values) is not None:
                    of = f"{other.name} [{other.column.unit}]"
                    self.left[item.name] = f"computed: a fixed number times {of}"

    def _find_pressure(self, braking: Array | None, clock: ColumnClock) -> None:
        """By unit, correlated with the deceleration and not later than it.

        ``braking`` is the deceleration, shape (n,), or None if speed does not change. A column
        without a unit is a doubt if it is named a brake pressure: it could be a torque or a
        percentage.
        """
        passed, unnamed = [], []
        for item in self._free():
            points = NAMED if item.name == "p_mc" else _brake_score(item.name)
            if corner(item.name) or points < 0:
                continue
            if item.si in (None, "?") and points >= 2 and PRESSURE & set(words(item.name)):
                unnamed.append(item)
            elif item.si == "N*m" and points >= 1:
                self._refuse(item, "a torque, not a pressure")
            elif item.si == "Pa":
                if reason := _no_brake(item, points, braking, clock):
                    self._refuse(item, reason)
                else:
                    passed.append((item, points))
        before = len(self.doubts)
        chosen = self._choose("p_mc", passed, "more than one brake pressure")
        if chosen is None:
            if unnamed and len(self.doubts) == before:
                why = "named a brake pressure, but it has no unit that is known"
                self._doubt("p_mc", unnamed, why, "give its unit: --take 'p_mc=NAME [bar]'")
            return
        named = chosen.name == "p_mc" or _brake_score(chosen.name) > 0
        reasons = [*(["name"] if named else []), f"unit {chosen.column.unit}"]
        sure = False
        if braking is None:
            reasons.append("no speed is known to check it with")
        elif np.ptp(chosen.values) <= PRESSED or np.ptp(braking) < ACCELERATED:
            reasons.append("no braking in the log to check it with")
        else:
            ahead, agrees = lead(chosen.values, braking, clock, LATE)
            when = f"{ahead:.2f} s before" if ahead > 0 else "with"
            reasons.append(f"{when} the deceleration (correlation {agrees:.2f})")
            sure = named
        self._propose("p_mc", Mapping(chosen.name), sure, *reasons)

    def _find_wheel_pressures(self) -> None:
        fours = self._fours("Pa")
        if len(fours) == 1 and all(s.values.max() <= LIMITS.pressure for s in fours[0].values()):
            for wheel, item in fours[0].items():
                unit = f"unit {item.column.unit}"
                self._propose(f"p_{wheel}", Mapping(item.name), False, "name", unit)

    def _find_by_name(self) -> None:
        """Find the channels that are not tested with physics."""
        for channel, fits in BY_NAME.items():
            found = [s for s in self._free() if s.name == channel or fits(s)]
            found = [s for s in found if s.name == channel] or found
            if len(found) > 1:
                do = f"choose one: --take {channel}=NAME; or none: --take {channel}="
                self._doubt(channel, found, "several columns fit by name", do)
            elif found:
                reasons = (
                    "name",
                    f"unit {found[0].column.unit}",
                    NOT_TESTED.get(channel, "not tested"),
                )
                self._propose(channel, Mapping(found[0].name), False, *reasons)


def _is_time(name: str) -> bool:
    return bool(TIME & set(words(name)))


def _runs(values: Array) -> bool:
    """Whether the values rise, with `REPEATED` of the rows repeating the one before at most."""
    steps = np.diff(values)
    few = np.count_nonzero(steps == 0.0) <= REPEATED * values.size
    return bool(steps.size and np.all(steps >= 0.0) and few)


def _disorder(time: Array) -> str:
    """What keeps a column from being a time, in words."""
    steps = np.diff(time)
    for what, wrong in (
        ("has no value", np.flatnonzero(np.isnan(time))),
        ("goes back", np.flatnonzero(steps < 0.0) + 1),
        ("repeats a time", np.flatnonzero(steps == 0.0) + 1),
    ):
        if wrong.size:
            return f"{what} in {wrong.size} rows, first in row {wrong[0] + 1}"
    return "has one row"


def _brake_score(name: str) -> int:
    return score(name, BRAKE, NO_BRAKE) + max(0, 2 * score(name, MASTER, NO_BRAKE))


def _no_brake(item: Series, points: int, braking: Array | None, clock: ColumnClock) -> str | None:
    """Reason why a pressure is not the brake pressure, or None."""
    if item.values.max() > LIMITS.pressure:
        return f"a pressure of {item.values.max() / 1e5:.0f} bar is too high for a brake"
    if braking is None or np.ptp(braking) < ACCELERATED or not np.ptp(item.values) > 0.0:
        return None if points > 0 else "a pressure, not known to be of the brake"
    ahead, agrees = lead(item.values, braking, clock)
    if agrees < FOLLOWS:
        return f"a pressure that does not agree with the deceleration (correlation {agrees:.2f})"
    if agrees - lead(item.values, braking, clock, LATE)[1] > LATER:
        return f"a pressure that comes {-ahead:.2f} s after the deceleration"
    return None


def _disc(side: str) -> Callable[[Series], bool]:
    return lambda s: s.si == "degC" and score(s.name, DISC, set()) > 0 and axle(s.name) == side


def _drive(side: str) -> Callable[[Series], bool]:
    """Whether a column is the torque of an engine or motor of an axle, by name and unit."""

    def fits(s: Series) -> bool:
        named = score(s.name, TORQUE, NO_DRIVE) > 0 and score(s.name, DRIVE, set()) > 0
        return s.si == "N*m" and named and axle(s.name) == side

    return fits


BY_NAME: dict[str, Callable[[Series], bool]] = {
    "steering": lambda s: s.si == "rad" and score(s.name, STEERING, NO_STEERING) > 0,
    "T_disc_f": _disc("f"),
    "T_disc_r": _disc("r"),
    "T_drive_f": _drive("f"),
    "T_drive_r": _drive("r"),
}
"""What a column is by name and unit alone."""

NOT_TESTED = dict.fromkeys(
    ("T_drive_f", "T_drive_r"),
    "not tested: it must be that at the wheels (scale by the gear), negative when it slows",
)
"""What the user must look at, by channel."""
