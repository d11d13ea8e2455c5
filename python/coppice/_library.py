"""The C interface (coppice_c.h) by ctypes."""

from __future__ import annotations

import ctypes
import os
import sys
from ctypes import POINTER, c_char_p, c_double, c_float, c_int, c_size_t, c_void_p
from typing import Any, Optional

OK = 0
CHECK_FAILED = 1
WRONG_USAGE = 2
BAD_INPUT = 3
FILE_TROUBLE = 4
INTERRUPTED = 130

SKELETON = 0
SURFACE = 1
POINTS = 2
BYTES = 3

PROGRESS = ctypes.CFUNCTYPE(c_int, c_void_p, c_char_p, c_double)


class SkeletonArrays(ctypes.Structure):
    _fields_ = [
        ("count", c_size_t),
        ("positions", c_void_p),
        ("radii", c_void_p),
        ("parents", c_void_p),
        ("origin", c_double * 3),
        ("units", c_char_p),
    ]


class SurfaceArrays(ctypes.Structure):
    _fields_ = [
        ("vertex_count", c_size_t),
        ("positions", c_void_p),
        ("face_count", c_size_t),
        ("face_size", c_size_t),
        ("corner_count", c_size_t),
        ("corners", c_void_p),
        ("first", c_void_p),
        ("texture", c_void_p),
        ("material_slots", c_void_p),
        ("origin", c_double * 3),
    ]


class PointsArrays(ctypes.Structure):
    _fields_ = [
        ("count", c_size_t),
        ("positions", c_void_p),
        ("origin", c_double * 3),
        ("intensities", c_void_p),
        ("classes", c_void_p),
        ("colors", c_void_p),
        ("tree_ids", c_void_p),
    ]


class InstancesArrays(ctypes.Structure):
    _fields_ = [
        ("count", c_size_t),
        ("prototypes", c_void_p),
        ("positions", c_void_p),
        ("rotations", c_void_p),
        ("scales", c_void_p),
        ("colors", c_void_p),
        ("origin", c_double * 3),
        ("prototype_count", c_size_t),
    ]


class Prototype(ctypes.Structure):
    _fields_ = [
        ("name", c_char_p),
        ("mesh", c_void_p),
        ("color", c_float * 3),
        ("image", c_void_p),
        ("image_size", c_size_t),
    ]


class Nodes(ctypes.Structure):
    _fields_ = [
        ("count", c_size_t),
        ("positions", c_void_p),
        ("radii", c_void_p),
        ("ids", c_void_p),
        ("parents", c_void_p),
    ]


class Faces(ctypes.Structure):
    _fields_ = [
        ("vertex_count", c_size_t),
        ("positions", c_void_p),
        ("face_count", c_size_t),
        ("face_size", c_size_t),
        ("corners", c_void_p),
    ]


# The functions of coppice_c.h: name -> (result, arguments).
_FUNCTIONS = {
    "version": (c_char_p, []),
    "task_create": (c_void_p, []),
    "task_free": (None, [c_void_p]),
    "task_set_progress": (None, [c_void_p, PROGRESS, c_void_p]),
    "task_cancel": (None, [c_void_p]),
    "task_run": (c_int, [c_void_p, c_size_t, POINTER(c_char_p)]),
    "task_message": (c_char_p, [c_void_p]),
    "task_output": (c_char_p, [c_void_p]),
    "task_report": (c_char_p, [c_void_p]),
    "task_put": (c_int, [c_void_p, c_char_p, c_void_p]),
    "task_take": (c_void_p, [c_void_p, c_char_p]),
    "object_free": (None, [c_void_p]),
    "object_kind": (c_int, [c_void_p]),
    "skeleton_get": (c_int, [c_void_p, POINTER(SkeletonArrays)]),
    "surface_get": (c_int, [c_void_p, POINTER(SurfaceArrays)]),
    "surface_normals": (c_int, [c_void_p, c_void_p]),
    "instances_get": (c_int, [c_void_p, POINTER(InstancesArrays)]),
    "prototype_get": (c_int, [c_void_p, c_size_t, POINTER(Prototype)]),
    "points_get": (c_int, [c_void_p, POINTER(PointsArrays)]),
    "bytes_get": (c_int, [c_void_p, POINTER(c_void_p), POINTER(c_size_t)]),
    "attribute_count": (c_size_t, [c_void_p]),
    "attribute_get": (c_int, [c_void_p, c_size_t, POINTER(c_char_p), POINTER(c_void_p)]),
    "skeleton_create": (c_int, [c_void_p, POINTER(Nodes), POINTER(c_void_p)]),
    "surface_create": (c_int, [c_void_p, POINTER(Faces), POINTER(c_void_p)]),
    "points_create": (c_int, [c_void_p, c_size_t, c_void_p, POINTER(c_void_p)]),
    "bytes_create": (c_int, [c_void_p, c_char_p, c_size_t, POINTER(c_void_p)]),
}

_library: Optional[Any] = None


def _find() -> str:
    named = os.environ.get("COPPICE_LIBRARY")
    if named:
        return named
    packed = os.path.join(os.path.dirname(os.path.abspath(__file__)), "lib", "libcoppice_c.so")
    return packed if os.path.exists(packed) else "libcoppice_c.so"


def library() -> Any:
    """Returns the library, which is loaded by the first call."""
    global _library
    if _library is None:
        try:
            loaded = ctypes.CDLL(_find())
        except OSError as error:
            raise ImportError(
                "the library libcoppice_c.so cannot be loaded: %s; install the wheel of coppice, or name the file "
                "in the environment variable COPPICE_LIBRARY" % error
            ) from None
        for name, (result, arguments) in _FUNCTIONS.items():
            function = getattr(loaded, "coppice_" + name)
            function.restype = result
            function.argtypes = arguments
            setattr(loaded, name, function)
        _library = loaded
    return _library


class Handle:
    """Owns an object of the library."""

    __slots__ = ("address", "__weakref__")

    def __init__(self, address: int) -> None:
        self.address = address

    def __del__(self) -> None:
        if _library is not None and not sys.is_finalizing():
            _library.object_free(self.address)

    def kind(self) -> int:
        return int(library().object_kind(self.address))


class _Memory:
    """Memory of an object as NumPy sees it; keeps the object alive."""

    def __init__(self, owner: Handle, address: int, shape: Any, kind: str) -> None:
        self.owner = owner
        self.__array_interface__ = {"data": (address, True), "shape": shape, "typestr": kind, "version": 3}


def view(owner: Handle, address: Optional[int], shape: Any, kind: str) -> Any:
    """Returns a read-only array of the memory of an object, without a copy; None for no memory."""
    import numpy

    if not address:
        count = 1
        for size in shape:
            count *= size
        return numpy.zeros(shape, kind) if count == 0 else None
    return numpy.asarray(_Memory(owner, address, shape, kind))
