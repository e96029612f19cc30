"""What a diagnosis answers."""

from collections.abc import Mapping
from dataclasses import dataclass

from calib.base.units import behind
from calib.base.warning import PlausibilityWarning
from calib.car.effects.effects import DefinedIn
from calib.car.model import Model
from calib.diagnosis.explanation.channels import ChannelNoise
from calib.diagnosis.proof.unexplained import Unexplained
from calib.diagnosis.replays.gap import Gap, Remainder
from calib.diagnosis.search.search import SearchStep
from calib.diagnosis.undecided import Confusion, ShowingDrive
from calib.logs.log import Log


@dataclass(frozen=True)
class ParameterEstimate:
    """A parameter: value and 95 % interval, cut at what the parameter can be, in ``unit``."""

    value: float
    unit: str
    ci95: tuple[float, float]


@dataclass(frozen=True)
class Where:
    """Where an effect acts: the channel that shows it most, and the ranges of its action, SI."""

    channel: str
    axle: str
    pressure: tuple[float, float]
    speed: tuple[float, float]
    temperature: tuple[float, float] | None


@dataclass(frozen=True)
class Evidence:
    """Rise of the mean squared innovation without an effect, all else unchanged [1]."""

    innovation_gain: float
    innovation_gain_holdout: float


@dataclass(frozen=True)
class RunnerUp:
    """The best name without an effect, and the fall of the mean squared innovation with it [1]."""

    name: str
    innovation_gain: float


@dataclass(frozen=True)
class Named:
    """An effect that was accepted, with its evidence.

    ``indistinguishable_from`` names that fit the data as well; ``separate_by`` the feasible test
    that would distinguish them; ``defined_in`` its file, where the catalogue does not have it.
    """

    name: str
    parameters: dict[str, ParameterEstimate]
    where: Where
    evidence: Evidence
    runner_up: RunnerUp | None
    indistinguishable_from: tuple[str, ...]
    separate_by: str
    defined_in: DefinedIn | None = None


@dataclass(frozen=True)
class Diagnosis:
    """The whole answer.

    ``before`` and ``after`` are the hold-outs replayed open loop; ``unexplained`` is None where
    nothing significant is left, ``confusion`` where one explanation stands alone; ``sides`` by how
    much the right wheel of an axle rolled faster than the left one before that was taken out [1],
    by axle; ``own`` by log what it has of its own, by the names and in the units of
    `calib.diagnosis.explanation.own`; ``withdrawn`` names of effects that fit the calibration logs
    and not the hold-outs; ``drives`` of effects that these logs could not have shown; ``warnings``
    what speaks against the logs and is not explained.
    """

    verdict: str
    effects: tuple[Named, ...]
    unexplained: Unexplained | None
    base: dict[str, ParameterEstimate]
    gap: Gap
    model_before: Model
    model_after: Model
    before: tuple[Log, ...]
    after: tuple[Log, ...]
    measured: tuple[Log, ...]
    reduced_before: float
    reduced_after: float
    left: Remainder
    withdrawn: tuple[tuple[str, ...], ...]
    steps: tuple[SearchStep, ...]
    noise: ChannelNoise
    own: Mapping[str, Mapping[str, float]]
    drives: tuple[ShowingDrive, ...]
    confusion: Confusion | None
    sides: Mapping[str, float]
    warnings: tuple[PlausibilityWarning, ...]

    def __repr__(self) -> str:
        lines = [f"Diagnosis: {self.verdict}"]
        for effect in self.effects:
            for name, p in effect.parameters.items():
                low, high = p.ci95
                interval = f"{p.value:.4g}{behind(p.unit)} (95 % {low:.4g} to {high:.4g})"
                lines.append(f"  {effect.name}: {name} = {interval}")
        if self.effects and self.unexplained is not None:
            lines.append(f"  and something else: {self.left.size:.1f} times the noise is left")
        lines.append(f"  gap on the hold-outs: {100.0 * self.gap.closed:.0f} % closed")
        return "\n".join(lines)
