"""Builds the library of the C interface and packs it with the libraries that it needs, except those of the C and C++
compilers. The wheel works with every Python 3, because it contains no code for one of them."""

import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys

from setuptools import Distribution, setup
from setuptools.command.build_py import build_py
from wheel.bdist_wheel import bdist_wheel

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = ROOT / "build/wheel"
# Part of every Linux with the C library of the wheel's tag, or of GCC.
OF_SYSTEM = re.compile(r"(ld-linux.*|lib(c|m|dl|rt|pthread|stdc\+\+|gcc_s))\.so")
STUB = '''"""Declarations for type checkers, written by the build from the option schema."""

from os import PathLike
from typing import List, Literal, Optional, Sequence, Union

from ._commands import Figures as Figures
from ._commands import Result as Result
from ._commands import call as call
from ._errors import Cancelled as Cancelled
from ._errors import Error as Error
from ._errors import FileError as FileError
from ._errors import InputError as InputError
from ._errors import UsageError as UsageError
from ._objects import Image as Image
from ._objects import Instances as Instances
from ._objects import Object as Object
from ._objects import Points as Points
from ._objects import Prototype as Prototype
from ._objects import Scene as Scene
from ._objects import Skeleton as Skeleton
from ._objects import Surface as Surface
from ._task import Progress as Progress
from ._task import run_words as run_words

Path = Union[str, "PathLike[str]"]
Input = Union[Path, Object]
__version__: str

def commands() -> List[str]: ...
'''


def version():
    text = (ROOT / "CMakeLists.txt").read_text()
    return re.search(r"project\(coppice VERSION ([0-9.]+)", text)[1]


def build_library():
    """Returns the library, which finds others in its own folder."""
    # The old kind of tag is also used for the libraries of libraries.
    settings = {
        "CMAKE_BUILD_WITH_INSTALL_RPATH": "ON",
        "CMAKE_INSTALL_RPATH": "$ORIGIN",
        "CMAKE_SHARED_LINKER_FLAGS": "-Wl,--disable-new-dtags -Wl,--strip-all",
        "CMAKE_CXX_FLAGS": "",
    }
    defined = [word for name, value in settings.items() for word in ("-D", "%s=%s" % (name, value))]
    subprocess.run(["cmake", "--preset", "demo", "-B", str(BUILD), *defined], cwd=ROOT, check=True)
    subprocess.run(["cmake", "--build", str(BUILD), "--target", "coppice_c"], check=True)
    return BUILD / "lib/libcoppice_c.so"


def find_needed(library):
    """Returns the libraries that a library needs, directly or not, by the names under which they are needed."""
    text = subprocess.run(["ldd", str(library)], stdout=subprocess.PIPE, check=True, text=True).stdout
    if "not found" in text:
        sys.exit("setup.py: a library is missing:\n" + text)
    found = re.findall(r"^\s*(\S+) => (/\S+)", text, re.M)
    return {name: pathlib.Path(path).resolve() for name, path in found if not OF_SYSTEM.match(name)}


def copy_licence(library, folder):
    """Copies the copyright file of the Debian package that contains the library."""
    for path in (str(library), str(library).replace("/usr/lib", "/lib", 1)):
        owner = subprocess.run(["dpkg", "-S", path], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
        package = owner.split(":")[0]
        terms = pathlib.Path("/usr/share/doc") / package / "copyright"
        if package and terms.exists():
            shutil.copyfile(terms, folder / (package + ".txt"))
            return
    sys.exit("setup.py: %s belongs to no Debian package, so that its licence is unknown" % library)


class BuildWithLibrary(build_py):
    def run(self):
        super().run()
        package = pathlib.Path(self.build_lib) / "coppice"
        folder = package / "lib"
        licences = folder / "licences"
        shutil.rmtree(folder, ignore_errors=True)
        licences.mkdir(parents=True)
        library = build_library()
        shutil.copyfile(library, folder / "libcoppice_c.so")
        for name, path in find_needed(library).items():
            shutil.copyfile(path, folder / name)
            copy_licence(path, licences)
        shutil.copyfile(ROOT / "LICENSE", licences / "coppice.txt")
        self.write_stub(package)

    def write_stub(self, package):
        code = "import coppice._commands as c; print(c.make_stub(list(c.commands())))"
        environment = {**os.environ, "PYTHONPATH": str(package.parent)}
        environment.pop("COPPICE_LIBRARY", None)
        made = subprocess.run(
            [sys.executable, "-c", code], cwd=package.parent, env=environment, stdout=subprocess.PIPE, check=True, text=True
        )
        (package / "__init__.pyi").write_text(STUB + "\n" + made.stdout)


class TaggedWheel(bdist_wheel):
    def get_tag(self):
        libc = platform.libc_ver()[1].replace(".", "_")
        return "py3", "none", "manylinux_%s_%s" % (libc, platform.machine())


class WithLibrary(Distribution):
    def has_ext_modules(self):
        return True


setup(version=version(), distclass=WithLibrary, cmdclass={"build_py": BuildWithLibrary, "bdist_wheel": TaggedWheel})
