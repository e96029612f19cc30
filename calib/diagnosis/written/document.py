"""diagnosis.json: a diagnosis as a JSON document of a fixed schema."""

import json
import math
from dataclasses import asdict
from typing import Any

from calib.base.warning import to_dict as warning_dict
from calib.car.effects.empirical import DRIVERS
from calib.diagnosis.diagnosis import Diagnosis, Named, ParameterEstimate
from calib.diagnosis.proof.unexplained import Unexplained, held_from
from calib.diagnosis.replays.gap import CHANNELS, UNITS, Gap
from calib.diagnosis.replays.remainder import Remainder
from calib.diagnosis.search.search import SearchStep
from calib.diagnosis.undecided.confusion import Confusion
from calib.diagnosis.undecided.drives import ShowingDrive
from calib.diagnosis.written.course import changes

SCHEMA = 1


def to_dict(found: Diagnosis) -> dict[str, Any]:
    """The whole diagnosis, JSON-able."""
    return {
        "schema": SCHEMA,
        "verdict": found.verdict,
        "effects": [_effect(effect) | _defined(effect, found) for effect in found.effects],
        "own_effects": _own(found),
        "known": {
            n: dict(values) for n, values in found.model_before.vehicle.effects.parameters.items()
        },
        "unexplained": None if found.unexplained is None else _structure(found.unexplained, found),
        "own_states": {log: dict(states) for log, states in found.own.items()},
        "sides": dict(found.sides),
        "confusion": None if found.confusion is None else _confusion(found.confusion),
        "not_resolved": list(found.not_resolved),
        "would_show": [_drive(drive) for drive in found.drives],
        "base": {name: _estimate(value) for name, value in found.base.items()},
        "innovation": {"before": found.reduced_before, "after": found.reduced_after},
        "noise": {"from": found.noise.source, "at_floor": list(found.noise.at_floor)},
        "left": _left(found.left),
        "steps": _steps(found.steps),
        "withdrawn": [list(names) for names in found.withdrawn],
        "gap": _gap(found.gap),
        "warnings": [warning_dict(warning) for warning in found.warnings],
    }


def text_of(found: Diagnosis) -> str:
    """The text of diagnosis.json; a number that is not finite is null."""
    return json.dumps(_finite(to_dict(found)), indent=2, allow_nan=False) + "\n"


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(part) for key, part in value.items()}
    if isinstance(value, list):
        return [_finite(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _estimate(value: ParameterEstimate) -> dict[str, Any]:
    return {"value": value.value, "unit": value.unit, "ci95": list(value.ci95)}


def _effect(effect: Named) -> dict[str, Any]:
    where = effect.where
    return {
        "name": effect.name,
        "parameters": {name: _estimate(value) for name, value in effect.parameters.items()},
        "where": {
            "channel": where.channel,
            "axle": where.axle,
            "pressure": {"range": list(where.pressure), "unit": "Pa"},
            "speed": {"range": list(where.speed), "unit": "m/s"},
            "temperature": None
            if where.temperature is None
            else {"range": list(where.temperature), "unit": "degC"},
        },
        "evidence": {
            "innovation_gain": effect.gain,
            "innovation_gain_holdout": effect.gain_holdout,
        },
        "runner_up": None
        if effect.runner_up is None
        else {"name": effect.runner_up[0], "innovation_gain": effect.runner_up[1]},
        "indistinguishable_from": list(effect.indistinguishable_from),
        "separate_by": effect.separate_by,
    }


def _steps(steps: tuple[SearchStep, ...]) -> list[dict[str, Any]]:
    """Every step; what it added and what that brought, for each but the first."""
    brought = [
        {"added": c.added, "removed": c.removed, "innovation_gain": c.gain} for c in changes(steps)
    ]
    return [asdict(step) | change for step, change in zip(steps, [{}, *brought], strict=True)]


def _confusion(found: Confusion) -> dict[str, Any]:
    best = found.explanations[0].innovation
    return {
        "explanations": [
            {"effects": list(e.names), "innovation": e.innovation, "behind": e.innovation - best}
            for e in found.explanations
        ],
        "pairs": [
            {
                "between": [pair.one, pair.other],
                "apart_in_logs": pair.apart,
                "drive": pair.drive,
                "apart_in_drive": pair.sigma,
                "unit": "sigma",
            }
            for pair in found.pairs
        ],
    }


def _drive(found: ShowingDrive) -> dict[str, Any]:
    units = found.card.units
    return {
        "effect": found.effect,
        "usual_size": {n: {"value": v, "unit": units[n]} for n, v in found.card.usual.items()},
        "drive": found.name,
        "sigma": found.sigma,
        "clear": found.clear,
    }


def _own(found: Diagnosis) -> list[dict[str, Any]]:
    """Every effect of the user's own that was tried, whether it was named or not."""
    names = {effect.name for effect in found.effects}
    return [
        {"name": name, "file": one.file, "sha256": one.sha256, "named": name in names}
        for name, one in found.model_after.effects.own.items()
    ]


def _defined(effect: Named, found: Diagnosis) -> dict[str, Any]:
    """The file of an effect that is not in the catalogue."""
    defined = found.model_after.effects.defined_in.get(effect.name)
    return {} if defined is None else {"defined_in": asdict(defined)}


def _left(left: Remainder) -> dict[str, Any]:
    return {
        "size": left.size,
        "unit": "rms of replay errors over the noise of the sensors",
        "log": left.log,
        "channel": left.channel,
        "largest": left.largest,
        "pressure": {"range": list(left.pressure), "unit": "Pa"},
        "speed": {"range": list(left.speed), "unit": "m/s"},
        "time": {"range": list(left.time), "unit": "s"},
    }


def _structure(found: Unexplained, whole: Diagnosis) -> dict[str, Any]:
    term = found.term
    return {
        "beside": [effect.name for effect in whole.effects],
        "in_model": whole.model_after.effects.terms != (),
        "replays": _left(whole.left),
        "innovation": whole.reduced_after if whole.effects else whole.reduced_before,
        "place": found.place,
        "axle": found.axle,
        "wheel": found.wheel,
        "driver": found.driver,
        "held_from": held_from(term),
        "explained": found.explained,
        "turning": found.turning,
        "oscillation": {
            "frequency": found.oscillation.frequency,
            "share": found.oscillation.share,
        },
        "term": {
            "driver": term.driver,
            "driver_unit": DRIVERS[term.driver],
            "knots": list(term.knots),
            "values": list(term.values),
        },
        "runners_up": [
            {"place": place, "driver": driver, "explained": share}
            for place, driver, share in found.runners_up
        ],
    }


def _gap(gap: Gap) -> dict[str, Any]:
    return {
        "before": gap.before,
        "after": gap.after,
        "closed": gap.closed,
        "unit": "rms over the noise of the sensors",
        "by_channel": _by_channel(gap),
        "by_log": {
            log: dict(zip(("before", "after"), gap.of(log), strict=True))
            | {"by_channel": _by_channel(gap, log)}
            for log in gap.logs
        },
    }


def _by_channel(gap: Gap, log: str | None = None) -> dict[str, Any]:
    """The gap of each channel in its unit, of one log or all."""
    out = {}
    for channel, noise in zip(CHANNELS, gap.noise.tolist(), strict=True):
        before, after = gap.of(log, channel)
        out[channel] = {
            "before": noise * before,
            "after": noise * after,
            "noise": noise,
            "closed": 1.0 - after / before if before > 0.0 else None,
            "unit": UNITS[channel],
        }
    return out
