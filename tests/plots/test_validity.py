from dataclasses import replace

import numpy as np

from calib.plots.validity import validity
from tests.support.plot_lines import axes


def test_each_reason_has_its_spans(trace):
    ax = axes()
    time = np.arange(0.0, 10.0, 0.01)
    late, slow = time > 8.0, time > 9.0
    validity(ax, replace(trace, time=time, valid=~late, refused={"a": late, "slow": slow}))
    assert [text.get_text() for text in ax.texts] == [" valid: 8.0 s", " a: 2.0 s", " slow: 1.0 s"]
    ends = [
        (bar.get_paths()[0].vertices[:, 0].min(), bar.get_paths()[0].vertices[:, 0].max())
        for bar in ax.collections
    ]
    assert np.allclose(ends, [(0.0, 8.0), (8.0, 10.0), (9.0, 10.0)], atol=0.011)
