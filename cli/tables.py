"""`brake-cal tables`: look at the tables of a store, and decide whether they may be used."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from cli import options
from cli.command import DAMAGED, Answer, command
from cli.console import say, usage_error
from cli.exchange import compare, export, merge
from cli.groups import add, group
from cli.options import argument, option
from cli.sign import sign


@command("brake-cal tables list", "brake-cal tables list --state released --serial 0815")
def list_(
    *,
    state: str | None = option(
        "draft, released, rejected or withdrawn.", "STATE", names="calib.store.state:STATES"
    ),
    serial: str | None = option("List only this serial number.", "S"),
    vin: str | None = option("List only this vehicle identification.", "VIN"),
    store: options.Tables,
) -> Answer:
    """List every version of every table, or those of a car."""
    from calib.show.store import listed
    from calib.store.figures import row_of

    rows = [row_of(entry) for entry in store.entries(state)]
    for key, wanted in (("serial", serial), ("vin", vin)):
        if wanted is not None:
            rows = [row for row in rows if row[key].lower() == wanted.lower()]
    missing = "no such table" if store.snapshot().names else "no table"
    result = listed(rows) if rows else f"{store.folder} holds {missing}"
    return Answer({"store": store.folder, "tables": rows}, result)


@command("brake-cal tables show sedan-2up")
def show(table: options.Table, *, store: options.Tables) -> Answer:
    """Say whether a table may be used, and how good it is."""
    from calib.show.store import shown_document

    stored = store.load(table)
    return Answer(shown_document(stored), stored)


@command("brake-cal tables log sedan-2up")
def log(
    table: str = argument("Name, or name@version.", "TABLE"), *, store: options.Tables
) -> Answer:
    """Print what happened to a table: when, by whom and why."""
    from calib.show.store import history

    snapshot = store.snapshot()
    journal = snapshot.journal
    if "@" in table:
        name, version = snapshot.numbered(table)
        entries = journal.versions(name).get(version, [])
    else:
        name = snapshot.require_table(table)
        entries = [entry for entry in journal.entries if entry.table == name]
    events = [entry.document for entry in entries]
    document = {"store": store.folder, "head": journal.head, "entries": events}
    return Answer(document, history(events))


@command("brake-cal tables diff sedan-2up@1 sedan-2up")
def diff(
    a: str = argument(options.TABLE, "A"),
    b: str = argument(options.TABLE, "B"),
    *,
    store: options.Tables,
) -> Answer:
    """Say whether and where two tables differ.

    They are equal, equal within their 95 % bands, or different.
    """
    from calib.show.store import compared, compared_document
    from calib.table.compare import diff as differ

    first, second = store.load(a), store.load(b)
    comparison = differ(first.table, second.table), first, second
    return Answer(compared_document(*comparison), compared(*comparison))


@command("brake-cal tables verify", "brake-cal tables verify sedan-2up")
def verify(
    name: str | None = argument("Name of a table, else all.", "NAME"),
    *,
    key: options.PublicKey,
    store: options.Tables,
) -> Answer:
    """Say which versions of a store are damaged.

    Each version is compared with its digests, its invariants and the journal. With --key every
    released version must also have a signature of this key, for its present state, and the journal
    must hold every state that was signed, or that you have seen. Exit code 4 if a version is
    damaged.
    """
    from calib.show.store import verified
    from calib.store.folders import unplaced
    from calib.store.minisign import read_public_key
    from calib.store.signature import verify_signed

    keys = ["id", "sound", "violations"]
    if key:
        verdicts, note = verify_signed(store, read_public_key(key), name)
        keys.append("signed")
        if note:
            say(note)
    else:
        verdicts = store.verify(name)
    rows = [{field: getattr(verdict, field) for field in keys} for verdict in verdicts]
    is_sound = all(verdict.sound for verdict in verdicts)
    document = {"store": store.folder, "sound": is_sound, "versions": rows}
    document["unfinished"] = unplaced(store.folder)
    result = verified(verdicts, bool(key)) if rows else f"{store.folder} holds no table"
    return Answer(document, result, 0 if is_sound else DAMAGED)


_Proof = Annotated[
    Path | None, option("summary.json of a validation, or station.json.", "FILE", "--evidence")
]


@dataclass(frozen=True)
class _Decision:
    """Options of a decision on the state of a version."""

    reason: options.Reason
    by: options.By
    store: options.Tables


@command(
    'brake-cal tables release sedan-2up@2 --reason "four stops agree" '
    "--evidence results/sedan/summary.json"
)
def release(table: options.Version, *, evidence: _Proof, decision: _Decision) -> Answer:
    """Release a version, so that it may be exported.

    The validation or station run of --evidence must be of this version and must not have failed. A
    rejected version needs such evidence; a withdrawn version is never released again.
    """
    return _judged(table, "released", decision, evidence)


@command('brake-cal tables reject sedan-2up@1 --reason "one ramp only"')
def reject(table: options.Version, *, evidence: _Proof, decision: _Decision) -> Answer:
    """Reject a version, so that it is no longer used.

    A name without a number never means this version, and it is not exported.
    """
    return _judged(table, "rejected", decision, evidence)


@command('brake-cal tables withdraw sedan-2up@1 --reason "brake pads recalled"')
def withdraw(table: options.Version, *, decision: _Decision) -> Answer:
    """Withdraw a version for good.

    A name without a number never means this version, and it is not exported. Withdraw also a
    version that is missing and cannot be restored: `tables verify` then no longer counts it.
    """
    from calib.store.state import StateDecision

    withdrawn = StateDecision("withdrawn", decision.reason, by=decision.by or "")
    if decision.store.withdraw_missing(table, withdrawn):
        document = {"table": table, "state": "withdrawn", "missing": True}
        return Answer(document, f"{table} is withdrawn; its folder is missing")
    return _judged(table, "withdrawn", decision, None)


def _judged(table: str, state: str, decision: _Decision, evidence: Path | None) -> Answer:
    from calib.base.errors import StoreError
    from calib.store.evidence import CONSISTENT, read_evidence
    from calib.store.state import StateDecision

    stored = decision.store.load(table)
    proof, verdict = read_evidence(evidence, stored) if evidence else (None, "")
    if state == "released" and verdict == "failed":
        flaw = f"{evidence} says that {table} failed, which releases nothing"
        raise usage_error(flaw, "--evidence")
    unknown_to_ecu = stored.table.not_sensed.get("wheel_pressures")
    if state == "released" and unknown_to_ecu:
        flaw = f"is for no ECU: it would have to know {unknown_to_ecu}"
        do = "declare rear_proportioning in the vehicle file, or fit the ramp without them"
        raise StoreError(flaw, where=table, expected="a table of pressures that an ECU has", do=do)
    proofs = (proof,) if proof else ()
    judgement = StateDecision(state, decision.reason, verdict, proofs, decision.by or "")
    old, new = stored.state, decision.store.judge(table, judgement).state
    document = {"table": stored.id, "digest": stored.digest, "before": old.word}
    document |= {"state": new.word, "why": new.description}
    change = "nothing to change" if old == new else f"it was {old.word}"
    text = f"{stored.id} is {new.description}; {change}"
    if verdict in (CONSISTENT, "warning"):
        text = f"{text}; the evidence: {verdict}"
    return Answer(document, text)


tables = group(
    "tables", "Look at tables, release or reject them, hand them out.", "brake-cal tables list"
)
add(tables, "Look", list_, show, diff, log, verify)
add(tables, "Decide", release, reject, withdraw, sign)
add(tables, "Hand out", export, compare, merge)
