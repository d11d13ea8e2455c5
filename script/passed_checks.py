"""Stores in the user's cache folder which checks passed in earlier runs."""
import hashlib
import os
import pathlib
import time

MAX_AGE = 30 * 24 * 3600  # [s] time since the last query after which a record is removed


class PassedChecks:
    """The passed checks of one tool; each is identified by a hash of all its inputs."""

    def __init__(self, tool):
        self.folder = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "coppice" / tool
        self.folder.mkdir(parents=True, exist_ok=True)
        for record in self.folder.iterdir():
            if time.time() - record.stat().st_mtime > MAX_AGE:
                record.unlink(missing_ok=True)

    def record_of(self, *parts):
        """Returns the file that exists if the check with these inputs passed."""
        read = hashlib.sha256()
        for part in parts:
            read.update(len(part).to_bytes(8, "little") + part)
        return self.folder / read.hexdigest()

    @staticmethod
    def passed(record):
        """Returns whether the check of this record passed; if so, restarts the time for which it is stored."""
        if record.exists():
            record.touch()
            return True
        return False
