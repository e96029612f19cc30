import hashlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

from calib.plots import table
from calib.plots.save import ENDINGS, render, render_pages, save
from tests.support.tables import made_table

MAGIC = {".png": b"\x89PNG\r\n\x1a\n", ".svg": b"<?xml", ".pdf": b"%PDF-"}
ROOT = Path(__file__).parents[2]


@pytest.fixture
def figure():
    return table.sheet(made_table(), "sedan@1").figure("coverage")


def test_the_endings_are_these():
    assert set(ENDINGS) == set(MAGIC)


@pytest.mark.parametrize("ending", MAGIC)
def test_an_ending_gives_its_format_whole(figure, ending):
    content = render(figure, ending)
    assert content.startswith(MAGIC[ending])
    end = {".png": b"IEND\xaeB`\x82", ".svg": b"</svg>", ".pdf": b"%%EOF"}[ending]
    assert content.rstrip().endswith(end)


@pytest.mark.parametrize("ending", MAGIC)
def test_the_same_figure_gives_the_same_bytes_in_another_process(figure, ending):
    code = (
        "import hashlib; from calib.plots import table; from calib.plots.save import render; "
        "from tests.support.tables import made_table; "
        "figure = table.sheet(made_table(), 'sedan@1').figure('coverage'); "
        f"print(hashlib.sha256(render(figure, {ending!r})).hexdigest())"
    )
    run = subprocess.run(
        [sys.executable, "-c", code],
        cwd=ROOT,
        # another year, another order of sets
        env={**os.environ, "PYTHONHASHSEED": "7", "SOURCE_DATE_EPOCH": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert run.stdout.strip() == hashlib.sha256(render(figure, ending)).hexdigest()


@pytest.mark.parametrize("ending", MAGIC)
def test_a_file_says_nothing_of_the_time(figure, ending):
    content = render(figure, ending)
    for word in (b"CreationDate", b"dc:date", b"tIME"):
        assert word not in content


def test_a_pdf_holds_all_pages(figure):
    content = render_pages([figure, figure])
    assert content.count(b"/Type /Page ") == 2
    assert render_pages([figure, figure]) == content


def test_every_page_is_reported(figure, tmp_path):
    told = []
    save({tmp_path / "a.pdf": [figure] * 2, tmp_path / "b.svg": [figure]}, lambda: told.append(1))
    assert len(told) == 3
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.pdf", "b.svg"]


def test_nothing_is_written_when_one_cannot_be_drawn(figure, tmp_path):
    (tmp_path / "a.png").write_bytes(b"old")
    with pytest.raises(KeyError):
        save({tmp_path / "a.png": [figure], tmp_path / "b.jpg": [figure]})
    assert [p.name for p in tmp_path.iterdir()] == ["a.png"]
    assert (tmp_path / "a.png").read_bytes() == b"old"


def test_a_png_takes_one_page(figure, tmp_path):
    with pytest.raises(ValueError, match="too many values"):
        save({tmp_path / "a.png": [figure, figure]})
