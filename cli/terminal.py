"""A terminal that shows text and obeys none of it: rich's console with safe strings.

Imports rich, so it is imported only where something is drawn.
"""

from typing import Any

from rich.console import Console
from rich.text import Text

from calib.base.printable import printable

KEPT = "\n\t"
"""Control characters of our own layout."""


class SafeConsole(Console):
    """Escapes what a terminal would obey in every string, also in the cells of a grid."""

    def render_str(self, text: str, **options: Any) -> Text:
        """Render a string; rich calls this for every string that it draws."""
        return super().render_str(printable(text, KEPT), **options)


def safe_text(text: str, style: str = "") -> Text:
    """Text of a style in which control characters are escaped."""
    return Text(printable(text, KEPT), style=style)
