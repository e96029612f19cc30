"""One run in the formats of recordings, written byte by byte without a library.

Sample i is taken at i times `STEP`, up to `LAST`. The wheels turn with 600 - 0.5 i rpm; every
second sample has 0.5 i psi, -0.001 i g and 90 - 0.05 i km/h. On the bus these are two messages of
raw integers, the pressure in the byte order of Motorola; MDF has floats, in one group for each.
"""

import struct
from collections.abc import Iterator, Sequence

STEP = 0.005
"""Time between two samples [s]."""
LAST = 300
"""Number of the last sample; the first is 0."""
BEGIN = 10.0
"""Time of the first frame [s]."""
WHEELS = ("omega_fl", "omega_fr", "omega_rl", "omega_rr")
SLOW = ("p_mc", "a_x", "v")
UNITS = {**dict.fromkeys(WHEELS, "rpm"), "p_mc": "psi", "a_x": "g", "v": "km/h"}

DBC = """VERSION ""
NS_ :
BS_:
BU_: ESP
BO_ 256 Wheels: 8 ESP
 SG_ omega_fl : 0|16@1+ (-0.5,600) [0|600] "rpm" ESP
 SG_ omega_fr : 16|16@1+ (-0.5,600) [0|600] "rpm" ESP
 SG_ omega_rl : 32|16@1+ (-0.5,600) [0|600] "rpm" ESP
 SG_ omega_rr : 48|16@1+ (-0.5,600) [0|600] "rpm" ESP
BO_ 512 Body: 8 ESP
 SG_ p_mc : 7|16@0+ (0.5,0) [0|500] "psi" ESP
 SG_ a_x : 16|16@1- (0.001,0) [-2|2] "g" ESP
 SG_ v : 32|16@1+ (-0.05,90) [0|90] "km/h" ESP
"""


def frames() -> Iterator[tuple[float, int, bytes]]:
    """Time [s], identifier and bytes of each frame."""
    for i in range(LAST + 1):
        time = BEGIN + i * STEP
        yield time, 256, struct.pack("<4H", i, i, i, i)
        if i % 2 == 0:
            yield time, 512, struct.pack(">H", i) + struct.pack("<hH2x", -i, i)


def candump() -> bytes:
    """A log of ``candump -L``."""
    rows = (f"({time:.6f}) can0 {number:03X}#{data.hex()}\n" for time, number, data in frames())
    return "".join(rows).encode()


def asc() -> bytes:
    """A log of Vector's ASC."""
    head = "date Mon Jan 6 10:00:00.000 am 2025\nbase hex  timestamps absolute\n"
    head += "internal events logged\nBegin Triggerblock Mon Jan 6 10:00:00.000 am 2025\n"
    rows = (
        f"{time:11.6f} 1  {number:X}             Rx   d {len(data)} {data.hex(' ')}\n"
        for time, number, data in frames()
    )
    return f"{head}{''.join(rows)}End TriggerBlock\n".encode()


def blf() -> bytes:
    """A log of Vector's BLF: all frames as objects of type 1 in one container that is not packed.

    An object begins with LOBJ, sizes of its header and of itself, and its type.
    """
    objects = [
        struct.pack("<4sHHLLLHHQ", b"LOBJ", 32, 1, 48, 1, 2, 0, 0, round(time * 1e9))
        + struct.pack("<HBBL8s", 1, 0, len(data), number, data)
        for time, number, data in frames()
    ]
    content = b"".join(objects)
    container = struct.pack("<4sHHLL", b"LOBJ", 16, 1, 32 + len(content), 10)
    container += struct.pack("<H6xL4x", 0, len(content)) + content
    head = struct.pack("<4sL8xQQLL64x", b"LOGG", 144, 144 + len(container), 144 + len(container),
                       len(objects), len(objects))  # fmt: skip
    return head.ljust(144, b"\0") + container


def mdf() -> bytes:
    """A measurement in ASAM MDF 4.10: a group with the wheels, a group with the others."""
    fast = [(BEGIN + i * STEP, *[600.0 - 0.5 * i] * 4) for i in range(LAST + 1)]
    slow = [(BEGIN + i * STEP, 0.5 * i, -0.001 * i, 90.0 - 0.05 * i) for i in range(0, LAST + 1, 2)]
    file = bytearray(struct.pack("<8s8s8s4xH30x4x", b"MDF     ", b"4.10    ", b"qualify ", 410))
    head = _block(file, "HD", [0] * 6, bytes(32))
    second = _group(file, SLOW, slow, 0)
    first = _group(file, WHEELS, fast, second)
    struct.pack_into("<Q", file, head + 24, first)
    return bytes(file)


def _block(file: bytearray, kind: str, links: list[int], content: bytes) -> int:
    """Append a block; returns where it begins."""
    place, size = len(file), 24 + 8 * len(links) + len(content)
    file += struct.pack(f"<4s4xQQ{len(links)}Q", f"##{kind}".encode(), size, len(links), *links)
    file += content + bytes(-len(content) % 8)
    return place


def _group(
    file: bytearray, names: tuple[str, ...], rows: Sequence[tuple[float, ...]], following: int
) -> int:
    """Append a data group of floats with time as its master; returns where it begins."""
    columns = [("time", "s"), *((name, UNITS[name]) for name in names)]
    channel = 0
    for place in reversed(range(len(columns))):
        texts = [_block(file, "TX", [], text.encode() + b"\0") for text in columns[place]]
        links = [channel, 0, texts[0], 0, 0, 0, texts[1], 0]
        master = place == 0  # type 2, and 1 for time
        content = struct.pack("<4BLLLL", 2 * master, master, 4, 0, 8 * place, 64, 0, 0)
        channel = _block(file, "CN", links, content + bytes(4 + 48))
    size = 8 * len(columns)
    counts = struct.pack("<QQHHLLL", 0, len(rows), 0, 0, 0, size, 0)
    group = _block(file, "CG", [0, channel, 0, 0, 0, 0], counts)
    values = b"".join(struct.pack(f"<{len(row)}d", *row) for row in rows)
    return _block(file, "DG", [following, group, _block(file, "DT", [], values), 0], bytes(8))
