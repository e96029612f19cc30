"""The errors that the command line reports, with their exit codes, as one tree of classes.

The command line catches only the root, `BrakeCalError`. Several mistakes in one file are one error,
whose message has a line for each mistake.
"""

import re
import unicodedata


def printable(text: str, keep: str = "") -> str:
    r"""Return the text with control characters, direction marks and invalid UTF-8 escaped.

    Spaces of any width and the characters in ``keep`` stay.

    >>> print(printable("\x1b[2J \u202egnp"))
    \x1b[2J \u202egnp
    """

    def escaped(character: str) -> str:
        is_space = unicodedata.category(character) == "Zs"
        if character in keep or character.isprintable() or is_space:
            return character
        return ascii(character)[1:-1]  # without the quotes

    return text if text.isprintable() else "".join(map(escaped, text))


def one_line(text: str) -> str:
    """Return the text in one line, with control characters escaped."""
    return printable(" ".join(line.strip() for line in text.splitlines() if line.strip()))


class BrakeCalError(Exception):
    """Root of every error that the command line reports."""

    exit_code = 1
    advice = ""  # the next step for the user if ``do`` is empty

    def __init__(
        self,
        problem: str,
        *,
        where: object = None,
        expected: str = "",
        do: str = "",
        lines: tuple[str, ...] = (),
    ):
        """Build the message: one line, then the ``lines`` of several mistakes, if any.

        ``problem`` says what was wrong and which value was given. ``where`` is the file, channel or
        key. ``expected`` is what would have been right. ``do`` is the next step for the user.
        """
        self.problem, self.expected = one_line(problem), one_line(expected)
        self.do = one_line(do or self.advice)
        self.where = where
        self.lines = tuple(map(one_line, lines))
        sentence = self.problem if where is None else f"{printable(str(where))}: {self.problem}"
        if self.expected:
            sentence += f"; expected {self.expected}"
        if self.do:
            sentence += f"; {self.do}"
        super().__init__("\n  ".join([sentence, *self.lines]))

    @property
    def kind(self) -> str:
        """Name of this kind of error in JSON, from the name of the class.

        >>> DamagedTable("edited").kind, ChannelMapError("empty").kind
        ('damaged_table', 'channel_map')
        """
        words = re.findall("[A-Z][a-z]+", type(self).__name__.removesuffix("Error"))
        return "_".join(words).lower()

    def to_dict(self) -> dict[str, object]:
        """Return the error as it stands in a JSON document."""
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
    """Forces of a roller brake tester are unreadable, or do not rise linearly with pressure."""


class TyreError(InputError):
    """A tyre property file is unreadable, incomplete, or of a tyre that does not fit the car."""


class LimitsError(InputError):
    """A limits file is unreadable or names an unknown metric."""


class ModelError(InputError):
    """A model file is unreadable or names an unknown effect."""


class SettingsError(InputError):
    """A settings file is unreadable or has an unknown key."""


class ExchangeError(InputError):
    """A calibration file (DCM, CDF) or a validation summary cannot be used."""


class NotFiniteError(InputError):
    """A computed number is not finite, so that nothing can be concluded."""


class ProgramError(InputError):
    """A linked program is unreadable, or does not hold the exported table."""


class KeyFileError(InputError):
    """A key file cannot be used or made; the message never shows a secret."""


class UsageError(BrakeCalError):
    """What was typed is no command line of the program."""

    exit_code = 2


class BatchError(UsageError):
    """A batch of logs, or work in several processes, cannot start or go on."""


class RevisionError(UsageError):
    """The tables that were named cannot be merged."""


class StoreError(BrakeCalError):
    """The table store is damaged or cannot do what was asked."""

    exit_code = 4


class TableNotFound(StoreError):
    """The store has no table of that name or version: a mistake in what was typed."""

    exit_code = 2


class DamagedTable(StoreError):
    """A version or the journal of a store was changed after it was written."""

    advice = "restore it from a copy of the store, or fit the car again"


class SignatureRefused(StoreError):
    """A signature is malformed, of another key, or not of this content."""


class ProgramFailure(BrakeCalError):
    """The program itself failed: an unforeseen exception, or not enough memory."""

    exit_code = 6


class AnswerError(BrakeCalError):
    """The answer could not be written: the disk is full, or the stream is closed."""

    exit_code = 5


def not_finite(quantity: str, where: object) -> NotFiniteError:
    """Return the error for a computed ``quantity`` that is infinite or no number."""
    flaw = f"{quantity} comes out as no finite number, so nothing is concluded from it"
    do = "look at each log with `brake-cal check` and at the file with `brake-cal vehicle check`"
    return NotFiniteError(flaw, where=where, expected="logs and a vehicle file of one car", do=do)


def program_failure(error: BaseException) -> ProgramFailure:
    """Return the error that reports an exception which nobody caught."""
    if isinstance(error, MemoryError):
        return ProgramFailure("not enough memory", do="give it more memory, or smaller logs")
    text = f"{type(error).__name__}: {' '.join(str(error).split())[:200]}".removesuffix(": ")
    do = "run it again with -v to see where, and report it with the files"
    return ProgramFailure(f"the program itself failed: {text}", do=do)
