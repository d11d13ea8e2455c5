#!/usr/bin/env python3
"""Groups sources that can be compiled as one translation unit: most of the time goes into the headers of others and into
instantiating their templates, which is then done once for each group. A name in an anonymous namespace must differ from every
name that the other sources of its group see.

    script/source_groups.py MAXIMUM FOLDER SOURCE...  writes a source for each group into FOLDER; prints all to compile, with ;

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
# A name that is defined or declared in the first column; of an alias the whole line, since equal aliases do not conflict.
NAMED = re.compile(r"^(?:struct|class|enum class|enum) (\w+)|^(using \w+ = .*)|"
                   r"^(?!namespace|using)[a-zA-Z][^=;(){}\n]*?[\s&*>](\w+)(?:\[\w*\])? ?[=({;]", re.MULTILINE)
BROUGHT = re.compile(r"^using (?:\w*::)+(\w+);", re.MULTILINE)
ANONYMOUS = re.compile(r"^namespace \{$(.*?)^\}  // namespace$", re.MULTILINE | re.DOTALL)
OWN_HEADER = re.compile(r'^#include "(.*)"', re.MULTILINE)


def named_in(text):
    """The names in a text, with the kind of each."""
    return {(what.split()[1] if what.startswith("using ") else what): what
            for match in NAMED.findall(text) for what in match if what not in ("", "main")}


def own_includes(file):
    """The files of this project that a file includes directly."""
    found = []
    for header in OWN_HEADER.findall(file.read_text()):
        places = (folder / header for folder in (ROOT / "src", file.parent, file.parent.parent, ROOT / "tests"))
        found += [place for place in places if place.exists()][:1]
    return found


@functools.cache
def names_of(file):
    """The names private to a file, and the names that others of its group would see, those of its headers included."""
    text = file.read_text()
    own = named_in("\n".join(ANONYMOUS.findall(text))) if file.suffix == ".cpp" else {}
    seen = {*named_in(ANONYMOUS.sub("", text)), *BROUGHT.findall(text)}
    for header in own_includes(file):
        seen |= names_of(header)[1]
    return own, seen


def compatible(a, b):
    """Whether two sources can be compiled as one."""
    (own_a, seen_a), (own_b, seen_b) = names_of(a), names_of(b)
    both = own_a.keys() & own_b.keys()
    return all(own_a[name] == own_b[name] != name for name in both) and not own_a.keys() & seen_b and not own_b.keys() & seen_a


def groups_of(sources, maximum):
    """The sources in groups of at most `maximum` compatible ones."""
    # Highway's sources include themselves, once for each instruction set.
    alone = [source for source in sources if "foreach_target.h" in source.read_text()]
    groups = []
    # Those that are the hardest to place come first.
    for source in sorted(set(sources) - set(alone), key=lambda source: (-len(names_of(source)[0]), source)):
        room = next((group for group in groups if len(group) < maximum and all(compatible(source, other) for other in group)), None)
        if room is None:
            groups.append([source])
        else:
            room.append(source)
    return groups + [[source] for source in alone]


def compile_flags(build):
    """The include folders and macros of all targets of a configured build folder together: every source compiles with them."""
    flags = {"-std=c++20": None}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        words = iter(shlex.split(entry["command"]))
        for word in words:
            if word.startswith(("-I", "-D")):
                flags[word] = None
            elif word == "-isystem":
                flags["-isystem" + next(words)] = None
    return [*flags]


def write_group(file, group):
    """Writes the source of a group, unless it is there as it should be."""
    text = "".join(f'#include "{os.path.relpath(source, file.parent)}"\n' for source in group)
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
