"""Figures of a stored table for people: its usability, effects, means, its row in a list."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from calib.base.plain import NBSP
from calib.base.random_effects import quantile95
from calib.car.effects.catalogue import every_effect
from calib.store.signature import signer
from calib.store.snapshot import StoreEntry
from calib.store.state import DRAFT, REJECTED, RELEASED
from calib.store.version import Stored
from calib.table.budget import pad_levels
from calib.table.table import Scatter, Table, Value


@dataclass(frozen=True)
class _Usability:
    """Whether a version is ``usable``, and why, in ``may``; the ``next`` step.

    ``decelerations``: range of the measured rows [g]; ``ends``: why it ends there.
    """

    usable: bool
    may: str
    decelerations: tuple[float, float]
    ends: str
    next: str


def usability(stored: Stored) -> _Usability:
    """Return the usability of a version."""
    state, q = stored.state, stored.table.quality
    peak, end = q.get("eta_peak_deceleration"), q.get("deceleration_max")
    if peak is not None and q.get("eta_peak_is_real"):
        ends = f"eta has its peak at {peak:.2f} g"
    else:
        ends = "the ramp ends" if end is None else f"the ramp ends at {end:.2f} g"
    steps = {
        RELEASED: f"brake-cal tables export {stored.id} --format ecu --out {stored.name}_ecu",
        DRAFT: f"brake-cal validate {stored.id} STOP... --out results",
        REJECTED: "find the cause and fit the car again, or release it on new evidence",
    }
    return _Usability(
        usable=state.released,
        may=("yes: " if state.released else "no: ") + state.words,
        decelerations=stored.table.paper.usable,
        ends=ends,
        next=steps.get(state.word, "fit the car again"),
    )


def verdict(stored: Stored) -> str:
    """State and use of a version, and its range, in one line."""
    uses = {DRAFT: "a draft, for trials only", RELEASED: "released, for an ECU"}
    word = stored.state.word
    if word not in uses:
        return f"{stored.id} is {word}: do not use it"
    end = f"{stored.table.paper.usable[1]:.2f}{NBSP}g"
    return f"{stored.id} is {uses[word]}; curves valid up to {end}"


@dataclass(frozen=True)
class _MeanFigure:
    """Mean ``value`` of several cars; ``half_width`` and ``between`` are relative to it [1].

    ``half_width`` of its 95 % interval without shared errors; ``between`` sigma of the cars.
    """

    name: str
    value: float
    half_width: float
    between: float


def mean_figures(table: Table) -> tuple[_MeanFigure, ...]:
    """Largest D, pad level and ratio over the file's, and stiffness of a mean table; else empty."""
    spread = table.spread
    if spread is None:
        return ()
    t95 = quantile95(spread.freedom)
    row = int(np.argmax(np.abs(table.difference.D)))
    eta, D = table.difference.peak
    pads = pad_levels(table.vehicle, table.calibration)

    def figure(name: str, value: float, scatter: Scatter, scale: float = 1.0) -> _MeanFigure:
        return _MeanFigure(name, value, t95 * scatter.of_mean / scale, scatter.between / scale)

    return (
        figure(f"D at eta {eta:.5f}", D, spread.D[row], abs(D)),
        figure("pad level", float(np.exp(pads.level)), spread.pad_level),
        figure("pad ratio", float(np.exp(pads.ratio)), spread.pad_ratio),
        figure("slip stiffness", table.calibration.slip_stiffness.value, spread.stiffness),
    )


@dataclass(frozen=True)
class _EffectFigure:
    """A parameter of an effect: ``value`` and its 95 % interval ``ci95`` [``unit``].

    The interval is cut at the range of the card. ``unit`` is "SI" for an own effect without a file.
    """

    effect: str
    name: str
    value: Value
    unit: str
    ci95: tuple[float, float]

    def __str__(self) -> str:
        low, high = self.ci95
        unit = "" if self.unit == "1" else f" {self.unit}"
        within = f"95 %: {low:.4g} to {high:.4g}" if low < high else "given"
        return f"{self.name} {self.value.value:.4g}{unit} ({within})"


def effect_figures(table: Table) -> Iterator[_EffectFigure]:
    """Every parameter of the effects of a table, in the order of its record."""
    effects = every_effect(table.vehicle.effects)
    for effect, values in table.effect_values.items():
        cards = effects[effect].card.parameters if effect in effects else ()
        by_name = {parameter.name: parameter for parameter in cards}
        for name, value in values.items():
            unit, (low, high) = "SI", value.ci95
            if card := by_name.get(name):
                unit = card.unit
                low = max(low, min(card.low, value.value))
                high = min(high, max(card.high, value.value))
            yield _EffectFigure(effect, name, value, unit, (low, high))


ListedVersion = dict[str, Any]
"""A version in the document of `tables list`."""


def row_of(entry: StoreEntry) -> ListedVersion:
    """The row of a version; values are None or empty where it cannot be read, see ``flaw``.

    ``date`` of storing; ``pads`` front and rear [1]; ``decelerations`` of its curves and their
    ``usable`` range [g]; ``warnings`` number at the fit; ``key`` that signed it, unverified.
    """
    state, stored = entry.state, entry.stored
    row: ListedVersion = {"id": entry.id, "name": entry.name, "version": entry.version}
    row |= {"digest": None, "state": state.word, "date": state.stored_at}
    row |= {"serial": "", "vin": "", "logs": ()}
    row |= dict.fromkeys(("pads", "decelerations", "usable", "band_width"))
    row |= {"verdict": state.verdict, "warnings": 0, "key": None, "flaw": "".join(entry.violations)}
    if stored is None:
        return row
    table, pads = stored.table, stored.table.calibration
    identity = table.provenance.identity
    return row | {
        "digest": stored.digest,
        "serial": identity.get("serial", ""),
        "vin": identity.get("vin", ""),
        "logs": tuple(log.name for log in table.provenance.logs),
        "pads": (pads.pad_friction_f.value, pads.pad_friction_r.value),
        "decelerations": table.paper.decelerations,
        "usable": table.paper.usable,
        "band_width": table.difference.band_width,
        "warnings": len(table.warnings),
        "key": signer(stored),
    }


def chosen(rows: Iterable[ListedVersion], **equal: str | None) -> list[ListedVersion]:
    """The rows whose texts are ``equal``, in upper or lower case; None matches all."""
    wanted = {key: value.lower() for key, value in equal.items() if value is not None}
    return [row for row in rows if all(row[key].lower() == x for key, x in wanted.items())]
