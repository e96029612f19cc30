"""Check a log: what it contains, and for which purposes it is usable."""

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass, is_dataclass
from itertools import chain
from typing import Any

from calib.base.names import CHANNELS
from calib.base.units import BAR, from_si, to_si
from calib.base.warning import PlausibilityWarning, unexplained
from calib.car.vehicle import Vehicle
from calib.logs.log import Log, Origin
from calib.plausibility.evidence import Evidence
from calib.plausibility.rules import CHECK, PURPOSES, unusable, warnings_on, warnings_on_log
from calib.run.driving_record import BrakeEvent
from calib.run.run import Run, figures
from calib.run.sensors import Sensor
from calib.run.wheels import IntervalEstimate

_VIEWS = (
    "present", "missing", "clock", "sensors", "events", "lead_in", "coasting", "speed", "z",
    "alone", "pressures", "wheels_held", "axles", "slipping", "wheels",
)  # fmt: skip
"""Views of a run in the document of `to_dict`."""


@dataclass(frozen=True)
class _Verdict:
    """Whether a log is usable for a purpose."""

    purpose: str
    usable: bool
    reasons: tuple[str, ...]  # why it is not usable, each with the remedy


@dataclass(frozen=True)
class Findings:
    """Result of `check` for one log."""

    run: Run
    warnings: tuple[PlausibilityWarning, ...]  # they do not make the log unusable
    verdicts: tuple[_Verdict, ...]  # one for each purpose

    def __repr__(self) -> str:
        lines = [f"  {v.purpose:<12} {'; '.join(v.reasons) or 'usable'}" for v in self.verdicts]
        return "\n".join([self.run.log.source, *lines])

    @property
    def usable(self) -> bool:
        """Whether the log is usable for at least one purpose."""
        return any(verdict.usable for verdict in self.verdicts)


def check(log: Log, vehicle: Vehicle | None = None) -> Findings:
    """Check a log and judge it for each purpose, by the rules of that purpose.

    Channels may be missing (``require=()`` of `read_log`). Rules that need other logs are left out,
    and without ``vehicle`` those that need a vehicle.

    >>> import calib
    >>> findings = calib.check(calib.read_log(calib.sample_logs() / "sedan" / "coast.csv"))
    >>> [verdict.purpose for verdict in findings.verdicts if verdict.usable]
    ['coast', 'diagnose']
    >>> findings.verdicts[0].reasons[0].partition(";")[0]
    'the log has no braking (no_braking)'
    """
    run = Run(log, vehicle)
    refusals = {purpose: unusable(run, purpose) for purpose in PURPOSES}
    is_refused = all(refusals.values())
    warnings = warnings_on_log(run, CHECK) if is_refused else warnings_on(Evidence(run), CHECK)
    verdicts = [
        _Verdict(purpose, not reasons, tuple(reason.text for reason in reasons))
        for purpose, reasons in refusals.items()
    ]
    all_reasons = chain.from_iterable(refusals.values())  # what follows from them is left out
    return Findings(run, unexplained(warnings, all_reasons), tuple(verdicts))


def unseen(run: Run) -> tuple[str, ...]:
    """Channels whose scale no log shows; its error changes each pad friction in proportion."""
    scaled = ("p_mc",) if "v" in run.present else ("p_mc", "a_x")
    return tuple(name for name in scaled if name in run.present)


def to_dict(findings: Findings) -> dict[str, Any]:
    """Return the findings as JSON types in SI; ``figures`` are the columns of a batch."""
    run, log = findings.run, findings.run.log
    return {
        "usable": findings.usable,
        "log": log.name,
        "source": log.source,
        "digest": log.digest,
        "truth": list(log.truth),
        "ignored": log.ignored,
        "notes": log.notes,
        "warnings": _plain(findings.warnings),
        "verdicts": _plain(findings.verdicts),
        "taken": _plain(_origins(log)),
        "unseen": unseen(run),
        "bridged": _plain(log.bridged),
        "seen": {name: _plain(getattr(run, name)) for name in _VIEWS},
        "figures": figures(run),
        "warned": list(dict.fromkeys(warning.code for warning in findings.warnings)),
    }


def _origins(log: Log) -> tuple[Origin, ...]:
    return tuple(origin for origin in log.origins if origin.channel in CHANNELS)


def _is_canonical(origin: Origin) -> bool:
    """Whether the file has a channel under its canonical name and unit."""
    quantity = CHANNELS[origin.channel]
    offset, one_unit = (to_si(x, quantity.unit, quantity.si) for x in (0.0, 1.0))
    has_factor = math.isclose(origin.factor, one_unit - offset)
    return origin.source == origin.channel and has_factor and origin.offset == offset


def _plain(x: Any) -> Any:
    """Turn nested records into mappings."""
    if isinstance(x, dict):
        return {name: _plain(value) for name, value in x.items()}
    if isinstance(x, tuple):
        return tuple(map(_plain, x))
    return asdict(x) if is_dataclass(x) and not isinstance(x, type) else x


def contents(findings: Findings) -> Iterator[tuple[str, str]]:
    """Label and text of each finding except warnings and verdicts, in the units of a log file."""
    run, clock, log = findings.run, findings.run.clock, findings.run.log
    yield "channels", ", ".join(run.present) + (" + truth" if log.truth else "")
    absent = [q.name for q in CHANNELS.values() if not q.required and q.name not in run.present]
    if run.missing:
        yield "missing", ", ".join(run.missing)
    yield "not there", ", ".join(absent) or "-"
    if log.ignored:
        yield "ignored", ", ".join(log.ignored)
    origins = _origins(log)
    if not all(map(_is_canonical, origins)):
        for origin in origins:
            offset = f" {origin.offset:+.6g}" if origin.offset else ""
            factor = f"[{origin.unit}] x {origin.factor:.6g}{offset}"
            yield origin.channel, f"from {origin.source!r} {factor}"
    jitter = f"jitter {1e3 * clock.jitter:.2f} ms, {len(clock.gaps)} gaps"
    yield "clock", f"{clock.samples} samples, {clock.duration:.2f} s, {clock.rate:.4g} Hz, {jitter}"
    for sensor in run.sensors:
        yield sensor.channel, _sensor(sensor)
    if run.axles is None:
        return
    yield "driven", f"up to {3.6 * run.speed:.0f} km/h, up to {run.z:.2f} g"
    yield "lead-in", f"{run.lead_in:.2f} s of steady rolling"
    for number, event in enumerate(run.events, start=1):
        yield f"braking {number}", _event(event)
    yield "eta - 1", _percent(run.axles.front_rear) + " without braking"
    sides = (run.axles.left_right_f, run.axles.left_right_r)
    yield "right/left", f"front {_percent(sides[0])}, rear {_percent(sides[1])}"
    if scales := ", ".join(unseen(run)):
        yield "unseen", f"the scale of {scales}: see `unseen` in the document of a fit"


def _sensor(sensor: Sensor) -> str:
    quantity = CHANNELS[sensor.channel]

    def written(value: float, digits: int = 4) -> str:
        return f"{from_si(value, quantity.unit, quantity.si):.{digits}g}"

    parts = [f"{written(sensor.low)} to {written(sensor.high)} {quantity.unit}"]
    if sensor.resolution:
        parts.append(f"steps of {written(sensor.resolution, 2)}")
    if not math.isnan(sensor.noise):
        parts.append(f"noise {written(sensor.noise, 2)}")
    return ", ".join(parts)


def _event(event: BrakeEvent) -> str:
    pressure = "" if event.pressure is None else f", to {event.pressure / BAR:.1f} bar"
    return (
        f"{event.start:.2f} to {event.end:.2f} s{pressure}, to {event.z_high:.2f} g, "
        f"{3.6 * event.speed_start:.0f} to {3.6 * event.speed_end:.0f} km/h, "
        f"rises for {event.rise_time:.1f} s by {event.rise_z:.2f} g"
    )


def _percent(estimate: IntervalEstimate | None) -> str:
    if estimate is None:
        return "unknown"
    return f"{100 * estimate.value:+.3f} +- {100 * estimate.half:.3f} %"
