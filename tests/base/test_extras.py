"""An error for a missing package names the extra that installs it."""

import pytest

from calib.base.errors import ProgramError
from calib.base.extras import EXTRAS, need


@pytest.mark.parametrize("extra", EXTRAS)
def test_a_missing_package_is_an_error_that_names_its_extra(extra):
    with pytest.raises(ProgramError, match=f"\\[{extra}\\]"):
        need("no_such_package_of_any_name", extra, error=ProgramError)


def test_a_broken_package_is_not_reported_as_missing(tmp_path, monkeypatch):
    (tmp_path / "half_there.py").write_text("import something_it_lacks")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(ModuleNotFoundError):
        need("half_there", "mdf")
