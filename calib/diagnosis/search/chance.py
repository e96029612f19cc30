"""What an effect that is not there would gain by chance, on these very logs.

    innovations without effects --> blocks, each kept or turned over --> best effect's gain --> 99 %

A wild block bootstrap: every block of the innovations gets a random sign. That destroys a common
course and keeps what noise has: how many samples, how loud in which run and channel, how correlated
within a block. So the share of false alarms is the same for three logs and forty, at any rate.
Gains are those of one linear step beside the base parameters, as in
`calib.diagnosis.search.search`.

It knows chance only. Where the form of a tyre or of a named effect differs from the car's, a wrong
effect gains in proportion to what it imitates, on all logs alike: that is for the hold-outs.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.explanation.candidate import Candidate, free
from calib.diagnosis.explanation.problem import Problem
from calib.diagnosis.gates import GATES
from calib.diagnosis.search.changes import EffectChange, changes_by, further_changes, tried_at

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@dataclass(frozen=True)
class _SignedBlocks:
    """Where the blocks (b,) of the innovations start, and at which block each run starts (r,)."""

    start: Index
    run: Index

    def sums(self, x: Array) -> Array:
        """Sums of ``x`` (n,) over the blocks (b,)."""
        return np.asarray(np.add.reduceat(x, self.start))

    def by_run(self, x: Array) -> Array:
        """Sums of blocks (..., b) over the runs (..., r)."""
        return np.asarray(np.add.reduceat(x, self.run, axis=-1))


def chance_of(at: Candidate, best: Candidate) -> Mapping[str, float]:
    """Gains in chi-square, by effect, that chance exceeds in 1 % of cars that have no effect.

    The share holds for all effects together; each has as large a part of it as any other. The
    noise is what the ``best`` explanation leaves, so that a hidden effect does not count as noise.
    """
    draws = _Draws.of(at, best)
    by_name = {name: draws.gains(changes) for name, changes in further_changes(at).items()}
    usual = {name: max(float(np.quantile(gains, 0.9)), 1e-9) for name, gains in by_name.items()}
    largest = np.max([gains / usual[name] for name, gains in by_name.items()], axis=0)
    factor = float(np.quantile(largest, 1.0 - GATES.false_alarms))
    return {name: factor * value for name, value in usual.items()}


@dataclass(frozen=True)
class _Draws:
    """Replicas of the innovations of a candidate, as ``signs`` (replicas, b) of their blocks.

    ``rest`` (n,) innovations of the best explanation, without what base and effects of ``at`` can
    do; ``turned`` is ``at`` with every wheel a quarter further.
    """

    at: Candidate
    turned: Candidate
    blocks: _SignedBlocks
    rest: Array
    signs: Array

    @classmethod
    def of(cls, at: Candidate, best: Candidate) -> "_Draws":
        """The same replicas for the same problem."""
        blocks = _blocks(at.whitened)
        rest = free(at.problem.flat(best.base, best.effects), at.directions)
        rng = np.random.default_rng(0)
        signs = rng.choice(np.array([-1.0, 1.0]), (GATES.chance_replicas, blocks.start.size))
        return cls(at, replace(at, problem=_quarter_turned(at.problem)), blocks, rest, signs)

    def gains(self, changes: Sequence[EffectChange]) -> Array:
        """Gain in chi-square of an effect in every replica (replicas,), the best of its forms."""
        largest = np.zeros(GATES.chance_replicas)
        turned = self._turned(changes[-1])
        for change, other in zip(changes, turned or changes, strict=True):
            length = float(change.own @ change.own)
            if length < GATES.chance_least:
                continue
            drawn = self.signs * self.blocks.sums(change.own * self.rest)
            if not turned:
                gains = np.sum(drawn, axis=1) ** 2
            else:  # the innovations of every run set its phase
                beside = self.signs * self.blocks.sums(other.own * self.rest)
                by_run = np.hypot(self.blocks.by_run(drawn), self.blocks.by_run(beside))
                gains = np.sum(by_run, axis=1) ** 2
            largest = np.maximum(largest, gains / length)
        return largest

    def _turned(self, change: EffectChange) -> tuple[EffectChange, ...]:
        """The changes by the effect with turned wheels; none where it goes with no angle."""
        first = replace(self.at.problem, runs=self.at.problem.runs[:1])
        effects = self.at.effects.with_(tried_at(first, change.name, change.trial))
        one, other = (p.flat(self.at.base, effects) for p in (first, _quarter_turned(first)))
        if np.allclose(one, other, atol=1e-9):
            return ()
        return changes_by(self.turned, change.name, self.at.directions)


def _blocks(whitened: list[list[Array]]) -> _SignedBlocks:
    start: list[int] = []
    run: list[int] = []
    at = 0
    for channels in whitened:
        run.append(len(start))
        for channel in channels:
            start += list(range(at, at + channel.size, GATES.chance_block))
            at += channel.size
    return _SignedBlocks(np.array(start), np.array(run))


def _quarter_turned(problem: Problem) -> Problem:
    quarter = 0.5 * np.pi
    runs = tuple(
        replace(run, angle_f=run.angle_f + quarter, angle_r=run.angle_r + quarter)
        for run in problem.runs
    )
    return replace(problem, runs=runs)
