"""Speed of reading text against the bare libraries, in one run.

    python tests/benchmarks/bench_text.py

The bare call reads the same columns to float64 from the same file; ours adds the digest, the
dialect, the look at the last row, the units and the check of the clock. Prints milliseconds, ratios
and the peak of memory; nothing is asserted, machines differ.
"""

import gzip
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from calib.logs.log import Log  # noqa: E402
from calib.logs.read import read_log  # noqa: E402
from calib.logs.write import write_csv, write_parquet  # noqa: E402
from tests.benchmarks.timing import best  # noqa: E402

REPEAT = 9
NAMES = ("time", "p_mc", "a_x", "omega_fl", "omega_fr", "omega_rl", "omega_rr", "v")


def made_log(rows: int) -> Log:
    """A log of ``rows`` samples at 200 Hz."""
    rng = np.random.default_rng(1)
    channels = {name: 10.0 * rng.normal(size=rows) for name in NAMES}
    channels["time"] = np.arange(rows) / 200.0
    return Log("bench", "bench", "", channels)


def arrow(path: Path, separator: str = ",", decimal: str = ".") -> object:
    """pyarrow alone, on one thread, all columns as float64."""
    import pyarrow as pa
    import pyarrow.csv as csv

    data = path.read_bytes()
    data = gzip.decompress(data) if path.suffix == ".gz" else data
    table = csv.read_csv(
        pa.BufferReader(data),
        read_options=csv.ReadOptions(use_threads=False),
        parse_options=csv.ParseOptions(delimiter=separator),
        convert_options=csv.ConvertOptions(decimal_point=decimal),
    )
    return [column.to_numpy() for column in table.columns]


def pandas(path: Path, separator: str = ",", decimal: str = ".") -> object:
    """pandas alone, with its C reader."""
    import pandas as pd

    return pd.read_csv(path, sep=separator, decimal=decimal)


def parquet(path: Path) -> object:
    """pyarrow alone, on one thread."""
    import pyarrow.parquet as pq

    return [c.to_numpy() for c in pq.read_table(path, use_threads=False).columns]


def files(folder: Path, rows: int) -> dict[str, tuple[Path, str, str]]:
    """The same log in several dialects: path, separator, decimal mark."""
    log = made_log(rows)
    ours, other, packed = folder / "a.csv", folder / "b.csv", folder / "c.csv.gz"
    write_csv(log, ours)
    text = ours.read_text()
    other.write_text(text.replace(",", ";").replace(".", ","))
    packed.write_bytes(gzip.compress(text.encode(), 6))
    write_parquet(log, folder / "d.parquet")
    return {
        "our CSV": (ours, ",", "."),
        "semicolon, decimal comma": (other, ";", ","),
        "gzip": (packed, ",", "."),
    }


def speed(rows: int) -> None:
    """One table for logs of ``rows`` samples."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        print(f"{rows} samples, 8 channels")
        for kind, (path, separator, decimal) in files(folder, rows).items():
            ours = best(lambda path=path: read_log(path), REPEAT)
            bare = {
                call.__name__: best(partial(call, path, separator, decimal), REPEAT)
                for call in (arrow, pandas)
            }
            told = ", ".join(f"{n} {1e3 * s:7.2f} ms ({ours / s:.2f} x)" for n, s in bare.items())
            print(f"  {kind:<26} {1e3 * ours:7.2f} ms; {told}")
        path = folder / "d.parquet"
        ours, alone = best(lambda: read_log(path), REPEAT), best(lambda: parquet(path), REPEAT)
        told = f"arrow {1e3 * alone:7.2f} ms ({ours / alone:.2f} x)"
        print(f"  {'Parquet':<26} {1e3 * ours:7.2f} ms; {told}")


def memory(rows: int) -> None:
    """Peak of a whole process that reads one log, against one that only imports and reads bare."""
    with tempfile.TemporaryDirectory() as name:
        path = files(Path(name), rows)["our CSV"][0]
        ours = peak(f"from calib.logs.read import read_log; read_log({str(path)!r})")
        code = "import sys; sys.path.insert(0, 'tests/benchmarks'); import bench_text as b; "
        bare = peak(code + f"from pathlib import Path; b.arrow(Path({str(path)!r}))")
        print(f"{rows} samples, {path.stat().st_size / 1e6:.0f} MB of text")
        print(
            f"  peak of the process        {ours:.0f} MB; arrow {bare:.0f} MB ({ours / bare:.2f} x)"
        )


def peak(code: str) -> float:
    """Peak memory of a Python process [MB], as it says itself."""
    end = "; import resource; print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)"
    run = [sys.executable, "-c", code + end]
    out = subprocess.run(run, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return int(out.split()[-1]) / 1024


if __name__ == "__main__":
    for count in (2_000, 20_000, 400_000):
        speed(count)
    memory(400_000)
