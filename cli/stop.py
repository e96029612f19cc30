"""A work that takes long is stopped by Ctrl-C and by SIGTERM alike, with one line and exit 130."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager

from cli.console import say


@contextmanager
def stoppable(said: str) -> Iterator[None]:
    """Let SIGTERM interrupt the work as Ctrl-C does, and say what becomes of it then."""
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    except KeyboardInterrupt:
        say(said)
        raise
    finally:
        signal.signal(signal.SIGTERM, before or signal.SIG_DFL)
