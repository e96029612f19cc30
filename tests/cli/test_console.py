import io
import json
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from cli.console import complain, emit, emit_json, plain, progress, say


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def terminal(monkeypatch):
    """Put a terminal in the place of stderr; to be called in the test, after pytest put its own."""
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.delenv("NO_COLOR", raising=False)
    return stream


@dataclass(frozen=True)
class Point:
    name: str
    place: Path
    values: tuple[float, ...]


def test_plain_takes_what_results_are_made_of():
    document = {
        "point": Point("a", Path("x/y"), (1.0, float("nan"))),
        "array": np.array([[1.0, np.inf], [2.0, -np.inf]]),
        "scalars": [np.float64(0.5), np.float32(0.25), np.int64(3), np.bool_(True)],
        "flag": True,
        "none": None,
        7: np.float64("nan"),
    }
    assert plain(document) == {
        "point": {"name": "a", "place": "x/y", "values": [1.0, None]},
        "array": [[1.0, None], [2.0, None]],
        "scalars": [0.5, 0.25, 3, True],
        "flag": True,
        "none": None,
        "7": None,
    }


@pytest.mark.parametrize("value", [object(), {1, 2}, b"bytes", Point])
def test_plain_refuses_the_rest(value):
    with pytest.raises(TypeError, match="no place in a JSON document"):
        plain(value)


def test_emit_json_prints_one_document_and_nothing_else(capsys):
    emit_json({"x": np.float64(0.1), "name": "Überland"})
    captured = capsys.readouterr()
    assert json.loads(captured.out) == {"x": 0.1, "name": "Überland"}
    assert captured.err == ""


def test_results_and_talk_go_their_own_ways(capsys):
    emit("result")
    say("talk")
    captured = capsys.readouterr()
    assert (captured.out, captured.err) == ("result\n", "talk\n")


def test_nothing_in_a_string_is_markup_and_no_line_is_cut(capsys):
    text = "[bold]log[/bold] :car: [/x] " + "long " * 60 + "to the end"
    emit(text)
    assert capsys.readouterr().out == text + "\n"
    complain(text)
    assert capsys.readouterr().err == f"error: {text}\n"


def test_colour_is_for_terminals_without_no_color(monkeypatch):
    stderr = terminal(monkeypatch)
    complain("x")
    assert "\x1b[1;31m" in stderr.getvalue()
    monkeypatch.setenv("NO_COLOR", "1")
    stderr.truncate(0)
    complain("x")
    assert "31m" not in stderr.getvalue()


def test_progress_is_drawn_for_a_terminal(monkeypatch, capsys):
    stderr = terminal(monkeypatch)
    with progress("reading", 2) as step:
        step()
        step()
    assert "reading" in stderr.getvalue()
    assert "100%" in stderr.getvalue()
    assert capsys.readouterr().out == ""


def test_progress_is_one_line_where_nobody_looks(capsys):
    with progress("reading", 2) as step:
        step()
        step()
    assert capsys.readouterr().err == "reading\n"
