"""Make the files of this folder with Debian's minisign: `python tests/store/golden/make.py`.

Written by minisign 0.11-1 (Debian 12). The keys are for these tests only; they are public. Each run
makes other keys.

    open      no password
    small     the password of `PASSWORD`, hidden at little cost: minisign had 60 MB of memory
"""

import resource
import subprocess
from collections.abc import Callable
from pathlib import Path

HERE = Path(__file__).parent
PASSWORD = "Grüne Bremse 7"
COMMENT = "car 7, geprüft"
DATA = b"axle,pressure,torque\nfront,50,1250\nrear,50,460\n" + bytes(range(256))


def minisign(*arguments: str, typed: str = "", prepare: Callable[[], None] | None = None) -> None:
    """Run minisign in this folder, with ``typed`` on its input."""
    subprocess.run(
        ["minisign", *arguments], cwd=HERE, input=typed, text=True, check=True, preexec_fn=prepare
    )


def little_memory() -> None:
    """Leave minisign 60 MB."""
    resource.setrlimit(resource.RLIMIT_AS, (60_000_000, 60_000_000))


def main() -> None:
    """Make all files of this folder but this one."""
    (HERE / "data.bin").write_bytes(DATA)
    typed = f"{PASSWORD}\n"
    minisign("-G", "-f", "-W", "-p", "open.pub", "-s", "open.key")
    minisign(
        *("-G", "-f", "-p", "small.pub", "-s", "small.key"), typed=typed * 2, prepare=little_memory
    )
    for key, answer in (("open", ""), ("small", typed)):
        signing = ("-S", "-s", f"{key}.key", "-m", "data.bin", "-t", COMMENT)
        minisign(*signing, "-x", f"{key}.minisig", typed=answer)


if __name__ == "__main__":
    main()
