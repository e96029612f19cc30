"""Bad input as the library refuses it."""

from collections.abc import Callable
from typing import Any

import pytest

from calib.base.errors import BrakeCalError, InputError


def refusal(
    act: Callable[..., object],
    *arguments: Any,
    kind: type[BrakeCalError] | tuple[type[BrakeCalError], ...] = InputError,
    names: object = "",
    **options: Any,
) -> str:
    """What is said of input that ``act`` refuses with an error of ``kind`` that ``names`` it."""
    with pytest.raises(kind) as error:
        act(*arguments, **options)
    assert error.value.exit_code == 3
    assert str(names) in str(error.value)
    return str(error.value)
