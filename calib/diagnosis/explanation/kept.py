"""The last result of a computation, for as long as its inputs stay the same."""

from collections.abc import Callable
from typing import Generic, TypeVar

K = TypeVar("K")
R = TypeVar("R")


class Kept(Generic[K, R]):
    """One result and the inputs that it belongs to. A copy in another process begins without."""

    def __init__(self) -> None:
        self._kept: tuple[K, R] | None = None

    def of(self, inputs: K, compute: Callable[[], R]) -> R:
        """The result for these ``inputs``, which are compared with those of the last time."""
        if self._kept is None or self._kept[0] != inputs:
            self._kept = (inputs, compute())
        return self._kept[1]

    def __reduce__(self) -> "tuple[type[Kept[K, R]], tuple[()]]":
        return type(self), ()
