"""The effects of a car as one value: named effects with their parameters, and empirical terms.

Plain data: the equations are in the files of the links, in `empirical` and in `combined`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Self

_ByParameter = Mapping[str, Mapping[str, float]]


@dataclass(frozen=True)
class EmpiricalTerm:
    """An effect of unknown cause, over one driver: ``values`` [1] at ``knots`` of the driver.

    Piecewise linear, and constant beyond the outer knots. ``place`` and ``driver`` as in
    `calib.car.effects.empirical`. On brakes a value is the factor on the brake torque less one; on
    wheels and body a force at the road over the weight, positive when it slows.
    """

    place: str
    driver: str
    knots: tuple[float, ...]
    values: tuple[float, ...]

    @property
    def on_brakes(self) -> bool:
        """Whether the values are for a brake torque, not for a force at the road."""
        return self.place.endswith("brakes")


@dataclass(frozen=True)
class DefinedIn:
    """The Python file of an effect of the user: its name without folder, and SHA-256 or ""."""

    file: str
    sha256: str = ""


@dataclass(frozen=True)
class Effects:
    """The effects that act in a car in addition to the paper's model.

    ``parameters`` of the named effects [SI]; ``terms`` empirical terms, whose cause is not known;
    ``sigma`` one standard deviation of each parameter [SI], only where it is known;
    ``user_defined`` effects of the user by name, whether they act or not: a `DefinedIn`, or an
    `OwnEffect` of `calib.car.effects.catalogue` where the file was given.
    """

    parameters: _ByParameter = field(default_factory=dict)
    terms: tuple[EmpiricalTerm, ...] = ()
    sigma: _ByParameter = field(default_factory=dict)
    user_defined: Mapping[str, DefinedIn] = field(default_factory=dict)

    def __hash__(self) -> int:
        """By the names: the parameters are mappings."""
        return hash(frozenset(self.parameters))

    def __bool__(self) -> bool:
        """Whether there is any effect."""
        return bool(self.parameters or self.terms)

    def __contains__(self, name: str) -> bool:
        """Whether there is a named effect of that name."""
        return name in self.parameters

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects in their order; an empirical term has none."""
        return tuple(self.parameters)

    @property
    def defined_in(self) -> dict[str, DefinedIn]:
        """Where the acting effects of the user are defined."""
        acting = {n: x for n, x in self.user_defined.items() if n in self.parameters}
        return {name: DefinedIn(x.file, x.sha256) for name, x in acting.items()}

    @property
    def described(self) -> tuple[str, ...]:
        """Every effect in words, the empirical terms last."""
        terms = (f"an empirical term on {t.place} over {t.driver}" for t in self.terms)
        return (*self.parameters, *terms)

    def with_(self, other: Self) -> Self:
        """Both together; an effect that both have is taken from ``other``.

        Terms of ``other`` replace those here, since a term was fitted without another one.
        """
        own_sigma = self.without(*other.names).sigma
        return type(self)(
            {**self.parameters, **other.parameters},
            other.terms or self.terms,
            {**own_sigma, **other.sigma},
            {**self.user_defined, **other.user_defined},
        )

    def only(self, *names: str) -> Self:
        """The effects of these names, without the empirical terms."""
        parameters, sigma = (
            {name: own for name, own in values.items() if name in names}
            for values in (self.parameters, self.sigma)
        )
        return type(self)(parameters, (), sigma, self.user_defined)

    def without(self, *names: str) -> Self:
        """All but the effects of these names; the empirical terms stay."""
        named = self.only(*(name for name in self.parameters if name not in names))
        return replace(named, terms=self.terms)
