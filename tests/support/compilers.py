"""What compiles and runs C on this machine; a test that needs more is left out, and says so."""

import os
import shutil
import subprocess

import pytest


def needs(*tools):
    """Leaves a test out where a tool is missing."""
    missing = [tool for tool in tools if shutil.which(tool) is None]
    return pytest.mark.skipif(bool(missing), reason=f"missing here: {', '.join(missing)}")


needs_cc = needs("cc")
needs_m4f = needs("arm-none-eabi-gcc", "arm-none-eabi-size", "qemu-system-arm")

BOTH = [pytest.param(cc, marks=needs(cc)) for cc in ("gcc", "clang")]
"""A parameter of a test: each C compiler."""


def links(cc, *options):
    """Whether a compiler makes a program with these options here."""
    command = [cc, *options, "-x", "c", "-", "-o", os.devnull]
    done = subprocess.run(command, input=b"int main(void) { return 0; }", capture_output=True)
    return done.returncode == 0
