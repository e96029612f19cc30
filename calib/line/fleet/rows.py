"""Rows and columns of `results.parquet`: first the columns `HEAD`, then those of a command."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

Cell = float | bool | str | None


class Command(StrEnum):
    """A command that is run on each log of a batch."""

    FIT = "fit"
    VALIDATE = "validate"
    CHECK = "check"


class Status(StrEnum):
    """Outcome for a log: DONE for a command without limits, ERROR if there is no result."""

    PASSED = "passed"
    FAILED = "failed"
    DONE = "done"
    ERROR = "error"


@dataclass(frozen=True)
class Column:
    """One column of the results."""

    name: str
    unit: str = "1"  # SI
    kind: type = float  # of its cells: float, bool or str


@dataclass(frozen=True)
class Row:
    """Result of a command for one log."""

    log: str  # name
    digest: str | None  # SHA-256 of the log
    status: Status
    error: str | None
    cells: tuple[Cell, ...] = ()  # of `columns_of`; none with an error
    lost: bool = False  # whether the next run tries the log again, such as after a worker died

    def head(self) -> dict[str, str | None]:
        """Return the cells of `HEAD` by name."""
        return {"log": self.log, "digest": self.digest, "status": self.status, "error": self.error}

    def metrics(self, command: Command) -> dict[str, Any]:
        """Return the cells of the command by name; none of a row with an error."""
        names = (column.name for column in columns_of(command))
        return dict(zip(names, self.cells, strict=False))

    def line(self, command: Command) -> str:
        """Return one line of text: the error, or the status with the limits that are not held."""
        if self.error is not None:
            return f"{self.log}: error: {self.error.removeprefix(f'{self.log}: ')}"
        not_held = self.metrics(command).get("not_held")
        limits = f" ({not_held})" if not_held else ""
        return f"{self.log}: {self.status}{limits}"


def _columns(*names: str, unit: str = "1", kind: type = float) -> tuple[Column, ...]:
    return tuple(Column(name, unit, kind) for name in names)


HEAD = _columns("log", "digest", "status", "error", kind=str)
_WARNED = _columns("warned", kind=str)  # codes of the warnings of a log; null without a warning

QUALITY = (
    "deceleration_max", "front_biased_up_to", "eta_peak", "eta_peak_deceleration",
    "eta_peak_is_real", "residual_eta_rms_sigma", "residual_slip_rms_sigma", "outliers",
    "pad_ratio_nominal_weight",
)  # fmt: skip
"""Metrics of the quality of a table that are columns of `fit`."""

_COLUMNS = {
    Command.FIT: (
        *_columns("pad_friction_f", "pad_friction_r", "pad_scale"),
        *_columns("pad_friction_f_sigma", "pad_friction_r_sigma", "pad_scale_sigma", *QUALITY),
        *_WARNED,
        *_columns("table_digest", kind=str),
    ),
    Command.CHECK: (
        *_columns("usable_fit", "usable_validate", "usable_coast", "usable_diagnose", kind=bool),
        *_columns("samples"),
        *_columns("duration", unit="s"),
        *_columns("rate", unit="Hz"),
        *_columns("jitter", unit="s"),
        *_columns("gaps", "brakings"),
        *_columns("lead_in", "coasting", unit="s"),
        *_columns("speed_max", unit="m/s"),
        *_columns("deceleration_max"),
        *_columns("pressure_max", unit="Pa"),
        *_columns("eta_zero"),
        *_WARNED,
    ),
}


def columns_of(command: Command) -> tuple[Column, ...]:
    """Return the columns of a command, which follow those of `HEAD`."""
    if command != Command.VALIDATE:
        return _COLUMNS[command]
    from calib.estimation.metrics import METRICS

    return (*_columns(*METRICS), *_columns("not_held", kind=str), *_WARNED)
