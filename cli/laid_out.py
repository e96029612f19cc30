"""Markdown laid out on a terminal, whose lines of code stay whole."""

from typing import ClassVar

from rich.console import Console, ConsoleOptions, RenderResult
from rich.markdown import CodeBlock, Markdown
from rich.text import Text

from calib.base.printable import printable


class WholeLines(CodeBlock):
    """A block of code; a line that is wider than the terminal is not broken, so it can be copied.

    The terminal itself wraps it on the screen.
    """

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Draw each line as it is."""
        for line in str(self.text).rstrip().splitlines():
            yield Text(f" {printable(line)}", style="markdown.code_block", overflow="ignore")


class LaidOut(Markdown):
    """Markdown with `WholeLines`."""

    elements: ClassVar = {**Markdown.elements, "fence": WholeLines, "code_block": WholeLines}
