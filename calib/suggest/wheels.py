"""Find the four columns of the wheel speeds, and of the wheel pressures."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.base.names import WHEELS
from calib.base.units import is_unit, to_si
from calib.logs.channel_map import Mapping
from calib.suggest.physics import together
from calib.suggest.proposal import SURE, Doubt, Proposal
from calib.suggest.series import Series
from calib.suggest.words import loose_corner

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Wheels:
    """Proposals, doubts, and the mean wheel speed in its own unit.

    ``angular`` is true if that unit is rad/s.
    """

    proposals: tuple[Proposal, ...] = ()
    doubts: tuple[Doubt, ...] = ()
    mean: Array | None = None
    angular: bool = False
    refused: tuple[tuple[str, str], ...] = ()


def groups(series: list[Series], *quantities: str | None) -> list[dict[str, Series]]:
    """Sets of four columns of the given quantities, one for each wheel."""
    found: dict[tuple[str, str | None], dict[str, Series]] = {}
    for item in series:
        wheel, rest = loose_corner(item.name)
        if wheel and item.si in quantities:
            found.setdefault((rest, item.si), {}).setdefault(wheel, item)
    return [four for four in found.values() if len(four) == 4]


def find_wheels(series: list[Series], radius: float | None) -> Wheels:
    """Find the wheel speeds: named for the four wheels, similar, with a unit.

    Speeds at the rim (km/h) need the ``radius`` [m] with which the car computed them.
    """
    good, refused = [], []
    for four in groups(series, "rad/s", "m/s", None):
        if together([four[w].values for w in WHEELS]):
            good.append(four)
        elif next(iter(four.values())).si is not None:
            refused += [
                (s.name, "does not agree with the other three wheels") for s in four.values()
            ]
    angular = [four for four in good if four["fl"].si == "rad/s"]
    fit = [four for four in angular if four["fl"].name == "omega_fl"] or angular or good
    if not fit:
        return Wheels(refused=tuple(refused))
    if len(fit) > 1:
        names = tuple(" ".join(four[w].name for w in WHEELS) for four in fit)
        do = "choose one: --take omega_fl=NAME, and the same for the others"
        return Wheels(doubts=(Doubt("omega_fl ... omega_rr", names, "several sets of four", do),))
    return replace(_of(fit[0], radius), refused=tuple(refused))


def rim_mapping(
    channel: str, source: str, unit: str | None, radius: float | None
) -> Mapping | None:
    """The mapping of a wheel speed that is written as a speed at the rim.

    None for another channel, a unit that is not one of speed, or without the ``radius`` [m].
    """
    wheel = channel.startswith("omega_") and radius is not None
    if not wheel or unit is None or radius is None or not is_unit(unit, "m/s"):
        return None
    return Mapping(source, "rad/s", scale=to_si(1.0, unit, "m/s") / radius)


def rim_reason(radius: float) -> str:
    """How a speed at the rim became a wheel speed, in words."""
    return f"divided by the given radius of {radius:g} m"


def _of(four: dict[str, Series], radius: float | None) -> Wheels:
    mean = np.mean([four[w].values for w in WHEELS], axis=0)
    names = tuple(four[w].name for w in WHEELS)
    unit, kind = four["fl"].column.unit, four["fl"].si
    reasons: tuple[str, ...] = ("name", f"unit {unit}", "the four wheels agree")
    if kind is None:
        do = "give it: --take 'omega_fl=NAME [rad/s]', and the same for the others"
        doubt = Doubt("omega_fl ... omega_rr", names, "the file gives no unit", do)
        return Wheels(doubts=(doubt,), mean=mean)
    if kind == "rad/s":
        found = [Proposal(f"omega_{w}", Mapping(four[w].name), SURE, reasons) for w in WHEELS]
        return Wheels(tuple(found), (), mean, True)
    if radius is None:
        do = "give the radius with which the car computes them: --radius 0.31"
        why = f"speeds at the rim, in {unit}, need a radius to become wheel speeds"
        return Wheels(doubts=(Doubt("omega_fl ... omega_rr", names, why, do),), mean=mean)
    reasons = (*reasons, rim_reason(radius))
    mappings = {w: rim_mapping(f"omega_{w}", four[w].name, unit, radius) for w in WHEELS}
    found = [Proposal(f"omega_{w}", m, SURE, reasons) for w, m in mappings.items() if m]
    return Wheels(tuple(found), (), mean / radius, True)
