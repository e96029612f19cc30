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
  ramp, coast or vehicle file; `validate` those with a table; `station` all. "Nothing new" counts
  words that came without the mistake, too, as silence.
* named: a refusal or the first two causes of a warning of any command hold the kind's words. What
  to do about a check of the station is no such cause: it lists all parts that there are.
"""

import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.studies.made_mistakes import KINDS
from tests.studies.scored_mistakes import COMMANDS, Row, Said, tried
from tests.studies.study import arguments, carried_out, share


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
        *((f"silent in {c}", [not r.said[c].anything for r in material if r.met(c)])
          for c in COMMANDS),
        ("silent in all three", [not r.caught for r in material]),
        *((f"nothing new in {c}", [not r.news(c) for r in material if r.met(c)])
          for c in COMMANDS),
        ("named", [r.named for r in material]),
        ("named, of those that were caught", [r.named for r in material if r.caught]),
    ):  # fmt: skip
        print(f"  {text:34} {share(hits)}")
    print("\ngood lines")
    middle, high = (100 * np.nanpercentile([row.off for row in rows], q, axis=0) for q in (50, 95))
    print(f"  largest error of the pads, front / rear: median {middle[0]:.1f} / {middle[1]:.1f} %, "
          f"95 % below {high[0]:.1f} / {high[1]:.1f} %")  # fmt: skip
    for command in COMMANDS:
        said = [row.clean[command] for row in rows if command in row.clean]
        print(f"  {command:9} warned {share([s.code == 0 and s.anything for s in said])}, "
              f"failed or refused {share([s.code != 0 for s in said])}")  # fmt: skip
        print_codes(said)
    for row in rows:
        for said in (*row.clean.values(), *row.said.values()):
            if said.crash:
                print(f"\nline {row.number}, {row.kind} {row.size}, crashed:\n{said.crash}")


def print_line(name: str, rows: list[Row]) -> None:
    """One kind."""
    material = [row for row in rows if row.material]
    cells = [str(len(rows)), str(sum(row.moved for row in rows)), str(len(material))]
    for command in COMMANDS:
        met = [row for row in material if row.met(command)]
        cells.append(of(met, lambda row, c=command: not row.said[c].anything))
    cells += [of(material, lambda row: not row.caught), of(material, lambda row: row.named)]
    print(f"{name:27}" + "".join(f"{cell:>10}" for cell in cells))


def of(rows: list[Row], hit: Callable[[Row], bool]) -> str:
    """How many of how many."""
    return f"{sum(map(hit, rows))}/{len(rows)}" if rows else "-"


def print_codes(said: list[Said]) -> None:
    """How many of the lines had each code; how often each refusal came."""
    counted = Counter(code for one in said for code in set(one.codes))
    counted.update(one.refusal.split(": ", 1)[-1][:90] for one in said if one.refusal)
    for code, n in counted.most_common():
        print(f"    {n:4} {code}")


def print_rows(rows: list[Row]) -> None:
    """Every line in one line, what it was told below it."""
    for row in rows:
        word = "material" if row.material else "harmless"
        print(f"{row.number:4} {row.kind} {row.size}: pads {100 * row.pads:.1f} %, "
              f"D {row.curve:.3f}, {word}, {'named' if row.named else 'not named'}")  # fmt: skip
        for command, said in row.said.items():
            told = said.refusal or ", ".join(dict.fromkeys(said.codes)) or "nothing"
            print(f"       {command:9} {said.code} {told[:200]}")


def main() -> None:
    """Run the study."""
    asked = arguments(__doc__, "rows", lines=2 * len(KINDS), seed=1, jobs=1, kind=list(KINDS))
    kinds = asked.kind
    jobs = [(asked.seed, i, kinds[i % len(kinds)]) for i in range(asked.lines)]
    rows = list(carried_out(tried, jobs, asked.jobs))
    if asked.rows:
        print_rows(rows)
    report(rows)


if __name__ == "__main__":
    main()
