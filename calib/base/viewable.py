"""Results with a picture and a page, which `calib.show` makes.

No file of this room may import `calib.show`, so the package `calib` registers the functions.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Viewable:
    """A result with a picture, made by ``views["plot"]``, and HTML, made by ``views["page"]``."""

    views: ClassVar[dict[str, Callable[["Viewable"], Any]]] = {}

    def plot(self) -> "Figure":
        """Return the picture of the result, as `brake-cal plot` draws it."""
        figure: Figure = self.views["plot"](self)
        return figure

    def _repr_html_(self) -> str:  # a notebook shows the result with it
        return str(self.views["page"](self))
