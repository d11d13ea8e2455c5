#!/usr/bin/env python3
"""Runs the programs of docs/user/python.md one after the other in one folder that contains examples/oak.swc. A program
that imports a missing package is skipped."""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
OPTIONAL = ("networkx", "pandas", "meshio")


def main():
    text = (ROOT / "docs/user/python.md").read_text()
    programs = re.findall(r"^```python\n(.*?)^```", text, re.M | re.S)
    if len(programs) < 8:
        sys.exit("docs/user/python.md contains %d programs; at least 8 are expected" % len(programs))
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(ROOT / "examples/oak.swc", folder)
        for number, program in enumerate(programs, 1):
            run = subprocess.run(
                [sys.executable, "-c", program], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
            )
            missing = re.search(r"No module named '(%s)'" % "|".join(OPTIONAL), run.stdout)
            if run.returncode != 0 and missing:
                print("program %d skipped: %s is not installed" % (number, missing[1]))
            elif run.returncode != 0:
                failed += 1
                print("program %d failed:\n%s\n%s" % (number, program, run.stdout))
            # A comment after print() states the output.
            for expected in re.findall(r"^print\(.*?\)  # (.*)$", program, re.M):
                if run.returncode == 0 and expected not in run.stdout:
                    failed += 1
                    print("program %d does not print %r, but %r" % (number, expected, run.stdout))
    print("%d programs, %d failed" % (len(programs), failed))
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
