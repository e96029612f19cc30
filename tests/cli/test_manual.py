"""`brake-cal manual`."""

import json
from io import StringIO

from cli.laid_out import LaidOut
from rich.console import Console

from calib.help.page import contents
from cli.group import GONE, PAGES


def test_without_a_name_it_lists_the_pages(brake_cal):
    ran = brake_cal("manual")
    assert ran.code == 0
    first = [line.split()[0] for line in ran.out.splitlines()]
    assert first == ["page", *(page.name for page in contents())]
    listed = json.loads(brake_cal("manual", "--json").out)["pages"]
    assert [page["name"] for page in listed] == first[1:]
    assert set(listed[0]) == {"name", "title", "about", "group"}


def test_a_page_is_printed_as_it_was_written_where_nobody_watches(brake_cal):
    ran = brake_cal("manual", "Vehicle-File")
    (page,) = [page for page in contents() if page.name == "vehicle_file"]
    assert (ran.code, ran.out) == (0, page.text)
    told = json.loads(brake_cal("manual", "vehicle_file", "--json").out)
    assert (told["page"]["title"], told["text"]) == ("The vehicle file", page.text)


def test_lines_of_code_are_not_broken_on_a_narrow_terminal():
    long = "word " * 40
    console = Console(file=StringIO(), width=80, force_terminal=True, color_system=None)
    page = LaidOut(f"Text {long}\n\n```text\n{long}\n\n  next\n```\n")
    console.print(page, crop=False)
    lines = console.file.getvalue().splitlines()
    assert f" {long.rstrip()}" in [line.rstrip() for line in lines]
    assert "   next" in [line.rstrip() for line in lines]
    assert max(len(line) for line in lines if line.startswith("Text")) <= 80


def test_a_misspelt_page_is_told_the_right_one(brake_cal):
    for asked, told in (
        ("vehicel", "did you mean 'vehicle_file'?"),
        ("v", "it may be vehicle_file or validation"),
        ("stop", "look into validation"),
        ("xyzzy", "'brake-cal manual' lists the pages"),
    ):
        ran = brake_cal("manual", asked)
        assert ran.code == 2
        assert told in " ".join(ran.err.split())


def test_what_is_gone_is_told_with_the_command_to_use(brake_cal):
    for words, instead in GONE.items():
        ran = brake_cal(*words.split()[1:])
        assert (ran.code, instead in " ".join(ran.err.split())) == (2, True), words
    assert brake_cal("manual", "--html=site").code == 2
    assert set(PAGES) <= {page.name for page in contents()}
