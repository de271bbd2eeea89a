"""What goes wrong, in the words of the command line."""

from __future__ import annotations


class Error(Exception):
    """Anything that granulens says is wrong."""

    def __init__(
        self,
        message: str,
        help: str | None = None,
        file: str | None = None,
        line: int | None = None,
        key: str | None = None,
    ) -> None:
        super().__init__(message, help, file, line, key)
        self.message = message
        self.help = help
        self.file = file
        self.line = line
        self.key = key

    def __str__(self) -> str:
        return self.message if not self.help else f"{self.message}\n  help: {self.help}"


class InputError(Error, ValueError):
    """What was given cannot be: a file, an option, an array. Says where, what was expected, and what to try."""


class GuardError(Error, RuntimeError):
    """A guard stopped a run on which everything else rests."""


class LostError(Error, RuntimeError):
    """An engine lost a part of the work more often than allowed: killed, out of time, out of memory, or its machine gone. No layout's fault;
    what was evaluated is kept."""
