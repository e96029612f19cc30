"""What takes long to make is made once in a session, for all modules and workers that ask for it.

    @shared
    def drive(plant, pressure, v0): ...

The key is the content of the arguments: of a function without a name that can be imported its code
and what it encloses. Each who asks has a copy of its own.
"""

import os
import pickle
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import ParamSpec, TypeVar

import cloudpickle

from calib.base.digest import sha256
from calib.base.write import write_whole

P = ParamSpec("P")
Result = TypeVar("Result")
FOLDER = "BRAKE_CAL_SHARED_RESULTS"
"""Variable of the environment with the folder of the session; without it nothing is shared."""


def shared(make: Callable[P, Result]) -> Callable[P, Result]:
    """``make``, or what it made in this session of the same arguments."""

    @wraps(make)
    def cached(*arguments: P.args, **named: P.kwargs) -> Result:
        if FOLDER not in os.environ:
            return make(*arguments, **named)
        content = cloudpickle.dumps((make.__module__, make.__qualname__, arguments, named))
        path = Path(os.environ[FOLDER], sha256(content))
        if not path.exists():
            write_whole(path, cloudpickle.dumps(make(*arguments, **named)))
        return pickle.loads(path.read_bytes())

    return cached
