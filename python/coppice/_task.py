"""Runs commands of the library, with progress and Ctrl-C."""

from __future__ import annotations

import ctypes
import json
import os
import sys
import threading
from typing import Any, Callable, Dict, List, Optional, Sequence, Union

from . import _library as c
from ._errors import Cancelled, Error, FileError, InputError, UsageError

Progress = Union[None, bool, Callable[[str, float], Any]]

_ERRORS = {
    c.WRONG_USAGE: UsageError,
    c.BAD_INPUT: InputError,
    c.FILE_TROUBLE: FileError,
    c.INTERRUPTED: Cancelled,
}


def _bytes(word: Union[str, bytes]) -> bytes:
    try:
        encoded = os.fsencode(word)
    except UnicodeEncodeError:
        raise UsageError("the text %r cannot be encoded; use valid Unicode" % (word,)) from None
    if b"\0" in encoded:
        raise UsageError("a text contains a null character; remove it")
    return encoded


class _Bar:
    """Shows the progress of each stage by tqdm."""

    def __init__(self, tqdm: Any) -> None:
        self._tqdm = tqdm
        self._stage: Optional[str] = None
        self._bar: Any = None

    def __call__(self, stage: str, fraction: float) -> None:
        if stage != self._stage:
            self.close()
            self._stage = stage
            self._bar = self._tqdm(total=100, desc=stage, delay=0.5, leave=False, bar_format="{l_bar}{bar}| {elapsed}")
        self._bar.update(round(100 * fraction) - self._bar.n)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()


def _progress_function(progress: Progress) -> Optional[Callable[[str, float], Any]]:
    if progress is False:
        return None
    if callable(progress):
        return progress
    if progress is None and not (sys.stderr is not None and sys.stderr.isatty()):
        return None
    try:
        from tqdm.auto import tqdm
    except ImportError:
        if progress is None:
            return None
        raise UsageError("progress=True needs the package tqdm; install it, or pass a function") from None
    return _Bar(tqdm)


class Task:
    """One call of the library. The objects that it uses are stored by names that begin with "memory:"."""

    def __init__(self) -> None:
        self._address = c.library().task_create()
        if not self._address:
            raise MemoryError
        self._finished = threading.Event()

    def __del__(self) -> None:
        if getattr(self, "_address", None) and not sys.is_finalizing():
            c.library().task_free(self._address)

    def put(self, name: str, handle: c.Handle) -> None:
        self.check(c.library().task_put(self._address, _bytes(name), handle.address))

    def take(self, name: str) -> Optional[c.Handle]:
        address = c.library().task_take(self._address, _bytes(name))
        return c.Handle(address) if address else None

    def make(self, name: str, *arguments: Any) -> c.Handle:
        """Creates an object by a function of the library."""
        made = ctypes.c_void_p()
        function = getattr(c.library(), name)
        self.check(function(self._address, *arguments, ctypes.byref(made)))
        assert made.value is not None
        return c.Handle(made.value)

    def check(self, status: int) -> int:
        """Raises the exception of a status that is an error."""
        if status in _ERRORS:
            raise _ERRORS[status](self.message or "the task is used by another thread")
        return status

    @property
    def message(self) -> str:
        return str(c.library().task_message(self._address).decode("utf-8", "replace"))

    @property
    def output(self) -> str:
        return str(c.library().task_output(self._address).decode("utf-8", "replace"))

    @property
    def report(self) -> Dict[str, Any]:
        text = c.library().task_report(self._address)
        return dict(json.loads(text)) if text else {}

    def run(self, words: Sequence[Union[str, bytes]], progress: Progress = None) -> int:
        """Runs a command and returns its status. The GIL is released, and Ctrl-C cancels."""
        encoded: List[bytes] = [_bytes(word) for word in words]
        array = (ctypes.c_char_p * len(encoded))(*encoded)
        show = _progress_function(progress)
        raised: List[BaseException] = []

        def call_progress(_: Any, stage: bytes, fraction: float) -> int:
            try:
                return 1 if show is not None and show(stage.decode("utf-8", "replace"), fraction) is False else 0
            except BaseException as error:  # it cannot pass through C
                raised.append(error)
                return 1

        callback = c.PROGRESS(call_progress) if show is not None else c.PROGRESS()
        c.library().task_set_progress(self._address, callback, None)
        try:
            status = self._run_in_thread(len(encoded), array)
        finally:
            c.library().task_set_progress(self._address, c.PROGRESS(), None)
            if isinstance(show, _Bar):
                show.close()
        if raised:
            raise raised[0]
        return self.check(status)

    def _run_in_thread(self, count: int, array: Any) -> int:
        """Only the main thread receives Ctrl-C, and only while it runs Python: the call is in another thread."""
        if threading.current_thread() is not threading.main_thread():
            return int(c.library().task_run(self._address, count, array))
        status: List[int] = []
        thread = threading.Thread(
            target=lambda: status.append(c.library().task_run(self._address, count, array)), daemon=True
        )
        thread.start()
        try:
            thread.join()
        except BaseException:
            c.library().task_cancel(self._address)
            thread.join()
            raise
        return status[0]


def run_words(*words: Union[str, bytes]) -> str:
    """Runs a command by the words of the command line, as run_words("info", "oak.swc"), and returns the text that
    it prints."""
    task = Task()
    task.run(words)
    return task.output


__all__ = ["Task", "run_words", "Progress", "Error"]
