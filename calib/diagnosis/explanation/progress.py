"""What a diagnosis says of its progress while it works."""

from collections.abc import Callable

Tell = Callable[[str, int, int], None]
"""Called at each step: the stage in words, how many of its steps are done, how many it has."""


def silent(stage: str, done: int, total: int) -> None:
    """Tell nobody."""
