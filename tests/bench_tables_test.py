#!/usr/bin/env python3
"""bench_tables_test.py SOURCE_DIR PROGRAMS: the tables of docs/user/benchmarks.md agree with the current results.

Runs the fast scenes once and compares their counts, which measure the amount of work independently of the machine, with those of the
tables. If they differ, measure again (script/bench), or add a line between the markers of the tables that begins with "Out of date:".
"""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

MAX_CHANGE = 0.01  # relative change of a count; processors differ in the last bits of sums


def measured(program, *arguments):
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "figures.json")
        subprocess.run([program, *arguments, "--repeat", "1", "--seconds", "0", "--json", file, "--csv", file.with_suffix(".csv")],
                       check=True, stdout=subprocess.DEVNULL)
        return json.loads(file.read_text())


def tables(page, name):
    """Returns the cells of every row by the first of them, or None for tables marked as out of date."""
    text = re.search(f"^<!-- {name} begin.*?^<!-- {name} end", page, re.MULTILINE | re.DOTALL).group()
    if re.search("^Out of date: ", text, re.MULTILINE):
        return None
    rows = {}
    for line in re.findall(r"^\| (.*) \|$", text, re.MULTILINE):
        cells = line.split(" | ")
        rows.setdefault(cells[0], cells[1:])
    return rows


def scene_counts(programs):
    figures = measured(programs / "coppice_bench", "tree300", "tree300hard", "tree3k", "--largest-output", "0")
    return {scene["scene"]: [scene["segments"], scene["quads"]] for scene in figures["scenes"]}


def crown_counts(programs):
    figures = measured(programs / "coppice_crown_bench", "--small")
    return {row["what"]: [row["size"]] for row in figures["rows"]}


def faults(rows, computed):
    for name, counts in computed.items():
        stated = [int(cell.split()[0]) for cell in rows.get(name, [])[:len(counts)]]
        if len(stated) < len(counts):
            yield f"the table has no row '{name}'; run script/bench"
        elif any(abs(a - b) > MAX_CHANGE * b for a, b in zip(stated, counts)):
            yield f"'{name}': the table contains {stated}, but {counts} was computed; run script/bench"


def main():
    root, programs = pathlib.Path(sys.argv[1]), pathlib.Path(os.path.abspath(sys.argv[2]))
    page = (root / "docs/user/benchmarks.md").read_text()
    wrong = []
    for name, counts in (("tables", scene_counts), ("crowns", crown_counts)):
        rows = tables(page, name)
        if rows is not None:
            wrong += faults(rows, counts(programs))
    print("\n".join(wrong))
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
