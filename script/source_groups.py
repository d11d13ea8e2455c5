#!/usr/bin/env python3
"""Sources that can be compiled as one: most of the time goes into the headers of others, and into making what these define inline,
which is done once for a group then. What a source keeps to itself, in an anonymous namespace, must have another name than
anything that the others of its group see.

    script/source_groups.py MOST SOURCE...  prints the number of each source's group, with ; between
"""
import functools
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
# A name that is defined or declared in the first column; of an alias all of it, since several may say the same.
NAMED = re.compile(r"^(?:struct|class|enum class|enum) (\w+)|^(using \w+ = .*)|"
                   r"^(?!namespace|using)[a-zA-Z][^=;(){}\n]*?[\s&*>](\w+)(?:\[\w*\])? ?[=({;]", re.MULTILINE)
BROUGHT = re.compile(r"^using (?:\w*::)+(\w+);", re.MULTILINE)
ANONYMOUS = re.compile(r"^namespace \{$(.*?)^\}  // namespace$", re.MULTILINE | re.DOTALL)
OWN_HEADER = re.compile(r'^#include "(.*)"', re.MULTILINE)


def named_in(text):
    """The names in a text, with what each one is."""
    return {(what.split()[1] if what.startswith("using ") else what): what
            for match in NAMED.findall(text) for what in match if what not in ("", "main")}


@functools.cache
def names_of(file):
    """What a file keeps to itself; and what others of its group would see of it, its headers included."""
    text = file.read_text()
    own = named_in("\n".join(ANONYMOUS.findall(text))) if file.suffix == ".cpp" else {}
    seen = {*named_in(ANONYMOUS.sub("", text)), *BROUGHT.findall(text)}
    for header in OWN_HEADER.findall(text):
        places = (folder / header for folder in (ROOT / "src", file.parent, ROOT / "tests"))
        seen |= next((names_of(place)[1] for place in places if place.exists()), set())
    return own, seen


def get_along(a, b):
    """Whether two sources can stand in one."""
    (own_a, seen_a), (own_b, seen_b) = names_of(a), names_of(b)
    both = own_a.keys() & own_b.keys()
    return all(own_a[name] == own_b[name] != name for name in both) and not own_a.keys() & seen_b and not own_b.keys() & seen_a


def groups_of(sources, most):
    """The sources in groups of at most so many, whose members get along."""
    # Highway's sources include themselves, once for each instruction set.
    alone = [source for source in sources if "foreach_target.h" in source.read_text()]
    groups = []
    # Those that are the hardest to place come first.
    for source in sorted(set(sources) - set(alone), key=lambda source: (-len(names_of(source)[0]), source)):
        room = next((group for group in groups if len(group) < most and all(get_along(source, other) for other in group)), None)
        if room is None:
            groups.append([source])
        else:
            room.append(source)
    return groups + [[source] for source in alone]


def main():
    sources = [pathlib.Path(word) for word in sys.argv[2:]]
    number = {source: i for i, group in enumerate(groups_of(sources, int(sys.argv[1]))) for source in group}
    print(";".join(str(number[source]) for source in sources), end="")


if __name__ == "__main__":
    main()
