"""Versions that were made of the same ramp as another one, and may not be used."""

from calib.base.errors import StoreError
from calib.store.store import Store
from calib.store.version import Stored


def refused_kin(store: Store, stored: Stored) -> tuple[Stored, ...]:
    """The rejected and withdrawn versions of its name that share a ramp with ``stored``.

    A version that cannot be read is left out: `verify` names it.
    """
    ramps = _ramps(stored)
    journal = store.journal()
    others = [v for v in journal.of(stored.name) if not journal.state(stored.name, v).usable]
    found = []
    for version in (v for v in others if v != stored.version):
        try:
            other = store.load(f"{stored.name}@{version}")
        except StoreError:
            continue
        if ramps & _ramps(other):
            found.append(other)
    return tuple(found)


def _ramps(stored: Stored) -> set[str]:
    return {log.digest for log in stored.table.provenance.logs if log.role == "ramp"}
