"""The file of what was seen of stores, see `calib.store.seen`."""

from typing import Annotated

from pydantic import Field

from calib.base.record import FileSchema, Section

Hash = Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]


class SightSection(Section):
    """One store, seen in one place with one key."""

    key: str
    store: Hash
    place: str
    head: Hash
    lines: Annotated[int, Field(ge=1)]


class SeenFile(FileSchema):
    """All that was seen."""

    seen: tuple[SightSection, ...]
