"""`import calib`: what a notebook sees first."""

import ast
import sys
from doctest import DocTestParser
from importlib import import_module
from inspect import signature
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import calib
from calib.base.errors import StoreError
from calib.car.forces import axle_loads
from calib.store.store import Store
from tests.support.reference_car import REAL, noisy, stop

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


@pytest.mark.parametrize("name", ["fit", "estimate", "validate", "diagnose"])
def test_the_car_comes_first_and_then_its_logs(name):
    car, logs, *options = signature(getattr(calib, name)).parameters.values()
    assert car.name in ("vehicle", "table")
    assert "Log" in str(logs.annotation)
    assert all(x.default is not x.empty for x in options) or name == "diagnose"


def test_f1_and_f2_are_those_of_the_paper_and_nothing_beyond_the_measured_rows(fitted):
    eta = fitted.paper.eta[5:9]
    F_zf, F_zr = axle_loads(fitted.vehicle, fitted.paper.z[5:9])
    assert fitted.f1(eta) * F_zf == pytest.approx(-fitted.f2(eta) * F_zr)  # (18)
    assert fitted.f1(1.0) == fitted.f2(1.0) == 0.0
    assert np.isnan(fitted.f1([0.99, 1.1])).all()
    assert fitted.f1(eta) == pytest.approx(fitted.curves().f1.loc[eta].to_numpy())


def test_a_map_reads_its_cells_and_is_linear_in_between(fitted):
    pads, z = fitted.map, fitted.map.axes["z"]
    shift, slip = pads.axes["shift"][4], pads.axes["slip"][1]
    cells = pads(z, shift, slip)["ratio"]
    assert cells == pytest.approx(pads.grid("ratio")[:, 4, 1])
    middle = pads(0.5 * (z[1:] + z[:-1]), shift, slip)["ratio"]
    assert middle == pytest.approx(0.5 * (cells[1:] + cells[:-1]))


def test_a_table_needs_no_store_to_be_exported(fitted, tmp_path):
    with pytest.raises(StoreError, match="not stored"):
        calib.export(fitted, tmp_path / "a.csv")
    calib.export(fitted, tmp_path / "a.csv", unreleased=True)
    stored = calib.export(Store(tmp_path).save(fitted), tmp_path / "b.csv", unreleased=True)
    free = (tmp_path / "a.csv").read_text()
    assert f"{fitted.name}@0" in free
    assert free.count("\n") == stored.content.decode().count("\n")


def test_a_version_of_a_store_is_judged_as_its_table(fitted, tmp_path):
    held_out = noisy(stop(REAL), 2)
    stored = Store(tmp_path).load(Store(tmp_path).save(fitted).id)
    (a,), (b,) = (calib.validate(x, [held_out]) for x in (fitted, stored))
    assert a.figures == b.figures
    frames = [calib.estimate(x, held_out).to_frame() for x in (fitted, stored)]
    assert frames[0].equals(frames[1])


def test_a_log_in_place_of_a_list_of_logs_is_a_type_error(fitted):
    held_out = noisy(stop(REAL), 2)
    for call, car in ((calib.fit, REAL.vehicle), (calib.validate, fitted)):
        with pytest.raises(TypeError, match="'Log' object is not iterable"):
            call(car, held_out)


def test_a_result_is_drawn_and_has_a_page_in_a_frame(fitted):
    (judged,) = calib.validate(fitted, [noisy(stop(REAL), 2)])
    for result, panels in ((fitted, 5), (judged.estimate, 5), (judged, 5)):
        assert len(result.plot().axes) == panels
        frame = ElementTree.fromstring(result._repr_html_())
        assert frame.tag == "iframe"
        assert frame.get("srcdoc").startswith("<!DOCTYPE html>")
