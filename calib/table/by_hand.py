"""What a person set in a table."""

from dataclasses import dataclass


@dataclass(frozen=True)
class SetByHand:
    """``key`` that was set from ``old`` to ``new``, the ``reason``, and ``by`` whom; "" if unsaid.

    A key is `pad_friction_f`, `D[1.0025]`: a pad, or a curve in the row of an eta.
    """

    key: str
    old: float
    new: float
    reason: str
    by: str = ""

    def __str__(self) -> str:
        by = f", by {self.by}" if self.by else ""
        return f"{self.key} set by hand to {self.new:.6g} from {self.old:.6g}{by}: {self.reason}"
