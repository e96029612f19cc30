"""How much a run of the program says, and whether its JSON document was printed."""

from contextvars import ContextVar
from dataclasses import dataclass
from typing import Annotated, Any

import typer
import typer.main


@dataclass
class CommandRun:
    """One run of the program: ``quiet`` of -q, ``verbose`` of -v, ``documents`` on stdout."""

    quiet: bool = False
    verbose: bool = False
    documents: int = 0


_RUN: ContextVar[CommandRun] = ContextVar("run")


def begin() -> CommandRun:
    """Begin a run: nothing is asked for, nothing is printed."""
    _RUN.set(CommandRun())
    return _RUN.get()


def this_run() -> CommandRun:
    """The run that goes on; one that asks for nothing where none was begun."""
    return _RUN.get(CommandRun())


def loudness_options() -> list[Any]:
    """The options -q and -v, as every command and every group of commands has them."""
    app = typer.Typer(add_completion=False)
    app.command()(_options)
    return list(typer.main.get_command(app).params)


def _ask(context: typer.Context, option: typer.CallbackParam, given: bool) -> None:
    if not given or context.resilient_parsing:
        return
    run = this_run()
    setattr(run, str(option.name), True)
    if run.quiet and run.verbose:
        raise typer.BadParameter(
            "-q and -v exclude each other", param_hint=["--quiet", "--verbose"]
        )


def _options(
    quiet: Annotated[
        bool,
        typer.Option(
            "--quiet",
            "-q",
            callback=_ask,
            expose_value=False,
            help="Print only results, warnings and errors.",
        ),
    ] = False,
    verbose: Annotated[
        bool,
        typer.Option(
            "--verbose",
            "-v",
            callback=_ask,
            expose_value=False,
            help="Print details, too.",
        ),
    ] = False,
) -> None:
    """Hold the two options."""
