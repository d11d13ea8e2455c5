"""Exceptions, with the sentences of the program."""

from __future__ import annotations


class Error(Exception):
    """Base of all errors of coppice: one sentence that names the file or the option, and the remedy."""


class UsageError(Error, ValueError):
    """An option or an argument is invalid."""


class InputError(Error, ValueError):
    """The data is invalid."""


class FileError(Error, OSError):
    """A file cannot be read or written."""


class Cancelled(Error):
    """The progress function cancelled the work."""
