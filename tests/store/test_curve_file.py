import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from calib.store.curve_file import curve_bytes, read_curve


@given(arrays(np.float64, st.integers(0, 30), elements=st.floats(allow_nan=False)))
def test_columns_come_back_to_the_bit(column):
    back = read_curve(curve_bytes({"eta": column, "D": -column}))
    assert list(back) == ["eta", "D"]
    assert back["eta"].tobytes() == column.tobytes()
    assert back["D"].tobytes() == (-column).tobytes()


def test_pandas_reads_it_plainly_and_the_unit_is_in_the_field(tmp_path):
    path = tmp_path / "curve.parquet"
    path.write_bytes(curve_bytes({"eta": np.array([1.0, 1.1]), "D": np.array([0.0, 2.5])}))
    expected = pd.DataFrame({"eta": [1.0, 1.1], "D": [0.0, 2.5]})
    pd.testing.assert_frame_equal(pd.read_parquet(path), expected)
    assert [field.metadata for field in pq.read_schema(path)] == [{b"unit": b"1"}] * 2


@pytest.mark.parametrize("data", [b"", b"PAR1", b"no such file" * 20])
def test_other_bytes_are_refused(data):
    with pytest.raises(ValueError, match=r"\w"):
        read_curve(data)
