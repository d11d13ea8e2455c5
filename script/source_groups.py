#!/usr/bin/env python3
"""Sources that can be compiled as one, since no two of them define the same name: most of the time goes into the headers of
others, which are read once for a group then.

    script/source_groups.py MOST SOURCE...  prints the number of each source's group, with ; between
"""
import functools
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
# A name that a source defines in its first column. No two sources of a group must define the same.
DEFINED = re.compile(r"^(?:struct|class|enum class|enum|using) (\w+)|"
                     r"^(?!namespace)[a-zA-Z][^=;(){}\n]*?[\s&*>](\w+)(?:\[\w*\])? ?[=({;]", re.MULTILINE)
OWN_HEADER = re.compile(r'^#include "(.*)"', re.MULTILINE)


@functools.cache
def names_of(file):
    """The file that defines each name of a source, or of an internal or a test's header that it includes by any way."""
    text = file.read_text()
    names = {}
    for header in OWN_HEADER.findall(text):
        places = (folder / header for folder in (ROOT / "src", file.parent, ROOT / "tests"))
        names |= next((names_of(place) for place in places if place.exists()), {})
    if file.suffix == ".cpp" or file.stem.endswith("_internal") or file.is_relative_to(ROOT / "tests"):
        names |= {name: file for match in DEFINED.findall(text) for name in match if name not in ("", "main")}
    return names


def groups_of(sources, most):
    """The sources in groups of at most so many, whose members share no names."""
    groups = []
    for source in sorted(sources):
        names = names_of(source)
        # Highway's sources include themselves, once for each instruction set.
        alone = "foreach_target.h" in source.read_text()
        room = [g for g in groups if len(g[0]) < most and all(g[1].get(n, f) == f for n, f in names.items())]
        if alone or not room:
            room = [([], {})]
            groups += room
        room[0][0].append(source)
        room[0][1].update(names)
    return [group for group, _ in groups]


def main():
    sources = [pathlib.Path(word) for word in sys.argv[2:]]
    number = {source: i for i, group in enumerate(groups_of(sources, int(sys.argv[1]))) for source in group}
    print(";".join(str(number[source]) for source in sources), end="")


if __name__ == "__main__":
    main()
