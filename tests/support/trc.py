"""PEAK TRC by the maker's description, one line format for each version."""

from collections.abc import Iterable
from typing import Any

START = 45232.5
"""Start of the measurement [days since 1899-12-30]."""

HEADS = {
    "1.0": ";   Start time: 02.11.2023 12:00:00.000\n;---+-   ---+---  ----+---  +  -+ --\n",
    "1.1": f";$FILEVERSION=1.1\n;$STARTTIME={START}\n;\n",
    "1.3": f";$FILEVERSION=1.3\n;$STARTTIME={START}\n;\n",
    "2.0": f";$FILEVERSION=2.0\n;$STARTTIME={START}\n;$COLUMNS=N,O,T,I,d,l,D\n;\n",
    "2.1": f";$FILEVERSION=2.1\n;$STARTTIME={START}\n;$COLUMNS=N,O,T,B,I,d,R,L,D\n;\n",
}
LINES = {
    "1.0": "{number:6d}) {time:9.0f}  {id:>8}  {length}  {data}",
    "1.1": "{number:6d}) {time:11.1f}  Rx     {id:>8}  {length}  {data}",
    "1.3": "{number:6d}) {time:13.3f} 1  Rx    {id:>8} -  {length}    {data}",
    "2.0": "{number:7d} {time:13.3f} {kind} {id:>8} Rx {length:<2} {data}",
    "2.1": "{number:7d} {time:13.3f} {kind} 1  {id:>8} Rx -  {code:<4} {data}",
}
STATUS = {
    "1.0": "{number:6d}) {time:9.0f}  FFFFFFFF  4  00 00 00 08 -- -- -- -- BUSHEAVY",
    "1.1": "{number:6d}) {time:11.1f}  Warng  FFFFFFFF  4  00 00 00 08  BUSHEAVY",
    "1.3": "{number:6d}) {time:13.3f} 1  Warng FFFFFFFF -  4    00 00 00 08 BUSHEAVY",
    "2.0": "{number:7d} {time:13.3f} ST          Rx    00 00 00 08",
    "2.1": "{number:7d} {time:13.3f} ST 1         - Rx -  4    00 00 00 08",
}
CODES = {12: 9, 16: 10, 20: 11, 24: 12, 32: 13, 48: 14, 64: 15}


def trc(version: str, messages: Iterable[Any], status_after: int = 10) -> str:
    """The text of a file; frames of CAN FD only from version 2 on, a status in between."""
    rows, number = [], 0
    for message in messages:
        if message.is_fd and version < "2":
            continue
        number += 1
        rows.append(LINES[version].format(number=number, **_fields(message)))
        if number == status_after:
            number += 1
            rows.append(STATUS[version].format(number=number, **_fields(message)))
    return HEADS[version] + "\n".join(rows) + "\n"


def _fields(message: Any) -> dict[str, Any]:
    length = len(message.data)
    return {
        "time": 1000 * message.timestamp,
        "id": f"{message.arbitration_id:0{8 if message.is_extended_id else 4}X}",
        "kind": "FB" if message.is_fd else "DT",
        "length": length,
        "code": CODES.get(length, length),
        "data": " ".join(f"{byte:02X}" for byte in message.data),
    }
