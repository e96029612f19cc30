"""A binding says what it holds: words that say nothing are refused.

They are free where three lines show what is meant: in a comprehension, a lambda, or a loop of at
most three lines; so is `left` beside `right`.
"""

import ast
from pathlib import Path

ROOT = Path(__file__).parents[1]
EMPTY = frozenset(
    """
    aged asked at before bent both departs done found given got has held here it kept known left
    made meant of one own renewed rest said searched seen settled stated strain stuff taken there
    thing things told what which who whose
    """.split()  # noqa: SIM905
)
STORED = {"own": "a column of a stored table", "at": "a key of a document", "stated": "a key, too"}
"""Words that stand in files which scripts outside read."""


class Bindings(ast.NodeVisitor):
    """Names that a module binds, each with its line and the names of its function."""

    def __init__(self) -> None:
        self.scopes: list[set[str]] = [set()]
        self.found: list[tuple[str, int, set[str]]] = []
        self.free = 0

    def bind(self, name: str, line: int) -> None:
        self.scopes[-1].add(name)
        if not self.free:
            self.found.append((name.strip("_"), line, self.scopes[-1]))

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        self.bind(node.name, node.lineno)
        self.scopes.append(set())
        arguments = node.args
        every = (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)
        for argument in every:
            self.bind(argument.arg, argument.lineno)
        for statement in node.body:
            self.visit(statement)
        self.scopes.pop()

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        self.bind(node.name, node.lineno)
        for statement in node.body:
            self.visit(statement)

    def visit_Lambda(self, node: ast.Lambda) -> None:
        """Nothing: it is short."""

    def visit_comprehension_of(self, node: ast.AST) -> None:
        self.free += 1
        self.generic_visit(node)
        self.free -= 1

    visit_ListComp = visit_SetComp = visit_comprehension_of  # noqa: N815
    visit_DictComp = visit_GeneratorExp = visit_comprehension_of  # noqa: N815

    def visit_For(self, node: ast.For) -> None:
        short = (node.end_lineno or 0) - node.lineno <= 3
        self.free += short
        self.visit(node.target)
        self.free -= short
        for child in (node.iter, *node.body, *node.orelse):
            self.visit(child)

    def visit_Name(self, node: ast.Name) -> None:
        if isinstance(node.ctx, ast.Store):
            self.bind(node.id, node.lineno)


def empty_bindings(text: str) -> list[tuple[str, int]]:
    """Names that say nothing, with their lines."""
    module = Bindings()
    module.visit(ast.parse(text))
    return [
        (name, line)
        for name, line, scope in module.found
        if name in EMPTY - STORED.keys() and not (name == "left" and "right" in scope)
    ]


def test_a_binding_says_what_it_holds():
    folders = (ROOT / name for name in ("calib", "cli", "tests"))
    files = (path for folder in folders for path in sorted(folder.rglob("*.py")))
    empty = {str(path.relative_to(ROOT)): empty_bindings(path.read_text()) for path in files}
    assert {path: names for path, names in empty.items() if names} == {}
