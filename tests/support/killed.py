"""A call in a process of its own that ends, as by kill -9, before its n-th change of the disk."""

import os
from collections.abc import Callable

CHANGES = ("mkdir", "rename", "replace", "fsync", "unlink", "rmdir")
"""Functions of `os` that change the disk or flush it; ``write`` comes before each ``fsync``."""


def killed(call: Callable[[], object], number: int) -> bool:
    """Run ``call`` and end without any cleaning before its change ``number``, from 0.

    Returns whether it was ended; False if it had fewer changes and came to its end.
    """
    child = os.fork()
    if child == 0:
        try:
            _arm(number)
            call()
        except BaseException:
            os._exit(1)
        os._exit(0)
    _, status = os.waitpid(child, 0)
    code = os.waitstatus_to_exitcode(status)
    assert code in (0, 9), f"the call failed by itself ({code})"
    return code == 9


def _arm(number: int) -> None:
    remaining = number

    def counted(name: str) -> Callable[..., object]:
        whole = getattr(os, name)

        def step(*arguments: object, **options: object) -> object:
            nonlocal remaining
            if remaining == 0:
                os._exit(9)
            remaining -= 1
            return whole(*arguments, **options)

        return step

    for name in CHANGES:
        setattr(os, name, counted(name))
