#!/usr/bin/env python3
"""Runs the program once in a fresh folder with small inputs and compares exit code, output and files.

A pattern that starts with "json:" asks for JSON with these keys instead. --report FILE:key,key.key=value does so for a file.
"""

import argparse
import json
import math
import os
import re
import shlex
import signal
import struct
import subprocess
import sys
import tempfile
import time

SKIPPED = 77

CUBE = "".join(f"v {x} {y} {z}\n" for z in (-1, 1) for y in (-1, 1) for x in (-1, 1))
CUBE_FACES = ["f 1 3 4 2\n", "f 5 6 8 7\n", "f 1 2 6 5\n", "f 3 7 8 4\n", "f 1 5 7 3\n", "f 2 4 8 6\n"]
TREE = "1 1 0 0 0 0.2 -1\n2 1 0 0 1 0.15 1\n3 1 0.5 0 1.8 0.1 2\n4 1 -0.5 0 1.8 0.1 2\n"


def write(name, content):
    with open(name, "wb") as file:
        file.write(content.encode() if isinstance(content, str) else content)


def make_inputs():
    write("tree.swc", TREE)
    # A branch that comes back and runs through its own stem, out again on the other side.
    write("loop.swc", "1 1 0 0 0 0.1 -1\n2 1 0 0 4 0.1 1\n3 1 4 0 4 0.1 2\n4 1 4 0 2 0.05 3\n5 1 1 0 2 0.05 4\n6 1 -2 0 2 0.05 5\n")
    write("tree_cm.swc", "1 1 0 0 0 20 -1\n2 1 0 0 100 15 1\n3 1 50 0 180 10 2\n4 1 -50 0 180 10 2\n")
    write("messy.swc", "2 1 0 0 1 0.15 1\n1 1 0 0 0 0.2 -1\n3 1 0 0 2 0 2\n")
    write("broken.swc", "1 1 0 0 0 0.2 -1\n2 1 0 0 1 0.1 1\n2 1 0 0 2 0.1 1\n")
    write("lines.obj", "v 0 0 0\nv 0 0 1\nv 0 0 2\nl 1 2 3\n")
    write("cube.obj", CUBE + "".join(CUBE_FACES))
    write("open.obj", CUBE + "".join(CUBE_FACES[1:]))
    write("empty.swc", "")
    # Rings of 16 points on a stem of radius 0.1 and 2 m.
    stem = [(0.1 * math.cos(math.pi * (i / 8 + k % 2 / 16)), 0.1 * math.sin(math.pi * (i / 8 + k % 2 / 16)), 0.04 * k)
            for k in range(51) for i in range(16)]
    rows = ["%.4f %.4f %.4f" % p for p in stem]
    write("stem.xyz", "\n".join(rows))
    write("stem.txt", "".join(row + " 1 200 90 40\n" for row in rows))
    write("tree.txt", TREE)
    write("stem.ply", "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
          "end_header\n" % len(rows) + "\n".join(rows) + "\n")
    write("two.xyz", "0 0 0\n0 0 1\n")
    las = bytearray(227)
    las[0:4], las[24:26], las[94:96], las[96:100] = b"LASF", b"\x01\x02", b"\xe3\x00", b"\xe3\x00\x00\x00"
    las[104], las[105], las[107] = 0x80, 20, 1  # compressed points of 20 bytes, of which there is one
    las[131:155] = struct.pack("<3d", 0.01, 0.01, 0.01)
    write("cut.laz", bytes(las))
    write("cut.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 100\nproperty float x\nproperty float y\n"
          "property float z\nelement face 50\nproperty list uchar int vertex_indices\nend_header\n1234")
    write("cut.glb", b"glTF\x02\x00\x00\x00\xff\xff\x00\x00")
    write("secret.swc", TREE)
    os.chmod("secret.swc", 0)
    write("tree.coppice", "sphere s\npointset gen s poisson count=200\n"
          "grow s s root=0,0,-1.5 influence_radius=2 kill_radius=0.2 step=0.1\nmesh s levels=1\ndescribe s\n"
          "save s s.ply kind=points\n")
    write("ball.coppice", "sphere ball\n")
    write("wrong.coppice", "sphere s\nshpere t\n")
    write("lines.coppice", "list\nscale bal 2\nquit\nlist\n")
    os.mkdir("folder")
    os.mkdir("folder.ply")


def has_keys(text, keys):
    value = json.loads(text)
    for key in keys.split(","):
        at = value
        path, _, expected = key.partition("=")
        for part in path.split("."):
            if not isinstance(at, dict) or part not in at:
                return False
            at = at[part]
        if expected and str(at) != expected:
            return False
    return True


def matches(pattern, text):
    if pattern.startswith("json:"):
        return has_keys(text, pattern[5:])
    return re.search(pattern, text.rstrip("\n") if pattern.endswith("$") else text, re.DOTALL) is not None


def run(program, words, signal_name):
    lines = subprocess.DEVNULL
    if "<" in words:
        lines = open(words[words.index("<") + 1], encoding="utf-8")
        words = words[:words.index("<")]
    process = subprocess.Popen([program] + words, stdin=lines, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if signal_name:
        time.sleep(0.7)
        if process.poll() is None:
            process.send_signal(getattr(signal, signal_name))
    out, err = process.communicate()
    return process.returncode, out, err


def complaints(arguments, before, code, out, err):
    if code != arguments.exit:
        yield f"exit code {code} instead of {arguments.exit}"
    for name, pattern, text in (("stdout", arguments.out, out), ("stderr", arguments.err, err)):
        if pattern is not None and not matches(pattern, text):
            yield f"{name} does not match {pattern}"
    if arguments.err and len(err.strip().splitlines()) > 1:
        yield "an error is more than one line"
    for name in filter(None, arguments.gone.split(",")):
        if os.path.exists(name):
            yield f"{name} was left behind"
    for name in filter(None, arguments.there.split(",")):
        if not os.path.isfile(name) or os.path.getsize(name) == 0:
            yield f"{name} is missing"
    if arguments.report:
        name, keys = arguments.report.split(":")
        with open(name, encoding="utf-8") as file:
            if not has_keys(file.read(), keys):
                yield f"the report lacks one of {keys}, or it has another value"
    if code != 0 and set(os.listdir(".")) != before:
        yield f"files were left behind: {set(os.listdir('.')) - before}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--exit", type=int, required=True)
    parser.add_argument("--out")
    parser.add_argument("--err")
    parser.add_argument("--gone", default="")
    parser.add_argument("--there", default="")
    parser.add_argument("--report", default="")
    parser.add_argument("--signal")
    own, words = sys.argv[1:], ""
    if "--" in own:
        words = " ".join(own[own.index("--") + 1:])
        own = own[:own.index("--")]
    # A value may begin with a dash or be a regular expression: join it to its option.
    joined = own[:1] + [f"{own[i]}={own[i + 1]}" for i in range(1, len(own) - 1, 2)]
    arguments = parser.parse_args(joined)

    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        make_inputs()
        if "secret" in words and os.access("secret.swc", os.R_OK):
            return SKIPPED  # root reads everything
        before = set(os.listdir("."))
        code, out, err = run(arguments.program, shlex.split(words), arguments.signal)
        found = list(complaints(arguments, before, code, out, err))
        os.chdir("/")
    if found:
        print(f"coppice {words}\n" + "\n".join(found) + f"\n--- stdout\n{out}\n--- stderr\n{err}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
