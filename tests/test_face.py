"""`import calib`: what a notebook sees first."""

import ast
import sys
from doctest import DocTestParser
from importlib import import_module
from pathlib import Path

import pytest

import calib

ROOT = Path(__file__).parents[1]
FACE = ROOT / "calib" / "__init__.py"


def homes() -> dict[str, str]:
    """Name and module as the type checker reads them."""
    (block,) = (node for node in ast.parse(FACE.read_text()).body if isinstance(node, ast.If))
    assert ast.unparse(block.test) == "TYPE_CHECKING"
    imports = [node for node in block.body if isinstance(node, ast.ImportFrom)]
    assert len(imports) == len(block.body)
    return {alias.name: str(node.module) for node in imports for alias in node.names}


def test_the_type_checker_and_the_interpreter_know_the_same_names():
    assert sorted(homes()) == sorted(calib.__all__)
    for name, module in homes().items():
        assert getattr(calib, name) is getattr(import_module(module), name)


def test_no_module_shadows_a_name():
    files = [p.relative_to(ROOT).with_suffix("") for p in sorted((ROOT / "calib").rglob("*.py"))]
    for file in files:
        import_module(".".join(file.parts).removesuffix(".__init__"))
    for name, module in homes().items():
        assert getattr(calib, name) is vars(sys.modules[module])[name]
    assert not set(calib.__all__) & {p.name for p in (ROOT / "calib").iterdir() if p.is_dir()}


@pytest.mark.parametrize("name", calib.__all__)
def test_every_name_has_an_example(name):
    examples = DocTestParser().get_examples(getattr(calib, name).__doc__)
    assert any(f"calib.{name}(" in example.source for example in examples)


def test_dir_names_the_face_and_nothing_else():
    assert sorted(dir(calib)) == sorted([*calib.__all__, "__version__"])


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="has no attribute 'fitt'"):
        _ = calib.fitt
