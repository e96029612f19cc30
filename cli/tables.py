"""`brake-cal tables`: look at the tables of a store, and decide on their states."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from cli import options
from cli.command import DAMAGED, Answer, add, command, group
from cli.console import misuse, say
from cli.exchange import compare, export, merge
from cli.options import argument, option
from cli.sign import sign


@command("brake-cal tables list", "brake-cal tables list --state released --serial 0815")
def list_(
    *,
    state: str | None = option(
        "draft, released, rejected or withdrawn.", "S", names="calib.store.state:STATES"
    ),
    serial: str | None = option("Serial number.", "S"),
    vin: str | None = option("Vehicle identification.", "V"),
    store: options.Tables,
) -> Answer:
    """List every version of every table, or those of a car."""
    from calib.show.store import listed
    from calib.store.figures import chosen, row_of

    rows = chosen(map(row_of, store.entries(state)), serial=serial, vin=vin)
    none = f"{store.folder} holds no {'such table' if store.snapshot().names else 'table'}"
    return Answer({"store": store.folder, "tables": rows}, listed(rows) if rows else none)


@command("brake-cal tables show sedan-2up")
def show(table: options.Table, *, store: options.Tables) -> Answer:
    """Say whether a table may be used, and how good it is."""
    from calib.show.store import shown_document

    stored = store.load(table)
    return Answer(shown_document(stored), stored)


@command("brake-cal tables log sedan-2up")
def log(
    table: str = argument("name, or name@version", "TABLE"), *, store: options.Tables
) -> Answer:
    """Print what happened to a table: when, by whom and why."""
    from calib.show.store import history

    name, separator, version = table.partition("@")
    now = store.snapshot()
    journal = now.journal
    versions = [str(number) for number in journal.versions(now.require_table(name))]
    if separator and version not in versions:
        raise misuse(f"no version {version!r} of {name!r}; there is {', '.join(versions)}", "TABLE")
    entries = [
        e.document for e in journal.entries if e.table == name and version in ("", str(e.version))
    ]
    document = {"store": store.folder, "head": journal.head, "entries": entries}
    return Answer(document, history(entries))


@command("brake-cal tables diff sedan-2up@1 sedan-2up")
def diff(
    a: str = argument("name, name@version or path", "A"),
    b: str = argument("name, name@version or path", "B"),
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
    name: str | None = argument("one table; if not given, all", "NAME"),
    *,
    key: options.PublicKey,
    store: options.Tables,
) -> Answer:
    """Say which versions of a store are damaged.

    Compares each with its digests, its invariants and the journal; exit code 4 if one is damaged.
    With --key also the signatures: every released version must have one of this key, for its
    present state, and the journal must hold what was signed and seen before.
    """
    from calib.show.store import verified
    from calib.store.folders import unplaced
    from calib.store.minisign import read_public_key
    from calib.store.signature import verify_signed

    if key:
        verdicts, note = verify_signed(store, read_public_key(key), name)
    else:
        verdicts, note = store.verify(name), ""
    keys = ("id", "sound", "violations", *(["signed"] if key else []))
    rows = [{name: getattr(verdict, name) for name in keys} for verdict in verdicts]
    sound = all(verdict.sound for verdict in verdicts)
    if note:
        say(note)
    unfinished = unplaced(store.folder)
    document = {"store": store.folder, "sound": sound, "versions": rows, "unfinished": unfinished}
    none = f"{store.folder} holds no table"
    return Answer(document, verified(verdicts, bool(key)) if rows else none, DAMAGED * (not sound))


_Proof = Annotated[
    Path | None, option("summary.json of a validation, or station.json.", "FILE", "--evidence")
]


@dataclass(frozen=True)
class _Decision:
    """Reason and author of a decision on a state."""

    reason: options.Reason
    by: options.By
    store: options.Tables


@command(
    'brake-cal tables release sedan-2up@2 --reason "four stops agree" '
    "--evidence results/sedan/summary.json"
)
def release(table: options.Version, *, evidence: _Proof, decision: _Decision) -> Answer:
    """Release a version, so that it may be exported.

    Others are measured by it, too. With --evidence the file must be of this version and must not
    have failed. A rejected version needs it; a withdrawn one is never released again.
    """
    return _judged(table, "released", decision, evidence)


@command('brake-cal tables reject sedan-2up@1 --reason "one ramp only"')
def reject(table: options.Version, *, evidence: _Proof, decision: _Decision) -> Answer:
    """Reject a version, so that it is no longer used.

    A bare name never means it, and it is not exported.
    """
    return _judged(table, "rejected", decision, evidence)


@command('brake-cal tables withdraw sedan-2up@1 --reason "brake pads recalled"')
def withdraw(table: options.Version, *, decision: _Decision) -> Answer:
    """Withdraw a version for good.

    A bare name never means it, and it is not exported. A version that is missing and cannot be
    restored is withdrawn, too: `tables verify` then no longer counts it.
    """
    from calib.store.state import StateDecision

    withdrawn = StateDecision("withdrawn", decision.reason, by=decision.by or "")
    if decision.store.withdraw_missing(table, withdrawn):
        document = {"table": table, "state": "withdrawn", "missing": True}
        return Answer(document, f"{table} is withdrawn; its folder is missing")
    return _judged(table, "withdrawn", decision, None)


def _judged(table: str, word: str, decision: _Decision, evidence: Path | None) -> Answer:
    from calib.base.errors import StoreError
    from calib.store.evidence import CONSISTENT, read_evidence
    from calib.store.state import StateDecision

    stored = decision.store.load(table)
    proof, verdict = read_evidence(evidence, stored) if evidence else (None, "")
    if word == "released" and verdict == "failed":
        raise misuse(f"{evidence} says that {table} failed, which releases nothing", "--evidence")
    lost = stored.table.not_sensed.get("wheel_pressures")
    if word == "released" and lost:
        flaw = f"is for no ECU: it would have to know {lost}"
        do = "declare rear_proportioning in the vehicle file, or fit the ramp without them"
        raise StoreError(flaw, where=table, expected="a table of pressures that an ECU has", do=do)
    proofs, old = (proof,) if proof else (), stored.state
    state = StateDecision(word, decision.reason, verdict, proofs, decision.by or "")
    after = decision.store.judge(table, state)
    same = "nothing to change" if old == after.state else f"it was {old.word}"
    states = {"before": old.word, "state": after.state.word, "why": after.state.description}
    document = {"table": after.id, "digest": after.digest, **states}
    proof_text = f"; the evidence: {verdict}" * (verdict in (CONSISTENT, "warning"))
    return Answer(document, f"{after.id} is {after.state.description}; {same}{proof_text}")


tables = group(
    "tables", "Look at tables, release or reject them, hand them out.", "brake-cal tables list"
)
add(tables, "Look", list_, show, diff, log, verify)
add(tables, "Decide", release, reject, withdraw, sign)
add(tables, "Hand out", export, compare, merge)
