#!/usr/bin/env python3
"""Checks the language of comments, messages, names, pages and commits: tests/language_test.py [FOLDER [PROGRAM]], or --self-test

Words of the glossary (docs/glossary.md) are used; the words listed here are not, because they hide the subject of a
sentence or have a plain technical equivalent. Bounds are called max and min. With the program, also checks that every help
text is one sentence, and that an option has the same help in every command."""

import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import tokenize

# The banned word and its replacement.
BANNED = {
    "what": "name the thing", "whatever": "any", "whichever": "the one that", "wherever": "where", "whose": "with, of which",
    "anew": "again", "beside": "next to, in addition to", "nobody": "no user", "lies": "is", "stands": "is", "told": "reported",
    "tells": "reports", "tell": "report", "asked": "requested", "mend": "repair", "mends": "repairs", "mended": "repaired",
    "meanwhile": "temporarily", "heeded": "considered",
}
WORD = re.compile(r"\b(" + "|".join(BANNED) + r")\b(?![_(-])", re.IGNORECASE)
BOUND = re.compile(r"\bk(?:Most|Least|Fewest|Greatest)[A-Z]?\w*|\b(?:most|fewest|greatest)_\w+|--(?:most|least|fewest|greatest)-[\w-]+")
SUBJECT = re.compile(r"(?=.{1,72}$)[a-z][\w-]*(?:, [a-z][\w-]*)*: [a-z].*")  # of a commit
LAST_UNCHECKED = "51124e4dc6182a4a5328dc5e1d57938471eb26bd"  # last commit with an unchecked subject
MAX_COLUMNS = 200  # of a line of a page, except in tables and code: one sentence a line

CPP = re.compile(r'''(?P<raw>R"(?P<mark>[^()\s\\"]{0,16})\(.*?\)(?P=mark)")|(?P<block>/\*.*?\*/)|(?P<line>//[^\n]*)|'''
                 r'''(?P<text>"(?:[^"\\\n]|\\.)*")|(?P<character>(?<!\w)'(?:[^'\\\n]|\\.)+')''', re.DOTALL)
FOLDERS = ("src", "app", "bench", "tests", "examples", "web/src", "web/test", "cmake", "script", "docs", ".ci")
CODE = {".cpp", ".h", ".cu", ".cuh", ".ts", ".tsx", ".mjs"}
# Options of one name with a different meaning or other files in each command.
HOMONYMS = {f"--{name}" for name in (
    "azimuth base crowns format height max-nodes method noise output pipe-exponent reference seed sheet spacing then-mesh tile-height tips tolerance "
    "units width").split()}
SKIPPED = {"CHANGELOG.md", "language_test.py"}


def cpp_prose(text, with_strings):
    """(offset, text) of comments, and of strings with a blank."""
    for match in CPP.finditer(text):
        if match["line"] or match["block"]:
            yield match.start(), match[0]
        elif with_strings and match["text"] and " " in match[0]:
            yield match.start(), match[0]


def python_prose(path):
    """(line, text) of comments and docstrings."""
    with tokenize.open(path) as file:
        for token in tokenize.generate_tokens(file.readline):
            if token.type == tokenize.COMMENT or token.type == tokenize.STRING and token.string.lstrip("rbf").startswith('"""'):
                yield token.start[0], token.string


def page_prose(text):
    """(line, text) of the lines of a page outside of code."""
    in_code = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            in_code = not in_code
        elif not in_code and not line.startswith("    "):
            yield number, re.sub(r"`[^`]*`|\]\([^)]*\)", "", line)


def prose(root, path):
    text = path.read_text(encoding="utf-8")
    if path.suffix in CODE:
        with_strings = any(path.is_relative_to(root / folder) for folder in ("src", "app", "web/src"))
        return [(text.count("\n", 0, at) + 1, part) for at, part in cpp_prose(text, with_strings)]
    if path.suffix == ".md":
        return list(page_prose(text))
    if path.suffix == ".py":
        return list(python_prose(path))
    return [(n, line) for n, line in enumerate(text.splitlines(), 1) if line.lstrip().startswith("#")]


def files(root):
    """Returns the files to check."""
    found = [path for folder in FOLDERS for path in (root / folder).rglob("*")] + [*root.glob("*.md"), root / "CMakeLists.txt"]
    suffixes = CODE | {".md", ".py", ".txt", ".cmake", ""}
    chosen = sorted(path for path in found if path.suffix in suffixes and path.is_file() and not path.is_symlink()
                    and path.name not in SKIPPED and "corpus_" not in str(path) and "node_modules" not in path.parts)
    if not chosen:
        sys.exit(f"{root}: there are no files to check")
    return chosen


def check_files(root):
    faults = []
    for path in files(root):
        name = path.relative_to(root)
        try:
            parts = prose(root, path)
        except UnicodeDecodeError:
            continue
        for line, part in parts:
            for match in WORD.finditer(part):
                faults.append(f"{name}:{line + part.count(chr(10), 0, match.start())}: '{match[0]}'; write: {BANNED[match[0].lower()]}")
        text = path.read_text(encoding="utf-8")
        for match in BOUND.finditer(text) if name.name != "renamed.cpp" and path.suffix in CODE | {".md"} else ():
            faults.append(f"{name}:{text.count(chr(10), 0, match.start()) + 1}: '{match[0]}'; bounds are called max and min")
        if path.suffix == ".md":
            in_code = False
            for n, line in enumerate(text.splitlines(), 1):
                in_code ^= line.lstrip().startswith("```")
                if len(re.sub(r"\]\([^)]*\)", "]", line)) > MAX_COLUMNS and not in_code and not line.lstrip().startswith(("|", "![", "    ")):
                    faults.append(f"{name}:{n}: {len(line)} columns; write one sentence a line")
    return faults


def check_subjects(lines):
    """Lines have the hash and the subject of a commit: 'module: imperative', at most 72 characters."""
    return [f"commit {line}: write 'module: imperative' in at most 72 characters" for line in lines if not SUBJECT.match(line.split(" ", 1)[1])]


def commits(root):
    """The hash and the subject of the commits after LAST_UNCHECKED; none in a shallow clone or outside of a repository."""
    if not shutil.which("git"):
        return []
    log = subprocess.run(["git", "-C", root, "log", "--no-merges", "--format=%h %s", f"{LAST_UNCHECKED}..HEAD"], capture_output=True, text=True, check=False)
    return log.stdout.splitlines() if log.returncode == 0 else []


def check_help(schema):
    """Help texts are one sentence; an option has the same help in every command, unless its name has several meanings."""
    faults, known = [], {}
    for command, entry in schema["commands"].items():
        for option in entry["options"]:
            name, text = option["name"], option["help"]
            first = known.setdefault((name, option["type"]), (text, command))
            if name.startswith("--") and first[0] != text and name not in HOMONYMS:
                faults.append(f"{command} {name}: '{text}' differs from the help of {first[1]}: '{first[0]}'")
    for place, text in help_texts(schema, ""):
        if not re.fullmatch(r"[A-Z0-9].*\.", text) or re.search(r"[a-z)]\. [A-Z]", text):
            faults.append(f"{place}: '{text}' is not one sentence with a capital and a full stop")
    return faults


def help_texts(entry, place):
    """(place, text) of every help in a schema, except those of nested structs, which are titles."""
    if isinstance(entry, list):
        for item in entry:
            yield from help_texts(item, place)
    elif isinstance(entry, dict):
        here = f"{place} {entry['name']}".strip() if isinstance(entry.get("name"), str) else place
        if isinstance(entry.get("help"), str) and "fields" not in entry:
            yield here, entry["help"]
        for key, value in entry.items():
            yield from help_texts(value, here if "name" in entry else f"{place} {key}".strip())


def self_test():
    """Known faults are found, and no others."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in {"src/a.cpp": "// Returns what lies beside it.\nconstexpr int kMostNodes = 1;\nf(\"told to wait\");\nint what = 1;\n",
                           "docs/b.md": "A sentence.\n" + "word " * 41 + "\n`what` in code\n",
                           "script/c.py": '"""Whatever."""\nx = 1  # anew\n'}.items():
            (root / name).parent.mkdir()
            (root / name).write_text(text)
        found = [fault.split(";")[0] for fault in check_files(root)]
    expected = ["docs/b.md:2: 205 columns", "script/c.py:1: 'Whatever'", "script/c.py:2: 'anew'", "src/a.cpp:1: 'what'", "src/a.cpp:1: 'lies'",
                "src/a.cpp:1: 'beside'", "src/a.cpp:3: 'told'", "src/a.cpp:2: 'kMostNodes'"]
    helps = check_help({"commands": {"a": {"options": [{"name": "--x", "type": "int", "help": "Size of x."}]},
                                     "b": {"options": [{"name": "--x", "type": "int", "help": "size of y"}]}}})
    subjects = check_subjects(["1 io, mesh: read polygons", "2 Read polygons", "3 io: Polygons", f"4 io: read {'x' * 63}", f"5 io: read {'x' * 64}"])
    if found != expected or len(helps) != 2 or [fault.split()[1] for fault in subjects] != ["2", "3", "5"]:
        sys.exit(f"expected {expected}, two faults of help and three of subjects, found {found}, {helps} and {subjects}")


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
    faults = check_files(root) + check_subjects(commits(root))
    if len(sys.argv) > 2:
        schema = subprocess.run([sys.argv[2], "schema"], capture_output=True, text=True, check=True).stdout
        faults += check_help(json.loads(schema))
    print("\n".join(faults))
    print(f"{len(faults)} faults of language")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
