"""How many mistakes at a station are seen and named, and how often a good line is stopped.

    python tests/studies/mistakes.py --lines 100 --seed 1 --jobs 2
    python tests/studies/mistakes.py --lines 20 --seed 1 --kind "a_x gain, all"

Line i is a random car with mistake i of `made_mistakes`, round and round, and the same car without
it. Every one is written to files and goes through `fit`, `validate` and `station`.

* moved: the mistake puts the pads of a run (of the fit, or the mean of a stop) more than 5 % off
  the truth of the plant and more than 5 % off what the same line without it says, or moves D(eta)
  by more than 0.02.
* material: moved, or refused by a command that took the line without it, or a mistake that is wrong
  whatever it moves (a channel that is a copy, the ramp as hold-out).
* silent: exit code 0 and no warning, of the material ones that the command met: `fit` those in
  ramp, coast or vehicle file; `validate` those with a table; `station` all.
* silent, but unseen and named: the command printed every wrong entry in its list of unseen errors,
  with a size that is not below that of the mistake.
* silent, but within the intervals: the 95 % intervals of the pads hold the truth in every run.
* named: a refusal or the first two causes of a warning of any command hold the kind's words. What
  to do about a check of the station is no such cause: it lists all parts that there are.
"""

import json
import math
import re
import sys
import tempfile
import traceback
import warnings
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from typer.testing import CliRunner

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.base.errors import BrakeCalError
from calib.base.intervals import Z95
from calib.car.vehicle import Vehicle
from calib.logs.log import Log
from calib.logs.write import write_parquet
from calib.store.store import Store
from cli.main import app
from tests.studies.made_lines import RUNS, STOPS, line, recorded
from tests.studies.made_mistakes import KINDS
from tests.studies.study import arguments, carried_out, share
from tests.support.vehicle_files import write_vehicle

Pads = tuple[float, float]

COMMANDS = ("fit", "validate", "station")


@dataclass(frozen=True)
class Outcome:
    """What one command said: exit ``code``, ``refusal`` where it ended with an error.

    ``codes`` of its warnings, and of the station's checks that failed or warn; ``causes`` the first
    two of each warning; ``crash`` a traceback, where the program broke; ``unseen`` sizes [1] of
    the errors that it lists as unseen.
    """

    code: int
    refusal: str = ""
    codes: tuple[str, ...] = ()
    causes: tuple[str, ...] = ()
    crash: str = ""
    unseen: dict[str, float] = field(default_factory=dict)

    @property
    def anything(self) -> bool:
        """Whether a person at the station had a reason to look."""
        return self.code != 0 or bool(self.codes)


@dataclass(frozen=True)
class Answer:
    """What the program made of a line: by command what it said; pads [1] by run; D over eta.

    ``halves`` of the 95 % intervals of these pads, relative [1].
    """

    outcomes: dict[str, Outcome]
    pads: dict[str, Pads] = field(default_factory=dict)
    halves: dict[str, Pads] = field(default_factory=dict)
    difference: tuple[np.ndarray, np.ndarray] | None = None


def answer(vehicle: Vehicle, logs: dict[str, Log], folder: Path) -> Answer:
    """Write the line into ``folder``, an empty one, without its truth, and run the commands."""
    write_vehicle(vehicle, folder / "vehicle.toml")
    for name, log in logs.items():
        write_parquet(replace(log, truth={}), folder / f"{name}.parquet")
    ramp, coast, *stops = (folder / f"{name}.parquet" for name in ("ramp", "coast", *STOPS))
    car, store = ("--vehicle", folder / "vehicle.toml"), ("--store", folder / "tables")
    outcomes, pads, halves, difference = {}, {}, {}, None
    outcomes["fit"], document = run("fit", ramp, coast, *car, *store)
    if document:
        fitted = [document["calibration"][f"pad_friction_{axle}"] for axle in "fr"]
        pads["ramp"] = tuple(pad["value"] for pad in fitted)
        halves["ramp"] = tuple(Z95 * pad["sigma"] / pad["value"] for pad in fitted)
        curve = Store(folder / "tables").load(vehicle.name).table.difference
        difference = curve.eta, curve.D
        outcomes["validate"], document = run("validate", vehicle.name, *stops, *store)
        for name, log in zip(STOPS, document.get("logs", ()), strict=False):
            of_stop = tuple(log["figures"][f"pad_friction_{a}"] for a in "fr")
            if None not in of_stop:
                pads[name] = of_stop
                halves[name] = tuple(log["figures"][f"interval_{axle}"] for axle in "fr")
    elsewhere = ("--store", folder / "of_station", "--out", folder / "out")
    outcomes["station"], _ = run("station", ramp, *stops, "--coast", coast, *car, *elsewhere)
    return Answer(outcomes, pads, halves, difference)


def run(*words: object) -> tuple[Outcome, dict[str, Any]]:
    """Run one command with ``--json``; what it said, and its document, {} without one."""
    ran = CliRunner().invoke(app, [*map(str, words), "--json"])
    error = ran.exception
    if isinstance(error, BrakeCalError):
        return Outcome(error.exit_code, refusal=str(error)), {}
    if error is not None and not isinstance(error, SystemExit):
        return Outcome(1, crash="".join(traceback.format_exception(error)[-3:])), {}
    try:
        document = json.loads(ran.stdout)
    except json.JSONDecodeError:
        return Outcome(ran.exit_code, refusal=ran.stderr), {}
    warnings = document.get("warnings") or []
    checks = [
        f"{check['figure']} {check['verdict']}"
        for check in document.get("checks", ())
        if check["verdict"] in ("warning", "failed")
    ]
    failed = [
        f"{limit['figure']} failed"
        for log in document.get("logs", ())
        for limit in log.get("limits", ())
        if limit["passed"] is False
    ]
    codes = [warning["code"] for warning in warnings]
    causes = [cause for warning in warnings for cause in warning["causes"][:2]]
    listed = (document.get("validation") or document).get("unseen", ())
    unseen = {one["entry"]: one["up_to"] for one in listed}
    all_codes = (*codes, *checks, *failed)
    return Outcome(ran.exit_code, "", all_codes, tuple(causes), unseen=unseen), document


Errors = dict[tuple[str, str], float]
"""ln of pads over truth by run and axle."""

PADS, CURVE = 0.05, 0.02
"""Errors of the pads [1] and of D [1] from which a mistake is material."""


@dataclass(frozen=True)
class Row:
    """One line: the mistake and its size, how far it moved pads and D, what was said.

    ``off`` largest error of the pads without the mistake, front and rear [1]; ``entries`` that are
    wrong, with their errors [1]; ``holds``: every 95 % interval of the pads holds the truth.
    """

    number: int
    kind: str
    size: str
    off: tuple[float, float]
    pads: float
    curve: float
    clean: dict[str, Outcome]
    outcomes: dict[str, Outcome]
    entries: dict[str, float]
    holds: bool

    @property
    def moved(self) -> bool:
        """Whether the answer is wrong because of the mistake."""
        return self.pads > PADS or self.curve > CURVE

    @property
    def material(self) -> bool:
        """Whether it should have been seen."""
        ended, ended_clean = (
            any(one.code > 1 or one.crash for one in outcomes.values())
            for outcomes in (self.outcomes, self.clean)
        )
        return self.moved or (ended and not ended_clean) or KINDS[self.kind].counts

    @property
    def caught(self) -> bool:
        """Whether any command said a word."""
        return any(outcome.anything for outcome in self.outcomes.values())

    @property
    def named(self) -> bool:
        """Whether any command named the cause."""
        words = re.compile(KINDS[self.kind].named, re.IGNORECASE)
        texts = [
            text
            for outcome in self.outcomes.values()
            for text in (outcome.refusal, *outcome.causes)
        ]
        return any(map(words.search, texts))

    def unseen(self, command: str) -> bool:
        """Whether the command lists each wrong entry as unseen, with at least its error."""
        listed = self.outcomes[command].unseen
        sizes = (listed.get(entry, 0.0) - abs(error) for entry, error in self.entries.items())
        return bool(self.entries) and min(sizes) >= 0.0

    def met(self, command: str) -> bool:
        """Whether the command could have seen it."""
        if command == "fit":
            return "ramp" in KINDS[self.kind].runs
        return command in self.outcomes


def tried(job: tuple[int, int, str]) -> Row:
    """Draw the line of a job (seed, number, kind), run it without the mistake and with it."""
    seed, number, name = job
    rng = np.random.default_rng([seed, number])
    good = line(rng, 1_000_000 * seed + 100 * number)
    if KINDS[name].needs_v:
        good = replace(good, sensors=replace(good.sensors, with_v=True))
    runs, mistake = KINDS[name].runs, KINDS[name].make(rng)
    bad = mistake.line(good, runs)
    logs = {run: recorded(run, good.runs[run], good.sensors) for run in RUNS}
    others = {
        run: logs[run]
        if bad.runs[run] is good.runs[run]
        else recorded(run, bad.runs[run], bad.sensors)
        for run in RUNS
    }
    others = mistake.recorded(others, runs)
    clean, spoiled = answered(good.file, logs), answered(bad.file, others)
    clean_errors = errors(clean, logs)
    off = [
        math.expm1(
            max((abs(e) for (_, side), e in clean_errors.items() if side == axle), default=math.nan)
        )
        for axle in "fr"
    ]
    after = errors(spoiled, others)
    added = [
        min(abs(e), abs(e - clean_errors[key])) for key, e in after.items() if key in clean_errors
    ]
    pads = math.expm1(max(added, default=0.0))
    return Row(
        number,
        name,
        mistake.size,
        tuple(off),
        pads,
        moved_curve(clean, spoiled),
        clean.outcomes,
        spoiled.outcomes,
        mistake.entries,
        all(
            abs(math.expm1(error)) <= spoiled.halves[run]["fr".index(axle)]
            for (run, axle), error in after.items()
        ),
    )


def answered(vehicle: Vehicle, logs: dict[str, Log]) -> Answer:
    """The answer on files in a folder that is gone afterwards."""
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return answer(vehicle, logs, Path(folder))


def errors(answers: Answer, logs: dict[str, Log]) -> Errors:
    """ln of pads over truth by run and axle."""
    return {
        (run, axle): math.log(mu / float(np.mean(logs[run].truth[f"true_mu_pad_{axle}"])))
        for run, pair in answers.pads.items()
        for axle, mu in zip("fr", pair, strict=True)
    }


def moved_curve(clean: Answer, spoiled: Answer) -> float:
    """How far D moved at most, where both tables know it [1]."""
    if clean.difference is None or spoiled.difference is None:
        return 0.0
    (eta, D), (other, moved) = clean.difference, spoiled.difference
    common = eta[(eta >= other[0]) & (eta <= other[-1])]
    apart = np.interp(common, eta, D) - np.interp(common, other, moved)
    return float(np.max(np.abs(apart), initial=0.0))


def report(rows: list[Row]) -> None:
    """Print the tables."""
    heads = ("lines", "moved", "material", "fit", "validate", "station", "all", "named")
    print(f"{'':27}" + " " * 18 + "silent in")
    print(f"{'kind':27}" + "".join(f"{head:>10}" for head in heads))
    for name in KINDS:
        part = [row for row in rows if row.kind == name]
        if part:
            print_line(name, part)
    print_line("all", rows)
    material = [row for row in rows if row.material]
    for text, hits in (
        *((f"silent in {c}", [not r.outcomes[c].anything for r in material if r.met(c)])
          for c in COMMANDS),
        *((f"silent in {c}, but unseen and named",
           [r.unseen(c) for r in material if r.met(c) and not r.outcomes[c].anything])
          for c in COMMANDS),
        *((f"silent in {c}, but within the intervals",
           [r.holds for r in material if r.met(c) and not r.outcomes[c].anything])
          for c in COMMANDS),
        ("silent in all three", [not r.caught for r in material]),
        ("named", [r.named for r in material]),
        ("named, of those that were caught", [r.named for r in material if r.caught]),
    ):  # fmt: skip
        print(f"  {text:44} {share(hits)}")
    for row in material:
        quiet = [c for c in COMMANDS if row.met(c) and not row.outcomes[c].anything]
        if quiet:
            print(
                f"  line {row.number}, {row.kind} {row.size}: silent in {', '.join(quiet)}; "
                f"pads {100 * row.pads:.1f} %, D {row.curve:.3f}; intervals hold: {row.holds}"
            )
    print("\ngood lines")
    middle, high = (100 * np.nanpercentile([row.off for row in rows], q, axis=0) for q in (50, 95))
    print(f"  largest error of the pads, front / rear: median {middle[0]:.1f} / {middle[1]:.1f} %, "
          f"95 % below {high[0]:.1f} / {high[1]:.1f} %")  # fmt: skip
    for command in COMMANDS:
        outcomes = [row.clean[command] for row in rows if command in row.clean]
        print(f"  {command:9} warned {share([s.code == 0 and s.anything for s in outcomes])}, "
              f"failed or refused {share([s.code != 0 for s in outcomes])}")  # fmt: skip
        counts = Counter(code for one in outcomes for code in {*one.codes, one.refusal[:90]} - {""})
        for code, n in counts.most_common():
            print(f"    {n:4} {code}")
    for row in rows:
        for outcome in (*row.clean.values(), *row.outcomes.values()):
            if outcome.crash:
                print(f"\nline {row.number}, {row.kind} {row.size}, crashed:\n{outcome.crash}")


def print_line(name: str, rows: list[Row]) -> None:
    """One kind."""
    material = [row for row in rows if row.material]
    cells = [str(len(rows)), str(sum(row.moved for row in rows)), str(len(material))]
    for command in COMMANDS:
        met = [row for row in material if row.met(command)]
        cells.append(ratio(met, lambda row, c=command: not row.outcomes[c].anything))
    cells += [ratio(material, lambda row: not row.caught), ratio(material, lambda row: row.named)]
    print(f"{name:27}" + "".join(f"{cell:>10}" for cell in cells))


def ratio(rows: list[Row], hit: Callable[[Row], bool]) -> str:
    """How many of how many."""
    return f"{sum(map(hit, rows))}/{len(rows)}" if rows else "-"


def main() -> None:
    """Run the study."""
    options = arguments(__doc__, lines=2 * len(KINDS), seed=1, jobs=1, kind=list(KINDS))
    kinds = options.kind
    jobs = [(options.seed, i, kinds[i % len(kinds)]) for i in range(options.lines)]
    rows = list(carried_out(tried, jobs, options.jobs))
    report(rows)


if __name__ == "__main__":
    main()
