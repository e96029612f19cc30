"""Rows and columns of `results.parquet`."""

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
    """Outcome for a log; DONE if the command has no limits, ERROR if there is no result."""

    PASSED = "passed"
    FAILED = "failed"
    DONE = "done"
    ERROR = "error"


@dataclass(frozen=True)
class Column:
    """One column, in its SI ``unit``; ``kind`` float, bool or str."""

    name: str
    unit: str = "1"
    kind: type = float


@dataclass(frozen=True)
class Row:
    """Result of a command for one log; ``cells`` by `columns_of`, none for an error.

    ``lost`` whether the log is tried again: its error may have another cause, as a dead worker.
    """

    log: str
    digest: str | None
    status: Status
    error: str | None
    cells: tuple[Cell, ...] = ()
    lost: bool = False

    def head(self) -> dict[str, str | None]:
        """The cells of `HEAD`, by name."""
        return {"log": self.log, "digest": self.digest, "status": self.status, "error": self.error}

    def metrics(self, command: Command) -> dict[str, Any]:
        """The cells of a command, by name."""
        names = (column.name for column in columns_of(command))
        return dict(zip(names, self.cells, strict=False))

    def line(self, command: Command) -> str:
        """The row in one line: its error, or its status with the limits that it does not hold."""
        if self.error is not None:
            return f"{self.log}: error: {self.error.removeprefix(f'{self.log}: ')}"
        not_held = self.metrics(command).get("not_held")
        return f"{self.log}: {self.status}{f' ({not_held})' if not_held else ''}"


def _columns(*names: str, unit: str = "1", kind: type = float) -> tuple[Column, ...]:
    return tuple(Column(name, unit, kind) for name in names)


HEAD = _columns("log", "digest", "status", "error", kind=str)
"""The first columns, of every command."""

_WARNED = _columns("warned", kind=str)
"""Codes of the warnings; null without any."""

QUALITY = (
    *("deceleration_max", "front_biased_up_to", "eta_peak", "eta_peak_deceleration"),
    *("eta_peak_is_real", "residual_eta_rms_sigma", "residual_slip_rms_sigma", "outliers"),
    "pad_ratio_nominal_weight",
)
"""Figures of a fit, as its table has them."""

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
    """The columns after `HEAD`."""
    if command != Command.VALIDATE:
        return _COLUMNS[command]
    from calib.estimation.metrics import METRICS

    return (*_columns(*METRICS), *_columns("not_held", kind=str), *_WARNED)
