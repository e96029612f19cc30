"""Optional input files of commands, and checks of names."""

import math
from collections.abc import Collection, Sequence
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from calib.car.vehicle import Vehicle
    from calib.estimation.limits import Limit
    from calib.logs.channel_map import ChannelMap
    from calib.store.version import Stored


def require_day(written: str | None, option: str) -> None:
    """Refuse what is written as a day and is none."""
    if written is None:
        return
    try:
        date.fromisoformat(written)
    except ValueError:
        raise typer.BadParameter(
            f"{written!r} is not a date such as 2025-03-31", param_hint=option
        ) from None


def channel_map_of(path: Path | None) -> "ChannelMap | None":
    """The channel map of ``--map``, read once for all logs."""
    from calib.logs.channel_map_file import read_channel_map

    return read_channel_map(path) if path else None


def vehicle_of(path: Path | None) -> "Vehicle | None":
    """The vehicle of an optional ``--vehicle``."""
    from calib.car.vehicle_file import read_vehicle

    return read_vehicle(path) if path else None


def with_own_effects(car: "Vehicle", files: list[Path] | None) -> "Vehicle":
    """The car with the effects of ``--effect``, whose files are executed."""
    from calib.car.own_effects.own_effect import with_own
    from calib.car.own_effects.read import read_own_effects

    return with_own(car, read_own_effects(files)) if files else car


def tables_of(store: Path, references: Sequence[str]) -> "tuple[Stored, ...]":
    """The tables to look at; says which versions they are, and in which state."""
    import calib
    from cli.console import say

    found = tuple(calib.Store(store).load(reference) for reference in references)
    for one in found:
        say(f"{one.id} is {one.state.words}")
    return found


def golden_of(store: Path, reference: str) -> "Stored":
    """The table by which others are measured: released, or a draft that is named by its version."""
    import calib
    from calib.base.errors import StoreError
    from cli.console import say

    found = calib.Store(store).released(reference)
    if not found.state.released:
        say(f"{found.id} is {found.state.words}")
    if not (found.state.usable and found.state.known):
        raise StoreError(
            f"is {found.state.words}; no car is measured by it",
            where=found.id,
            expected="a released version",
        )
    return found


def tell_kin(store: Path, stored: "Stored") -> None:
    """Say which rejected and withdrawn versions are made of the same ramp."""
    import calib
    from calib.store.kin import refused_kin
    from cli.console import say

    for other in refused_kin(calib.Store(store), stored):
        say(f"note: {stored.id} has a ramp of {other.id}, which is {other.state.words}")


def tell_newest(store: Path, stored: "Stored") -> None:
    """Say that a bare name means a new version from now on, where its fit has warnings."""
    import calib
    from cli.console import say

    journal = calib.Store(store).journal(stored.name)
    before = [v for v in journal.of(stored.name) if v < stored.version]
    usable = [v for v in before if journal.state(stored.name, v).usable]
    if usable and stored.table.warnings and not stored.existed:
        say(
            f"note: {stored.name} without a number means {stored.id} from now on, and its fit has "
            f"warnings; if it is a mistake, `brake-cal tables reject {stored.id} --reason ...`: "
            f"then {stored.name} is {stored.name}@{max(usable)} again"
        )


def quantity_of(written: str, si: str, option: str) -> float:
    """A quantity of an option in SI, written as in a vehicle file; else a usage error."""
    from calib.base.errors import InputError
    from calib.base.toml import quantity

    try:
        return quantity(written, si, None, InputError)
    except InputError as error:
        raise typer.BadParameter(str(error), param_hint=option) from None


def seconds_of(written: str | None, option: str) -> float | None:
    """A time of an optional option [s]: a quantity, or a plain number of seconds."""
    if written is None:
        return None
    try:
        plain = float(written)
    except ValueError:
        return quantity_of(written, "s", option)
    if not math.isfinite(plain):
        raise typer.BadParameter(
            f'{written!r} is not finite; expected a time such as "1.5 s"', param_hint=option
        )
    return plain


def mass_of(written: str | None) -> float | None:
    """The mass [kg] of an optional ``--mass``, within what a vehicle file may say."""
    if written is None:
        return None
    from calib.car.mass import LEAST, MOST

    mass = quantity_of(written, "kg", "--mass")
    if not LEAST <= mass <= MOST:
        raise typer.BadParameter(
            f"{mass:g} kg is not believable; expected {LEAST:g} to {MOST:g} kg", param_hint="--mass"
        )
    return mass


def limits_of_stops(path: Path | None) -> "tuple[Limit, ...]":
    """The limits of a file for single stops; the default limits without a file."""
    from calib.base.errors import LimitsError
    from calib.estimation.limits import DEFAULTS
    from calib.estimation.metrics import METRICS

    if path is None:
        return DEFAULTS
    limits = tuple(limit for limit in _limits(path) if limit.figure in METRICS)
    if not limits:
        raise LimitsError(
            "no limit for a stop", where=path, do="judge the car with `brake-cal station`"
        )
    return limits


def limits_of_car(path: Path | None) -> "tuple[Limit, ...]":
    """The limits of a file for a car and its stops; the default limits without a file."""
    from calib.line.station.limits_file import LIMITS

    return _limits(path) if path else LIMITS


def _limits(path: Path) -> "tuple[Limit, ...]":
    from calib.estimation.limits_file import read_limits
    from calib.estimation.metrics import METRICS as OF_STOPS
    from calib.line.station.metrics import METRICS as OF_CAR

    return read_limits(path, {*OF_STOPS, *OF_CAR})


def unknown_format(form: str, name: str, known: Collection[str], option: str) -> typer.BadParameter:
    """The error for an unknown export format; ``name`` is ``form`` in the case of ``known``."""
    from calib.base.toml import did_you_mean

    near = did_you_mean(name, known)
    what = f"unknown format {form!r}; {near} " if near else f"unknown format {form!r}; "
    return typer.BadParameter(f"{what}known: {', '.join(known)}", param_hint=option)
