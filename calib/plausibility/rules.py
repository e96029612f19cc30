"""Judge a run for a purpose by the rules: `check` uses the same rows as the purpose itself.

run --figures--> rows of `rules.csv` for the purpose --> refused, void, or warned of

Figures of the log alone come first; if they refuse it, its signals are not computed. Rules that
need a vehicle count where there is one. Reasons come in the order of the rows, causes first.
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
PURPOSES = (FIT, VALIDATE, COAST, DIAGNOSE)
"""Purposes of a log; "coast": for a fit, beside its ramps."""

_CALLED = {
    FIT: "this run will not do for a fit",
    COAST: "this coast will not do for a fit",
    VALIDATE: "this run cannot be used for a validation",
    DIAGNOSE: "this run will not do for a diagnosis",
}

Figure = Callable[[Evidence], Iterator[Measured]]

_OF_LOG: tuple[Figure, ...] = (
    *(driving.clock, channels.channels, channels.computed, channels.marked, channels.sensors),
)
"""Figures of any log, each named as in the rules."""
_OF_MOTION: tuple[Figure, ...] = (
    *(wheels.wheel_sign, driving.driving, driving.use, wheels.a_x_follows),
    *(wheels.wheels, wheels.radii),
    *(channels.at_rest, channels.pressure, channels.speed, channels.held_values),
)
"""Those that need a_x and the wheel speeds."""
_OF_SIGNALS: tuple[Figure, ...] = (
    *(channels.copied, channels.late, channels.pressure_sides, channels.from_master),
    *(wheels.car_wheels, wheels.a_x_by_wheels, wheels.slip, wheels.slip_of_v, wheels.v_scale),
    *(forces.accelerometer, forces.a_x_late, forces.brakes, forces.force_step),
    *(forces.bend, forces.levels),
)
"""Those that need all channels, and a car that moves."""


def unusable(
    run: Run, purpose: str, does: Collection[str] = (REFUSE, VOID)
) -> tuple[PlausibilityWarning, ...]:
    """Reasons for which a run is refused, or its result void, before any estimate."""
    e, (first, second) = Evidence(run), _figures(run)
    return _broken(e, first, purpose, does) or _broken(e, second, purpose, does)


def require(run: Run, purpose: str) -> None:
    """Raise LogError with every reason for a run that will not do for a purpose."""
    require_none(unusable(run, purpose, (REFUSE,)), run, purpose)


def require_none(reasons: tuple[PlausibilityWarning, ...], run: Run, purpose: str) -> None:
    """Raise LogError with all ``reasons`` against a run, each in its line, if there are any."""
    if reasons:
        first, *more = (one.text for one in reasons)
        flaw, do = f"{_CALLED[purpose]}: {first}", "see `brake-cal check`"
        raise LogError(flaw, where=run.log.source, do=do, lines=tuple(more))


def warnings_on(
    e: Evidence, purpose: str, does: Collection[str] = (WARN,), *, whole: bool = True
) -> tuple[PlausibilityWarning, ...]:
    """Warnings on a run for a purpose, in the order of the rules; ``does`` their consequences.

    Not ``whole``: by the log alone, if it is refused.
    """
    first, second = _figures(e.run)
    return _broken(e, (*first, *second) if whole else first, purpose, does)


def _figures(run: Run) -> tuple[tuple[Figure, ...], tuple[Figure, ...]]:
    """Figures of the log and its motion, and those of its signals, if it has what they need."""
    first = (*_OF_LOG, *_OF_MOTION) if run.moves else _OF_LOG
    return first, _OF_SIGNALS if not run.missing and run.speed > MOVING else ()


def _broken(
    e: Evidence, figures: tuple[Figure, ...], purpose: str, does: Collection[str]
) -> tuple[PlausibilityWarning, ...]:
    by_name = {figure.__name__: figure for figure in figures}
    to_compute = [by_name[name] for name in _figure_names(purpose, tuple(does)) if name in by_name]
    name = e.run.log.name
    return unexplained(
        w for figure in to_compute for w in rule_warnings(name, figure(e), purpose, does)
    )


@cache
def _figure_names(purpose: str, does: tuple[str, ...]) -> tuple[str, ...]:
    """Names of the figures that a purpose needs, in the order of the rules."""
    figures = (
        rule.figure for rule in RULES if purpose in rule.purposes and rule.consequence in does
    )
    return tuple(dict.fromkeys(figures))


def makes_void(warning: PlausibilityWarning, purpose: str) -> bool:
    """Whether a result with this warning counts for nothing."""
    rules = (
        r
        for r in RULES
        if r.code == warning.code and r.consequence == VOID and purpose in r.purposes
    )
    return any(not rule.low <= warning.measured <= rule.high for rule in rules)
