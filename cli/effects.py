"""`brake-cal effects`: the effects of the catalogue, one line each, or the card of one."""

from typing import TYPE_CHECKING, Annotated

import typer

from cli.completion import names_of
from cli.console import emit, emit_json
from cli.grid import grid
from cli.options import Json, OwnEffects, example

if TYPE_CHECKING:
    from rich.table import Table as Grid

    from calib.car.effects.effect import Card, Parameter

EPILOG = example(
    "brake-cal effects",
    "brake-cal effects hydraulic_lag",
    "brake-cal effects air_brake_flap --effect sample_logs/own_effect/air_brake_flap.py",
)


def effects(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="NAME",
            help="One effect; if not given, all.",
            autocompletion=names_of("calib.car.effects.catalogue", "CATALOGUE"),
        ),
    ] = None,
    effect: OwnEffects = None,
    json: Json = False,
) -> None:
    """List the effects that a model can have.

    With a NAME its card is printed. With --effect the file is checked, and its effect is among
    them.
    """
    from calib.car.effects.catalogue import CATALOGUE
    from calib.car.own_effects.read import read_own_effects

    known = {**CATALOGUE, **{one.name: one.effect for one in read_own_effects(effect or [])}}
    if name is not None and name not in known:
        from calib.base.toml import did_you_mean

        hint = did_you_mean(name, known) or "'brake-cal effects' lists the known ones"
        raise typer.BadParameter(f"unknown effect {name!r}; {hint}", param_hint="NAME")
    cards = [e.card for n, e in known.items() if name in (None, n)]
    if json:
        emit_json({"schema": 1, "effects": cards})
    elif name is None:
        emit(_list(cards))
    else:
        emit(_card(cards[0]))


def _list(cards: "list[Card]") -> "Grid":
    table = grid("effect", "cause", fold=True)
    table.columns[0].no_wrap = True
    for card in cards:
        table.add_row(card.name, card.cause)
    return table


def _card(card: "Card") -> str:
    lines = [
        ("effect", card.name),
        ("cause", card.cause),
        ("equation", card.equation),
        ("source", card.source),
        ("looks like", card.looks_like),
        *((p.name, _range(p)) for p in card.parameters),
    ]
    width = max(len(head) for head, _ in lines)
    return "\n".join(f"{head:<{width}}  {text}" for head, text in lines)


def _range(p: "Parameter") -> str:
    from calib.base.units import behind

    unit = behind(p.unit)
    typical = f"{p.typical:g} +- {p.spread:g}{unit}"
    return f"{typical}, from {p.low:g} to {p.high:g}{unit}"
