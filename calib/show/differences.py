"""Facts of what differs: two tables, a file that came back from a calibration tool."""

from typing import Any

from calib.exports.compare import Difference as FromFile
from calib.exports.read import Returned
from calib.show.facts import FAILED, PASSED, Facts, Table
from calib.store.version import Stored
from calib.table.compare import Difference

_SHOWN = 6
"""Differences of a file in the head of the answer; all are in the details."""
_PRINTED = ("name", "vehicle", "effects", "provenance", "quality")
"""Sections whose changed keys are printed; of the others only how many there are."""


def compared_document(found: Difference, first: Stored, second: Stored) -> dict[str, Any]:
    """The JSON document of two tables."""
    return {
        "a": first.id,
        "b": second.id,
        "states": {"a": first.state.word, "b": second.state.word},
        "verdict": found.verdict,
        "identical": found.identical,
        **vars(found),
    }


def compared(found: Difference, first: Stored, second: Stored) -> Facts:
    """Whether and where two tables differ."""
    one, other = (f"{stored.id} ({stored.state.word})" for stored in (first, second))
    headline = f"{one} and {other} are {found.verdict}"
    if found.identical:
        return Facts(headline=headline)
    curves = [
        (gap.curve, f"{gap.start:.5f}", f"{gap.end:.5f}", f"{gap.largest:+.5f}", f"{gap.at:.5f}",
         f"{gap.rms:.5f}", f"{gap.in_bands:.2f}")
        for gap in found.curves
    ]  # fmt: skip
    values = [(v.name, f"{v.a:.4f}", f"{v.b:.4f}", f"{v.in_bands:.2f}") for v in found.values]
    changes, rest = [], []
    for section, changed in found.changes.items():
        if section in _PRINTED:
            changes += [(section, one.key, _short(one.a), _short(one.b)) for one in changed]
        elif section != "calibration":
            rest.append(f"{len(changed)} of {section}")
    both = [
        Table(("value", first.id, second.id, "in 95 % bands"), values),
        Table(("section", "key", first.id, second.id), changes),
    ]
    return Facts(
        headline=headline,
        tables=[Table(("curve", "from", "to", "largest", "at", "rms", "in 95 % bands"), curves)],
        parts=[Facts("Values and texts", tables=both)],
        notes=[
            *(f"{curve}: no common axis" for curve in found.apart),
            *([f"also different: {', '.join(rest)}; --json prints them"] if rest else []),
        ],
    )


def _short(written: str | None) -> str:
    """A value of a record, a number with four digits."""
    try:
        return "-" if written is None else f"{float(written):.4g}"
    except ValueError:
        return str(written)


def returned_document(found: Returned, stored: Stored | None, told: FromFile) -> dict[str, Any]:
    """The JSON document of a file of a calibration tool."""
    grids = found.content.grids
    return {
        "format": found.format,
        "facts": found.facts,
        "axes": found.content.axes,
        "curves": {n: {"x": x[0], "y": y} for n, (x, y) in grids.items() if len(x) == 1},
        "maps": {n: {"axes": x, "y": y} for n, (x, y) in grids.items() if len(x) > 1},
        "scalars": found.content.scalars,
        "units": found.units,
        "in_store": stored is not None,
        "unchanged": found.unchanged,
        "rounded": told.rounded,
        "differences": told.wrong,
    }


def returned(found: Returned, stored: Stored | None, told: FromFile) -> Facts:
    """What a file of a calibration tool holds, and whether it agrees with the table it names."""
    content, units = found.content, found.units
    arrays = {**content.axes, **{name: y for name, (_, y) in content.grids.items()}}
    cells = [
        (name, str(len(y)), f"{min(y):.6g}", f"{max(y):.6g}", units[name])
        for name, y in arrays.items()
    ]
    cells += [(n, "", f"{value:.6g}", "", units[n]) for n, value in content.scalars.items()]
    if told.wrong:
        headline = f"{found.table} does not agree: edited or damaged; export the table again"
    elif stored is None:
        headline = f"unchanged since it was written; {found.table} is not in this store"
    else:
        how = f"as rounded {told.rounded}" if told.rounded else "to the last bit"
        headline = f"agrees with {stored.id} {how}"
    return Facts(
        headline=headline,
        verdict=FAILED if told.wrong else PASSED,
        notes=[f"differs: {what}" for what in told.wrong[:_SHOWN]],
        parts=[
            Facts("All that differs", notes=[f"differs: {what}" for what in told.wrong]),
            Facts(
                "What is in the file",
                rows=[("table", found.table), *found.facts.items()],
                tables=[Table(("object", "points", "from", "to", "unit"), cells)],
            ),
        ],
    )
