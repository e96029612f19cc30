"""The effects of a car as data: named effects with their parameters, and empirical terms.

An effect is something physical in addition to the paper's model, such as air drag. Equations of
effects are in `body`, `hydraulics`, `pads` and `wheels`, those of terms in `empirical`; `combined`
applies them together.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Self

_ByEffect = Mapping[str, Mapping[str, float]]  # numbers by effect and parameter


@dataclass(frozen=True)
class EmpiricalTerm:
    """An effect of unknown cause that depends on one quantity of the run, its ``driver``.

    The effect has ``values`` [1] at ``knots`` [SI unit of the driver], is linear between knots and
    constant beyond the outer knots. At a ``place`` on brakes, a value is the factor on the brake
    torque, less one. On wheels and body, a value is a force at the road over the weight, positive
    when it slows the car. `calib.car.effects.empirical` lists places and drivers.
    """

    place: str
    driver: str
    knots: tuple[float, ...]
    values: tuple[float, ...]

    @property
    def on_brakes(self) -> bool:
        """Whether the values change a brake torque; otherwise they are forces at the road."""
        return self.place.endswith("brakes")


@dataclass(frozen=True)
class DefinedIn:
    """Name and digest of the Python file that defines an effect of the user."""

    file: str  # name without folder
    sha256: str = ""


@dataclass(frozen=True)
class Effects:
    """The effects that act in a car in addition to the paper's model.

    ``user_defined`` has the effects of the user by name, whether they act or not. If the file of an
    effect was read, it is an `OwnEffect` of `calib.car.effects.catalogue`, which has the equations;
    otherwise it is a `DefinedIn`, which only names the file.
    """

    parameters: _ByEffect = field(default_factory=dict)  # values [SI]
    terms: tuple[EmpiricalTerm, ...] = ()
    sigma: _ByEffect = field(default_factory=dict)  # standard deviations [SI], where known
    user_defined: Mapping[str, DefinedIn] = field(default_factory=dict)

    def __hash__(self) -> int:
        """Return a hash of the names, since mappings of parameters have none."""
        return hash(frozenset(self.parameters))

    def __bool__(self) -> bool:
        """Whether any effect or term acts."""
        return bool(self.parameters or self.terms)

    def __contains__(self, name: str) -> bool:
        """Whether the effect of that name acts."""
        return name in self.parameters

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects in their order; an empirical term has none."""
        return tuple(self.parameters)

    @property
    def defined_in(self) -> dict[str, DefinedIn]:
        """The files of those effects of the user that act, by name of the effect."""
        return {
            name: DefinedIn(effect.file, effect.sha256)
            for name, effect in self.user_defined.items()
            if name in self.parameters
        }

    @property
    def described(self) -> tuple[str, ...]:
        """Names of the effects, then the empirical terms in words."""
        terms = (f"an empirical term on {t.place} over {t.driver}" for t in self.terms)
        return (*self.parameters, *terms)

    def with_(self, other: Self) -> Self:
        """Return the effects of both; an effect of ``other`` replaces the one of that name here.

        Any terms of ``other`` replace all terms here, since terms are fitted without others.
        """
        own_sigma = self.without(*other.names).sigma
        return type(self)(
            {**self.parameters, **other.parameters},
            other.terms or self.terms,
            {**own_sigma, **other.sigma},
            {**self.user_defined, **other.user_defined},
        )

    def only(self, *names: str) -> Self:
        """Return the effects of these names, without the empirical terms."""
        parameters = {name: x for name, x in self.parameters.items() if name in names}
        sigma = {name: x for name, x in self.sigma.items() if name in names}
        return type(self)(parameters, (), sigma, self.user_defined)

    def without(self, *names: str) -> Self:
        """Return all effects but those of these names; the empirical terms stay."""
        named = self.only(*(name for name in self.parameters if name not in names))
        return replace(named, terms=self.terms)
