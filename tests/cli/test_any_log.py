"""Any log, channels and rows in any order: a finite answer, or a line that refuses it."""

import json
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

ROOT = Path(__file__).parents[2]
SEDAN = ROOT / "sample_logs" / "sedan"
TABLES = ("--store", ROOT / "tables")
COMMANDS = {
    "check": (),
    "fit": ("--vehicle", SEDAN / "vehicle.toml"),
    "validate": (*TABLES,),
}
LOGS = ("ramp_wet_asphalt", "dry_asphalt_stop", "coast")
SCALES = (1.0, -1.0, 0.0, 1e-3, 3.6, 1e3, 1e9, 1e300, 5e-324)


@cache
def frame(name: str) -> pd.DataFrame:
    return pd.read_csv(SEDAN / f"{name}.csv")


def seldom(low: int, high: int) -> st.SearchStrategy[int]:
    """0 in four of five logs, so that many of them are of use."""
    return st.integers(0, 4).flatmap(lambda n: st.just(0) if n else st.integers(low, high))


@st.composite
def any_log(draw) -> pd.DataFrame:
    log = frame(draw(st.sampled_from(LOGS)))
    columns = draw(st.permutations(list(log.columns)))
    log = log[columns[: len(columns) - draw(seldom(1, 4))]]
    first = draw(seldom(0, 900))
    log = log.iloc[first : [len(log), first + 1, first + 300][draw(seldom(1, 2))]].copy()
    for name in columns[: draw(seldom(1, 2))]:
        if name in log:
            log[name] *= draw(st.sampled_from(SCALES))
    if draw(seldom(1, 1)):
        log = log.iloc[np.random.default_rng(draw(st.integers(0, 99))).permutation(len(log))]
    return log


def finite(text: str) -> float:
    raise AssertionError(f"{text} is no number")


@settings(max_examples=12, suppress_health_check=list(HealthCheck), deadline=None)
@given(any_log(), st.sampled_from(sorted(COMMANDS)))
def test_it_has_a_finite_answer_or_is_refused_in_a_line(brake_cal, tmp_path, log, command):
    path = tmp_path / "any.csv"
    log.to_csv(path, index=False)
    table = ("sedan-2up",) if command == "validate" else ()
    store = ("--store", tmp_path / "new") if command == "fit" else ()
    ran = brake_cal(command, *table, path, *COMMANDS[command], *store, "--json")
    document = json.loads(ran.out, parse_constant=finite)
    assert "Traceback" not in ran.err
    if ran.code == 1:  # a verdict, and no crash
        assert "error" not in document
    else:
        assert ran.code in (0, 3), ran.err
