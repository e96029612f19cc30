"""The Jinja templates from which the program makes its pages and export files."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jinja2 import Environment


def templates(room: str, *, markup: bool) -> "Environment":
    """Return the templates of the package ``room``; with ``markup``, all values are escaped.

    An unknown variable is an error. A line with only a tag of the template leaves no line.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    return Environment(
        loader=PackageLoader(room),
        autoescape=markup,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
