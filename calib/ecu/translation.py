"""Functions of Python written in C, so that both run the same equations.

    calib/estimation/equations.py --ast--> static functions of bte.c

Statements are assignments, if, calls and return. A tuple is assigned part by part. A returned
NamedTuple becomes a structure; a `BlockState` is not copied, its fields are members of the state.
An annotated name is a pointer to a part of the state. Tests compare the numbers of both, since C
computes 1/2 in integers, for one.
"""

import ast
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from textwrap import wrap

_TYPES = {
    "Constants": "BTE_CAL bte_numbers *", "State": "bte_filters *", "Sample": "const bte_block *",
    "Zero": "bte_zero *", "LevelFilter": "bte_level_filter *", "SpeedFilter": "bte_speed_filter *",
    "Check": "bte_check *", "Means": "bte_means *", "BlockState": "const bte_filters *",
    "Array": "bte_real", "float": "bte_real", "Mask": "bool", "bool": "bool",
    "None": "void",
}  # fmt: skip
"""Of parameters and what is returned; a NamedTuple has a type of its own."""
_CALLED = {"update", "update_zero", "reset_speed"}  # not inlined: they need registers
_VIEW = "BlockState", "block_state"  # of the state, and the function that makes it
_NAMES = {
    "G": "GRAVITY", "max": "largest", "min": "smallest",
    "abs": "MATH(fabs)", "np.abs": "MATH(fabs)",
    "np.maximum": "largest", "np.minimum": "smallest", "np.clip": "clip",
    "math.exp": "exponential", "math.log": "logarithm", "math.sqrt": "MATH(sqrt)",
    "np.exp": "exponential", "np.sqrt": "MATH(sqrt)",
}  # fmt: skip
_LOGIC = {" and ": " && ", " or ": " || ", " | ": " || ", "not ": "!"}


def translated(source: str) -> str:
    """The functions and NamedTuples of a module in C, in their order.

    Raises ValueError for a statement that has no counterpart there.
    """
    out, depth = list[str](), 0
    whole = [x for x in ast.parse(source).body if isinstance(x, ast.ClassDef | ast.FunctionDef)]
    for line in _lines(map(_View(whole).visit, (x for x in whole if x.name not in _VIEW)), {}):
        depth -= line.startswith("}")
        margin = 4 * depth * " "
        out += wrap(line, 100, initial_indent=margin, subsequent_indent=margin + 8 * " ") or [""]
        depth += line.endswith("{")
    return "\n".join(out).strip()


def _lines(body: Iterable[ast.stmt], new: dict[str, int]) -> Iterator[str]:
    """Statements without margins; ``new``: assignments of each local that is not yet declared."""
    for node in body:
        match node:
            case ast.ClassDef():
                members = (_text(x.target) for x in node.body if isinstance(x, ast.AnnAssign))
                yield from ("", "typedef struct {", f"bte_real {', '.join(members)};")
                yield f"}} {_type(node.name)};"
            case ast.FunctionDef(body=[ast.Expr(ast.Constant(str(about))), *rest]):
                yield from ("", f"/* {' '.join(about.split()).replace('``', '')} */")
                parameters = (*node.args.args, *node.args.kwonlyargs)
                heads = ", ".join(f"{_type(x.annotation, ' *')} {x.arg}" for x in parameters)
                called = "CALLED " * (node.name in _CALLED)
                yield f"{called}static {_type(node.returns)} {node.name}({heads}) {{".replace(
                    " * ", " *"
                )
                names = (x for x in ast.walk(node) if isinstance(getattr(x, "ctx", 0), ast.Store))
                stored = Counter(map(ast.unparse, names))
                yield from _lines(
                    rest, {x: stored[x] for x in {*stored} - {y.arg for y in parameters}}
                )
                yield "}"
            case ast.If():
                yield f"if ({_text(node.test)}) {{"
                yield from _lines(node.body, new)
                if node.orelse:
                    yield "} else {"
                    yield from _lines(node.orelse, new)
                yield "}"
            case ast.Return(ast.Call(ast.Name(name), values)) if name[0].isupper():
                yield f"const {_type(name)} result = {{{', '.join(map(_text, values))}}};"
                yield "return result;"
            case ast.Assign([to], of):
                for target, value in _parts(to, of):
                    kind = "bool" if isinstance(value, ast.Compare | ast.BoolOp) else "bte_real"
                    times = new.pop(_text(target), 0)
                    declared = f"{'const ' if times == 1 else ''}{kind} " if times else ""
                    yield f"{declared}{_text(target)} = {_text(value)};"
            case ast.AnnAssign(target, kind, ast.Attribute() as value) if _type(kind)[-1] == "*":
                yield f"{_type(kind)} {_text(target)} = &{_text(value)};".replace(" * ", " *")
            case ast.AugAssign() | ast.Expr() | ast.Return():
                yield f"{_text(node)};"
            case _:
                raise ValueError(f"no counterpart in C: {ast.unparse(node)}")


def _parts(target: ast.expr, value: ast.expr) -> list[tuple[ast.expr, ast.expr]]:
    """Targets with their values; where only one side is a tuple, the other is an indexed array."""
    sides = [x.elts if isinstance(x, ast.Tuple) else x for x in (target, value)]
    count = max(len(x) if isinstance(x, list) else 0 for x in sides)
    if not count:
        return [(target, value)]
    parts = (
        x if isinstance(x, list) else [ast.Subscript(x, ast.Constant(i)) for i in range(count)]
        for x in sides
    )
    pairs = [(to, of) for to, of in zip(*parts, strict=True) if ast.unparse(to) != "_"]
    for i, (_, of) in enumerate(pairs):
        if {ast.unparse(x) for x in ast.walk(of)} & {ast.unparse(to) for to, _ in pairs[:i]}:
            raise ValueError(f"assigned before it is read in C: {ast.unparse(of)}")
    return pairs


def _type(kind: ast.expr | str | None, pointer: str = "") -> str:
    name = (kind if isinstance(kind, str) else ast.unparse(kind or ast.Name(""))).split("[")[0]
    return _TYPES.get(name, f"{'const ' * bool(pointer)}{structure(name)}{pointer}")


def structure(name: str) -> str:
    """The structure in C of a class: `bte_block_state` of BlockState."""
    return "bte" + re.sub("([A-Z])", r"_\1", name).lower()


def _text(node: ast.AST) -> str:
    text = ast.unparse(_InC().visit(node))
    for python, c in _LOGIC.items():
        text = text.replace(python, c)
    return text


class _InC(ast.NodeTransformer):
    """Write an expression as in C."""

    def visit_Name(self, node: ast.Name) -> ast.expr:
        return ast.Name(_NAMES.get(node.id, node.id))

    def visit_Constant(self, node: ast.Constant) -> ast.expr:
        if isinstance(node.value, bool):
            return ast.Name(str(node.value).lower())
        return ast.Name(f"R({node.value})") if isinstance(node.value, float) else node

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        name = ast.unparse(node).replace("Reason.", "(bte_real)BTE_")
        return ast.Name(_NAMES.get(name, name.replace(".", "->", 1)))

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
        left, right = self.visit(node.left), self.visit(node.right)
        if isinstance(node.op, ast.Pow) and ast.unparse(node.right) == "2":
            return ast.Call(ast.Name("square"), [left], [])
        return ast.BinOp(left, node.op, right)

    def visit_IfExp(self, node: ast.IfExp) -> ast.expr:
        return ast.Name(f"({_text(node.test)} ? {_text(node.body)} : {_text(node.orelse)})")

    def visit_Call(self, node: ast.Call) -> ast.expr:
        match node:
            case ast.Call(ast.Name("min"), [ast.Call(ast.Name("max"), [x, low]), high]):
                return self.visit_Call(ast.Call(ast.Name("clip"), [x, low, high], []))
        if ast.unparse(node.func) == "np.where":
            return self.visit_IfExp(ast.IfExp(*node.args))
        arguments = [self.visit(x) for x in (*node.args, *(k.value for k in node.keywords))]
        return ast.Call(self.visit(node.func), arguments, [])


class _View(ast.NodeTransformer):
    """Read members of a `BlockState` ``s`` from the state that it is made of."""

    def __init__(self, body: Iterable[ast.ClassDef | ast.FunctionDef]) -> None:
        view, maker = ({x.name: x.body for x in body}.get(name, []) for name in _VIEW)
        names = [ast.unparse(x.target) for x in view if isinstance(x, ast.AnnAssign)]
        calls = [x.value for x in maker if isinstance(x, ast.Return)]
        values = [y for x in calls if isinstance(x, ast.Call) for y in x.args]
        self._places = dict(zip(map("s.{}".format, names), values, strict=True))

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        return self.generic_visit(node) if f"s: {_VIEW[0]}" in ast.unparse(node.args) else node

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        return self._places.get(ast.unparse(node), node)
