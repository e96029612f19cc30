"""A strict reader of A2L, written from the parameters that ASAM MCD-2 MC 1.7.1 gives each keyword.

It knows the keywords below and no others, and decodes objects from the memory of a program.
"""

import re
import struct
from dataclasses import dataclass, field

TOKEN = re.compile(r'\s*("[^"\\]*"|[^\s"]+)')

FIXED = {
    "PROJECT": 2, "HEADER": 1, "MODULE": 2, "MOD_COMMON": 1, "RECORD_LAYOUT": 1, "COMPU_METHOD": 5,
    "AXIS_PTS": 10, "CHARACTERISTIC": 9, "AXIS_DESCR": 6, "FUNCTION": 2, "DEF_CHARACTERISTIC": 0,
}  # fmt: skip
"""Number of parameters of a block before its keywords."""

KEYWORDS = {
    "HEADER": {"VERSION": 1},
    "MOD_COMMON": {"BYTE_ORDER": 1, "DEPOSIT": 1},
    "RECORD_LAYOUT": {"AXIS_PTS_X": 4, "FNC_VALUES": 4},
    "COMPU_METHOD": {"COEFFS_LINEAR": 2},
    "AXIS_PTS": {"DEPOSIT": 1, "MONOTONY": 1, "EXTENDED_LIMITS": 2, "SYMBOL_LINK": 2},
    "CHARACTERISTIC": {"EXTENDED_LIMITS": 2, "SYMBOL_LINK": 2},
    "AXIS_DESCR": {"AXIS_PTS_REF": 1},
    "FUNCTION": {"FUNCTION_VERSION": 1},
}
"""Keywords of a block with the number of their parameters."""

TYPES = {"SBYTE": "b", "SWORD": "h", "SLONG": "i", "FLOAT64_IEEE": "d"}


@dataclass
class Block:
    kind: str
    given: list[str] = field(default_factory=list)
    words: dict[str, list[str]] = field(default_factory=dict)
    inside: list["Block"] = field(default_factory=list)

    def all(self, *kinds):
        return [b for b in self.inside if b.kind in kinds]

    def one(self, kind):
        (found,) = self.all(kind)
        return found

    def named(self, kind):
        found = {b.given[0]: b for b in self.all(kind)}
        assert len(found) == len(self.all(kind)), f"two of one name: {kind}"
        return found


def read_a2l(content):
    """The PROJECT of a file; asserts that each block has what the standard asks for."""
    text = content.decode("utf-8-sig")
    assert text.isascii() or content.startswith(b"\xef\xbb\xbf")
    tokens = TOKEN.findall(re.sub(r"/\*.*?\*/", " ", text, flags=re.DOTALL))
    assert tokens[:3] == ["ASAP2_VERSION", "1", "71"]
    project, rest = _block(tokens[3:])
    assert rest == []
    return project


def _block(tokens):
    assert tokens[0] == "/begin"
    block, count = Block(tokens[1]), FIXED[tokens[1]]
    block.given, tokens = tokens[2 : 2 + count], tokens[2 + count :]
    while tokens[0] != "/end":
        if tokens[0] == "/begin":
            inner, tokens = _block(tokens)
            block.inside.append(inner)
        elif block.kind == "DEF_CHARACTERISTIC":
            block.given.append(tokens.pop(0))
        else:
            size = KEYWORDS[block.kind][tokens[0]]
            assert tokens[0] not in block.words
            block.words[tokens[0]], tokens = tokens[1 : 1 + size], tokens[1 + size :]
    assert tokens[1] == block.kind
    return block, tokens[2:]


def objects(module):
    """Axes and characteristics as name: (address, layout, method, limits, axis block or None)."""
    found = {}
    for b in module.all("AXIS_PTS"):
        name, _, at, _, layout, _, method, _, low, high = b.given
        found[name] = (int(at, 0), layout, method, (float(low), float(high)), b)
    axes = module.named("AXIS_PTS")
    for b in module.all("CHARACTERISTIC"):
        name, _, kind, at, layout, _, method, low, high = b.given
        over = b.all("AXIS_DESCR")
        assert (kind, len(over)) in (("CURVE", 1), ("VALUE", 0))
        axis = axes[over[0].words["AXIS_PTS_REF"][0]] if over else None
        found[name] = (int(at, 0), layout, method, (float(low), float(high)), axis)
    return found


def decoded(module, memory):
    """Values of every object by name; ``memory(address, size)`` gives the bytes of the program."""
    order = {"MSB_LAST": "<", "MSB_FIRST": ">"}[module.one("MOD_COMMON").words["BYTE_ORDER"][0]]
    layouts, methods = module.named("RECORD_LAYOUT"), module.named("COMPU_METHOD")
    found = {}
    for name, (at, layout, method, _, axis) in objects(module).items():
        ((position, kind, _, how),) = layouts[layout].words.values()
        assert (position, how) == ("1", "DIRECT")
        count = 1 if axis is None else int(axis.given[7])
        form = f"{order}{count}{TYPES[kind]}"
        raw = struct.unpack(form, memory(at, struct.calcsize(form)))
        conversion = methods[method]
        if conversion.given[2] == "IDENTICAL":
            found[name] = list(raw)
        else:
            assert conversion.given[2] == "LINEAR"
            a, b = map(float, conversion.words["COEFFS_LINEAR"])
            found[name] = [a * v + b for v in raw]
    return found
