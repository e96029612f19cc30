"""Declare a command by a function, its parameters and its `Answer`.

    @command("brake-cal fit ramp.csv --vehicle car.toml")
    def fit(logs: list[Path] = argument("Ramps.", "LOG..."), *, vehicle: Car) -> Answer:

Positional parameters are arguments of the command, keyword-only parameters are options. A parameter
whose type is a dataclass stands for one option of each field. `cli.options` declares each argument
and option, as the default of the parameter or in its annotation. typer converts the typed words to
simple types. `_Declaration` then does the rest, in this order:

    settings    fill in what was not typed
    outputs     refuse a place that cannot be written
    make        convert values, such as a path to the vehicle of its file
"""

from collections.abc import Callable
from dataclasses import dataclass, fields, is_dataclass
from functools import wraps
from inspect import Parameter, Signature, signature
from pathlib import Path
from typing import Annotated, Any, ForwardRef, get_args, get_origin

import typer

from cli.console import print_json, print_result, print_warnings, this_run, usage_error
from cli.options import Extra, from_settings, option
from cli.outputs import check_file, write_page

FAILED, UNREADABLE, DAMAGED = 1, 3, 4
"""Exit codes: a result fails its limits; an input cannot be used; a table is damaged."""


@dataclass(frozen=True)
class Answer:
    """Result of a command."""

    document: dict[str, Any]  # what --json prints, without its "schema"
    result: object = ""  # a text, facts, or a result that `calib.show.facts` knows
    exit_code: int = 0
    out: Path | None = None  # the folder that was written, for the advice on the next command


def _switch(text: str, *flags: str) -> Any:
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
"""Options of every command. --report must be declared; --force is there if a file is written."""


def command(
    *examples: str, report: bool = False, cls: Any = None
) -> Callable[[Callable[..., Any]], Any]:
    """Declare a command by its function, see the head of this file.

    A switch, an option that is a list, and a parameter that may be None are optional. A function
    with a parameter ``json`` prints its result by itself. ``examples`` are lines of the help,
    ``report`` says whether the command has the option --report, ``cls`` replaces typer's class.
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
    """The parameters of a command for typer, and their conversion to arguments of its function.

    ``own`` are the parameters of the function by name, with the fields of each dataclass in its
    place. ``common`` are the options of every command, without those that the function declares.
    """

    def __init__(self, function: Callable[..., Answer], report: bool):
        declared = signature(function).parameters.values()
        self._groups: dict[str, Any] = {  # dataclasses by the name of their parameter
            p.name: p.annotation for p in declared if is_dataclass(p.annotation)
        }
        ungrouped = [p for parameter in declared for p in _ungrouped(parameter)]
        self.own = {p.name: _typed(p) for p in ungrouped}
        self._infos = {name: _info(p.annotation) for name, p in self.own.items()}
        if report:
            self._infos["report"] = _info(_COMMON["report"])
        absent = set(self.own)
        if not report:
            absent.add("report")
        if not any(_writes_file(info) for info in self._infos.values()):
            absent.add("force")
        self.common = {
            name: Parameter(name, Parameter.KEYWORD_ONLY, annotation=hint, default=_default(hint))
            for name, hint in _COMMON.items()
            if name not in absent
        }

    def arguments(self, values: dict[str, Any]) -> dict[str, Any]:
        """Return the arguments of the function by name, from the ``values`` of typer."""
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
        """Fill in a setting of the project, or else the built-in value, if none was typed."""
        for name, info in self._infos.items():
            extra: Extra = info.extra
            if extra.setting and not values[name]:
                setting = from_settings(extra.setting) if extra.when(values) else None
                if setting is not None:
                    values[name] = setting
                elif values[name] is None:
                    values[name] = extra.built_in

    def _remember_inputs(self, values: dict[str, Any]) -> None:
        """Remember the files to read: no output may replace them."""
        for name, info in self._infos.items():
            words = values[name] if isinstance(values[name], list) else [values[name]]
            files = [word for word in words if isinstance(word, Path)]
            if files and info.extra.writes is None:
                this_run().inputs[name] = files

    def _check_outputs(self, values: dict[str, Any]) -> None:
        """Refuse a file that cannot be written. The command itself checks a folder."""
        for name, info in self._infos.items():
            if values[name] is not None and _writes_file(info):
                check_file(values[name], info.extra.writes, _flag(name, info))


def _writes_file(info: Any) -> bool:
    return info.extra.writes not in (None, "folder")


def _info(annotation: Any) -> Any:
    """Return the declaration of `cli.options` in the annotation of a parameter."""
    return get_args(annotation)[1]


def _ungrouped(parameter: Parameter) -> list[Parameter]:
    """Return a parameter, or the parameters for the fields of its dataclass."""
    kind, keyword = parameter.annotation, Parameter.KEYWORD_ONLY
    if not is_dataclass(kind):
        return [parameter]
    return [Parameter(f.name, keyword, annotation=f.type) for f in fields(kind)]


def _typed(parameter: Parameter) -> Parameter:
    """Return a parameter for typer, with the annotation ``Annotated[type, declaration]``."""
    kind, info = parameter.annotation, parameter.default
    if get_origin(kind) is Annotated:
        kind, info = get_args(kind)
    # an annotation in quotes: the user types the path of a file, which `make` reads
    if isinstance(kind, str | ForwardRef):
        kind = Path | None
    hint: Any = Annotated[kind if info.extra.typed is None else info.extra.typed, info]
    default = _default(hint, is_option=parameter.kind == Parameter.KEYWORD_ONLY)
    return parameter.replace(annotation=hint, default=default)


def _default(hint: Any, *, is_option: bool = True) -> Any:
    """Return the default of a parameter for typer; `Parameter.empty` if it is required."""
    kind, info = get_args(hint)
    extra: Extra = info.extra
    if extra.built_in is not None:
        return None if extra.setting else extra.built_in  # a setting comes before what is built in
    if type(None) in get_args(kind):
        return None
    if kind is bool:
        return False
    return [] if is_option and get_origin(kind) is list else Parameter.empty


def _converted(name: str, info: Any, value: Any) -> Any:
    """Return the converted value of a parameter. An error names the option."""
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
    """Return the name of a parameter on the command line, such as ``--out`` or ``LOG``."""
    flags = info.extra.flags
    if flags is None:
        return str(info.metavar)
    return str(flags[0]) if flags else f"--{name.replace('_', '-')}"


def _print_answer(answer: Answer, as_json: bool, page: Path | None) -> None:
    """Print an answer, its warnings first, and write it as a page if --report was typed."""
    result: Any = answer.result
    if not isinstance(result, str):
        from calib.show.facts import facts_of

        result = facts_of(result).with_folder(answer.out)
        print_warnings(result.warnings)
        if page is not None:
            write_page(page, result, "--report")
    if this_run().documents:  # the command has printed its document itself
        return
    if as_json:
        print_json({"schema": 1, **answer.document})
    elif result:
        print_result(result)
