"""Propose a channel map: a proposal for each channel, doubts, and unused columns.

columns --> clock --> wheels --> speed --> a_x --> pressure --> the rest, by name and unit
(each step uses the results of the steps before)
"""

from collections.abc import Callable
from collections.abc import Mapping as Named
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from calib.base.names import CHANNELS, WHEELS
from calib.logs.channel_map import Mapping
from calib.logs.clock import step_of
from calib.logs.source import ColumnSource
from calib.run.copies import factor_between, is_other_quantity
from calib.suggest.body import FoundChannel, find_acceleration, find_pressure, find_speed
from calib.suggest.clock import find_clock, rising
from calib.suggest.physics import ColumnClock, moving, rate_of
from calib.suggest.proposal import LIKELY, Doubt, Proposal, Suggestion
from calib.suggest.series import Series, read_series, without_gaps
from calib.suggest.told import told_source, values_of
from calib.suggest.wheels import find_wheels, groups
from calib.suggest.words import (
    DISC,
    DRIVE,
    NO_DRIVE,
    NO_STEERING,
    STEERING,
    TORQUE,
    axle,
    score,
)

Array = NDArray[np.float64]

REQUIRED = tuple(q.name for q in CHANNELS.values() if q.required)


def suggest(
    source: ColumnSource,
    where: str,
    *,
    told: Named[str, str] | None = None,
    radius: float | None = None,
) -> Suggestion:
    """Propose a channel map for an opened log.

    Parameters
    ----------
    source : of any format.
    where : the file's path, for messages.
    told : sources given by the user, by channel: ``Brake [bar]`` with or without a unit; empty
        for a channel that must not be mapped.
    radius : rolling radius [m] if the log has wheel speeds as speeds at the rim; used for those in
        ``told``, too.

    Returns
    -------
    The suggestion. A channel is missing if no column fits, and a doubt if several fit. Raises
    InputError for a channel or column in ``told`` that does not exist.
    """
    told = dict(told or {})
    series, with_gaps, left = read_series(source)
    work = _Work(series, with_gaps, left, told, radius)
    for channel, cell in told.items():
        work.assign(channel, cell, source, where)
    work.find()
    return work.suggestion(where)


@dataclass
class _Work:
    """Intermediate state. Columns that are assigned are not proposed again."""

    series: list[Series]
    with_gaps: list[Series]
    left: dict[str, str]
    told: dict[str, str]
    radius: float | None
    proposals: dict[str, Proposal] = field(default_factory=dict)
    doubts: list[Doubt] = field(default_factory=list)
    clock: ColumnClock | None = None

    def assign(self, channel: str, cell: str, source: ColumnSource, where: str) -> None:
        """Assign the source that the user gives."""
        proposal = told_source(channel, cell, source, where, self.radius)
        if proposal is not None:
            self.proposals[channel] = proposal

    def find(self) -> None:
        """Find every channel that the user did not give, in the order of the module's sketch."""
        self._clock()
        clock = self.clock
        if clock is None:
            self.left.update({s.name: "has missing values" for s in self.with_gaps})
            return
        self._bridge(clock)
        wheels = find_wheels(self._free(), self.radius)
        self.left.update(dict(wheels.refused))
        self._take_group("omega", wheels.proposals, wheels.doubts)
        mean = wheels.mean if wheels.mean is not None else self._given_wheels()
        speed = self._take("v", find_speed(self._free(), mean))
        metres = speed is not None
        motion = speed if speed is not None else mean
        rate, clock = self._while_moving(motion, clock)
        metres = metres or not (wheels.angular or "omega_fl" in self.told)
        self._take("a_x", find_acceleration(self._free(), rate, clock, metres))
        self._computed()
        self._take("p_mc", find_pressure(self._free(), None if rate is None else -rate, clock))
        self._wheel_pressures()
        self._by_name()

    def _bridge(self, clock: ColumnClock) -> None:
        """Bridge the short gaps of columns; leave those with longer ones."""
        for item in self.with_gaps:
            filled = without_gaps(item, clock.time)
            if isinstance(filled, str):
                self.left[item.name] = filled
            else:
                self.series.append(filled)
        rows = 1.0 / clock.step
        self.series = [replace(s, rate=s.rate or rows) for s in self.series]

    def _while_moving(
        self, motion: Array | None, clock: ColumnClock
    ) -> tuple[Array | None, ColumnClock]:
        """Derivative of the speed; drops all rows in which the car does not move."""
        if motion is None:
            return None, clock
        part = moving(motion, clock)
        rate = rate_of(motion, clock)[part]
        self.series = [replace(s, values=s.values[part]) for s in self.series]
        return rate, ColumnClock(clock.time[part], clock.step)

    def _free(self) -> list[Series]:
        """Columns that are neither assigned nor refused."""
        taken = {p.mapping.source for p in self.proposals.values()}
        return [s for s in self.series if s.name not in taken and s.name not in self.left]

    def _clock(self) -> None:
        if "time" in self.proposals:
            series = [values_of(s, self.proposals["time"]) for s in self.series]
            named = next((s for s in series if s is not None), None)
            if named is not None:
                named = named[rising(named)]
                self.clock = ColumnClock(named, step_of(named))
        elif "time" not in self.told:
            found, self.clock, doubts = find_clock(self._free(), self.with_gaps, self.left)
            self.doubts += doubts
            if found:
                self.proposals["time"] = found
        self._drop_repeated_rows()

    def _drop_repeated_rows(self) -> None:
        """Leave out the rows that repeat the time of the row before them."""
        written = [s.values for s in self.series if self._is_time(s)]
        if written and self.clock is not None:
            kept = rising(written[0])
            self.series = [replace(s, values=s.values[kept]) for s in self.series]
            self.with_gaps = [replace(s, values=s.values[kept]) for s in self.with_gaps]

    def _is_time(self, item: Series) -> bool:
        return "time" in self.proposals and item.name == self.proposals["time"].mapping.source

    def _given_wheels(self) -> Array | None:
        """Mean wheel speed of the columns that the user gave [rad/s], or None."""
        four = []
        for wheel in WHEELS:
            proposal = self.proposals.get(f"omega_{wheel}")
            found = [values_of(s, proposal) for s in self.series] if proposal else []
            four += [x for x in found if x is not None]
        return np.mean(four, axis=0) if len(four) == 4 else None

    def _take(self, channel: str, found: FoundChannel) -> Array | None:
        """Record a proposal, unless the user gave another source. Returns the column's values."""
        self.left.update({k: v for k, v in found.refused if k not in self.left})
        if channel in self.told:
            proposal = self.proposals.get(channel)
            values = [values_of(s, proposal) for s in self.series] if proposal else []
            return next((x for x in values if x is not None), None)
        self.doubts += found.doubts
        if found.proposal is None or found.series is None:
            return None
        self.proposals[channel] = found.proposal
        return found.series.values

    def _take_group(
        self, prefix: str, proposals: tuple[Proposal, ...], doubts: tuple[Doubt, ...]
    ) -> None:
        if not any(f"{prefix}_{w}" in self.told for w in WHEELS):
            self.proposals.update({p.channel: p for p in proposals})
            self.doubts += doubts

    def _computed(self) -> None:
        """Refuse pressures that are a column of another quantity times a number."""
        others = [s for s in self.series if is_other_quantity(s.column.unit)]
        for item in self._free():
            for other in others if item.si == "Pa" else []:
                factor = factor_between(item.values, other.values)
                if factor is not None:
                    self.left[item.name] = (
                        f"computed: a fixed number times {other.name} [{other.column.unit}]"
                    )

    def _wheel_pressures(self) -> None:
        fours = groups(self._free(), "Pa")
        if len(fours) != 1 or any(s.values.max() > 350e5 for s in fours[0].values()):
            return
        for wheel in WHEELS:
            item = fours[0][wheel]
            if f"p_{wheel}" not in self.told:
                reasons = ("name", f"unit {item.column.unit}")
                self.proposals[f"p_{wheel}"] = Proposal(
                    f"p_{wheel}", Mapping(item.name), LIKELY, reasons
                )

    def _by_name(self) -> None:
        """Find the channels that are not tested with physics."""
        wanted: dict[str, Callable[[Series], bool]] = {
            "steering": lambda s: s.si == "rad" and score(s.name, STEERING, NO_STEERING) > 0,
            "T_disc_f": lambda s: (
                s.si == "degC" and score(s.name, DISC, set()) > 0 and axle(s.name) == "f"
            ),
            "T_disc_r": lambda s: (
                s.si == "degC" and score(s.name, DISC, set()) > 0 and axle(s.name) == "r"
            ),
            "T_drive_f": lambda s: _is_drive(s) and axle(s.name) == "f",
            "T_drive_r": lambda s: _is_drive(s) and axle(s.name) == "r",
        }
        for channel, fits in wanted.items():
            found = [s for s in self._free() if s.name == channel or fits(s)]
            found = [s for s in found if s.name == channel] or found
            if channel in self.told or not found:
                continue
            if len(found) > 1:
                do = f"choose one: --take {channel}=NAME; or none: --take {channel}="
                names = tuple(s.name for s in found)
                self.doubts.append(Doubt(channel, names, "several columns fit by name", do))
                continue
            reasons = (
                "name",
                f"unit {found[0].column.unit}",
                NOT_TESTED.get(channel, "not tested"),
            )
            self.proposals[channel] = Proposal(channel, Mapping(found[0].name), LIKELY, reasons)

    def suggestion(self, where: str) -> Suggestion:
        """The result."""
        ordered = tuple(self.proposals[name] for name in CHANNELS if name in self.proposals)
        taken = {p.mapping.source for p in ordered}
        doubted = {name for doubt in self.doubts for name in doubt.channel.split(" ... ")}
        left = {s.name: self.left.get(s.name, "not a known channel") for s in self.series}
        left = {name: why for name, why in {**self.left, **left}.items() if name not in taken}
        missing = {
            name: f"the column of that name is {left[name]}" if name in left else self._why(name)
            for name in REQUIRED
            if name not in self.proposals and name not in doubted and not self._wheel_doubt(name)
        }
        ignore = tuple(n for n in left if n in CHANNELS and n not in self.proposals)
        return Suggestion(where, ordered, tuple(self.doubts), missing, left, ignore)

    def _why(self, name: str) -> str:
        return _why_missing(name) if self.clock else "not looked for, since the time is not known"

    def _wheel_doubt(self, name: str) -> bool:
        return name.startswith("omega") and any(d.channel.startswith("omega") for d in self.doubts)


def _is_drive(item: Series) -> bool:
    """Whether a column is the torque of an engine or motor, by name and unit."""
    named = score(item.name, TORQUE, NO_DRIVE) > 0 and score(item.name, DRIVE, set()) > 0
    return item.si == "N*m" and named


NOT_TESTED = dict.fromkeys(
    ("T_drive_f", "T_drive_r"),
    "not tested: it must be that at the wheels (scale by the gear), negative when it slows",
)
"""What the user must look at, by channel."""


def _why_missing(name: str) -> str:
    why = {
        "time": "no column is increasing and named a time",
        "p_mc": "no column is a brake pressure by name, unit and values",
        "a_x": "no column is a longitudinal acceleration by name, unit and values",
    }
    return why.get(name, "no four columns are wheel speeds by name, unit and values")
