#!/usr/bin/env python3
"""Compares the page of the tour with its programs: docs/library/tour.md quotes each of them with its output.

    tour_test.py SOURCE_DIR                  checks that every program is quoted exactly
    tour_test.py SOURCE_DIR PROGRAM...       and that its output agrees with the page; a folder means all programs in it
    tour_test.py SOURCE_DIR --write FOLDER   inserts programs and outputs into the page

Words must be equal. Numbers may differ by 3 %: decisions that depend on rounding differ between processors.
"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

PAGE = "docs/library/tour.md"
PROGRAMS = "examples/tour"
TOLERANCE = 0.03
SECTION = re.compile(
    r"(\[(?P<name>\d\d_\w+)\.cpp\]\(\.\./\.\./examples/tour/(?P=name)\.cpp\)[^\n]*\n\n```cpp\n)(?P<code>.*?)"
    r"(```\n\n```text\n)(?P<output>.*?)(```\n)",
    re.DOTALL,
)
PROGRAM = re.compile(r"\d\d_\w+")
NUMBER = re.compile(r"-?\d[\d,]*(?:\.\d+)?(?:e[+-]?\d+)?")


def get_output(program, root):
    """Returns the output of a program that runs in a new folder with the oak."""
    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(root / "examples/oak.swc", folder)
        done = subprocess.run([program.resolve()], cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{program.name} ended with {done.returncode}: {done.stderr}")
    return done.stdout


def same(expected, printed):
    if NUMBER.sub("#", expected) != NUMBER.sub("#", printed):
        return False
    pairs = zip(NUMBER.findall(expected), NUMBER.findall(printed))
    values = ((float(a.replace(",", "")), float(b.replace(",", ""))) for a, b in pairs)
    return all(abs(a - b) <= TOLERANCE * abs(a) for a, b in values)


def write(page, root, folder):
    def filled(match):
        name = match["name"]
        code = (root / PROGRAMS / f"{name}.cpp").read_text()
        return match[1] + code + match[4] + get_output(folder / name, root) + match[6]

    page.write_text(SECTION.sub(filled, page.read_text()))


def faults(page, root, programs):
    quoted = {match["name"]: match for match in SECTION.finditer(page.read_text())}
    sources = {path.stem: path.read_text() for path in sorted((root / PROGRAMS).glob("*.cpp"))}
    for name in sorted(quoted.keys() ^ sources.keys()):
        yield f"{name} " + ("is on the page, but there is no such program" if name in quoted else f"is missing on the page {PAGE}")
    for name in sorted(quoted.keys() & sources.keys()):
        if quoted[name]["code"] != sources[name]:
            yield f"{PAGE} quotes an outdated {name}.cpp; tests/tour_test.py --write updates it"
    for program in programs:
        if program.name not in quoted:
            yield f"{program} is not on the page"
            continue
        printed = get_output(program, root)
        if not same(quoted[program.name]["output"], printed):
            yield f"{program.name} prints other output than {PAGE}:\n{printed}"


def main():
    root = pathlib.Path(sys.argv[1])
    page = root / PAGE
    if sys.argv[2:3] == ["--write"]:
        write(page, root, pathlib.Path(sys.argv[3]))
        return
    programs = []
    for path in map(pathlib.Path, sys.argv[2:]):
        programs += sorted(p for p in path.iterdir() if PROGRAM.fullmatch(p.name)) if path.is_dir() else [path]
    found = list(faults(page, root, programs))
    print("\n".join(found))
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
