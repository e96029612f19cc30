"""Limits of a validation as a TOML file.

    schema = 1
    [limits]
    valid_share = { min = 0.7 }
    pad_scale = { fail = [0.8, 1.2], warn = [0.9, 1.1] }

It fails outside ``fail`` and warns outside ``warn``; `-inf` and `inf` leave an end open. `min` and
`max` are other words for the ends of ``fail``. With `required = true` a metric that a log cannot
give fails.
"""

from collections.abc import Collection
from math import inf, isfinite
from pathlib import Path
from typing import Annotated, Any, ClassVar, Self

from pydantic import BeforeValidator, FiniteFloat, WithJsonSchema, create_model, model_validator

from calib.base.errors import LimitsError
from calib.base.plain import Ends
from calib.base.record import FileSchema, Section, by_name, read_toml
from calib.base.record_errors import wrong
from calib.estimation.limits import Limit

_EXPECTED = "[LOW, HIGH]; -inf, inf: no limit"


def _range(written: object) -> tuple[float, float]:
    if not (isinstance(written, list) and len(written) == 2 and all(map(_is_number, written))):
        raise wrong(f"{written!r}", _EXPECTED)
    low, high = map(float, written)
    if low > high or low == inf or high == -inf:
        raise wrong(f"{low:g} to {high:g} is no range", _EXPECTED)
    return low, high


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and value == value


_Range = Annotated[
    tuple[float, float],
    BeforeValidator(_range),
    WithJsonSchema({"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}),
]


class _LimitSection(Section):
    """Range of a metric: ``min`` and/or ``max``, or ``fail``; inside it ``warn``."""

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
        low, high = (-inf if self.min is None else self.min, inf if self.max is None else self.max)
        return (*(self.fail or (low, high)), *(self.warn or (-inf, inf)))

    @model_validator(mode="after")
    def _says_one_thing(self) -> Self:
        if self.model_fields_set <= {"required"}:
            raise wrong("no limit in it", self.written_as)
        if self.fail is not None and (self.min is not None or self.max is not None):
            other = "max" if self.min is None else "min"
            raise wrong(f"has both fail and {other}", "one of them: they say the same")
        low, high, warn_low, warn_high = self.ends
        if low > high:
            raise wrong(f"min {low:g} lies above max {high:g}", "min below max")
        for warn, fail, sign in ((warn_low, low, 1.0), (warn_high, high, -1.0)):
            if isfinite(warn) and sign * warn < sign * fail:
                raise wrong(f"warn {warn:g} lies beyond fail {fail:g}", "warn inside fail")
        return self


def limits_schema(known: Collection[str]) -> type[FileSchema]:
    """Return the schema of a limits file over the ``known`` metrics."""
    about = "The allowed range of each metric."
    limits: Any = by_name("LimitsSection", dict.fromkeys(sorted(known), _LimitSection), about)
    return create_model("LimitsFile", __base__=FileSchema, __doc__=about, limits=(limits, ...))


def read_limits(path: Path, known: Collection[str]) -> tuple[Limit, ...]:
    """Read limits. Raises LimitsError for an unreadable file, an unknown metric or a bad range."""
    file: Any = read_toml(path, limits_schema(known), LimitsError)
    entries = file.limits.entries()
    if not entries:
        raise LimitsError("no limits in it", where=path, expected="metrics in the table [limits]")
    return tuple(
        Limit(name, *Ends(*(x if isfinite(x) else None for x in one.ends)), one.required)
        for name, one in entries
    )
