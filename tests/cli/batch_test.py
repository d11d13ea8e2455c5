#!/usr/bin/env python3
"""Many files in one command: a bad file costs a row, results do not depend on the number of threads, and a batch that was killed is
resumed to the same files."""

import csv
import os
import pathlib
import subprocess
import sys
import tempfile
import time

FILES = 30


def tree(number):
    nodes = ["1 1 0 0 0 0.2 -1"] + [f"{i} 1 {0.01 * number * i} 0 {0.1 * i} {0.2 - 0.001 * i} {i - 1}" for i in range(2, 100)]
    return "\n".join(nodes) + "\n"


def contents(folder):
    return {path.name: path.read_bytes() for path in pathlib.Path(folder).glob("*.ply")}


def main():
    program = sys.argv[1]
    wrong = []

    def run(expected, *words):
        done = subprocess.run([program, "mesh", *words], capture_output=True, text=True, check=False)
        if done.returncode != expected:
            wrong.append(f"{words}: exit code {done.returncode}, {done.stderr!r}")
        return done

    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        os.mkdir("in")
        for number in range(FILES):
            pathlib.Path(f"in/t{number}.swc").write_text(tree(number), encoding="ascii")
        run(0, "in", "-o", "whole", "--threads", "1")
        whole = contents("whole")
        if len(whole) != FILES:
            wrong.append(f"{len(whole)} results")
        for _ in range(3):
            process = subprocess.Popen([program, "mesh", "in", "-o", "killed", "--resume"], stderr=subprocess.DEVNULL)
            time.sleep(0.1)
            process.kill()
            process.wait()
        run(0, "in", "-o", "killed", "--resume")
        if contents("killed") != whole:
            wrong.append("the resumed batch differs from the whole one")
        pathlib.Path("in/t3.swc").write_text(tree(FILES), encoding="ascii")
        pathlib.Path("killed/t5.ply").unlink()
        pathlib.Path("list.txt").write_text("in\nmissing.swc\n", encoding="ascii")
        listed = run(0, "@list.txt", "-o", "killed", "--resume", "--dry-run").stdout.splitlines()
        if len(listed) != 3:
            wrong.append(f"the dry run lists {listed}")
        run(4, "@list.txt", "-o", "killed", "--resume")
        with open("killed/trees.csv", encoding="utf-8", newline="") as table:
            failed = [row["input"] for row in csv.DictReader(table) if row["error"]]
        if failed != ["missing.swc"]:
            wrong.append(f"the table has errors of {failed}")
        os.chdir("/")
    print("\n".join(wrong))
    return 1 if wrong else 0


sys.exit(main())
