"""Facts and JSON documents of the tables of a store.

In this order: the list, one table, its history, its damage, a mean of several cars, the differences
of two tables, and of a table and a file.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from calib.base.intervals import Z95
from calib.base.plain import NBSP, counted, metric_of
from calib.show.facts import FAILED, PASSED, WARNING, Facts, Row, Table
from calib.show.judged import budget_rows, ramp_rows
from calib.show.numbers import spaced
from calib.store.figures import ListedVersion, effect_figures, mean_figures, usability, verdict
from calib.store.signature import signer
from calib.store.snapshot import StoreEntry
from calib.store.version import Stored
from calib.table.budget import advice_lines, limiting_parts

if TYPE_CHECKING:
    from calib.exports.compare import Difference as FromFile
    from calib.exports.read import Returned
    from calib.table.compare import Difference


def listed(rows: Sequence[ListedVersion]) -> Facts:
    """Return the list of all versions; notes say which cannot be used, and why."""
    heads = ("table", "state", "stored", "car", "logs", "pads f/r", "range [g]", "band", "verdict")
    flaws = [f"{row['id']} cannot be used: {row['flaw']}" for row in rows if row["flaw"]]
    return Facts(tables=[Table(heads, list(map(_listed, rows)))], notes=flaws)


def _listed(row: ListedVersion) -> Sequence[str]:
    first_cells = (row["id"], row["state"], row["date"][:10])
    if row["flaw"]:
        return *first_cells, "", "", "", "", "", ""
    warned = counted(row["warnings"], "warning") if row["warnings"] else ""
    signed = "signed" if row["key"] else ""
    low, high = row["usable"]
    return (
        *first_cells,
        " ".join(filter(None, (row["serial"], row["vin"]))),
        str(len(row["logs"])),
        "/".join(f"{friction:.3f}" for friction in row["pads"]),
        f"{low:.2f}-{high:.2f}",
        "" if row["band_width"] is None else f"{100 * row['band_width']:.0f} %",
        ", ".join(filter(None, (row["verdict"], warned, signed))),
    )


def table_facts(stored: Stored) -> Facts:
    """Return the facts of a table: its torques, whether it may be used, and its record."""
    table, use, budgets = stored.table, usability(stored), stored.table.budget.axles
    logs = ", ".join(log.name for log in table.provenance.logs)
    parents = ", ".join(parent.id for parent in table.provenance.parents)
    return Facts(
        headline=verdict(stored),
        verdict=PASSED if use.usable else WARNING,
        numbers=ramp_rows(table),
        rows=[
            ("state", stored.state.description),
            ("range", use.ends),
            ("largest uncertainty", limiting_parts(budgets)),
            ("made of", parents or logs),
        ],
        notes=advice_lines(budgets)[:1],
        next=use.next,
        parts=[_made_of(stored)],
    )


def _made_of(stored: Stored) -> Facts:
    table, car, key = stored.table, stored.table.vehicle, signer(stored)
    scale, (eta, D) = table.calibration.pad_scale, table.difference.peak
    low, high = scale.ci95
    rows: list[Row] = [
        *(("warning", str(warning)) for warning in table.warnings),
        ("digest", stored.digest),
        ("signed", f"by key {key}; `tables verify --key` checks it" if key else "no"),
        ("vehicle", f"{car.name}, {car.mass:g} kg"),
        *table.provenance.identity.items(),
        *(("parent", f"{p.id} ({p.digest[:12]})") for p in table.provenance.parents),
        *((f"spread of {x.name}", f"± {100.0 * Z95 * x.between:.2f} % of the cars (95 %)")
          for x in mean_figures(table)),
        *((log.role, f"{log.name} ({log.digest[:12]})") for log in table.provenance.logs),
        *((spaced(value.effect), str(value)) for value in effect_figures(table)),
        ("pad scale", f"{scale.value:.4g} (95 %: {low:.4g} to {high:.4g})"),
        *budget_rows(table.budget.axles),
        ("largest D", f"eta {eta:.5f}, D {D:.4f}"),
        *((metric_of(key).name, metric_of(key).with_unit(x)) for key, x in table.quality.items()),
    ]  # fmt: skip
    return Facts("Record", rows=rows, notes=[*advice_lines(table.budget.axles)[1:], *table.remarks])


def shown_document(stored: Stored) -> dict[str, Any]:
    """Return the JSON document of a table."""
    record, curves = stored.table.content()
    eta, D = stored.table.difference.peak
    return {
        **stored.address,
        "state": stored.state.word,
        "key": signer(stored),
        "answer": usability(stored),
        "decelerations": stored.table.paper.decelerations,
        "peak": {"eta": eta, "D": D},
        "record": record,
        "curves": curves,
    }


def history(entries: Sequence[dict[str, Any]]) -> Facts:
    """Return what happened to a table: when, by whom and why."""
    rows = []
    for entry in entries:
        event, id_ = entry["state"], f"{entry['table']}@{entry['version']}"
        if entry["event"] not in ("stored", "changed"):  # the state alone says these
            event = f"{entry['event']}, {event}"
        evidence = [f"{file['name']} {file['sha256'][:12]}" for file in entry["evidence"]]
        evidence += [f"key {entry['key']}"] if entry["key"] else []
        rows.append((entry["at"], id_, event, entry["by"], entry["reason"], "; ".join(evidence)))
    return Facts(tables=[Table(("when", "table", "state", "by", "why", "evidence"), rows)])


def verified(verdicts: Sequence[StoreEntry], with_key: bool) -> Facts:
    """Return the damage of each version, and its signature if a key was given."""
    rows = []
    for entry in verdicts:
        signature = f"signed as {entry.signed}" if entry.signed else "not signed by this key"
        sound = f"sound, {signature}" if with_key else "sound"
        rows.append((entry.id, "; ".join(entry.violations) or sound))
    colours = ["" if entry.sound else FAILED for entry in verdicts]
    return Facts(tables=[Table(("table", "verdict"), rows, verdicts=colours)])


def merged(stored: Stored) -> Facts:
    """Return the facts of a mean of several cars, with the spread between the cars."""
    cells = []
    for figure in mean_figures(stored.table):
        half_width, spread = f"±{NBSP}{100.0 * figure.half_width:.2f}{NBSP}%", "less than noise"
        if figure.between > 0.0:
            spread = f"{100.0 * (Z95 * figure.between):.2f}{NBSP}%"
        cells.append((figure.name, f"{figure.value:.4g}", half_width, spread))
    return Facts(
        headline=f"stored {stored.id}",
        tables=[Table(("of the mean", "value", "95 % of the mean", "95 % between cars"), cells)],
        rows=[("parent", f"{p.id} ({p.digest[:12]})") for p in stored.table.provenance.parents],
        notes=stored.table.remarks,
    )


def merged_document(stored: Stored) -> dict[str, Any]:
    """Return the JSON document of a mean of several cars."""
    table = stored.table
    return {
        **stored.address,
        "parents": table.provenance.parents,
        "cars": table.spread.cars if table.spread else 1,
        "eta": [table.difference.eta[0], table.difference.eta[-1]],
        "figures": mean_figures(table),
        "remarks": table.remarks,
        "warnings": table.warnings,
    }


def compared_document(difference: "Difference", first: Stored, second: Stored) -> dict[str, Any]:
    """Return the JSON document of the differences of two tables."""
    return {
        "a": first.id,
        "b": second.id,
        "states": {"a": first.state.word, "b": second.state.word},
        "verdict": difference.verdict,
        **vars(difference),
    }


def compared(difference: "Difference", first: Stored, second: Stored) -> Facts:
    """Return whether and where two tables differ."""
    a, b = (f"{stored.id} ({stored.state.word})" for stored in (first, second))
    headline = f"{a} and {b} are {difference.verdict}"
    if difference.identical:
        return Facts(headline=headline)
    curves = []
    for gap in difference.curves:
        places = (f"{x:.5f}" for x in (gap.start, gap.end))
        largest = f"{gap.largest:+.5f}", f"{gap.at:.5f}", f"{gap.in_bands:.2f}"
        curves.append((gap.curve, *places, *largest))
    values = [(v.name, f"{v.a:.4f}", f"{v.b:.4f}", f"{v.in_bands:.2f}") for v in difference.values]
    changed = ", ".join(f"{len(keys)} of {part}" for part, keys in difference.changes.items())
    heads = ("value", first.id, second.id, "in 95 % bands")
    return Facts(
        headline=headline,
        tables=[Table(("curve", "from", "to", "largest", "at", "in 95 % bands"), curves)],
        parts=[Facts("Values", tables=[Table(heads, values)])],
        notes=[
            *(f"{curve}: no common axis" for curve in difference.apart),
            *([f"different: {changed}; --json prints them"] if changed else []),
        ],
    )


def returned_document(
    file: "Returned", stored: Stored | None, difference: "FromFile"
) -> dict[str, Any]:
    """Return the JSON document of a file of a calibration tool."""
    grids = file.content.grids
    return {
        "format": file.format,
        "facts": file.facts,
        "axes": file.content.axes,
        "curves": {k: {"x": axes[0], "y": y} for k, (axes, y) in grids.items() if len(axes) == 1},
        "maps": {k: {"axes": axes, "y": y} for k, (axes, y) in grids.items() if len(axes) > 1},
        "scalars": file.content.scalars,
        "units": file.units,
        "in_store": stored is not None,
        "unchanged": file.unchanged,
        "rounded": difference.rounded,
        "differences": difference.wrong,
        "not_in_file": difference.missing,
    }


def returned(file: "Returned", stored: Stored | None, difference: "FromFile") -> Facts:
    """Return whether a file of a calibration tool agrees with the table that it names.

    ``stored`` is None where the store does not have that table.
    """
    if difference.wrong:
        headline = f"{file.table} does not agree: edited or damaged; export the table again"
    elif stored is None:
        headline = f"unchanged since it was written; {file.table} is not in this store"
    else:
        how = f"as rounded {difference.rounded}" if difference.rounded else "to the last bit"
        headline = f"agrees with {stored.id} {how}"
        if difference.missing:
            headline += f", without {counted(len(difference.missing), 'label')}"
    differences = [f"differs: {text}" for text in difference.wrong]
    missing = [f"not in the file: {name}" for name in difference.missing]
    return Facts(
        headline=headline,
        verdict=FAILED if difference.wrong else PASSED,
        notes=[*differences, *missing],
        parts=[Facts("What is in the file", rows=[("table", file.table), *file.facts.items()])],
    )
