"""Check a log: its content, and the purposes it is usable for."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass, is_dataclass
from typing import Any

from calib.base.names import AXLE_NAMES, CHANNELS
from calib.base.units import from_si, to_si
from calib.base.warning import PlausibilityWarning
from calib.car.vehicle import Vehicle
from calib.logs.gaps import ChannelHole
from calib.logs.log import Log, Origin
from calib.plausibility.evidence import Evidence
from calib.plausibility.rules import CHECK, PURPOSES, unusable, warnings_on
from calib.run.driving_record import BrakeEvent
from calib.run.limits import LIMITS
from calib.run.run import Run, figures
from calib.run.sensors import FIGURES, Sensor
from calib.run.wheels import IntervalEstimate


@dataclass(frozen=True)
class LogVerdict:
    """Whether a log is usable for a purpose; ``reasons`` why not, each with what to do instead."""

    purpose: str
    usable: bool
    reasons: tuple[str, ...]


@dataclass(frozen=True)
class _Taken(Origin):
    """The source of a channel with its range ``low`` to ``high`` [``si``]."""

    si: str
    low: float
    high: float

    def __str__(self) -> str:
        offset = f" {self.offset:+.6g}" if self.offset else ""
        span = f"{self.low:.6g} to {self.high:.6g} {self.si}"
        return f"from {self.source!r} [{self.unit}] x {self.factor:.6g}{offset}: {span}"

    @property
    def as_it_stands(self) -> bool:
        """Whether the file has the channel under its canonical name and unit."""
        unit = CHANNELS[self.channel].unit
        zero, one = (to_si(x, unit, self.si) for x in (0.0, 1.0))
        same = self.source == self.channel and math.isclose(self.factor, one - zero)
        return same and self.offset == zero


@dataclass(frozen=True)
class Findings:
    """Result of `check` for one log.

    Attributes
    ----------
    log, source, digest, truth, ignored, notes, bridged : as the `Log` has them.
    seen : what is seen of clock, sensors and driving [SI].
    warnings : problems that do not make the log unusable.
    verdicts : one for each purpose.
    taken : source column of each channel.
    uses : quantities that can be determined from the log, also if it is not usable.
    """

    log: str
    source: str
    digest: str
    truth: tuple[str, ...]
    ignored: tuple[str, ...]
    seen: Run
    notes: tuple[str, ...]
    warnings: tuple[PlausibilityWarning, ...]
    verdicts: tuple[LogVerdict, ...]
    taken: tuple[_Taken, ...] = ()
    uses: tuple[str, ...] = ()
    bridged: tuple[ChannelHole, ...] = ()

    def __repr__(self) -> str:
        lines = [f"  {v.purpose:<12} {'; '.join(v.reasons) or 'usable'}" for v in self.verdicts]
        return "\n".join([self.source, *lines])

    @property
    def usable(self) -> bool:
        """Whether the log is usable for at least one purpose."""
        return any(verdict.usable for verdict in self.verdicts)


def check(log: Log, copies: Iterable[str] = (), vehicle: Vehicle | None = None) -> Findings:
    """Check a log and judge it for each purpose, by the rules that the purpose asks itself.

    Channels may be missing (``require=()`` of `read_log`). ``copies`` name pressures that were
    computed from another column: they make the log unusable. Rules that need a vehicle, or other
    logs, are asked by the purpose alone; with a ``vehicle`` those of the first kind here, too.

    >>> import calib
    >>> findings = calib.check(calib.read_log(calib.sample_logs() / "sedan" / "coast.csv"))
    >>> [verdict.purpose for verdict in findings.verdicts if verdict.usable]
    ['coast', 'diagnose']
    >>> findings.verdicts[0].reasons[0].partition(";")[0]
    'no braking (no_braking)'
    """
    seen, copies = Run(log, vehicle), tuple(copies)
    reasons = {name: (*copies, *(one.text for one in unusable(seen, name))) for name in PURPOSES}
    useless = all(reasons.values())
    return Findings(
        log=log.name,
        source=log.source,
        digest=log.digest,
        truth=tuple(log.truth),
        ignored=log.ignored,
        seen=seen,
        notes=log.notes,
        warnings=warnings_on(Evidence(seen), CHECK, whole=not useless),
        verdicts=tuple(LogVerdict(name, not why, why) for name, why in reasons.items()),
        taken=tuple(_taken(log, one) for one in log.origins if one.channel in CHANNELS),
        uses=tuple(_uses(seen)),
        bridged=log.bridged,
    )


def _uses(seen: Run) -> Iterator[str]:
    """What can be determined from a log, with its accuracy, in words."""
    axles = seen.axles
    if axles is None:
        return
    zero = axles.front_rear
    if zero is not None:
        enough = "fine" if zero.half <= LIMITS.table_zero else "too coarse"
        sharp = f"to {100 * zero.half:.3f} % ({enough} for a table)"
        yield f"the zero of eta {sharp}, if the car rolled without its engine"
    if axles.slope is not None and axles.slope > 0:
        yield f"sign and size of a_x: with the wheels it makes a radius of {axles.slope:.2f} m"
    logged = [name for name in ("T_drive_f", "T_drive_r") if name in seen.present]
    if logged:
        yield f"brake forces less the torque of engine or motor: {', '.join(logged)}"
    if seen.alone:
        what = f"the {AXLE_NAMES[seen.alone]} tyres' stiffness, and the pads' ratio"
        yield f"{what}, in a fit with a ramp of both axles: the other axle has no pressure"
    if seen.events and "p_mc" in seen.missing:
        yield f"deceleration and slip of {len(seen.events)} braking(s); without pressure no torque"


def _taken(log: Log, origin: Origin) -> _Taken:
    values, si = log[origin.channel], CHANNELS[origin.channel].si
    return _Taken(**asdict(origin), si=si, low=float(values.min()), high=float(values.max()))


def to_dict(findings: Findings) -> dict[str, Any]:
    """The findings as plain data, numbers in SI; ``figures`` as in the results of a batch."""
    others = {name: x for name, x in vars(findings).items() if name != "seen"}
    return {
        "usable": findings.usable,
        **{name: _plain(x) for name, x in others.items()},
        "seen": {name: _plain(getattr(findings.seen, name)) for name in _SEEN},
        "figures": figures(findings.seen),
        "warned": list(dict.fromkeys(warning.code for warning in findings.warnings)),
    }


_SEEN = (
    "present", "missing", "clock", "sensors", "events", "lead_in", "coasting", "lead_in_driven",
    "standing", "speed", "z", "alone", "pressures", "wheels_held", "v_of_wheels", "axles",
    "slipping", "wheels",
)  # fmt: skip
"""What is told of a run, by name."""


def _plain(x: Any) -> Any:
    """Records as mappings, in tuples and mappings, too."""
    if isinstance(x, Sensor):
        return {name: getattr(x, name) for name in FIGURES}
    if isinstance(x, dict):
        return {name: _plain(y) for name, y in x.items()}
    if isinstance(x, tuple):
        return tuple(map(_plain, x))
    return asdict(x) if is_dataclass(x) and not isinstance(x, type) else x


def facts(findings: Findings) -> Iterator[tuple[str, str]]:
    """Label and text of each finding except warnings and verdicts; units of a log file."""
    seen, clock = findings.seen, findings.seen.clock
    yield "channels", ", ".join(seen.present) + (" + truth" if findings.truth else "")
    absent = [q.name for q in CHANNELS.values() if not q.required and q.name not in seen.present]
    if seen.missing:
        yield "missing", ", ".join(seen.missing)
    yield "not there", ", ".join(absent) or "-"
    if findings.ignored:
        yield "ignored", ", ".join(findings.ignored)
    if not all(item.as_it_stands for item in findings.taken):
        yield from ((item.channel, str(item)) for item in findings.taken)
    jitter = f"jitter {1e3 * clock.jitter:.2f} ms, {len(clock.gaps)} gaps"
    yield "clock", f"{clock.samples} samples, {clock.duration:.2f} s, {clock.rate:.4g} Hz, {jitter}"
    for sensor in seen.sensors:
        yield sensor.channel, _sensor(sensor)
    yield from _driving(findings)


def _driving(findings: Findings) -> Iterator[tuple[str, str]]:
    seen = findings.seen
    if seen.axles is None:
        return
    yield "driven", f"up to {3.6 * seen.speed:.0f} km/h, up to {seen.z:.2f} g"
    yield "lead-in", f"{seen.lead_in:.2f} s of steady rolling"
    for number, event in enumerate(seen.events, start=1):
        yield f"braking {number}", _event(event)
    yield "eta - 1", _percent(seen.axles.front_rear) + " without braking"
    sides = (seen.axles.left_right_f, seen.axles.left_right_r)
    yield "right/left", f"front {_percent(sides[0])}, rear {_percent(sides[1])}"
    for text in findings.uses:
        yield "good for", text


def _sensor(sensor: Sensor) -> str:
    quantity = CHANNELS[sensor.channel]

    def written(value: float, digits: int = 4) -> str:
        return f"{from_si(value, quantity.unit, quantity.si):.{digits}g}"

    parts = [f"{written(sensor.low)} to {written(sensor.high)} {quantity.unit}"]
    parts += [f"steps of {written(sensor.resolution, 2)}"] if sensor.resolution else []
    if sensor.noise == sensor.noise:  # not NaN
        colour = f"autocorrelation {sensor.autocorrelation:+.2f}"
        parts.append(f"noise {written(sensor.noise, 2)} ({colour})")
    return ", ".join(parts)


def _event(event: BrakeEvent) -> str:
    pressure = "" if event.pressure is None else f", to {event.pressure / 1e5:.1f} bar"
    return (
        f"{event.start:.2f} to {event.end:.2f} s{pressure}, to {event.z_high:.2f} g, "
        f"{3.6 * event.speed_start:.0f} to {3.6 * event.speed_end:.0f} km/h, "
        f"rises for {event.rise:.1f} s by {event.rise_z:.2f} g"
    )


def _percent(estimate: IntervalEstimate | None) -> str:
    if estimate is None:
        return "unknown"
    return f"{100 * estimate.value:+.3f} +- {100 * estimate.half:.3f} %"
