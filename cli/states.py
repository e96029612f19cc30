"""`brake-cal tables release | reject | withdraw | log`: states of versions and their history."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import calib
from cli.completion import table_names
from cli.console import emit, emit_json
from cli.grid import grid
from cli.options import By, Json, Reason, Store, Version, example, refuse_bare
from cli.project import STORE

if TYPE_CHECKING:
    from calib.store.journal import Entry
    from calib.store.version import Stored

RELEASE = example(
    'brake-cal tables release sedan-2up@2 --reason "four stops agree" '
    "--evidence results/sedan/summary.json"
)
REJECT = example('brake-cal tables reject sedan-2up@1 --reason "one ramp only"')
WITHDRAW = example('brake-cal tables withdraw sedan-2up@1 --reason "brake pads recalled"')
LOG = example("brake-cal tables log sedan-2up")

Proof = Annotated[
    Path | None,
    typer.Option(
        "--evidence", metavar="FILE", help="summary.json of a validation, or station.json."
    ),
]


def release(
    table: Version,
    *,
    reason: Reason,
    evidence: Proof = None,
    by: By = None,
    store: Store = STORE,
    json: Json = False,
) -> None:
    """Release a version, so that it may be exported.

    Others are measured by it, too. With --evidence the file must be of this version and must not
    have failed. A rejected version needs it; a withdrawn one is never released again.
    """
    _judge(table, "released", reason, evidence, by, store, json)


def reject(
    table: Version,
    *,
    reason: Reason,
    evidence: Proof = None,
    by: By = None,
    store: Store = STORE,
    json: Json = False,
) -> None:
    """Reject a version, so that it is no longer used.

    A bare name never means it, and it is not exported.
    """
    _judge(table, "rejected", reason, evidence, by, store, json)


def withdraw(
    table: Version,
    *,
    reason: Reason,
    by: By = None,
    store: Store = STORE,
    json: Json = False,
) -> None:
    """Withdraw a version for good.

    A bare name never means it, and it is not exported. A version that is missing and cannot be
    restored is withdrawn, too: `tables verify` then no longer counts it.
    """
    from calib.store.state import StateDecision

    _check(table, reason)
    decision = StateDecision("withdrawn", reason, by=by or "")
    if not calib.Store(store).withdraw_missing(table, decision):
        _judge(table, "withdrawn", reason, None, by, store, json)
    elif json:
        emit_json({"schema": 1, "table": table, "state": "withdrawn", "missing": True})
    else:
        emit(f"{table} is withdrawn; its folder is missing")


def log(
    table: Annotated[
        str,
        typer.Argument(metavar="TABLE", help="name, or name@version", autocompletion=table_names),
    ],
    store: Store = STORE,
    json: Json = False,
) -> None:
    """Print what happened to a table: when, by whom and why."""
    name, at, version = table.partition("@")
    journal = calib.Store(store).journal(name)
    known = journal.of(name)
    if at and version not in {str(number) for number in known}:
        numbers = ", ".join(map(str, known))
        raise typer.BadParameter(
            f"no version {version!r} of {name!r}; there is {numbers}", param_hint="TABLE"
        )
    entries = [e for e in journal.entries if e.table == name and version in ("", str(e.version))]
    if json:
        emit_json({"schema": 1, "store": store, "head": journal.head, "entries": entries})
        return
    rows = grid("when", "table", "state", "by", "why", "evidence", fold=True)
    for column in rows.columns[:3]:
        column.no_wrap = True
    for entry in entries:
        rows.add_row(entry.at, entry.id, _event(entry), entry.by, entry.reason, _evidence(entry))
    emit(rows)


def _judge(
    table: str,
    word: str,
    reason: str,
    evidence: Path | None,
    by: str | None,
    store: Path,
    json: bool,
) -> None:
    from calib.store.evidence import read_evidence
    from calib.store.state import StateDecision

    _check(table, reason)
    before = calib.Store(store).load(table)
    proofs, verdict = [], ""
    if evidence is not None:
        proof, verdict = read_evidence(evidence, before)
        proofs.append(proof)
        if word == "released" and verdict == "failed":
            raise typer.BadParameter(
                f"{evidence} says that {table} failed, which releases nothing",
                param_hint="--evidence",
            )
    decision = StateDecision(word, reason, verdict, tuple(proofs), by or "")
    after = calib.Store(store).judge(table, decision)
    _report(before, after, json)


def _check(table: str, reason: str) -> None:
    refuse_bare(table)
    if not reason.strip():
        raise typer.BadParameter("says nothing", param_hint="--reason")


def _report(before: "Stored", after: "Stored", json: bool) -> None:
    if json:
        states = {"before": before.state.word, "state": after.state.word}
        head = {"schema": 1, "table": after.id, "digest": after.digest}
        emit_json({**head, **states, "why": after.state.words})
    elif before.state == after.state:
        emit(f"{after.id} is {after.state.words}; nothing to change")
    else:
        emit(f"{after.id} is {after.state.words}; it was {before.state.word}")


def _event(entry: "Entry") -> str:
    return entry.state if entry.event in ("stored", "changed") else f"{entry.event}, {entry.state}"


def _evidence(entry: "Entry") -> str:
    files = [f"{one.name} {one.sha256[:12]}" for one in entry.evidence]
    return "\n".join([*files, f"key {entry.key}"] if entry.key else files)
