#!/usr/bin/env python3
"""summary_terminal.py PROGRAM: the summaries that commands print in a terminal at their end."""

import math
import os
import pty
import re
import sys
import tempfile

# Rings of 16 points on a stem of radius 0.1 and 2 m.
STEM = "".join(f"{0.1 * math.cos(math.pi * (i / 8 + k % 2 / 16)):.4f} {0.1 * math.sin(math.pi * (i / 8 + k % 2 / 16)):.4f} "
               f"{0.04 * k:.4f}\n" for k in range(51) for i in range(16))
STICK = "1 1 0 0 0 0.1 -1\n2 1 0 0 2 0.1 1\n"
# A stick on a stump that is shorter than it is wide: no row of quads fits around it.
STUMP = "1 1 0 0 0 0.5 -1\n2 1 0 0 0.4 0.1 1\n3 1 0 0 2 0.1 2\n"
# A branch that returns and runs through its own stem.
LOOP = "1 1 0 0 0 0.1 -1\n2 1 0 0 4 0.1 1\n3 1 4 0 4 0.1 2\n4 1 4 0 2 0.05 3\n5 1 1 0 2 0.05 4\n6 1 -2 0 2 0.05 5\n"

# Input, command, and the end of its summary.
CASES = [
    (STEM, "extract in.xyz -o out.swc --leaves drop", rb"out\.swc: \d+ nodes in 1 trees, \d+ of 816 points left out as leaves, "
     rb"height [\d.]+ m \([\d.]+ to [\d.]+\), DBH [\d.]+ cm \(2\d\.\d, [\d.]+ to [\d.]+, in the points\), length [\d.]+ m \([\d.]+ to [\d.]+\), [\d.]+ m3 \([\d.]+ to [\d.]+\), \d+ % inferred"),
    (STICK, "mesh in.swc -o out.ply", rb"[\d,]+ quads; volume 100\.00 % of the cones', 98\.[\d]+ % before fitting"),
    (STICK, "mesh in.swc -o out.ply --fit surface", rb"[\d,]+ quads; volume 98\.\d % of the cones'"),
    (STICK, "mesh in.swc -o out.ply --faces 1000", rb"quads; volume [\d.]+ % .*; level 2, 1 of 1 axes, without 0\.0 % of the silhouette"),
    (STUMP, "mesh in.swc -o out.ply", rb"[\d,]+ quads, 1 lost bulge remeshed; volume [\d.]+ % of the cones'.*"),
    (LOOP, "mesh in.swc -o out.ply --overlaps merge", rb"[\d,]+ quads, 1 handle; volume [\d.]+ % .*"),
]


def said_by(command):
    said = b""

    def read(terminal):
        nonlocal said
        said += (data := os.read(terminal, 65536))
        return data

    return os.waitstatus_to_exitcode(pty.spawn(command, read)), said


def main():
    program = os.path.abspath(sys.argv[1])
    os.chdir(tempfile.mkdtemp())
    for content, command, end in CASES:
        words = command.split()
        with open(words[1], "w", encoding="utf-8") as file:
            file.write(content)
        code, said = said_by([program, *words])
        if code != 0 or not re.search(end + rb"\r?\n", said):
            sys.exit(f"{command}: exit code {code}: {said!r}")


if __name__ == "__main__":
    main()
