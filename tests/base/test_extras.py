"""An error for a missing package names the extra that installs it."""

import pytest

from calib.base.errors import ProgramError
from calib.base.extras import EXTRAS, need


@pytest.mark.parametrize("extra", EXTRAS)
def test_what_is_missing_is_said(extra):
    with pytest.raises(ProgramError, match=f"\\[{extra}\\]"):
        need("no_such_package_of_any_name", extra, error=ProgramError)


def test_a_package_that_is_broken_is_no_missing_one(tmp_path, monkeypatch):
    (tmp_path / "half_there.py").write_text("import something_it_lacks")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(ModuleNotFoundError):
        need("half_there", "mdf")
