"""Declare a command by a function: what it reads, what it writes, what it returns.

    @command("brake-cal fit ramp.csv --vehicle car.toml")
    def fit(logs: list[Path] = logs("Ramps."), *, vehicle: Car, store: Tables) -> Answer:

Options that commands share are types in `cli.options`, others are defaults; each says how what is
typed is converted. Every command has -q, -v and --json. Bad outputs are refused first.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields, is_dataclass
from functools import wraps
from inspect import Parameter, Signature, signature
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ForwardRef, NamedTuple, get_args, get_origin

import typer
from typer.core import TyperGroup

from cli.console import emit, emit_json, misuse, this_run, warn
from cli.options import from_settings, option
from cli.outputs import check_file, write_page

if TYPE_CHECKING:
    from calib.show.facts import Facts

FAILED, UNREADABLE, DAMAGED = 1, 3, 4
"""Exit codes of a result: it fails its limits; an input is no use; a table is damaged."""


@dataclass(frozen=True)
class Answer:
    """Result of a command.

    Attributes
    ----------
    document : of --json, without its "schema".
    result : a text, facts, or a result that `calib.show.facts` knows; its warnings go to stderr.
    exit_code : 0 if it passed.
    out : the folder that was written, which the next step names.
    """

    document: dict[str, Any]
    result: object = ""
    exit_code: int = 0
    out: Path | None = None

    @property
    def facts(self) -> "Facts | str":
        """The result in words."""
        if isinstance(self.result, str):
            return self.result
        from calib.show.facts import facts_of

        return facts_of(self.result).written(self.out)


def _flag(text: str, *flags: str) -> Any:
    return Annotated[bool, option(text, None, *flags)]


_COMMON: dict[str, Any] = {
    "report": Annotated[
        Path | None, option("Write one page of HTML here.", "FILE.html", writes="page")
    ],
    "quiet": _flag("Print the verdict alone, warnings and errors.", "--quiet", "-q"),
    "verbose": _flag("Print all details of the answer.", "--verbose", "-v"),
    "json": _flag("Print one JSON document on stdout.", "--json"),
    "force": _flag("Replace a file that exists, whatever it holds.", "--force"),
}
"""Options of every command; --report where it is declared, --force where a file is written."""


def command(
    *examples: str, report: bool = False, cls: Any = None
) -> Callable[[Callable[..., Any]], Any]:
    """Declare a command by its function, see above.

    Its parameters are arguments, keyword-only ones are options, those of a dataclass its fields. A
    switch, a list or what may be None is optional. With a parameter ``json`` it prints by itself.
    """

    def declare(body: Callable[..., Answer]) -> Callable[..., None]:
        declared = signature(body).parameters.values()
        kinds: dict[str, Any] = {p.name: p.annotation for p in declared}
        groups: dict[str, Any] = {n: kind for n, kind in kinds.items() if is_dataclass(kind)}
        parameters = {p.name: _parameter(p) for one in declared for p in _parts(one)}
        infos = {p.name: get_args(p.annotation)[1] for p in parameters.values()}
        infos |= {"report": get_args(_COMMON["report"])[1]} if report else {}
        writes = {name: info for name, info in infos.items() if info.writes is not None}
        is_file = any(info.writes != "folder" for info in writes.values())
        common = [*["report"] * report, "quiet", "verbose", "json", *["force"] * is_file]
        every = [*parameters.values(), *(_common(n) for n in common if n not in parameters)]

        @wraps(body)
        def run(**values: Any) -> None:
            this, is_forced = this_run(), values.get("force", False)
            this.quiet, this.verbose, this.force = values["quiet"], values["verbose"], is_forced
            for name, info in infos.items():
                if info.setting and not values[name]:
                    setting = from_settings(info.setting) if info.when(values) else None
                    default = info.built_in if values[name] is None else values[name]
                    values[name] = default if setting is None else setting
            for name in infos.keys() - writes:
                value = values[name] if isinstance(values[name], list) else [values[name]]
                if files := [one for one in value if isinstance(one, Path)]:
                    this.inputs[name] = files
            for name, info in writes.items():
                if values[name] is not None and info.writes != "folder":
                    check_file(values[name], info.writes, _flag_of(name, info))
            arguments = {name: _converted(name, infos[name], values[name]) for name in parameters}
            for name, kind in groups.items():
                arguments[name] = kind(**{f.name: arguments.pop(f.name) for f in fields(kind)})
            answer = body(**arguments)
            if "json" not in parameters:
                _print_answer(answer, values["json"], values.get("report"))
            if answer.exit_code:
                raise typer.Exit(answer.exit_code)

        typed = Signature(every, return_annotation=None)
        run.__annotations__ = {p.name: p.annotation for p in every}
        vars(run).update(__signature__=typed, examples=examples, cls=cls)
        return run

    return declare


def _common(name: str) -> Parameter:
    hint = _COMMON[name]
    return Parameter(name, Parameter.KEYWORD_ONLY, annotation=hint, default=_default(hint))


class Row(NamedTuple):
    """A command in the help of its group."""

    heading: str
    name: str
    summary: str


class Group(TyperGroup):
    """Commands under their headings; a summary is never cut."""

    def rows(self) -> list[Row]:
        """Every command in the order of the help."""
        commands: dict[str, Any] = dict(self.commands)
        return [Row(one.rich_help_panel, name, one.short_help) for name, one in commands.items()]

    def list_commands(self, ctx: Any) -> list[str]:
        """Names of the commands in the order of the help."""
        return [row.name for row in self.rows()]

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write each subject with its commands."""
        width = max(len(row.name) for row in self.rows())
        for heading, rows in groupby(self.rows(), lambda row: row.heading):
            with formatter.section(heading):
                formatter.write_dl([(row.name.ljust(width), row.summary) for row in rows])


def first_sentence(text: str) -> str:
    r"""The first sentence of a help text, in one line and without its full stop.

    >>> first_sentence("Fit the table of a car.\n\nMore on it.")
    'Fit the table of a car'
    """
    paragraph = " ".join(text.strip().split("\n\n")[0].split())
    return paragraph.split(". ")[0].removesuffix(".")


def add(app: typer.Typer, heading: str, *commands: Any) -> None:
    """Add commands to a group under a heading of its help."""
    for function in commands:
        app.command(
            function.__name__.rstrip("_"),
            cls=function.cls,
            short_help=first_sentence(function.__doc__),
            epilog=example(*function.examples),
            rich_help_panel=heading,
        )(function)


def group(name: str, text: str, *examples: str, cls: Any = Group, **more: Any) -> typer.Typer:
    """Return a group without commands: its help and examples."""
    # Plain help: typer's boxes import rich, which takes half of the time that --help may take.
    app = typer.Typer(
        name=name,
        cls=cls,
        rich_markup_mode=None,
        add_completion=cls is not Group,
        no_args_is_help=True,
        short_help=first_sentence(text),
        epilog=example(*examples),
        **more,
    )
    app.callback(help=text)(_nothing)
    return app


def _nothing() -> None:
    """Do nothing: a group needs a callback for its help."""


def example(*lines: str) -> str:
    """Epilog of a command's help: ``lines`` that can be run in the folder of the demo."""
    return "\n".join(("\b", "Example:", *(f"  {line}" for line in lines)))


def _parts(parameter: Parameter) -> list[Parameter]:
    """A parameter, or the fields of a dataclass: options that commands share."""
    kind, keyword = parameter.annotation, Parameter.KEYWORD_ONLY
    if not is_dataclass(kind):
        return [parameter]
    return [Parameter(f.name, keyword, annotation=f.type) for f in fields(kind)]


def _parameter(parameter: Parameter) -> Parameter:
    """A parameter as typer reads it."""
    kind, info = parameter.annotation, parameter.default
    if get_origin(kind) is Annotated:
        kind, info = get_args(kind)
    by_name = isinstance(kind, str | ForwardRef)  # what a file becomes
    hint: Any = Annotated[info.typed or (Path | None if by_name else kind), info]
    default = _default(hint, parameter.kind == Parameter.KEYWORD_ONLY)
    return parameter.replace(annotation=hint, default=default)


def _default(hint: Any, optional: bool = True) -> Any:
    kind, info = get_args(hint)
    if info.setting and info.built_in is not None:
        return None  # it may come from the settings
    if info.built_in is not None or type(None) in get_args(kind):
        return info.built_in
    if kind is bool:
        return False
    return [] if optional and get_origin(kind) is list else Parameter.empty


def _converted(name: str, info: Any, value: Any) -> Any:
    """The value of an option, converted; an error names the option."""
    if info.make is None or (value is None and not info.always):
        return value
    try:
        return info.make(value)
    except typer.BadParameter as error:
        error.param_hint = error.param_hint or _flag_of(name, info)
        raise
    except ValueError as error:
        raise misuse(str(error), _flag_of(name, info)) from None


def _flag_of(name: str, info: Any) -> str:
    if info.flags is None:
        return str(info.metavar)
    return str(info.flags[0]) if info.flags else f"--{name.replace('_', '-')}"


def _print_answer(answer: Answer, as_json: bool, page: Path | None) -> None:
    facts = answer.facts
    if not isinstance(facts, str):
        warn(facts.warnings)
        if page is not None:
            write_page(page, facts, "--report")
    if this_run().documents:
        return
    if as_json:
        emit_json({"schema": 1, **answer.document})
    elif facts:
        emit(facts)
