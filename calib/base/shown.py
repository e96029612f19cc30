"""Results that draw themselves, by functions of higher rooms that `calib` registers here."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Shown:
    """A result with a picture and a page; ``views`` make the figure ("plot") and HTML ("page")."""

    views: ClassVar[dict[str, Callable[["Shown"], Any]]] = {}

    def plot(self) -> "Figure":
        """Return the picture of the result, as `brake-cal plot` draws it."""
        figure: Figure = self.views["plot"](self)
        return figure

    def _repr_html_(self) -> str:
        return str(self.views["page"](self))
