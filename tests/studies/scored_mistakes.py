"""One line with a mistake and without it: what the commands said, and how far the answer moved.

Material, silent and named are as in `mistakes`.
"""

import math
import re
import tempfile
import warnings
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from tests.studies.answers import Answer, Said, answer
from tests.studies.made_lines import RUNS, line, recorded
from tests.studies.made_mistakes import KINDS

Errors = dict[tuple[str, str], float]
"""ln of pads over truth by run and axle."""

PADS, CURVE = 0.05, 0.02
"""Errors of the pads [1] and of D [1] from which a mistake is material."""


@dataclass(frozen=True)
class Row:
    """One line: the mistake and its size, how far it moved pads and D, what was said.

    ``off`` largest error of the pads without the mistake, front and rear [1].
    """

    number: int
    kind: str
    size: str
    off: tuple[float, float]
    pads: float
    curve: float
    clean: dict[str, Said]
    said: dict[str, Said]

    @property
    def moved(self) -> bool:
        """Whether the answer is wrong because of the mistake."""
        return self.pads > PADS or self.curve > CURVE

    @property
    def refused(self) -> bool:
        """Whether a command ended with an error that the line without the mistake did not get."""
        return any(s.code > 1 or s.crash for s in self.said.values()) and not any(
            s.code > 1 or s.crash for s in self.clean.values()
        )

    @property
    def material(self) -> bool:
        """Whether it should have been seen."""
        return self.moved or self.refused or KINDS[self.kind].counts

    @property
    def caught(self) -> bool:
        """Whether any command said a word."""
        return any(said.anything for said in self.said.values())

    @property
    def named(self) -> bool:
        """Whether any command named the cause."""
        words = re.compile(KINDS[self.kind].named, re.IGNORECASE)
        return any(words.search(said.words) for said in self.said.values())

    def news(self, command: str) -> bool:
        """Whether the command said what it does not say without the mistake."""
        said, before = self.said[command], self.clean.get(command, Said(0))
        return said.code > before.code or bool(set(said.codes) - set(before.codes))

    def met(self, command: str) -> bool:
        """Whether the command could have seen it."""
        if command == "fit":
            return "ramp" in KINDS[self.kind].runs
        return command in self.said


def tried(job: tuple[int, int, str]) -> Row:
    """Draw the line of a job (seed, number, kind), run it without the mistake and with it."""
    seed, number, name = job
    rng = np.random.default_rng([seed, number])
    good = line(rng, 1_000_000 * seed + 100 * number)
    if KINDS[name].needs_v:
        good = replace(good, sensors=replace(good.sensors, with_v=True))
    mistake = KINDS[name].make(rng)
    bad = mistake.line(good)
    logs = {run: recorded(run, good.runs[run], good.sensors) for run in RUNS}
    others = {
        run: logs[run]
        if bad.runs[run] is good.runs[run]
        else recorded(run, bad.runs[run], bad.sensors)
        for run in RUNS
    }
    others = mistake.logs(others)
    clean, made = answered(good.file, logs), answered(bad.file, others)
    before = errors(clean, logs)
    pads, curve = moved_pads(before, errors(made, others)), moved_curve(clean, made)
    return Row(number, name, mistake.size, largest(before), pads, curve, clean.said, made.said)


def answered(vehicle: Vehicle, logs: dict[str, Log]) -> Answer:
    """The answer on files in a folder that is gone afterwards."""
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return answer(vehicle, logs, Path(folder))


def errors(of: Answer, logs: dict[str, Log]) -> Errors:
    """ln of pads over truth by run and axle."""
    return {
        (run, axle): math.log(mu / float(np.mean(logs[run].truth[f"true_mu_pad_{axle}"])))
        for run, pair in of.pads.items()
        for axle, mu in zip("fr", pair, strict=True)
    }


def largest(clean: Errors) -> tuple[float, float]:
    """The largest error over the runs, front and rear [1]; nan without any."""
    front, rear = (
        max((abs(e) for (_, side), e in clean.items() if side == axle), default=math.nan)
        for axle in "fr"
    )
    return math.expm1(front), math.expm1(rear)


def moved_pads(clean: Errors, made: Errors) -> float:
    """The largest error that the mistake brought [1]: of the truth and of the good answer."""
    both = [min(abs(e), abs(e - clean[key])) for key, e in made.items() if key in clean]
    return math.expm1(max(both, default=0.0))


def moved_curve(clean: Answer, made: Answer) -> float:
    """How far D moved at most, where both tables know it [1]."""
    if clean.difference is None or made.difference is None:
        return 0.0
    (eta, D), (other, moved) = clean.difference, made.difference
    common = eta[(eta >= other[0]) & (eta <= other[-1])]
    apart = np.interp(common, eta, D) - np.interp(common, other, moved)
    return float(np.max(np.abs(apart), initial=0.0))
