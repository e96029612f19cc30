"""Mutated files are refused by an error of the program: a part of `tests/studies/fuzz.py`."""

import random
import warnings

import pytest

from tests.support.fuzzed import READERS, finding, mutated

EXECUTIONS = 20
"""Fixed ones; the study takes 100,000 of each reader."""


@pytest.mark.parametrize("name", READERS)
def test_good_files_are_read(name, tmp_path):
    """Else their mutants would test nothing."""
    reader = READERS[name]
    for number, data in enumerate(reader.seeds()):
        if (name, number) in (("parquet", 1), ("result", 0), ("result", 1)):
            continue  # a Parquet file that is no log, or no result
        (tmp_path / reader.file).write_bytes(data)
        reader.read(tmp_path / reader.file)


@pytest.mark.parametrize("name", READERS)
def test_mutated_files_are_read_or_refused(name, tmp_path):
    reader, chance = READERS[name], random.Random(20)
    seeds = reader.seeds()
    for _ in range(EXECUTIONS):
        data = mutated(seeds, chance)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of asammdf and python-can on damaged files
            error = finding(reader, tmp_path, data)
        assert error is None, (error, data[:200])


def test_the_mutator_repeats_itself():
    made = [[mutated([b"abc" * 50], random.Random(seed)) for _ in range(20)] for seed in (1, 1, 2)]
    assert made[0] == made[1]
    assert made[0] != made[2]
