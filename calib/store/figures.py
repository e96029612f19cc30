"""Figures of a stored table for people: usability, a mean, effects, a row of `tables list`."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from calib.base.plain import NBSP
from calib.base.random_effects import quantile95
from calib.car.effects.catalogue import all_effects
from calib.store.signature import signer
from calib.store.snapshot import StoreEntry
from calib.store.state import DRAFT, REJECTED, RELEASED
from calib.store.version import Stored
from calib.table.budget import level_and_ratio
from calib.table.table import Scatter, Table, Value


@dataclass(frozen=True)
class _Usability:
    """Whether and where a version may be used in an ECU."""

    usable: bool
    may: str  # whether it may be used: yes or no, with the state
    decelerations: tuple[float, float]  # range in which the curves are valid [g]
    ends: str  # reason for the end of this range
    next: str  # next step: a command or a sentence


def usability(stored: Stored) -> _Usability:
    """Return whether and where a version may be used in an ECU."""
    state, quality = stored.state, stored.table.quality
    peak, end = quality.get("eta_peak_deceleration"), quality.get("deceleration_max")
    if peak is not None and quality.get("eta_peak_is_real"):
        ends = f"eta has its peak at {peak:.2f} g"
    else:
        ends = "the ramp ends" if end is None else f"the ramp ends at {end:.2f} g"
    next_steps = {
        RELEASED: f"brake-cal tables export {stored.id} --format ecu --out {stored.name}_ecu",
        DRAFT: f"brake-cal validate {stored.id} STOP... --out results",
        REJECTED: "find the cause and fit the car again, or release it on new evidence",
    }
    return _Usability(
        usable=state.released,
        may=("yes: " if state.released else "no: ") + state.description,
        decelerations=stored.table.paper.usable,
        ends=ends,
        next=next_steps.get(state.word, "fit the car again"),
    )


def verdict(stored: Stored) -> str:
    """Return state, use and range of a version, such as "sedan@1 is released, ..."."""
    uses = {DRAFT: "a draft, for trials only", RELEASED: "released, for an ECU"}
    word = stored.state.word
    if word not in uses:
        return f"{stored.id} is {word}: do not use it"
    end = f"{stored.table.paper.usable[1]:.2f}{NBSP}g"
    return f"{stored.id} is {uses[word]}; curves valid up to {end}"


@dataclass(frozen=True)
class _MeanFigure:
    """The mean of several cars, with two errors relative to it [1]."""

    name: str
    value: float
    half_width: float  # of the 95 % interval of the mean, without errors that all cars share
    between: float  # standard deviation between the cars


def mean_figures(table: Table) -> tuple[_MeanFigure, ...]:
    """Return the largest D, pad level, pad ratio and slip stiffness of a mean table, else ().

    Pad level and pad ratio are relative to the vehicle file.
    """
    spread = table.spread
    if spread is None:
        return ()
    t95 = quantile95(spread.freedom)
    row_of_peak = int(np.argmax(np.abs(table.difference.D)))
    eta, D = table.difference.peak
    pads = level_and_ratio(table.vehicle, table.calibration)

    def figure(name: str, value: float, scatter: Scatter, scale: float = 1.0) -> _MeanFigure:
        return _MeanFigure(name, value, t95 * scatter.of_mean / scale, scatter.between / scale)

    # the scatter of D is absolute; the others are of logarithms, and so relative already
    return (
        figure(f"D at eta {eta:.5f}", D, spread.D[row_of_peak], abs(D)),
        figure("pad level", float(np.exp(pads.level)), spread.pad_level),
        figure("pad ratio", float(np.exp(pads.ratio)), spread.pad_ratio),
        figure("slip stiffness", table.calibration.slip_stiffness.value, spread.stiffness),
    )


@dataclass(frozen=True)
class _EffectFigure:
    """A parameter of an effect. Its str() is a line for people."""

    effect: str
    name: str
    value: Value
    unit: str  # "SI" if the effect has no card
    ci95: tuple[float, float]  # 95 % interval, cut at the range of the effect's card

    def __str__(self) -> str:
        low, high = self.ci95
        unit = "" if self.unit == "1" else f" {self.unit}"
        interval = f"95 %: {low:.4g} to {high:.4g}" if low < high else "given"
        return f"{self.name} {self.value.value:.4g}{unit} ({interval})"


def effect_figures(table: Table) -> Iterator[_EffectFigure]:
    """Yield every parameter of the effects of a table, in the order of its record."""
    effects = all_effects(table.vehicle.effects)
    for effect, values in table.effect_values.items():
        on_card = effects[effect].card.parameters if effect in effects else ()
        parameters = {parameter.name: parameter for parameter in on_card}
        for name, value in values.items():
            unit, (low, high) = "SI", value.ci95
            if name in parameters:
                card = parameters[name]
                # a value beyond the range of the card stays in its interval
                low = max(low, min(card.low, value.value))
                high = min(high, max(card.high, value.value))
                unit = card.unit
            yield _EffectFigure(effect, name, value, unit, (low, high))


ListedVersion = dict[str, Any]  # a row of the document of `tables list`


def row_of(entry: StoreEntry) -> ListedVersion:
    """Return the row of a version; ``flaw`` says why the version cannot be read.

    ``date`` is when it was stored, ``pads`` the pad friction of front and rear [1],
    ``decelerations`` the range of the curves and ``usable`` that of their valid part [g],
    ``warnings`` the number of warnings of the fit, ``key`` the key of the unverified signature.
    """
    state, stored = entry.state, entry.stored
    row: ListedVersion = {"id": entry.id, "name": entry.name, "version": entry.version}
    row |= {"digest": None, "state": state.word, "date": state.stored_at}
    row |= {"serial": "", "vin": "", "logs": ()}
    row |= {"pads": None, "decelerations": None, "usable": None, "band_width": None}
    row |= {"verdict": state.verdict, "warnings": 0, "key": None}
    row["flaw"] = "; ".join(entry.violations)
    if stored is not None:
        table, pads = stored.table, stored.table.calibration
        identity = table.provenance.identity
        row["digest"], row["key"] = stored.digest, signer(stored)
        row["serial"], row["vin"] = identity.get("serial", ""), identity.get("vin", "")
        row["logs"] = tuple(log.name for log in table.provenance.logs)
        row["pads"] = (pads.pad_friction_f.value, pads.pad_friction_r.value)
        row["decelerations"], row["usable"] = table.paper.decelerations, table.paper.usable
        row["band_width"] = table.difference.band_width
        row["warnings"] = len(table.warnings)
    return row
