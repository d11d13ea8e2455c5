"""Checks that passed, remembered between runs in the user's cache folder."""
import hashlib
import os
import pathlib
import time

MAX_AGE = 30 * 24 * 3600  # seconds for which a check is remembered since it was last looked up


class PassedChecks:
    """Those of one tool, each known by a hash of all that its result depends on."""

    def __init__(self, tool):
        self.folder = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "coppice" / tool
        self.folder.mkdir(parents=True, exist_ok=True)
        for record in self.folder.iterdir():
            if time.time() - record.stat().st_mtime > MAX_AGE:
                record.unlink(missing_ok=True)

    def record_of(self, *parts):
        """The file that exists once a check passed that depends on these bytes."""
        read = hashlib.sha256()
        for part in parts:
            read.update(len(part).to_bytes(8, "little") + part)
        return self.folder / read.hexdigest()

    @staticmethod
    def passed(record):
        """Whether the check of that record passed, which is remembered for longer then."""
        if record.exists():
            record.touch()
            return True
        return False
