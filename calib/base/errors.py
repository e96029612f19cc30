"""The errors a user can cause, as one tree, with their exit codes.

The command line catches only the root. A message says what was wrong, which value was given, what
was expected and where to look. Several errors of one file are one message of several lines.
"""

import re
import unicodedata


def printable(text: str, keep: str = "") -> str:
    r"""Text with control characters, marks of writing direction and invalid UTF-8 escaped.

    Spaces of any width stay, and the characters in ``keep``.

    >>> print(printable("\x1b[2J \u202egnp"))
    \x1b[2J \u202egnp
    """
    if text.isprintable():
        return text
    shown = (c in keep or c.isprintable() or unicodedata.category(c) == "Zs" for c in text)
    return "".join(c if whole else ascii(c)[1:-1] for c, whole in zip(text, shown, strict=True))


def one_line(text: str) -> str:
    """Text in one line; control characters are escaped."""
    return printable(" ".join(line.strip() for line in text.splitlines() if line.strip()))


class BrakeCalError(Exception):
    """Root of every error that a user can cause and correct."""

    exit_code = 1
    advice = ""
    """The next step where an error of this kind names no other."""

    def __init__(
        self,
        problem: str,
        *,
        where: object = None,
        expected: str = "",
        do: str = "",
        lines: tuple[str, ...] = (),
    ):
        """Build the message, one line and one more for each of the further mistakes in ``lines``.

        ``problem`` with the value given; ``where``: file, channel or key; ``do`` the next step.
        """
        parts = (problem, expected, do or self.advice)
        self.problem, self.expected, self.do = map(one_line, parts)
        self.where = where
        head = self.problem if where is None else f"{printable(str(where))}: {self.problem}"
        sentences = (head, f"expected {self.expected}" if expected else "", self.do)
        whole = "; ".join(filter(None, sentences))
        self.lines = tuple(map(one_line, lines))
        super().__init__("\n  ".join([whole, *self.lines]))

    @property
    def kind(self) -> str:
        """Name of the kind for programs.

        >>> DamagedTable("edited").kind, ChannelMapError("empty").kind
        ('damaged_table', 'channel_map')
        """
        words = re.findall("[A-Z][a-z]+", type(self).__name__.removesuffix("Error"))
        return "_".join(words).lower()

    def to_dict(self) -> dict[str, object]:
        """The error as plain data, see `calib.base.record`."""
        return {
            "kind": self.kind,
            "message": str(self),
            "exit_code": self.exit_code,
            "what": self.problem,
            "where": "" if self.where is None else str(self.where),
            "expected": self.expected,
            "do": self.do,
            "lines": list(self.lines),
        }


class InputError(BrakeCalError):
    """A file from the user cannot be used."""

    exit_code = 3


class LogError(InputError):
    """A log is missing, unreadable or unfit for the task."""


class VehicleError(InputError):
    """A vehicle file is missing, unreadable or implausible."""


class ChannelMapError(InputError):
    """A channel map is unreadable or does not fit the log."""


class BenchError(InputError):
    """Forces of a roller brake tester are unreadable, or on no line that rises with pressure."""


class TyreError(InputError):
    """A tyre property file is unreadable, incomplete, or of no tyre of the car."""


class LimitsError(InputError):
    """A limits file is unreadable or names an unknown metric."""


class ModelError(InputError):
    """A model file is unreadable or names an unknown effect."""


class SettingsError(InputError):
    """A settings file is unreadable or has an unknown key."""


class ExchangeError(InputError):
    """A calibration file (DCM, CDF) or a validation summary cannot be used."""


class NotFiniteError(InputError):
    """A computed number is not finite: nothing is concluded from it."""


def not_finite(quantity: str, where: object) -> NotFiniteError:
    """The error for a computed ``quantity`` that is not finite."""
    flaw = f"{quantity} comes out as no finite number, so nothing is concluded from it"
    do = "look at each log with `brake-cal check` and at the file with `brake-cal vehicle check`"
    return NotFiniteError(flaw, where=where, expected="logs and a vehicle file of one car", do=do)


class ProgramError(InputError):
    """A linked program is unreadable, or does not hold the exported table."""


class KeyFileError(InputError):
    """A key file cannot be used or made; the message never shows a secret."""


class UsageError(BrakeCalError):
    """What was typed is no command line of the program."""

    exit_code = 2


class BatchError(UsageError):
    """A batch cannot start: other settings, folder in use, no scheduler, unfit workers."""


class RevisionError(UsageError):
    """Tables cannot be merged."""


class StoreError(BrakeCalError):
    """The table store is damaged or cannot do what was asked."""

    exit_code = 4


class TableNotFound(StoreError):
    """The store has no table of that name or version: a mistake in what was typed."""

    exit_code = 2


class DamagedTable(StoreError):
    """A version or the journal of a store is not what was written."""

    advice = "restore it from a copy of the store, or fit the car again"


class SignatureRefused(StoreError):
    """A signature does not hold, is of another key or is malformed."""


class ProgramFailure(BrakeCalError):
    """The program itself failed: an error that nobody foresaw, or no memory."""

    exit_code = 6


def program_failure(error: BaseException) -> ProgramFailure:
    """The error to report for one that nobody caught."""
    if isinstance(error, MemoryError):
        return ProgramFailure("not enough memory", do="give it more memory, or smaller logs")
    text = f"{type(error).__name__}: {' '.join(str(error).split())[:200]}".removesuffix(": ")
    do = "run it again with -v to see where, and report it with the files"
    return ProgramFailure(f"the program itself failed: {text}", do=do)


class AnswerError(BrakeCalError):
    """The answer could not be written: the disk is full, or the stream is closed."""

    exit_code = 5
