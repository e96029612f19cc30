"""Log of candump (``candump -L``), read with python-can.

(1436509052.249713) vcan0 044#2A366C2BBA
(1436509052.449847) vcan0 0F6##1112233         two #: CAN FD, then one digit of flags
"""

import re
from pathlib import Path

from calib.logs.bus.databases import Databases
from calib.logs.bus.recording import recording, require_dbc
from calib.logs.bus.text_log import Counted
from calib.logs.extra import need
from calib.logs.recording import Recording

FRAME = re.compile(r"\s*\(\d+\.\d+\)\s")

EXAMPLE = "a frame of `candump -L`, such as '(1436509052.249713) can0 044#2A366C2BBA'"

NO_FOOTER = "candump writes no footer: a log cut at the end of a line looks like a complete one"


def open_candump(path: Path, dbc: Databases) -> Recording:
    """Open a log of candump.

    The format has no count and no footer. Raises LogError for a last line that is cut off, for
    a line that is not a frame, if python-can or a DBC is missing, and if no frame is described by
    the DBC.
    """
    where = str(path)
    can = need("can", "can", where)
    known = require_dbc(dbc, "can", where)
    with path.open(encoding="utf-8", errors="replace") as file:
        lines = Counted(file, FRAME, path, EXAMPLE)
        found = lines.gathered(can.CanutilsLogReader(lines), known)
    lines.require_all(found)
    return recording(found, known, (NO_FOOTER,), where)
