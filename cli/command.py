"""Declare a command by a function: what it reads, what it writes, what it returns.

    @command("brake-cal fit ramp.csv --vehicle car.toml")
    def fit(logs: list[Path] = argument("Ramps.", "LOG..."), *, vehicle: Car) -> Answer:

Parameters are arguments, keyword-only ones are options; those of a dataclass are its fields. Each
is declared by `cli.options`, as its default or in its annotation. typer converts what is typed to
the types that the function declares; `_Declaration` then does the rest, in this order:

    settings    fill in what was not typed
    outputs     refuse a place that cannot be written
    make        convert, such as a path to the vehicle of its file
"""

from collections.abc import Callable
from dataclasses import dataclass, fields, is_dataclass
from functools import wraps
from inspect import Parameter, Signature, signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ForwardRef, get_args, get_origin

import typer

from cli.console import print_json, print_result, print_warnings, this_run, usage_error
from cli.options import Extra, from_settings, option
from cli.outputs import check_file, write_page

if TYPE_CHECKING:
    from calib.show.facts import Facts

FAILED, UNREADABLE, DAMAGED = 1, 3, 4
"""Exit codes of a result: it fails its limits; an input is no use; a table is damaged."""


@dataclass(frozen=True)
class Answer:
    """Result of a command."""

    document: dict[str, Any]  # what --json prints, without its "schema"
    result: object = ""  # a text, facts, or a result that `calib.show.facts` knows
    exit_code: int = 0
    out: Path | None = None  # the folder that was written, which the next step names

    @property
    def facts(self) -> "Facts | str":
        """The result in words."""
        if isinstance(self.result, str):
            return self.result
        from calib.show.facts import facts_of

        return facts_of(self.result).written(self.out)


def _switch(text: str, *flags: str) -> Any:
    """Annotation of an option without a value."""
    return Annotated[bool, option(text, None, *flags)]


_COMMON: dict[str, Any] = {
    "report": Annotated[
        Path | None, option("Write one page of HTML here.", "FILE.html", writes="page")
    ],
    "quiet": _switch("Print the verdict alone, warnings and errors.", "--quiet", "-q"),
    "verbose": _switch("Print all details of the answer.", "--verbose", "-v"),
    "json": _switch("Print one JSON document on stdout.", "--json"),
    "force": _switch("Replace a file that exists, whatever it holds.", "--force"),
}
"""Options of every command; --report where it is declared, --force where a file is written."""


def command(
    *examples: str, report: bool = False, cls: Any = None
) -> Callable[[Callable[..., Any]], Any]:
    """Declare a command by its function, see above.

    A switch, a list or what may be None is optional. A function that has a parameter ``json``
    prints by itself. ``examples`` are lines of the help, ``report`` says whether the command has
    the option --report, and ``cls`` is another class than that of typer.
    """

    def declare(function: Callable[..., Answer]) -> Callable[..., None]:
        declaration = _Declaration(function, report)

        @wraps(function)
        def run(**values: Any) -> None:
            answer = function(**declaration.arguments(values))
            if "json" not in declaration.own:
                _print_answer(answer, values["json"], values.get("report"))
            if answer.exit_code:
                raise typer.Exit(answer.exit_code)

        # typer reads signature and annotations, `cli.groups.add` the examples and the class
        parameters = [*declaration.own.values(), *declaration.common.values()]
        run.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
        typed = Signature(parameters, return_annotation=None)
        vars(run).update(__signature__=typed, examples=examples, cls=cls)
        return run

    return declare


class _Declaration:
    """The parameters of a command, as typer reads them and as its function gets them.

    ``own`` are those of the function, by name, and instead of a dataclass its fields. ``common``
    are the options of every command that the function does not declare.
    """

    def __init__(self, function: Callable[..., Answer], report: bool):
        declared = signature(function).parameters.values()
        self._groups: dict[str, Any] = {
            p.name: p.annotation for p in declared if is_dataclass(p.annotation)
        }
        ungrouped = [p for parameter in declared for p in _ungrouped(parameter)]
        self.own = {p.name: _typed(p) for p in ungrouped}
        self._infos = {name: _info(p.annotation) for name, p in self.own.items()}
        if report:
            self._infos["report"] = _info(_COMMON["report"])
        left_out = set(self.own)
        if not report:
            left_out.add("report")
        if not any(_writes_file(info) for info in self._infos.values()):
            left_out.add("force")
        self.common = {name: _common(name) for name in _COMMON if name not in left_out}

    def arguments(self, values: dict[str, Any]) -> dict[str, Any]:
        """Return the arguments of the function, by name, from the typed ``values``."""
        run = this_run()
        run.quiet, run.verbose = values["quiet"], values["verbose"]
        run.force = values.get("force", False)
        self._fill_in(values)
        self._remember_inputs(values)
        self._check_outputs(values)
        arguments = {name: _converted(name, self._infos[name], values[name]) for name in self.own}
        for name, group in self._groups.items():
            arguments[name] = group(**{f.name: arguments.pop(f.name) for f in fields(group)})
        return arguments

    def _fill_in(self, values: dict[str, Any]) -> None:
        """Fill in a setting of the project, or what is built in, where nothing was typed."""
        for name, info in self._infos.items():
            extra: Extra = info.extra
            if extra.setting and not values[name]:
                setting = from_settings(extra.setting) if extra.when(values) else None
                if setting is not None:
                    values[name] = setting
                elif values[name] is None:
                    values[name] = extra.built_in

    def _remember_inputs(self, values: dict[str, Any]) -> None:
        """Keep the files that are read, which no output may replace."""
        for name, info in self._infos.items():
            typed = values[name] if isinstance(values[name], list) else [values[name]]
            files = [value for value in typed if isinstance(value, Path)]
            if files and info.extra.writes is None:
                this_run().inputs[name] = files

    def _check_outputs(self, values: dict[str, Any]) -> None:
        """Refuse a file that cannot be written; a command checks a folder itself."""
        for name, info in self._infos.items():
            if values[name] is not None and _writes_file(info):
                check_file(values[name], info.extra.writes, _flag(name, info))


def _writes_file(info: Any) -> bool:
    return info.extra.writes not in (None, "folder")


def _info(annotation: Any) -> Any:
    """Return the declaration by `cli.options` in the annotation of a parameter."""
    return get_args(annotation)[1]


def _ungrouped(parameter: Parameter) -> list[Parameter]:
    """Return a parameter, or the fields of its dataclass, which are options of several commands."""
    kind, keyword = parameter.annotation, Parameter.KEYWORD_ONLY
    if not is_dataclass(kind):
        return [parameter]
    return [Parameter(f.name, keyword, annotation=f.type) for f in fields(kind)]


def _typed(parameter: Parameter) -> Parameter:
    """Return a parameter as typer reads it: ``Annotated[type that is typed, declaration]``."""
    kind, info = parameter.annotation, parameter.default
    if get_origin(kind) is Annotated:
        kind, info = get_args(kind)
    if isinstance(kind, str | ForwardRef):  # a quoted type, made of a file: its path is typed
        kind = Path | None
    hint: Any = Annotated[kind if info.extra.typed is None else info.extra.typed, info]
    default = _default(hint, is_option=parameter.kind == Parameter.KEYWORD_ONLY)
    return parameter.replace(annotation=hint, default=default)


def _common(name: str) -> Parameter:
    hint = _COMMON[name]
    return Parameter(name, Parameter.KEYWORD_ONLY, annotation=hint, default=_default(hint))


def _default(hint: Any, *, is_option: bool = True) -> Any:
    """Return the default value of a parameter for typer; a parameter without one is required."""
    kind, info = get_args(hint)
    extra: Extra = info.extra
    if extra.setting and extra.built_in is not None:
        return None  # the settings come before what is built in
    if extra.built_in is not None or type(None) in get_args(kind):
        return extra.built_in
    if kind is bool:
        return False
    return [] if is_option and get_origin(kind) is list else Parameter.empty


def _converted(name: str, info: Any, value: Any) -> Any:
    """Return the value of a parameter, converted; an error names the option."""
    extra: Extra = info.extra
    if extra.make is None or (value is None and not extra.always):
        return value
    try:
        return extra.make(value)
    except typer.BadParameter as error:
        error.param_hint = error.param_hint or _flag(name, info)
        raise
    except ValueError as error:
        raise usage_error(str(error), _flag(name, info)) from None


def _flag(name: str, info: Any) -> str:
    """Return how a parameter is called on the command line, such as ``--out`` or ``LOG``."""
    flags = info.extra.flags
    if flags is None:
        return str(info.metavar)
    return str(flags[0]) if flags else f"--{name.replace('_', '-')}"


def _print_answer(answer: Answer, as_json: bool, page: Path | None) -> None:
    """Print an answer, its warnings first, and write it as a page if one is wanted."""
    facts = answer.facts
    if not isinstance(facts, str):
        print_warnings(facts.warnings)
        if page is not None:
            write_page(page, facts, "--report")
    if this_run().documents:  # the command has printed its document itself
        return
    if as_json:
        print_json({"schema": 1, **answer.document})
    elif facts:
        print_result(facts)
