"""What a person may set, and what is said of everything else."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.errors import RevisionError
from calib.store.merged_keys import HandSetting, key_of, settings_of


def test_a_pad_and_a_row_by_as_many_digits_as_tell_it(table):
    """The rows of the table are 0.00025 apart."""
    found = settings_of(table, ["pad_friction_f=0.4", " D[1.0025] = 0.06 ", "f2[1.00325]=-5e-2"])
    assert found == [
        HandSetting("pad_friction_f", None, 0.4),
        HandSetting("D", 10, 0.06),
        HandSetting("f2", 13, -0.05),
    ]
    assert [key_of(table, s.name, s.row) for s in found] == [
        "pad_friction_f", "D[1.0025]", "f2[1.00325]",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("written", "says"),
    [
        ((), "nothing to set; expected KEY=VALUE"),
        (("pad_friction_f",), "'pad_friction_f' sets nothing; expected KEY=VALUE"),
        (("pad_frictoin_f=0.4",), "cannot be set; did you mean 'pad_friction_f'"),
        (("mass=1700",), "'mass' cannot be set; expected one of pad_friction_f, pad_friction_r, D"),
        (("g[0.01]=0.2",), r"'g\[0.01\]' cannot be set"),
        (("D=0.2",), "'D' cannot be set"),
        (("pad_friction_f[1.0025]=0.4",), "cannot be set"),
        (("pad_friction_r=high",), "'high' has no meaning for pad_friction_r; expected 0.05 to 1"),
        (("pad_friction_r=1.2",), "'1.2' has no meaning"),
        (("pad_friction_r=nan",), "'nan' has no meaning"),
        (("D[1.0025]=inf",), "'inf' has no meaning"),
        (("D[1.0025]=-1.5",), "expected -1 to 1"),
        (("D[1.0026]=0.05",), "no row has this eta; expected the nearest rows are at 1.0025 and"),
        (("D[1.2]=0.05",), "nearest rows are at 1.00475 and 1.005"),
        (("D[1.003]=0.05", "f1[1.003]=0.02"), "is set twice; one value fixes"),
        (("pad_friction_f=0.4", "pad_friction_f=0.41"), "pad_friction_f is set twice"),
        (("D[x]=0.05",), "'x' is no eta"),
        (("D[1.00]=0.05",), "D = 0 where the wheels turn alike"),
        (("D[1.00000]=0.05",), "D = 0 where the wheels turn alike"),
    ],
)
def test_what_means_nothing_is_refused(table, written, says):
    with pytest.raises(RevisionError, match=says) as error:
        settings_of(table, written)
    assert error.value.exit_code == 2


def test_too_few_digits_fit_two_rows(fitted):
    low, high = fitted.difference.eta[20:22]
    with pytest.raises(RevisionError, match=r"fits two rows, .* and .*; write more digits"):
        settings_of(fitted, [f"D[{0.5 * (low + high):.3f}]=0.05"])
    for row in (20, 21):
        written = f"D[{fitted.difference.eta[row]:.5f}]=0.05"
        assert settings_of(fitted, [written]) == [HandSetting("D", row, 0.05)]


def test_rows_of_D_that_f1_and_f2_do_not_have_cannot_be_set(table):
    paper = replace(table.paper, eta=np.linspace(1.0, 1.004, table.paper.eta.size))
    with pytest.raises(RevisionError, match="other rows than f1 and f2"):
        settings_of(replace(table, paper=paper), ["D[1.0025]=0.05"])
