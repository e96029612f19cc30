"""Imports go downhill, and what is heavy is imported only when it is used."""

import ast
import subprocess
import sys
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

CALIB = Path(__file__).parents[1] / "calib"

ROOMS = """
    base
    car logs
    run
    suggest
    table
    plausibility
    model
    fitting
    store
    exports estimation plan
    ecu diagnosis
    line
    show
    help
"""
"""The house, from the ground floor up: a file imports from its own room or from a lower floor."""

INSIDE = {
    "diagnosis": [
        *("explanation", "replays", "rank", "fits", "terms", "search", "runs"),
        *("verdict", "diagnosis", "named", "diagnose"),
    ],
}
"""The order inside a room whose folders stand on each other; a file of the room is a name, too."""

FLOOR = {room: i for i, row in enumerate(ROOMS.split("\n")) for room in row.split()}
FACE = Path("calib/__init__.py")
"""Names what is in the rooms and loads none of it; `tests/test_face.py` looks at it."""
FILES = sorted({p.relative_to(CALIB.parent) for p in CALIB.rglob("*.py")} - {FACE})

HEAVY = {
    *("numpy", "pandas", "scipy", "matplotlib", "pyarrow"),
    *("asammdf", "can", "cantools", "distributed", "elftools", "jinja2"),
    *("bokeh", "minisign"),
}


def room(module: str) -> str:
    """Return the room of a module, such as `logs` of calib.logs.text.csv."""
    return module.split(".")[1]


def folder(module: str) -> str:
    """Return the folder of a module in a room, or the name of its file where it is in no folder."""
    return module.split(".")[2]


@cache
def parsed(file: Path) -> ast.Module:
    return ast.parse((CALIB.parent / file).read_text())


@cache
def imported(file: Path) -> list[str]:
    """Modules of the project that ``file`` imports, at its top or inside functions."""
    modules = []
    for node in ast.walk(parsed(file)):
        if isinstance(node, ast.Import):
            modules += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file}: relative import"
            for alias in node.names:
                # `from calib.logs import csv` names a module, `from calib.base.names import G` not.
                inner = CALIB.parent / Path(*f"{node.module}.{alias.name}".split("."))
                deeper = inner.with_suffix(".py").is_file() or inner.is_dir()
                modules.append(f"{node.module}.{alias.name}" if deeper else str(node.module))
                assert deeper or node.module != "calib", f"{file}: {alias.name} through the root"
    return [m for m in modules if m.split(".")[0] in ("calib", "cli", "tests")]


def module_of(file: Path) -> str:
    parts = file.with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def test_every_file_is_in_a_room():
    assert {room(module_of(file)) for file in FILES} == FLOOR.keys()


def test_imports_go_downhill():
    """Not to a neighbour on the same floor either, nor from the library to a command."""
    uphill = [
        f"{file} imports {other}"
        for file in FILES
        for other in imported(file)
        if other.split(".")[0] != "calib"
        or (
            room(other) != room(module_of(file))
            and FLOOR[room(other)] >= FLOOR[room(module_of(file))]
        )
    ]
    assert uphill == []


@pytest.mark.parametrize("name", INSIDE)
def test_imports_go_downhill_inside_a_room(name):
    for file in (f for f in FILES if f.parts[1] == name and f.name != "__init__.py"):
        floor = INSIDE[name].index(folder(module_of(file)))
        for other in (m for m in imported(file) if room(m) == name):
            assert INSIDE[name].index(folder(other)) <= floor, f"{file} imports {other}"


def test_no_circle():
    commands = [p.relative_to(CALIB.parent) for p in (CALIB.parent / "cli").rglob("*.py")]
    files = [*FILES, *commands]
    graph = {module_of(f): {m for m in imported(f) if m != module_of(f)} for f in files}
    assert len(list(TopologicalSorter(graph).static_order())) >= len(graph)


def loaded_after(statement: str) -> set[str]:
    """Top-level packages that a fresh interpreter has loaded after ``statement``."""
    code = f"import sys; {statement}; print(*sorted({{m.split('.')[0] for m in sys.modules}}))"
    run = subprocess.run(
        [sys.executable, "-c", code], cwd=CALIB.parent, capture_output=True, text=True, check=True
    )
    return set(run.stdout.split())


def test_commands_are_made_without_what_is_heavy():
    code = (
        "import typer; from cli.main import app; group = typer.main.get_command(app); "
        "[group.get_command(None, name) for name in group.list_commands(None)]"
    )
    assert loaded_after(code) & {*HEAVY, "rich"} == set()


def test_the_face_loads_no_room_before_a_name_is_used():
    assert loaded_after("import calib; dir(calib)") & HEAVY == set()


def test_help_is_printed_without_what_is_heavy():
    code = (
        "import io, contextlib; from typer.testing import CliRunner; from cli.main import app; "
        "assert CliRunner().invoke(app, ['--help']).exit_code == 0"
    )
    assert loaded_after(code) & {*HEAVY, "rich"} == set()


def is_schema(file: Path) -> bool:
    """Whether a file holds what a file of the user may hold: its classes are pydantic's."""
    return file.name.endswith("_file.py") or file.name in ("record.py", "record_errors.py")


def test_numpy_is_the_only_heavy_import_at_the_top_of_calib():
    for file in FILES:
        allowed = {"numpy", "pydantic", "pydantic_core"} if is_schema(file) else {"numpy"}
        for node in parsed(file).body:
            names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
            names += [str(node.module)] if isinstance(node, ast.ImportFrom) else []
            assert not {n.split(".")[0] for n in names} & (HEAVY - allowed), f"{file}: {names}"


def test_what_computes_is_imported_without_what_reads_files():
    modules = [module_of(f) for f in FILES if not is_schema(f)]
    assert len(modules) > 200
    assert loaded_after(f"import {', '.join(modules)}") & {"pydantic", "tomlkit"} == set()
