"""What compiles C on this machine; tests that need it are left out elsewhere, and say so."""

import shutil

import pytest

needs_cc = pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler, cc")
