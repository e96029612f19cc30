"""Judge a run for a purpose by the rules, in `check` as in `fit`, `validate` and `diagnose`.

    run --figures--> measured values --rows of `rules.csv` for the purpose--> warnings

Warnings come in the order of the rows, causes first.
"""

from collections.abc import Callable, Collection, Iterator
from functools import cache

from calib.base.errors import LogError
from calib.base.warning import (
    REFUSE,
    RULES,
    VOID,
    WARN,
    Measured,
    PlausibilityWarning,
    rule_warnings,
    unexplained,
)
from calib.car.braking import MOVING
from calib.plausibility import channels, driving, forces, wheels
from calib.plausibility.evidence import Evidence
from calib.run.run import Run

FIT, COAST, VALIDATE, DIAGNOSE, CHECK = "fit", "coast", "validate", "diagnose", "check"
PURPOSES = (FIT, VALIDATE, COAST, DIAGNOSE)  # of a log; a coast is for a fit, beside its ramps
_REFUSALS = {
    FIT: "this run will not do for a fit",
    COAST: "this coast will not do for a fit",
    VALIDATE: "this run cannot be used for a validation",
    DIAGNOSE: "this run will not do for a diagnosis",
}

Figure = Callable[[Evidence], Iterator[Measured]]

_LOG_FIGURES: tuple[Figure, ...] = (
    driving.clock, channels.channels, channels.computed, channels.impossible_samples,
    channels.sensors,
)  # fmt: skip
"""Figures of any log, each named as in `rules.csv`."""
_MOTION_FIGURES: tuple[Figure, ...] = (
    wheels.wheel_sign, driving.driving, driving.maneuver, wheels.a_x_follows, wheels.wheels,
    wheels.radii, channels.zero_of_pressure, channels.pressure, channels.reference_speed,
    channels.held_values,
)  # fmt: skip
"""Figures that need a_x and the wheel speeds."""
_SIGNAL_FIGURES: tuple[Figure, ...] = (
    channels.copied, channels.delay_of_v, channels.pressure_sides, channels.from_master,
    wheels.car_wheels, wheels.a_x_by_wheels, wheels.slip, wheels.slip_of_v, wheels.v_scale,
    forces.accelerometer, forces.a_x_late, forces.brakes, forces.force_step, forces.bend,
    forces.levels,
)  # fmt: skip
"""Figures that need all channels, and a car that moves; some need a vehicle."""


def unusable(
    run: Run, purpose: str, consequences: Collection[str] = (REFUSE, VOID)
) -> tuple[PlausibilityWarning, ...]:
    """Reasons for which a run is refused, or its result void, before any estimate."""
    evidence, (log_figures, signal_figures) = Evidence(run), _figures(run)
    reasons = _broken(evidence, log_figures, purpose, consequences)
    if reasons:  # the signals of a log that is refused are not computed
        return reasons
    return _broken(evidence, signal_figures, purpose, consequences)


def require(run: Run, purpose: str) -> None:
    """Raise LogError with every reason for which a run is refused for a purpose."""
    require_none(unusable(run, purpose, (REFUSE,)), run, purpose)


def require_none(reasons: tuple[PlausibilityWarning, ...], run: Run, purpose: str) -> None:
    """Raise LogError with all ``reasons`` against a run, each in its line, if there are any."""
    if reasons:
        first, *others = (reason.text for reason in reasons)
        flaw, do = f"{_REFUSALS[purpose]}: {first}", "see `brake-cal check`"
        raise LogError(flaw, where=run.log.source, do=do, lines=tuple(others))


def warnings_on(
    evidence: Evidence, purpose: str, consequences: Collection[str] = (WARN,)
) -> tuple[PlausibilityWarning, ...]:
    """Warnings on a run for a purpose, in the order of the rules, with these consequences."""
    log_figures, signal_figures = _figures(evidence.run)
    return _broken(evidence, (*log_figures, *signal_figures), purpose, consequences)


def warnings_on_log(run: Run, purpose: str) -> tuple[PlausibilityWarning, ...]:
    """Warnings by the figures of the log and its motion alone, as for a run that is refused."""
    return _broken(Evidence(run), _figures(run)[0], purpose, (WARN,))


def _figures(run: Run) -> tuple[tuple[Figure, ...], tuple[Figure, ...]]:
    """Figures of log and motion, and figures of the signals, for which the run has the channels."""
    motion = _MOTION_FIGURES if run.has_motion_channels else ()
    signals = _SIGNAL_FIGURES if not run.missing and run.speed > MOVING else ()
    return (*_LOG_FIGURES, *motion), signals


def _broken(
    evidence: Evidence, figures: tuple[Figure, ...], purpose: str, consequences: Collection[str]
) -> tuple[PlausibilityWarning, ...]:
    """Warnings of the rules that the figures break; a figure that no rule needs is not computed."""
    by_name, log = {figure.__name__: figure for figure in figures}, evidence.run.log.name
    warnings: list[PlausibilityWarning] = []
    for name in _figure_names(purpose, tuple(consequences)):
        if name in by_name:
            warnings += rule_warnings(log, by_name[name](evidence), purpose, consequences)
    return unexplained(warnings)


@cache
def _figure_names(purpose: str, consequences: tuple[str, ...]) -> tuple[str, ...]:
    """Names of the figures that a purpose needs, in the order of the rules."""
    rules = (r for r in RULES if purpose in r.purposes and r.consequence in consequences)
    return tuple(dict.fromkeys(rule.figure for rule in rules))


def makes_void(warning: PlausibilityWarning, purpose: str) -> bool:
    """Whether a result with this warning is void."""
    rules = (r for r in RULES if r.code == warning.code and purpose in r.purposes)
    return any(r.consequence == VOID and not r.low <= warning.measured <= r.high for r in rules)
