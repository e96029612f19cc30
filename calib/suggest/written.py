"""A suggestion as a channel map, and as lines of text."""

import json
from collections.abc import Iterator

from calib.suggest.proposal import Proposal, Suggestion


def to_toml(found: Suggestion) -> str:
    """The channel map, ready to be read; how sure each entry is stands in a comment."""
    lines = [f"# proposed from {_one_line(found.log)}", "schema = 1"]
    if found.ignore:
        lines.append(f"ignore = [{', '.join(_quoted(name) for name in found.ignore)}]")
    lines += [f"# {name}: {_one_line(why)}" for name, why in found.missing.items()]
    for proposal in found.proposals:
        lines += ["", *_entry(proposal)]
    return "\n".join(lines) + "\n"


def _entry(proposal: Proposal) -> Iterator[str]:
    mapping = proposal.mapping
    why = _one_line("; ".join(proposal.reasons))
    yield f"[channels.{proposal.channel}]  # {proposal.sure}: {why}"
    yield f"source = {_quoted(mapping.source)}"
    if mapping.unit is not None:
        yield f"unit = {_quoted(mapping.unit)}"
    if mapping.sign != 1:
        yield f"sign = {mapping.sign}"
    if mapping.scale != 1.0:
        yield f"scale = {mapping.scale!r}"


def _quoted(text: str) -> str:
    """A TOML basic string: what JSON escapes, TOML does in the same way; but also DEL."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _one_line(text: str) -> str:
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


def to_lines(found: Suggestion) -> Iterator[tuple[str, str]]:
    """Channel and what is said of it: proposals, doubts, what is missing, what is left."""
    for proposal in found.proposals:
        mapping = proposal.mapping
        extra = "" if mapping.sign == 1 else ", sign -1"
        extra += "" if mapping.scale == 1.0 else f", scale {mapping.scale:.6g}"
        extra += f" [{mapping.unit}]" if mapping.unit else ""
        yield (
            proposal.channel,
            f"{mapping.source}{extra} ({proposal.sure}: {'; '.join(proposal.reasons)})",
        )
    for doubt in found.doubts:
        names = ", ".join(doubt.candidates) or "none"
        yield doubt.channel, f"not certain: {doubt.why}; candidates: {names}; {doubt.do}"
    for name, why in found.missing.items():
        yield name, f"missing: {why}"
    for name, why in found.left.items():
        yield "left", f"{name}: {why}"
