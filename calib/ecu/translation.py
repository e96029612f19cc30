"""Write functions of Python in C, so that both run the same equations.

    calib/estimation/equations.py --ast.parse--> definitions --translated--> functions of bte.c

These are the rules. Code without a rule raises ValueError.

    Python                         C
    a NamedTuple                   a structure of its fields
    a function                     a static function, with its docstring as a comment
    the first x = ...              a declaration, const if nothing else is assigned to x
    a, b = 1.0, 2.0                two assignments, in this order
    f: LevelFilter = s.level       a pointer to a part of the state
    return Name(a, b)              a structure that is initialised, then returned
    if, return, x += ..., a call   the same
    x.a.b                          x->a.b, since all parameters with members are pointers
    s.a with a `BlockState` s      the expression that `block_state` passes for its field a

The translation does not guard against all differences, such as 1/2, which is 0 in C. So the tests
compare the numbers of both languages.
"""

import ast
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from itertools import chain
from textwrap import wrap

_TYPES = {
    "Constants": "BTE_CAL bte_numbers *", "State": "bte_filters *", "Sample": "const bte_block *",
    "Zero": "bte_zero *", "LevelFilter": "bte_level_filter *", "SpeedFilter": "bte_speed_filter *",
    "Check": "bte_check *", "Means": "bte_means *", "BlockState": "const bte_filters *",
    "Array": "bte_real", "float": "bte_real", "Mask": "bool", "bool": "bool", "None": "void",
}  # fmt: skip
"""Types in C by those of Python. Other classes are structures of equations.py."""
_NOT_INLINED = {"update", "update_zero", "reset_speed", "share_of"}
"""Functions that would cost too much flash if the compiler copied them into each caller."""
_Definition = ast.ClassDef | ast.FunctionDef
_VIEW, _VIEW_MAKER = "BlockState", "block_state"
"""A NamedTuple of parts of the state, and the function that makes it. C has neither: it reads the
parts themselves."""
_SPELLINGS = {
    r"(?<![\w.])(\d+\.\d+|\d+e-\d+)\b": r"R(\1)",
    r"\bTrue\b": "true", r"\bFalse\b": "false", r"\bReason\.": "(bte_real)BTE_",
    r"\b(np|math)\.": "", r"\b(max|maximum)\b": "largest", r"\b(min|minimum)\b": "smallest",
    r"\babs\b": "MATH(fabs)", r"\bsqrt\b": "MATH(sqrt)", r"\bexp\b": "exponential",
    r"\blog\b": "logarithm", r"\bG\b": "GRAVITY",
    r"(?<![\w.])(\w+)\.(?=[a-z])": r"\1->",
    " and ": " && ", " or ": " || ", r" \| ": " || ", "not ": "!",
}  # fmt: skip
"""Words of Python with those of C, as regular expressions. They are replaced in this order."""


def translated(source: str) -> str:
    """Return the functions and NamedTuples of a module in C, in their order."""
    definitions = {x.name: x for x in ast.parse(source).body if isinstance(x, _Definition)}
    parts = _parts_of_view(definitions)
    out, depth = list[str](), 0
    for line in chain.from_iterable(_definition(x, parts) for x in definitions.values()):
        if line.startswith("}"):
            depth -= 1
        margin = 4 * depth * " "
        out += wrap(line, 100, initial_indent=margin, subsequent_indent=margin + 8 * " ") or [""]
        if line.endswith("{"):
            depth += 1
    return "\n".join(out).strip()


def structure(name: str) -> str:
    """Return the structure in C of a class: ``bte_slip_evidence`` of ``SlipEvidence``."""
    return "bte" + re.sub("([A-Z])", r"_\1", name).lower()


def _parts_of_view(definitions: dict[str, _Definition]) -> dict[str, str]:
    """Remove the view and its maker; return for each field the expression of C in its place."""
    if _VIEW not in definitions:
        return {}
    view, maker = definitions.pop(_VIEW), definitions.pop(_VIEW_MAKER)
    fields = [ast.unparse(x.target) for x in ast.walk(view) if isinstance(x, ast.AnnAssign)]
    returned = [x.value for x in ast.walk(maker) if isinstance(x, ast.Return)]
    parts = [part for x in returned if isinstance(x, ast.Call) for part in x.args]
    return dict(zip(fields, map(_in_c, parts), strict=True))


def _definition(node: _Definition, parts: dict[str, str]) -> Iterator[str]:
    """Write a NamedTuple or a function, without margins; ``parts`` as `_parts_of_view`."""
    if isinstance(node, ast.ClassDef):
        fields = [ast.unparse(x.target) for x in node.body if isinstance(x, ast.AnnAssign)]
        yield from ("", "typedef struct {", f"bte_real {', '.join(fields)};")
        yield f"}} {structure(node.name)};"
        return
    parameters = [*node.args.args, *node.args.kwonlyargs]
    declared = ", ".join(_declared(x.annotation, x.arg) for x in parameters)
    names = [x for x in ast.walk(node) if isinstance(x, ast.Name)]
    assigned = Counter(x.id for x in names if isinstance(x.ctx, ast.Store))
    for x in parameters:
        assigned.pop(x.arg, None)
    called = "CALLED " if node.name in _NOT_INLINED else ""
    docstring = " ".join((ast.get_docstring(node) or "").split()).replace("``", "")
    yield from ("", f"/* {docstring} */")
    yield f"{called}static {_declared(node.returns, node.name)}({declared}) {{"
    has_view = f"s: {_VIEW}" in ast.unparse(node.args)
    for line in _statements(node.body[1:], assigned):
        yield re.sub(r"\bs->(\w+)", lambda s: parts[s[1]], line) if has_view else line
    yield "}"


def _statements(body: Iterable[ast.stmt], undeclared: Counter[str]) -> Iterator[str]:
    """Write statements; ``undeclared`` counts the assignments of locals not yet declared."""
    for node in body:
        match node:
            case ast.If():
                yield f"if ({_in_c(node.test)}) {{"
                yield from _statements(node.body, undeclared)
                if node.orelse:
                    yield "} else {"
                    yield from _statements(node.orelse, undeclared)
                yield "}"
            case ast.Return(ast.Call(ast.Name(result), values)) if result[0].isupper():
                yield f"const {structure(result)} result = {{{', '.join(map(_in_c, values))}}};"
                yield "return result;"
            case ast.Assign([target], value):
                for name, part in _pairs(target, value):
                    kind = "bool" if isinstance(part, ast.Compare | ast.BoolOp) else "bte_real"
                    count = undeclared.pop(ast.unparse(name), 0)
                    constant = "const " if count == 1 else ""
                    declared = f"{constant}{kind} " if count else ""
                    yield f"{declared}{_in_c(name)} = {_in_c(part)};"
            case ast.AnnAssign(ast.Name(local), kind, ast.Attribute() as part):
                yield f"{_declared(kind, local)} = &{_in_c(part)};"
            case ast.AugAssign() | ast.Expr() | ast.Return():
                yield f"{_in_c(node)};"
            case _:
                raise ValueError(f"no counterpart in C: {ast.unparse(node)}")


def _pairs(target: ast.expr, value: ast.expr) -> list[tuple[ast.expr, ast.expr]]:
    """Pair targets with values, which C assigns one after the other.

    Raises ValueError if a later value reads an earlier target.
    """
    if not (isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple)):
        return [(target, value)]
    pairs = [*zip(target.elts, value.elts, strict=True)]
    for i, (_, part) in enumerate(pairs):
        read = {ast.unparse(x) for x in ast.walk(part)}
        if read & {ast.unparse(name) for name, _ in pairs[:i]}:
            raise ValueError(f"assigned before it is read in C: {ast.unparse(part)}")
    return pairs


def _declared(annotation: ast.expr | None, name: str) -> str:
    """Return a parameter, a local or a function with its type in front."""
    kind = ast.unparse(annotation or ast.Name("float")).split("[")[0]
    return f"{_TYPES.get(kind) or structure(kind)} {name}".replace("* ", "*")


def _in_c(node: ast.AST) -> str:
    text = ast.unparse(_Reshaped().visit(node))
    for python, c in _SPELLINGS.items():
        text = re.sub(python, c, text)
    return text


class _Reshaped(ast.NodeTransformer):
    """Change expressions that C writes in another order: powers, conditions, calls."""

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
        left, right = self.visit(node.left), self.visit(node.right)
        if isinstance(node.op, ast.Pow) and ast.unparse(node.right) == "2":
            return ast.Call(ast.Name("square"), [left], [])
        return ast.BinOp(left, node.op, right)

    def visit_IfExp(self, node: ast.IfExp) -> ast.expr:
        parts = (ast.unparse(self.visit(x)) for x in (node.test, node.body, node.orelse))
        return ast.Name("({} ? {} : {})".format(*parts))

    def visit_Call(self, node: ast.Call) -> ast.expr:
        match node:  # min(max(x, low), high)
            case ast.Call(ast.Name("min"), [ast.Call(ast.Name("max"), [x, low]), high]):
                return self.visit_Call(ast.Call(ast.Name("clip"), [x, low, high], []))
        if ast.unparse(node.func) == "np.where":
            return self.visit_IfExp(ast.IfExp(*node.args))
        arguments = [self.visit(x) for x in (*node.args, *(k.value for k in node.keywords))]
        return ast.Call(node.func, arguments, [])
