#!/usr/bin/env python3
"""docs_test.py SOURCE_DIR [PROGRAM]: keys of cited sources and links to files exist; pictures are used and small; the library's
modules are listed; README.md's commands run.

Commands are those of the README that begin with "coppice "; they run in a folder of their own beside a copy of examples/.
"""

import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

CITED = re.compile(r"\[([A-Z][A-Za-z]+(?:19|20)\d\d[a-z]?)\]")
LINK = re.compile(r"\]\(([^)#\s]*)(?:#([^)]*))?\)")
CODE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)
HEADING = re.compile(r"^#+ +(.*)$", re.MULTILINE)
LARGEST_PICTURES = 1 << 20  # bytes of all together
FOLDERS = ("src", "app", "bench", "tests", "examples", "docs")


def texts(root):
    files = [p for p in root.glob("*.md")]
    for folder in FOLDERS:
        files += [p for p in (root / folder).rglob("*") if p.suffix in {".h", ".cpp", ".py", ".md"}]
    for path in sorted(files):
        if "node_modules" not in path.parts:
            yield path, path.read_text(errors="replace")


def missing_sources(root):
    known = set(re.findall(r"@\w+\{(\w+),", (root / "docs/references.bib").read_text()))
    cited = set()
    for path, text in texts(root):
        for key in CITED.findall(text):
            cited.add(key)
            if key not in known:
                yield f"{path.relative_to(root)}: [{key}] is not in docs/references.bib"
    for key in sorted(known - cited):
        yield f"docs/references.bib: nothing cites {key}"


def anchors(text):
    """What the headings of a page are called in links."""
    return {re.sub(r"[^\w -]", "", heading.strip().lower()).replace(" ", "-") for heading in HEADING.findall(text)}


def broken_links(root):
    for path, text in texts(root):
        if path.suffix != ".md":
            continue
        for target, anchor in LINK.findall(CODE.sub("", text)):
            if "://" in target:
                continue
            page = path.parent / target if target else path
            if not page.exists():
                yield f"{path.relative_to(root)}: links to {target}, which does not exist"
            elif anchor and page.suffix == ".md" and anchor not in anchors(page.read_text()):
                yield f"{path.relative_to(root)}: links to {target}#{anchor}, and no heading there is called so"


def pictures(root):
    files = sorted((root / "docs/pictures").iterdir())
    pages = [text for path, text in texts(root) if path.suffix == ".md"]
    used = {pathlib.PurePath(target).name for text in pages for target, _ in LINK.findall(text)}
    for path in files:
        if path.name not in used:
            yield f"{path.relative_to(root)}: no page shows it"
    total = sum(path.stat().st_size for path in files)
    if total > LARGEST_PICTURES:
        yield f"docs/pictures: {total} bytes, more than {LARGEST_PICTURES}"


def missing_modules(root):
    """The table of docs/library/README.md has every library, in the order of layers.txt."""
    listed = re.findall(r"^(\w+):", (root / "layers.txt").read_text(), re.MULTILINE)
    libraries = [module for module in listed if (root / "src/coppice" / module).is_dir()]
    rows = re.findall(r"^\| `(\w+)` \|", (root / "docs/library/README.md").read_text(), re.MULTILINE)
    if rows != libraries:
        yield f"docs/library/README.md: lists the modules {' '.join(rows)}, layers.txt {' '.join(libraries)}"


def failing_commands(root, program):
    lines = re.findall(r"^(coppice .*)$", (root / "README.md").read_text(), re.MULTILINE)
    if not lines:
        yield "README.md: no commands found"
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(root / "examples", os.path.join(folder, "examples"))
        for line in lines:
            command = [program, *shlex.split(line, comments=True)[1:]]
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
            # Exit code 1 is the verdict of `check`, which other tests look after.
            if done.returncode not in (0, 1) or (done.returncode == 1 and "check" not in line):
                yield f"README.md: '{line}' ended with {done.returncode}: {done.stderr.strip()}"


def main():
    root = pathlib.Path(sys.argv[1])
    faults = [*missing_sources(root), *broken_links(root), *pictures(root), *missing_modules(root)]
    if len(sys.argv) > 2:
        faults += failing_commands(root, os.path.abspath(sys.argv[2]))
    print("\n".join(faults))
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
