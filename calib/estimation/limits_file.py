"""Read the limits of a validation from a TOML file.

    schema = 1
    [limits]
    valid_share = { min = 0.7 }
    pad_scale = { fail = [0.8, 1.2], warn = [0.9, 1.1], required = true }

A value outside ``fail`` fails, a value outside ``warn`` warns. ``min`` and ``max`` are the single
ends of ``fail``; in a range `-inf` and `inf` leave an end open.
"""

from collections.abc import Collection
from math import inf, isfinite
from pathlib import Path
from typing import Annotated, Any, ClassVar, Self

from pydantic import BeforeValidator, Field, FiniteFloat, create_model, model_validator

from calib.base.errors import LimitsError
from calib.base.plain import MetricLimits, finite_or_none
from calib.base.record import FileSchema, Section, by_name, read_toml
from calib.base.record_errors import wrong
from calib.estimation.limits import Limit

_EXPECTED = "[LOW, HIGH]; -inf, inf: no limit"


def _range(written: object) -> object:
    """Return ``written`` if it is a list of two numbers in order, else raise."""
    match written:
        case [int() | float() as low, int() | float() as high]:  # the schema refuses booleans
            if low <= high and low < inf and high > -inf:
                return written
            raise wrong(f"{low:g} to {high:g} is no range", _EXPECTED)
    raise wrong(f"{written!r}", _EXPECTED)


_Range = Annotated[list[float], Field(min_length=2, max_length=2), BeforeValidator(_range)]


class _LimitSection(Section):
    """Range of a metric: ``min`` and/or ``max``, or ``fail``; a range ``warn`` lies within it."""

    min: FiniteFloat | None = None
    max: FiniteFloat | None = None
    fail: _Range | None = None
    warn: _Range | None = None
    required: bool = False

    written_as: ClassVar[str] = (
        "{ min = NUMBER } and/or { max = NUMBER }, or { fail = [LOW, HIGH] } and/or "
        "{ warn = [LOW, HIGH] }; with required = true it must be known"
    )

    @property
    def ends(self) -> tuple[float, float, float, float]:
        """The ranges outside of which the metric fails and warns; an open end is infinite."""
        low = -inf if self.min is None else self.min
        high = inf if self.max is None else self.max
        return (*(self.fail or (low, high)), *(self.warn or (-inf, inf)))

    @model_validator(mode="after")
    def _require_consistent(self) -> Self:
        if not self.model_fields_set - {"required"}:
            raise wrong("no limit in it", self.written_as)
        if self.fail is not None and self.model_fields_set & {"min", "max"}:
            raise wrong("has both fail and min or max", "one of them: they say the same")
        low, high, *warn = self.ends
        _range([low, high])
        for end in warn:
            if isfinite(end) and not low <= end <= high:
                flaw = f"warn {end:g} lies outside of fail {low:g} to {high:g}"
                raise wrong(flaw, "warn within fail")
        return self


def limits_schema(metrics: Collection[str]) -> type[FileSchema]:
    """Return the schema of a limits file for the ``metrics``."""
    text = "The allowed range of each metric."
    limits: Any = by_name("LimitsSection", dict.fromkeys(sorted(metrics), _LimitSection), text)
    return create_model("LimitsFile", __base__=FileSchema, __doc__=text, limits=(limits, ...))


def read_limits(path: Path, metrics: Collection[str]) -> tuple[Limit, ...]:
    """Read limits. Raises LimitsError for an unreadable file, an unknown metric or a bad range."""
    file: Any = read_toml(path, limits_schema(metrics), LimitsError)
    entries = file.limits.entries()
    if not entries:
        raise LimitsError("no limits in it", where=path, expected="metrics in the table [limits]")
    return tuple(
        Limit(name, *MetricLimits(*map(finite_or_none, limit.ends)), limit.required)
        for name, limit in entries
    )
