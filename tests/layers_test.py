#!/usr/bin/env python3
"""Compares the #includes of src/coppice, app and bench with layers.txt, both ways: a module includes exactly
the modules of its line. The CMakeLists.txt of a module lists all of its headers except *_internal.h, which no listed
header includes. A CMakeLists.txt lists every source of src and test. Source files have at most 600 lines. In the
library, only the module system includes headers of POSIX and Linux.

    layers_test.py [SOURCE_DIR]    prints one line per fault; exit code 1 if there is one
    layers_test.py --self-test     creates a small tree of files with known faults and expects exactly these
"""

import pathlib
import re
import sys
import tempfile

INCLUDE = re.compile(r'\s*#\s*include\s*["<]coppice/([^/">]+)/[^">]*[">]')
POSIX = re.compile(r"\s*#\s*include\s*<((?:sys|linux)/[^>]+|(?:unistd|fcntl|poll|signal|spawn|dlfcn)\.h)>")
# Sources outside the module system that include headers of POSIX, with the reason.
POSIX_EXCEPTIONS = {
    "src/coppice/base/column.cpp": "base is below system, and its allocation gives the kernel a hint for large pages",
}
INTERNAL = "_internal.h"
MAX_LINES = 600
ENDINGS = {".h", ".cpp", ".py", ".mjs", ".ts", ".tsx", ".css", ".cmake", ".cu", ".cuh"}


def read_layers(path):
    """Returns module -> the modules it may include."""
    allowed = {}
    for number, line in enumerate(path.read_text().splitlines(), 1):
        line = line.split("#")[0].strip()
        if not line:
            continue
        module, colon, targets = line.partition(":")
        if not colon or module in allowed:
            sys.exit(f"{path}:{number}: expected 'module: modules it may include', each module once")
        unknown = [t for t in targets.split() if t not in allowed]
        if unknown:
            sys.exit(f"{path}:{number}: {module} may include {unknown[0]}, which is not listed above it")
        allowed[module] = {"base", module, *targets.split()}
    return allowed


def find_module(relative):
    """Maps src/coppice/io/file.h -> io, app/cli/main.cpp -> app, anything else -> None."""
    parts = relative.parts
    if parts[:2] == ("src", "coppice"):
        return parts[2] if len(parts) > 3 else None
    return parts[0] if parts[0] in ("app", "bench") else None


def source_files(root):
    for folder in ("src", "app", "web", "bench", "tests", "examples"):
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in ENDINGS and "node_modules" not in path.parts:
                yield path


def find_faults(path, root, allowed, used):
    """Returns the faults of one file; adds the includes of its module to used, module -> modules."""
    relative = path.relative_to(root)
    lines = path.read_text(errors="replace").splitlines()
    if len(lines) > MAX_LINES:
        yield f"{relative}: {len(lines)} lines; the maximum is {MAX_LINES}"
    module = find_module(relative)
    if module is None:
        return
    if module not in allowed:
        yield f"{relative}: the module {module} is missing in layers.txt"
        return
    for number, line in enumerate(lines, 1):
        match = INCLUDE.match(line)
        if match:
            used.setdefault(module, set()).add(match[1])
        if match and match[1] not in allowed[module]:
            yield f"{relative}:{number}: forbidden include {module} -> {match[1]}: {line.strip()}"


def posix_faults(path, root):
    """Returns the includes of POSIX headers of one file that is part of the library, but not of system."""
    relative = path.relative_to(root)
    module = find_module(relative) if relative.parts[0] == "src" else None
    if module in (None, "system") or str(relative) in POSIX_EXCEPTIONS:
        return
    for number, line in enumerate(path.read_text(errors="replace").splitlines(), 1):
        match = POSIX.match(line)
        if match:
            yield f"{relative}:{number}: <{match[1]}> may be included only by system: use its functions"


def header_faults(root, module):
    """Returns the faults of the public headers of a module, which are installed."""
    folder = root / "src/coppice" / module
    lists = folder / "CMakeLists.txt"
    listed = set(re.findall(r"[\w/]+\.h\b", lists.read_text())) if lists.exists() else set()
    for path in sorted(folder.rglob("*.h")):
        relative = path.relative_to(root)
        if path.name.endswith(INTERNAL) == (str(path.relative_to(folder)) in listed):
            yield f"{relative}: {lists.relative_to(root)} must list all headers except *{INTERNAL}"
        if path.name.endswith(INTERNAL):
            continue
        for number, line in enumerate(path.read_text(errors="replace").splitlines(), 1):
            if INCLUDE.match(line) and INTERNAL in line:
                yield f"{relative}:{number}: a public header includes an internal one: {line.strip()}"


def unlisted_sources(root):
    """Returns the sources of src, and the tests, that no CMakeLists.txt names: nothing would compile them."""
    listed = "".join(path.read_text() for folder in ("src", "tests") for path in (root / folder).rglob("CMakeLists.txt"))
    sources = [*(root / "src").rglob("*.cpp"), *(root / "tests").rglob("*_test.cpp")]
    return [f"{path.relative_to(root)}: no CMakeLists.txt lists it" for path in sorted(sources) if path.name not in listed]


def all_faults(root):
    allowed = read_layers(root / "layers.txt")
    files = list(source_files(root))
    if not files:
        sys.exit(f"{root}: no sources found")
    used = {}
    faults = [fault for path in files for fault in find_faults(path, root, allowed, used)]
    faults += [fault for path in files for fault in posix_faults(path, root)]
    for module in allowed:
        faults += header_faults(root, module)
    for module, targets in allowed.items():
        for target in sorted(targets - used.get(module, set()) - {"base", module}):
            faults.append(f"layers.txt: {module} lists {target}, which it does not include")
    return faults + unlisted_sources(root)


def self_test():
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        files = {
            "layers.txt": "# comment\nbase:\nsystem:\nmesh:\nio: mesh\napp: io mesh\n",
            "src/coppice/base/CMakeLists.txt": "HEADERS a.h",
            "src/coppice/base/a.h": '#include "coppice/mesh/b.h"\n',
            "src/coppice/mesh/CMakeLists.txt": "HEADERS b.h",
            "src/coppice/mesh/b.h": '#include "coppice/base/a.h"\n#include <vector>\n',
            "src/coppice/io/CMakeLists.txt": "HEADERS d.h e_internal.h",
            "src/coppice/io/c.h": "",
            "src/coppice/io/c.cpp": '// long\n' * 601,
            "src/coppice/io/d.h": '#include "coppice/io/e_internal.h"\n',
            "src/coppice/io/e_internal.h": "",
            "src/coppice/mesh/d.cpp": '\n  #  include <coppice/io/c.h>\n',
            "src/coppice/new/e.h": "",
            "src/coppice/base/column.cpp": "#include <sys/mman.h>\n",
            "src/coppice/mesh/e.cpp": "#include <csignal>\n#include <poll.h>\n # include <sys/stat.h>\n",
            "src/coppice/system/f.cpp": "#include <unistd.h>\n",
            "src/CMakeLists.txt": "c.cpp d.cpp e.cpp f.cpp column.cpp",
            "tests/io/c_test.cpp": "",
            "app/cli/main.cpp": '#include "coppice/io/c.h"\n#include <unistd.h>\n',
        }
        for name, text in files.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text)
        found = all_faults(root)
    expected = [
        "src/coppice/base/a.h:1: forbidden include base -> mesh",
        "src/coppice/io/c.cpp: 601 lines",
        "src/coppice/mesh/d.cpp:2: forbidden include mesh -> io",
        "src/coppice/new/e.h: the module new is missing",
        "src/coppice/mesh/e.cpp:2: <poll.h> may be included only by system",
        "src/coppice/mesh/e.cpp:3: <sys/stat.h> may be included only by system",
        "src/coppice/io/c.h: src/coppice/io/CMakeLists.txt must list",
        "src/coppice/io/d.h:1: a public header includes an internal one",
        "src/coppice/io/e_internal.h: src/coppice/io/CMakeLists.txt must list",
        "layers.txt: io lists mesh",
        "layers.txt: app lists mesh",
        "tests/io/c_test.cpp: no CMakeLists.txt lists it",
    ]
    if len(found) != len(expected) or any(not f.startswith(e) for f, e in zip(found, expected)):
        sys.exit("self-test: expected\n  " + "\n  ".join(expected) + "\nbut found\n  " + "\n  ".join(found))


def main():
    if sys.argv[1:] == ["--self-test"]:
        self_test()
        return
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent
    faults = all_faults(root)
    for fault in faults:
        print(fault)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
