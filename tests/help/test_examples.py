"""Every example of the manual: commands and Python are run, TOML and JSON are read."""

import json
import re
import shutil
import tomllib
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator

from calib.base.record import json_schema
from calib.help.documents import section
from tests.support.manual import LANGUAGES, PAGES, examples, run, working_folder

RUN = [page for page in PAGES if any(example.is_run for example in examples(page))]


@pytest.fixture(scope="module")
def prepared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder that the examples begin with, made once."""
    folder = tmp_path_factory.mktemp("prepared")
    working_folder(folder)
    return folder


@pytest.mark.parametrize("page", RUN, ids=lambda page: page.stem)
def test_the_examples_of_a_page_run_in_their_order(page, prepared, tmp_path, monkeypatch):
    folder = tmp_path / "work"
    shutil.copytree(prepared, folder, symlinks=True)
    monkeypatch.chdir(folder)
    names: dict[str, object] = {}
    for example in examples(page):
        if not example.is_run:
            continue
        if example.language == "python":
            exec(compile(example.text, str(page), "exec"), names)
            continue
        *others, last = example.commands
        for line in others:
            assert run(folder, line) == 0, line
        assert run(folder, last) == example.ends_with, last


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_block_says_what_it_is_and_why_it_is_not_run(page):
    for example in examples(page):
        assert example.language in LANGUAGES, example.text
        marks = ("", "not run: ", "exit code ")
        assert example.mark in marks or example.mark.startswith(marks[1:]), example.mark
        if example.language == "sh" and example.is_run:
            assert all(line.startswith("brake-cal ") for line in example.commands), example.text
        if example.language not in ("sh", "python"):
            assert not example.text.startswith("brake-cal "), example.text
    assert not re.search("^    brake-cal ", page.read_text(), re.MULTILINE)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_toml_and_json_in_the_pages_are_valid(page):
    for example in examples(page):
        if example.language == "toml":
            document = tomllib.loads(example.text)
            if example.kind:
                schema = json_schema(section(example.kind))
                Draft202012Validator(schema).validate(document)
        elif example.language == "json":
            json.loads(example.text)
