"""A car that could not be judged: who it was and why, for the index of the line.

DIR/refused.json says so. It holds no verdict and no number, so nobody takes it for a result. The
files of an earlier run in DIR stay; the next run that ends with a verdict removes it.
"""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from calib.base.errors import BrakeCalError
from calib.base.printable import printable
from calib.base.program import PROGRAM
from calib.base.publish import publish, workshop
from calib.base.write import write_whole
from calib.line.station.folder import REFUSED
from calib.line.station.identity import Identity

SCHEMA = 1


def to_dict(error: BrakeCalError, identity: Identity, logs: Sequence[Path]) -> dict[str, Any]:
    """The document as plain data; ``logs`` as they were given."""
    return {
        "schema": SCHEMA,
        "identity": identity.given(),
        "logs": [printable(log.name) for log in logs],
        "program": PROGRAM,
        "error": error.to_dict(),
    }


def write_refusal(
    error: BrakeCalError, identity: Identity, logs: Sequence[Path], out: Path
) -> None:
    """Write `REFUSED` into the folder ``out``, whole or not at all. Raises OSError."""
    text = json.dumps(to_dict(error, identity, logs), indent=2) + "\n"
    with workshop(out) as work:
        write_whole(work / REFUSED, text.encode())
        publish(work, out, REFUSED)
