"""Mutated files are read, or refused by an error of the program."""

import random
import warnings

import pytest

from tests.support.fuzzed import READERS, finding, mutated

EXECUTIONS = 20


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
