"""What the rules say of a run, for each use: the same rows for `check` and for the use itself.

run --figures--> rows of `rules.csv` that the use asks --> refused, void, or warned of

First come figures of the log alone. Where these refuse it, nothing is made of its signals. Rules
that need a vehicle are asked where there is one.
"""

from collections.abc import Callable, Collection, Iterator
from functools import cache

from calib.base.errors import LogError
from calib.base.warning import REFUSE, RULES, VOID, WARN, Measured, PlausibilityWarning, judged
from calib.car.braking import MOVING
from calib.plausibility import channels, driving, forces, wheels
from calib.plausibility.evidence import Evidence
from calib.run.run import Run

FIT, COAST, VALIDATE, DIAGNOSE, CHECK = "fit", "coast", "validate", "diagnose", "check"
PURPOSES = (FIT, VALIDATE, COAST, DIAGNOSE)
"""What a log may serve for; "coast": a fit, in addition to its ramps."""

_CALLED = {
    FIT: "this run will not do for a fit",
    COAST: "this coast will not do for a fit",
    VALIDATE: "this run cannot be used for a validation",
    DIAGNOSE: "this run will not do for a diagnosis",
}

Figure = Callable[[Evidence], Iterator[Measured]]


def _named(*figures: Figure) -> dict[str, Figure]:
    return {figure.__name__: figure for figure in figures}


_OF_LOG = _named(driving.clock, channels.channels, channels.marked, channels.sensors)
"""Figures of any log, by the names that the rules have."""
_OF_MOTION = _named(
    *(
        driving.driving,
        driving.use,
        channels.noise,
        channels.pressure,
        channels.speed,
        channels.held,
    ),
    *(wheels.wheels, wheels.radii),
)
"""Those that need a_x and the wheel speeds."""
_OF_SIGNALS = _named(
    *(
        channels.copied,
        channels.late,
        channels.at_rest,
        channels.pressure_sides,
        channels.from_master,
    ),
    *(wheels.car_wheels, wheels.slip, wheels.slip_of_v, wheels.v_scale, wheels.lost_pulses),
    *(forces.accelerometer, forces.brakes, forces.bend, forces.levels),
)
"""Those that need all channels, and a car that moves."""


def refusals(
    run: Run, purpose: str, does: Collection[str] = (REFUSE,)
) -> list[PlausibilityWarning]:
    """Why a run is of no use for a purpose, by its figures before any estimate."""
    return [*_first(Evidence(run), purpose, does)] or [*_second(Evidence(run), purpose, does)]


def unusable(run: Run, purpose: str) -> list[PlausibilityWarning]:
    """Why nothing comes of a run: it is refused, or its result would be void."""
    return refusals(run, purpose, (REFUSE, VOID))


def require(run: Run, purpose: str) -> None:
    """Raise LogError with every reason for a run that will not do for a purpose."""
    if why := refusals(run, purpose):
        what = f"{_CALLED[purpose]}: {'; '.join(one.text for one in why)}"
        raise LogError(what, where=run.log.source, do="see `brake-cal check`")


def warnings_on(
    e: Evidence, purpose: str, does: Collection[str] = (WARN,), *, whole: bool = True
) -> tuple[PlausibilityWarning, ...]:
    """Warnings on a run that is used for a purpose, or what else the rules do.

    Without the ``whole`` of them those of the log alone, for one that is refused.
    """
    first = tuple(_first(e, purpose, does))
    return (*first, *_second(e, purpose, does)) if whole else first


def makes_void(warning: PlausibilityWarning, purpose: str) -> bool:
    """Whether nothing counts of a result with this warning."""
    rules = (r for r in RULES if r.code == warning.code and r.does == VOID and purpose in r.asked)
    return any(not rule.low <= warning.measured <= rule.high for rule in rules)


def _first(e: Evidence, purpose: str, does: Collection[str]) -> Iterator[PlausibilityWarning]:
    yield from _asked(e, _OF_LOG, purpose, does)
    if e.run.moves:
        yield from _asked(e, _OF_MOTION, purpose, does)


def _second(e: Evidence, purpose: str, does: Collection[str]) -> Iterator[PlausibilityWarning]:
    if not e.run.missing and e.run.speed > MOVING:
        yield from _asked(e, _OF_SIGNALS, purpose, does)


def _asked(
    e: Evidence, figures: dict[str, Figure], purpose: str, does: Collection[str]
) -> Iterator[PlausibilityWarning]:
    """By the order of the rules; a figure that no rule asks is not computed."""
    for name in _figures(purpose, tuple(does)):
        if name in figures:
            yield from judged(e.run.log.name, figures[name](e), purpose, does)


@cache
def _figures(purpose: str, does: tuple[str, ...]) -> tuple[str, ...]:
    """Names of the figures that rules ask, by the order of the rules."""
    asked = (rule.figure for rule in RULES if purpose in rule.asked and rule.does in does)
    return tuple(dict.fromkeys(asked))
