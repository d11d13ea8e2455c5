#!/usr/bin/env python3
"""docs_test.py SOURCE_DIR [PROGRAM]: keys of cited sources and links to files exist; images are used and small; the modules of
the library are listed; measured tables are dated; the commands of README.md run; every command, and every figure of check and
info, is documented.

Commands are those of the README that begin with "coppice "; they run in a new folder with a copy of examples/.
"""

import json
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile

CITED = re.compile(r"\[([A-Z][A-Za-z]+(?:19|20)\d\d[a-z]?)\]")
LINK = re.compile(r"\]\(([^)#\s]*)(?:#([^)]*))?\)")
CODE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)
HEADING = re.compile(r"^#+ +(.*)$", re.MULTILINE)
LARGEST_PICTURES = 1536 << 10  # [bytes] in total
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
    """Returns the anchors of the headings of a page."""
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
                yield f"{path.relative_to(root)}: links to {target}#{anchor}, which has no such heading"


def pictures(root):
    files = sorted((root / "docs/pictures").iterdir())
    pages = [text for path, text in texts(root) if path.suffix == ".md"]
    used = {pathlib.PurePath(target).name for text in pages for target, _ in LINK.findall(text)}
    for path in files:
        if path.name not in used:
            yield f"{path.relative_to(root)}: no page shows it"
    total = sum(path.stat().st_size for path in files)
    if total > LARGEST_PICTURES:
        yield f"docs/pictures: {total} bytes in total; the maximum is {LARGEST_PICTURES}"


def missing_modules(root):
    """Checks that the table of docs/library/README.md lists every library in the order of layers.txt."""
    listed = re.findall(r"^(\w+):", (root / "layers.txt").read_text(), re.MULTILINE)
    libraries = [module for module in listed if (root / "src/coppice" / module).is_dir()]
    rows = re.findall(r"^\| `(\w+)` \|", (root / "docs/library/README.md").read_text(), re.MULTILINE)
    if rows != libraries:
        yield f"docs/library/README.md: lists the modules {' '.join(rows)}, layers.txt {' '.join(libraries)}"


def undated_tables(root):
    """Checks that tables measured by a script begin with the date and the commit."""
    for path, text in texts(root):
        for name, first in re.findall(r"^<!-- (\w+) begin: written by .*-->\n(.*)$", text, re.MULTILINE):
            if path.suffix == ".md" and not re.match(r"Measured on \d{4}-\d\d-\d\d at commit [0-9a-f]{7}", first):
                yield f"{path.relative_to(root)}: the tables {name} have no date of measurement"


def run_studio(command, folder):
    """Ends the studio once it prints its address. `true` replaces the browser."""
    environment = dict(os.environ, BROWSER="true", XDG_STATE_HOME=folder)
    with subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        process.stdout.readline()
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate()
        return subprocess.CompletedProcess(command, process.returncode, "", errors)


def copy_examples(root, folder):
    """Uses one sample per pixel of an image, because the images are not checked."""
    shutil.copytree(root / "examples", os.path.join(folder, "examples"))
    for scene in pathlib.Path(folder, "examples").glob("*.coppice"):
        scene.write_text(re.sub(r"\bsamples=\d+", "samples=1", scene.read_text()))


def failing_commands(root, program):
    lines = re.findall(r"^(coppice .*)$", (root / "README.md").read_text(), re.MULTILINE)
    if not lines:
        yield "README.md: no commands found"
    with tempfile.TemporaryDirectory() as folder:
        copy_examples(root, folder)
        for line in lines:
            command = [program, *shlex.split(line, comments=True)[1:]]
            if command[1] in ("render", "animate"):
                command += ["--samples", "1"]
            done = run_studio(command, folder) if command[1] == "studio" else subprocess.run(
                command, cwd=folder, capture_output=True, text=True, check=False)
            # Exit code 1 is the verdict of `check`, which other tests cover.
            if done.returncode not in (0, 1) or (done.returncode == 1 and "check" not in line):
                yield f"README.md: '{line}' ended with {done.returncode}: {done.stderr.strip()}"


def unexplained_commands(root, program):
    """Returns the commands of `coppice help` without a section or a row in the table of command-line.md."""
    page = root / "docs/user/command-line.md"
    text = CODE.sub("", page.read_text())
    sections = set(re.findall(r"^## (\w+)$", text, re.MULTILINE))
    rows = set(re.findall(r"^\| \[(\w+)\]\(#\1\) \|", text, re.MULTILINE))
    listed = subprocess.run([program, "help"], capture_output=True, text=True, check=True).stdout.split("Subcommands:")[1]
    commands = set(re.findall(r"^  (\w+) ", listed, re.MULTILINE)) - {"help"}
    if not commands:
        yield "coppice help: lists no commands"
    for command in sorted(commands - (sections & rows)):
        yield f"{page.relative_to(root)}: needs a section and a row for 'coppice {command}'"


def names_in(figures):
    """Returns the names of all figures in a JSON report, at any depth."""
    if isinstance(figures, dict):
        yield from figures
    for value in figures.values() if isinstance(figures, dict) else figures if isinstance(figures, list) else ():
        yield from names_in(value)


def unexplained_figures(root, program):
    """Returns the figures of check and info for a skeleton, its mesh and a scan of it that figures.md lacks."""
    page = root / "docs/user/figures.md"
    explained = set(re.findall(r"`(\w+)`", page.read_text()))
    commands = ("mesh fork.swc -o mesh.ply", "scan mesh.ply --points 20000 -o scan.ply",
                "check mesh.ply --skeleton fork.swc --json", "info fork.swc --json --forestry", "info mesh.ply --json",
                "info scan.ply --json --forestry")
    with tempfile.TemporaryDirectory() as folder:
        # Nodes out of order, without a radius, at the position of the parent, of a sibling, and with a missing parent.
        pathlib.Path(folder, "fork.swc").write_text("3 1 0 0 2 0.1 2\n1 1 0 0 0 0.3 -1\n2 1 0 0 1 0.2 1\n4 1 1 0 2 0 2\n"
                                                    "5 1 1 0 2 0.1 4\n6 1 1 1 3 0.1 5\n7 1 4 0 0 0.1 99\n8 1 4 0 2 0.1 7\n"
                                                    "9 1 4 0 2 0.1 8\n10 1 4 1 3 0.1 9\n11 1 4 1 3 0.1 9\n")
        for command in commands:
            done = subprocess.run([program, *command.split()], cwd=folder, capture_output=True, text=True, check=False)
            if done.returncode != 0:
                yield f"{command}: ended with {done.returncode}: {done.stderr.strip()}"
            elif "--json" in command:
                for name in dict.fromkeys(names_in(json.loads(done.stdout))):
                    if name not in explained:
                        yield f"{page.relative_to(root)}: does not explain '{name}' of coppice {command.split()[0]}"


def main():
    root = pathlib.Path(sys.argv[1])
    faults = [*missing_sources(root), *broken_links(root), *pictures(root), *missing_modules(root), *undated_tables(root)]
    if len(sys.argv) > 2:
        program = os.path.abspath(sys.argv[2])
        faults += [*failing_commands(root, program), *unexplained_commands(root, program), *unexplained_figures(root, program)]
    print("\n".join(faults))
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
