"""Failures, in the words of the command line, with their parts as attributes."""


class Error(Exception):
    """What failed: `str()` is the whole sentence with place and hint.

    kind: short word such as "unit", "range", "missing"; problem: what is wrong; hint: what to do, may be empty;
    file, line, column (from 1), byte (from 0): where, None or "" when unknown.
    """

    def __init__(self, text, *, kind="", problem="", hint="", file="", line=None, column=None, byte=None):
        super().__init__(text)
        self.kind = kind
        self.problem = problem or text
        self.hint = hint
        self.file = file
        self.line = line
        self.column = column
        self.byte = byte


class InputError(Error, ValueError):
    """A file, or a value in it, is wrong."""


class UsageError(Error, ValueError):
    """An argument is wrong."""


def wrong_use(problem, hint="", kind="usage"):
    """A UsageError of this package's own, in the form of the others."""
    return UsageError(problem + (f"\n  hint: {hint}" if hint else ""), kind=kind, problem=problem, hint=hint)


class SystemError(Error):
    """The machine failed: disk full, no permission, no display. Nothing is half written."""


class Cancelled(Error):
    """The work was cancelled, and not by Ctrl-C, which raises KeyboardInterrupt."""


class Defect(Error, RuntimeError):
    """A defect of Underbody, not of your input: please report it."""


class CheckFailed(Error):
    """The work is done, but a check that was asked for failed. `result` holds what came out."""

    def __init__(self, text, result=None):
        super().__init__(text, kind="check")
        self.result = result


class UnderbodyWarning(UserWarning):
    """Something that changes what a number means."""


# Tracebacks and pickles name them as they are called.
for _error in (Error, InputError, UsageError, SystemError, Cancelled, Defect, CheckFailed, UnderbodyWarning):
    _error.__module__ = "underbody"
