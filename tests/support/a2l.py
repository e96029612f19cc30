"""Objects of an A2L file, decoded from the memory of a program; a2ltool judges its grammar."""

import itertools
import math
import re
import struct
from dataclasses import dataclass, field

TYPES = {"SBYTE": "b", "SWORD": "h", "SLONG": "i", "FLOAT32_IEEE": "f", "FLOAT64_IEEE": "d"}
AXES = {"VALUE": 0, "CURVE": 1, "MAP": 2, "CUBOID": 3}


@dataclass
class Block:
    """What stands between /begin and /end: ``kind``, its words, and the blocks in it."""

    kind: str
    words: list[str] = field(default_factory=list)
    inside: list["Block"] = field(default_factory=list)

    def all(self, *kinds):
        return [b for b in self.inside if b.kind in kinds]

    def only(self, kind):
        (element,) = self.all(kind)
        return element

    def named(self, kind):
        by_name = {b.words[0]: b for b in self.all(kind)}
        assert len(by_name) == len(self.all(kind)), f"two of one name: {kind}"
        return by_name

    def after(self, keyword, count=1):
        """The parameters of a keyword."""
        place = self.words.index(keyword) + 1
        return self.words[place : place + count]


def without_epk(a2l):
    """An A2L without what debug information does not tell."""
    return re.sub(r"/begin MOD_PAR.*?/end MOD_PAR", "", a2l, flags=re.DOTALL)


def read_a2l(content):
    """The PROJECT of a file."""
    text = re.sub(r"/\*.*?\*/", " ", content.decode("utf-8-sig"), flags=re.DOTALL)
    file = Block("file")
    open_blocks = [file]
    words = iter(re.findall(r'"[^"\\]*"|[^\s"]+', text))
    for word in words:
        if word == "/begin":
            open_blocks[-1].inside.append(Block(next(words)))
            open_blocks.append(open_blocks[-1].inside[-1])
        elif word == "/end":
            assert next(words) == open_blocks.pop().kind
        else:
            open_blocks[-1].words.append(word)
    assert (open_blocks, file.words) == ([file], ["ASAP2_VERSION", "1", "71"])
    return file.only("PROJECT")


def objects(module):
    """Axes and characteristics as name: (address, layout, method, limits, axis blocks, X first).

    An axis is its own axis.
    """
    by_name = {}
    for b in module.all("AXIS_PTS"):
        name, _, address, _, layout, _, method, _, low, high = b.words[:10]
        by_name[name] = (int(address, 0), layout, method, (float(low), float(high)), [b])
    axes = module.named("AXIS_PTS")
    for b in module.all("CHARACTERISTIC"):
        name, _, kind, address, layout, _, method, low, high = b.words[:9]
        over = b.all("AXIS_DESCR")
        assert len(over) == AXES[kind]
        named = [axes[one.after("AXIS_PTS_REF")[0]] for one in over]
        assert [one.words[3] for one in over] == [axis.words[7] for axis in named]
        by_name[name] = (int(address, 0), layout, method, (float(low), float(high)), named)
    return by_name


def decoded(module, memory):
    """Values of every object by name; ``memory(address, size)`` gives the bytes of the program.

    Those of a map are in the order in which they lie there.
    """
    order = {"MSB_LAST": "<", "MSB_FIRST": ">"}[module.only("MOD_COMMON").after("BYTE_ORDER")[0]]
    layouts, methods = module.named("RECORD_LAYOUT"), module.named("COMPU_METHOD")
    values = {}
    for name, (address, layout, method, _, axes) in objects(module).items():
        _, _, position, kind, _, how = layouts[layout].words
        assert (position, how) == ("1", "DIRECT")
        form = f"{order}{math.prod(int(axis.words[7]) for axis in axes)}{TYPES[kind]}"
        raw = struct.unpack(form, memory(address, struct.calcsize(form)))
        conversion = methods[method]
        if conversion.words[2] == "IDENTICAL":
            values[name] = list(raw)
        else:
            a, b = map(float, conversion.after("COEFFS_LINEAR", 2))
            values[name] = [a * v + b for v in raw]
    return values


def cells(module, memory, name):
    """Values of a map by their place (x, y) or (x, y, z), X the first axis that it describes."""
    values = decoded(module, memory)
    _, layout, _, _, axes = objects(module)[name]
    assert module.named("RECORD_LAYOUT")[layout].words[4] == "ROW_DIR"  # X runs fastest
    places = itertools.product(*(values[axis.words[0]] for axis in reversed(axes)))
    return {place[::-1]: value for place, value in zip(places, values[name], strict=True)}
