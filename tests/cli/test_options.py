"""A record of options as one parameter of a command."""

from dataclasses import dataclass
from inspect import signature
from typing import Annotated

import pytest
import typer
from typer.testing import CliRunner

from cli.options import grouped


@dataclass(frozen=True)
class Place:
    """Where it is."""

    town: Annotated[str, typer.Option("--town", help="Name of the town.")] = "Ulm"
    number: Annotated[int | None, typer.Option("--no", help="Number of the house.")] = None


@grouped
def visit(
    who: Annotated[str, typer.Argument(help="Who goes.")],
    *,
    first: bool = False,
    place: Place,
    last: Annotated[str, typer.Option(help="Said at the end.")] = "bye",
) -> None:
    """Say who goes where."""
    typer.echo(f"{who} {first} {place} {last}")


@pytest.fixture
def run():
    app = typer.Typer(rich_markup_mode=None, add_completion=False)
    app.command()(visit)
    return lambda *words: CliRunner().invoke(app, words)


@pytest.mark.parametrize(
    ("words", "place"),
    [
        ((), Place()),
        (("--town", "Bonn"), Place("Bonn")),
        (("--no", "7", "--town", "Bonn"), Place("Bonn", 7)),
    ],
)
def test_the_command_gets_the_record(run, words, place):
    assert run("Ann", *words, "--first").output == f"Ann True {place} bye\n"


def test_its_options_stand_where_the_record_stood(run):
    text = run("--help").output
    places = [text.index(option) for option in ("--first", "--town", "--no ", "--last")]
    assert places == sorted(places)
    assert "Say who goes where." in text
    assert "[default: Ulm]" in text
    assert list(signature(visit).parameters) == ["who", "first", "town", "number", "last"]


def test_a_value_of_another_kind_is_a_usage_error(run):
    ran = run("Ann", "--no", "seven")
    assert ran.exit_code == 2
    assert "--no" in ran.output
