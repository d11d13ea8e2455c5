#!/usr/bin/env python3
"""Groups sources that can be compiled as one translation unit: third-party headers and the instantiation of their templates,
which need most of the time, are then compiled once per group.

A name in an anonymous namespace must differ from every name that the other sources of its group see. If two sources define the same
private name, for example a file-local function, a macro renames it in one of them, unless a header of either source uses the same word.

    script/source_groups.py MAXIMUM FOLDER SOURCE...  writes a source for each group to FOLDER; prints all sources to compile, separated by ;

A written source includes its group by relative paths, so that clones in different folders share a compiler cache.
"""
import functools
import json
import os
import pathlib
import re
import shlex
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
# A name that is defined or declared in the first column; for an alias the whole line, because equal aliases do not conflict.
NAMED = re.compile(r"^(?:struct|class|enum class|enum) (\w+)|^(using \w+ = .*)|"
                   r"^(?!namespace|using)[a-zA-Z][^=;(){}\n]*?[\s&*>](\w+)(?:\[\w*\])? ?[=({;]", re.MULTILINE)
DECLARATION = re.compile(r"^constexpr [^(){}\n]*;", re.MULTILINE)  # may declare several constants
BROUGHT = re.compile(r"^using (?:\w*::)+(\w+);", re.MULTILINE)
ANONYMOUS = re.compile(r"^namespace \{$(.*?)^\}  // namespace$", re.MULTILINE | re.DOTALL)
OWN_HEADER = re.compile(r'^#include "(.*)"', re.MULTILINE)
# Compound words, which the standard library and third-party headers do not contain by chance: file_local, kConstant, TypeName.
RENAMABLE = re.compile(r"[a-z]\w*_\w+|k[A-Z]\w+|[A-Z][a-z0-9]+[A-Z]\w*")


def named_in(text):
    """Returns the names that a text declares; maps each to its declaration if it is an alias, and to itself otherwise."""
    names = {(found.split()[1] if found.startswith("using ") else found): found
             for match in NAMED.findall(text) for found in match if found not in ("", "main")}
    others = {name: name for declaration in DECLARATION.findall(text) for name in re.findall(r", (\w+) =", declaration)}
    return names | others | {match[1]: match[0] for match in BROUGHT.finditer(text)}


def own_includes(file):
    """Returns the files of this project that a file includes directly."""
    found = []
    for header in OWN_HEADER.findall(file.read_text()):
        places = (folder / header for folder in (ROOT / "src", file.parent, file.parent.parent, ROOT / "tests"))
        found += [place for place in places if place.exists()][:1]
    return found


@functools.cache
def included_by(file):
    """Returns all files of this project that a file includes, directly or indirectly."""
    direct = own_includes(file)
    return frozenset(direct).union(*map(included_by, direct))


@functools.cache
def names_of(file):
    """Returns the private names of a file, and the names that the other sources of its group would see, including those of its headers."""
    text = file.read_text()
    own = named_in("\n".join(ANONYMOUS.findall(text))) if file.suffix == ".cpp" else {}
    seen = {*named_in(ANONYMOUS.sub("", text))}
    for header in own_includes(file):
        seen |= names_of(header)[1]
    return own, seen


@functools.cache
def words_of(file):
    return {*re.findall(r"\w+", file.read_text())}


@functools.cache
def words_of_headers(file):
    """Returns all words in the headers of this project that a file includes, directly or indirectly."""
    return set().union(*map(words_of, included_by(file)))


def clashes(source, other):
    """Returns the names in the anonymous namespaces of a source that another source also sees or defines, except equal aliases."""
    (own, _), (own_other, seen_other) = names_of(source), names_of(other)
    return {name for name in own if name in seen_other or name in own_other and not own[name] == own_other[name] != name}


@functools.cache
def compatible(a, b):
    """Returns whether two sources can be compiled as one."""
    return all(RENAMABLE.fullmatch(name) and name not in words_of_headers(source)
               for source, other in ((a, b), (b, a)) for name in clashes(source, other))


def groups_of(sources, maximum):
    """Returns the sources in groups of at most `maximum` compatible ones."""
    # Sources that use Highway include themselves once per instruction set.
    alone = [source for source in sources if "foreach_target.h" in source.read_text()]
    groups = []
    # The sources with the largest number of private names are the hardest to place and come first.
    for source in sorted(set(sources) - set(alone), key=lambda source: (-len(names_of(source)[0]), source)):
        room = next((group for group in groups if len(group) < maximum and all(compatible(source, other) for other in group)), None)
        if room is None:
            groups.append([source])
        else:
            room.append(source)
    return groups + [[source] for source in alone]


def compile_flags(build):
    """Returns the union of the include folders and macros of all targets of a configured build folder, with which every source compiles."""
    flags = {"-std=c++20": None}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        words = iter(shlex.split(entry["command"]))
        for word in words:
            if word.startswith(("-I", "-D")):
                flags[word] = None
            elif word == "-isystem":
                flags["-isystem" + next(words)] = None
    return [*flags]


def includes_of(group, path_of=str):
    """Returns the text that includes each source of a group with its clashing names renamed; path_of(source) is the path to include."""
    texts = []
    for i, source in enumerate(group):
        renamed = sorted(set().union(*(clashes(source, other) for other in group if other != source)))
        lines = [*(f"#define {name} {name}{i}" for name in renamed), f'#include "{path_of(source)}"', *(f"#undef {name}" for name in renamed)]
        texts.append("".join(line + "\n" for line in lines))
    return texts


def write_group(file, group):
    """Writes the source of a group if it is missing or out of date; returns its path."""
    text = "".join(includes_of(group, lambda source: os.path.relpath(source, file.parent)))
    if not file.exists() or file.read_text() != text:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    return file


def main():
    maximum, folder, sources = int(sys.argv[1]), pathlib.Path(sys.argv[2]), [pathlib.Path(word) for word in sys.argv[3:]]
    groups = groups_of(sources, maximum)
    print(";".join(str(group[0] if len(group) == 1 else write_group(folder / f"group_{i}.cpp", group))
                   for i, group in enumerate(groups)), end="")


if __name__ == "__main__":
    main()
