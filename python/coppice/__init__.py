"""Coppice: trees, roots and vessels from skeletons to closed surfaces, and back.

    import coppice
    tree = coppice.Skeleton.read("oak.swc")
    surface = coppice.mesh(tree, levels=2)
    surface.positions, surface.quads              # NumPy arrays without a copy

Each command of the program is a function with its options as keyword arguments: help(coppice.mesh). Lengths are
metres, angles degrees, as on the command line.
"""

from __future__ import annotations

from importlib import import_module

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, List

# Names by the module that contains them, which the first use imports: importing coppice takes milliseconds.
_MODULES = {
    "_commands": ["Figures", "Result", "call"],
    "_errors": ["Cancelled", "Error", "FileError", "InputError", "UsageError"],
    "_objects": ["Image", "Instances", "Object", "Points", "Prototype", "Scene", "Skeleton", "Surface"],
    "_task": ["Progress", "run_words"],
}
_NAMES = {name: module for module, names in _MODULES.items() for name in names}

__all__ = [*_NAMES, "commands"]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from ._library import library

        return library().version().decode()
    if name.startswith("_"):
        raise AttributeError("module coppice has no attribute %s" % name)
    if name in _NAMES:
        found = getattr(import_module("coppice." + _NAMES[name]), name)
    else:
        try:
            found = import_module("coppice._commands").function(name)
        except KeyError:
            raise AttributeError("module coppice has no attribute %s" % name) from None
    globals()[name] = found
    return found


def commands() -> List[str]:
    """Returns the names of all functions that run commands."""
    return list(import_module("coppice._commands").commands())


def __dir__() -> List[str]:
    return sorted(set(__all__) | set(commands()))
