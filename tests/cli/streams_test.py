#!/usr/bin/env python3
"""Standard streams that are closed or full: the exit code is that of the work, and lost output is an error."""

import os
import subprocess
import sys
import tempfile

TREE = "1 1 0 0 0 0.2 -1\n2 1 0 0 1 0.15 1\n"
FILE_TROUBLE = 4

# The redirection of the shell, the command and the exit code.
CASES = [
    ("2>&-", "info missing.swc", 4), ("2>/dev/full", "info missing.swc", 4), ("2>&-", "mehs", 2), ("2>/dev/full", "mesh", 2),
    ("2>/dev/full", "shell < lines.txt", 3), (">&- 2>&-", "info missing.swc", 4), ("2>&-", "mesh tree.swc -o a.ply", 0),
    ("<&-", "info tree.swc", 0), (">&-", "mesh tree.swc -o b.ply", 0), ("<&- >&- 2>&-", "mesh tree.swc -o c.ply", 0)]
# Commands that print.
PRINTING = ["--help", "--version", "help", "mesh --help", "schema", "info tree.swc", "info tree.swc --json", "info tree.swc --forestry",
            "check box.obj", "compare tree.swc tree.swc", "table tree.swc", "run --reference", "run list.coppice", "edit --reference",
            "edit tree.swc 'select tips'", "library list oak.branches", "shell < list.coppice"]


def run(program, words, redirection):
    return subprocess.run(["sh", "-c", f"exec {program} {words} {redirection}"], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True)


def complaints(program):
    for redirection, words, code in CASES:
        done = run(program, words, redirection)
        if done.returncode != code:
            yield f"coppice {words} {redirection}: exit code {done.returncode} instead of {code}\n{done.stderr}"
    for words in PRINTING:
        for redirection, reason in ((">/dev/full", "no space is left on the disk"), (">&-", "it is closed")):
            done = run(program, words, redirection)
            if done.returncode != FILE_TROUBLE or not done.stderr.endswith(f"cannot write to the standard output: {reason}\n"):
                yield f"coppice {words} {redirection}: exit code {done.returncode}\n{done.stderr}"
    for name in ("a.ply", "b.ply", "c.ply"):
        with open(name, "rb") as file:
            if not file.read().startswith(b"ply"):
                yield f"{name} is not whole"


def main():
    program = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for name, text in (("tree.swc", TREE), ("list.coppice", "sphere s\nlist\n"), ("lines.txt", "shpere s\n"),
                           ("box.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"),
                           ("fork.swc", TREE + "3 1 1 0 2 0.1 2\n4 1 -1 0 2 0.1 2\n")):
            with open(name, "w", encoding="utf-8") as file:
                file.write(text)
        subprocess.run([program, "library", "add", "oak.branches", "fork.swc"], check=True, capture_output=True)
        found = list(complaints(program))
        os.chdir("/")
    print("\n".join(found))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
