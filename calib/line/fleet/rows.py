"""Rows and columns of `results.parquet`: what a batch says of each log."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

Cell = float | bool | str | None


class Command(StrEnum):
    """A command that is run on each log of a batch."""

    FIT = "fit"
    VALIDATE = "validate"
    CHECK = "check"
    DIAGNOSE = "diagnose"


class Status(StrEnum):
    """Outcome for a log; DONE if the command does not judge, ERROR if there is no result."""

    PASSED = "passed"
    FAILED = "failed"
    DONE = "done"
    ERROR = "error"

    def in_words(self, command: Command) -> str:
        """The outcome of a command in words: a check says for what a log is usable."""
        usable = {Status.PASSED: "usable", Status.FAILED: "not usable"}
        return usable.get(self, self.value) if command is Command.CHECK else self.value


@dataclass(frozen=True)
class Column:
    """One column; ``kind`` float, bool or str; ``meaning`` empty if the file does not give it."""

    name: str
    unit: str = "1"
    meaning: str = ""
    kind: type = float


@dataclass(frozen=True)
class Row:
    """Result of a command for one log; ``cells`` follow `columns_of`, none for an error.

    ``lost``: an error that the log may not cause, as of a worker that died. It is tried again.
    """

    log: str
    digest: str | None
    status: Status
    error: str | None
    cells: tuple[Cell, ...] = ()
    lost: bool = False

    def to_dict(self, command: Command) -> dict[str, Any]:
        """The row of a command as one JSON document."""
        head = {"log": self.log, "digest": self.digest, "status": self.status, "error": self.error}
        names = (column.name for column in columns_of(command))
        return {**head, "figures": dict(zip(names, self.cells, strict=False))}

    def line(self, command: Command) -> str:
        """The row of a command in one line: its status or error, and the pads where it has them."""
        if self.error is not None:
            return f"{self.log}: error: {self.error.removeprefix(f'{self.log}: ')}"
        metrics = self.to_dict(command)["figures"]
        broken = f" ({metrics['not_held']})" if metrics.get("not_held") else ""
        pads = [metrics.get(f"pad_friction_{axle}") for axle in "fr"]
        details = "" if None in pads else f", pads {pads[0]:.3f} / {pads[1]:.3f}"
        purposes = [name[7:] for name, x in metrics.items() if name.startswith("usable_") and x]
        details += f" for {', '.join(purposes)}" if purposes else ""
        return f"{self.log}: {self.status.in_words(command)}{broken}{details}"


def _text(name: str, meaning: str) -> Column:
    return Column(name, "1", meaning, str)


HEAD = (
    _text("log", "path as given"),
    _text("digest", "SHA-256 of the log; null if it cannot be read"),
    _text("status", "passed, failed, done or error"),
    _text("error", "error message; null without an error"),
)
"""The first columns, of every command."""

_WARNED = _text("warned", "codes of the warnings; null without any")

_PADS = ("friction_f", "friction_r", "scale")

FIT = (
    Column("pad_friction_f", "1", "pad friction, front"),
    Column("pad_friction_r", "1", "pad friction, rear"),
    Column("pad_scale", "1", "common factor on the nominal pad friction"),
    *(Column(f"pad_{name}_sigma", "1", "one sigma of it") for name in _PADS),
    Column("deceleration_max", "1", "deceleration that the ramp reached, z"),
    Column("front_biased_up_to", "1", "z up to which the front axle brakes more for its load"),
    Column("eta_peak", "1", "largest eta on the ramp"),
    Column("eta_peak_deceleration", "1", "z at the largest eta"),
    Column("eta_peak_is_real", "1", "1 if eta falls again within the ramp, else 0"),
    Column("residual_eta_rms_sigma", "1", "rms residual of eta in the fit, over its sigma"),
    Column("residual_slip_rms_sigma", "1", "the same for the slip; 0 without v"),
    Column("outliers", "1", "blocks of eta past four sigma"),
    Column("pad_ratio_nominal_weight", "1", "weight of the pad ratio of the vehicle file"),
    _WARNED,
    _text("table_digest", "digest of the table"),
)

_CHECK = (
    Column("usable_fit", "1", "usable for fit", bool),
    Column("usable_validate", "1", "usable for validate", bool),
    Column("usable_coast", "1", "usable for a fit, as a coast log", bool),
    Column("usable_diagnose", "1", "usable for diagnose", bool),
    Column("samples", "1", "samples"),
    Column("duration", "s", "duration"),
    Column("rate", "Hz", "rate of the median step"),
    Column("jitter", "s", "rms deviation of the steps from the median"),
    Column("gaps", "1", "number of gaps in the clock"),
    Column("brakings", "1", "applications of the brake"),
    Column("lead_in", "s", "steady rolling before the first braking"),
    Column("coasting", "s", "all steady rolling without braking"),
    Column("speed_max", "m/s", "highest speed"),
    Column("deceleration_max", "1", "highest deceleration, z"),
    Column("pressure_max", "Pa", "highest p_mc"),
    Column("eta_zero", "1", "eta - 1 without braking"),
    _WARNED,
)

_DIAGNOSE = (
    _text("verdict", "no_gap, named, ambiguous or unknown"),
    _text("effects", "named effects, joined by +"),
    Column("gap_before", "1", "gap on the hold-outs, no effect added"),
    Column("gap_after", "1", "gap on the hold-outs, with the named effects"),
    Column("gap_closed", "1", "share of the gap that is closed"),
)

_COLUMNS = {Command.FIT: FIT, Command.CHECK: _CHECK, Command.DIAGNOSE: _DIAGNOSE}


def columns_of(command: Command) -> tuple[Column, ...]:
    """The columns after `HEAD`."""
    if command != Command.VALIDATE:
        return _COLUMNS[command]
    from calib.estimation.metrics import METRICS

    return (
        *(Column(name, "1", meaning) for name, meaning in METRICS.items()),
        _text("not_held", "metrics that break a limit; null if none does"),
        _WARNED,
    )
