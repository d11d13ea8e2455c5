#!/usr/bin/env python3
"""extract_terminal.py PROGRAM: what coppice extract says in a terminal of points that it leaves out as leaves."""

import math
import os
import pty
import re
import sys
import tempfile


def main():
    program = os.path.abspath(sys.argv[1])
    os.chdir(tempfile.mkdtemp())
    with open("stem.xyz", "w", encoding="utf-8") as file:  # rings of 16 points on a stem of radius 0.1 and 2 m
        for k in range(51):
            for i in range(16):
                turn = math.pi * (i / 8 + k % 2 / 16)
                file.write(f"{0.1 * math.cos(turn):.4f} {0.1 * math.sin(turn):.4f} {0.04 * k:.4f}\n")
    said = b""

    def read(terminal):
        nonlocal said
        said += (data := os.read(terminal, 65536))
        return data

    code = os.waitstatus_to_exitcode(pty.spawn([program, "extract", "stem.xyz", "-o", "stem.swc", "--leaves", "drop"], read))
    if code != 0 or not re.search(rb"stem\.swc: \d+ nodes in 1 trees, \d+ of 816 points left out as leaves", said):
        sys.exit(f"exit code {code}: {said!r}")


if __name__ == "__main__":
    main()
