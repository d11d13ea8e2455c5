#!/usr/bin/env python3
"""Ctrl-C acts at once while a file is read, on a pipe without a writer and in the middle of a large file, between files, and
within the loops of a scene."""

import math
import os
import signal
import subprocess
import sys
import tempfile
import time

LIMIT = 2.0  # [s] from the signal to the end, on a busy machine
INTERRUPTED = 130


def interrupted(program, *words, after=0.5):
    process = subprocess.Popen([program, *words], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    time.sleep(after)
    if process.poll() is not None:
        return f"{words}: it had ended with {process.returncode} before the signal"
    begin = time.monotonic()
    process.send_signal(signal.SIGINT)
    err = process.communicate()[1]
    took = time.monotonic() - begin
    if process.returncode != INTERRUPTED or err != "coppice: interrupted\n":
        return f"{words}: exit code {process.returncode}, said {err!r}"
    return f"{words}: it took {took:.1f} s" if took > LIMIT else None


def main():
    program = sys.argv[1]
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for name in ("pipe.swc", "pipe.xyz", "pipe.obj"):
            os.mkfifo(name)
            wrong.append(interrupted(program, "info", name))
        # Some 200 MB: several seconds to read.
        with open("large.xyz", "w", encoding="ascii") as file:
            for _ in range(20):
                file.write("1.234567 2.345678 3.456789 255 255 255\n" * 250_000)
        wrong.append(interrupted(program, "info", "large.xyz", "--threads", "1"))
        # Finished files of a batch are kept.
        with open("stem.xyz", "w", encoding="ascii") as file:
            for i in range(816):
                turn = math.pi * (i % 16) / 8
                file.write(f"{0.1 * math.cos(turn)} {0.1 * math.sin(turn)} {i // 16 / 25}\n")
        wrong.append(interrupted(program, "extract", "stem.xyz", "large.xyz", "-o", "many", "--threads", "1", after=1))
        if sorted(os.listdir("many")) != ["stem.swc", "trees.csv"]:
            wrong.append(f"many files left {os.listdir('many')}")
        with open("loops.coppice", "w", encoding="ascii") as file:
            file.write("sphere s\nrepeat 300\nrepeat 300\npointset gen s count=5000\nend\nend\n")
        wrong.append(interrupted(program, "run", "loops.coppice"))
        os.chdir("/")
    wrong = [text for text in wrong if text]
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
